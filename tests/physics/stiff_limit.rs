//! Joints as stiff as can be weld: the network becomes the intact rock.

use kluft_mesh::SurfaceRole;
use kluft_solver::{NewtonSettings, Problem, SectorNodes};

use kluft_verification::scenes;
use kluft_verification::scenes::networks;

/// Cell size of the networks (m).
const SIZE: f64 = 0.25;

/// The same mesh and loads without any fracture.
fn welded(fractured: &Problem, seed: u64) -> Problem {
    let draft = networks::meshed(&networks::polygons(seed), SIZE).expect("a mesh");
    let weld = |role| match role {
        SurfaceRole::Fracture => SurfaceRole::Unused,
        kept => kept,
    };
    let roles: Vec<SurfaceRole> = scenes::roles(&draft).into_iter().map(weld).collect();
    let mesh = kluft_mesh::Mesh::build(draft, &roles).expect("a good mesh");
    Problem {
        fractures: Vec::new(),
        mesh,
        ..fractured.clone()
    }
}

/// Displacement at every cell node.
fn at_cells(problem: &Problem) -> Vec<glam::DVec3> {
    let (record, solution, _) = scenes::try_solve(problem, NewtonSettings::default());
    assert!(record.converged(), "{record:?}");
    let points = SectorNodes::of(&problem.mesh);
    let moved = points.of_cell_node.iter();
    moved
        .map(|&point| solution.displacements[point as usize])
        .collect()
}

/// A joint adds the compliance 1/K to the h/E of the cells beside it, so the difference falls with
/// E/(K h), until at K = 1e8 E/h rounding, 1e-16 times as much, meets it.
#[test]
fn stiff_networks_are_intact_rock() {
    for seed in [1, 4] {
        let draft = networks::meshed(&networks::polygons(seed), SIZE).expect("a mesh");
        let mut problem = networks::random_problem(draft, seed);
        let intact = at_cells(&welded(&problem, seed));
        let largest = intact.iter().map(|u| u.length()).fold(0.0, f64::max);
        let differences = [1e2, 1e4, 1e6, 1e8].map(|stiff| {
            for fracture in &mut problem.fractures {
                let stiffness = stiff * problem.rocks[0].young_modulus / SIZE;
                fracture.law.closure.normal_stiffness = stiffness;
                fracture.law.shear_stiffness = stiffness;
            }
            let moved = at_cells(&problem);
            let apart = intact.iter().zip(&moved).map(|(u, v)| u.distance(*v));
            apart.fold(0.0, f64::max) / largest
        });
        let table = differences.map(|difference| format!("{difference:.1e}"));
        println!("seed {seed}: K h/E = 1e2, 1e4, 1e6, 1e8 differ by {table:?} from intact rock");
        assert!(differences[2] < 3e-6, "{differences:?}");
        for pair in differences.windows(2).take(2) {
            let ratio = pair[0] / pair[1];
            assert!((ratio / 100.0 - 1.0).abs() < 0.2, "{differences:?}");
        }
        assert!(differences[3] < 1e-7, "{differences:?}");
    }
}
