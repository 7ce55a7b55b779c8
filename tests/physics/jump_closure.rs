//! Around a junction the jumps of the facets close: along every closed path through the sectors
//! they add up to zero, whatever the load, the law and the number of sectors.
//!
//! Sectors are those of the split-node formulation, jumps those of the facet points.

use glam::DVec3;
use kluft_mesh::structured::Patch;
use kluft_solver::{Problem, Solution, Support};

use kluft_verification::methods::split_nodes::copies;
use kluft_verification::scenes::networks;
use kluft_verification::scenes::{self, EXACT, joint};

type Contains<'a> = &'a dyn Fn([f64; 3]) -> bool;

/// A block held at its bottom and loaded askew, so that no symmetry closes the loops by itself.
fn loaded(mut problem: Problem) -> (Problem, Solution) {
    scenes::support(
        &mut problem,
        "bottom",
        Support::Displacement([Some(0.0); 3]),
    );
    scenes::load(&mut problem, "top", DVec3::new(1e6, -0.6e6, -7e6));
    scenes::load(&mut problem, "right", DVec3::new(-3e6, 0.5e6, 0.2e6));
    scenes::load(&mut problem, "back", DVec3::new(0.3e6, -1.5e6, 0.4e6));
    // Every fracture its own stiffness.
    for (number, fracture) in problem.fractures.iter_mut().enumerate() {
        fracture.law.closure.normal_stiffness *= 1.0 + 0.7 * number as f64;
        fracture.law.shear_stiffness *= 1.0 + 1.3 * number as f64;
    }
    let solution = scenes::solve(&problem);
    (problem, solution)
}

fn planes(patches: &[(&str, Contains<'_>)]) -> Problem {
    let patches: Vec<Patch<'_>> = patches
        .iter()
        .map(|&(name, contains)| Patch { name, contains })
        .collect();
    let draft = scenes::box_draft([4; 3], [1.0; 3], &patches);
    scenes::problem(scenes::build(draft), joint(EXACT))
}

/// A facet at a node: the copies of the node on its two sides, and the jump there.
struct Step {
    minus: usize,
    plus: usize,
    jump: DVec3,
}

/// Steps from copy to copy around every node.
fn steps(problem: &Problem, solution: &Solution) -> Vec<Vec<Step>> {
    let mesh = &problem.mesh;
    let (copy, _) = copies(mesh);
    let facets = &mesh.facets;
    let mut steps: Vec<Vec<Step>> = (0..mesh.nodes.len()).map(|_| Vec::new()).collect();
    for facet in 0..facets.elements.len() {
        for point in facets.elements.range(facet) {
            let node = facets.elements.nodes[point];
            let seen = |cell: u32| {
                let mut range = mesh.cells.range(cell as usize);
                let slot = range.find(|&slot| mesh.cells.nodes[slot] == node);
                copy[slot.expect("a node of the cell")]
            };
            steps[node as usize].push(Step {
                minus: seen(facets.minus[facet]),
                plus: seen(facets.plus[facet]),
                jump: solution.facet_points[point].jump,
            });
        }
    }
    steps
}

/// Walks from copy to copy and adds up jumps; every step that leads back to a known copy closes a
/// loop. Returns the largest gap and the number of copies reached.
fn largest_gap(steps: &[Step]) -> (f64, usize) {
    let Some(first) = steps.first() else {
        return (0.0, 1);
    };
    let mut known = std::collections::BTreeMap::from([(first.minus, DVec3::ZERO)]);
    for _ in 0..steps.len() {
        for step in steps {
            match (
                known.get(&step.minus).copied(),
                known.get(&step.plus).copied(),
            ) {
                (Some(minus), None) => known.insert(step.plus, minus + step.jump),
                (None, Some(plus)) => known.insert(step.minus, plus - step.jump),
                _ => None,
            };
        }
    }
    let gap = |step: &Step| (known[&step.plus] - known[&step.minus] - step.jump).length();
    (steps.iter().map(gap).fold(0.0, f64::max), known.len())
}

/// Loops of all nodes close to rounding. At some node exactly `sectors` copies meet whose jumps
/// differ from facet to facet, so that the closure is no accident of symmetry.
fn check((problem, solution): &(Problem, Solution), sectors: usize) {
    let jumps = solution
        .facet_points
        .iter()
        .map(|point| point.jump.length());
    let largest = jumps.fold(0.0, f64::max);
    let (mut most, mut differ) = (0, false);
    for steps in steps(problem, solution) {
        let (gap, copies) = largest_gap(&steps);
        // A handful of sums of numbers of the size of the largest jump.
        assert!(gap < 1e-13 * largest, "{gap:e} of {largest:e}");
        most = most.max(copies);
        let lengths = || steps.iter().map(|step| step.jump.length());
        let (low, high) = (
            lengths().fold(f64::INFINITY, f64::min),
            lengths().fold(0.0, f64::max),
        );
        differ |= copies == sectors && low > 0.0 && high > 1.1 * low;
    }
    assert_eq!(most, sectors);
    assert!(differ);
}

#[test]
fn jumps_close_around_an_x() {
    let (a, b): (Contains<'_>, Contains<'_>) = (&|x| x[2] == 0.5, &|x| x[0] == 0.5);
    check(&loaded(planes(&[("a", a), ("b", b)])), 4);
}

#[test]
fn jumps_close_around_a_t() {
    let through: Contains<'_> = &|x| x[2] == 0.5;
    let abutting: Contains<'_> = &|x| x[0] == 0.5 && x[2] <= 0.5;
    check(
        &loaded(planes(&[("through", through), ("abutting", abutting)])),
        3,
    );
}

#[test]
fn jumps_close_around_a_y() {
    let draft = scenes::geometry("y-junction", &[("h", 0.3)]);
    check(
        &loaded(scenes::problem(scenes::build(draft), joint(EXACT))),
        3,
    );
}

#[test]
fn jumps_close_around_eight_octants() {
    let p: [Contains<'_>; 3] = [&|x| x[0] == 0.5, &|x| x[1] == 0.5, &|x| x[2] == 0.5];
    check(&loaded(planes(&[("x", p[0]), ("y", p[1]), ("z", p[2])])), 8);
}

/// Five planes through one line: ten sectors, beyond any table made by hand.
#[test]
fn jumps_close_around_ten_sectors() {
    let draft = networks::meshed(&networks::fan(5), 0.3).expect("a mesh");
    check(
        &loaded(scenes::problem(networks::built(draft), joint(EXACT))),
        10,
    );
}
