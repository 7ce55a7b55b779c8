//! What the hierarchy promises for rock that fractures cut.

use glam::{DMat3, DVec3};
use kluft_algebra::multigrid::{CoarseBasis, Multigrid, rigid_modes};
use kluft_algebra::{Communicator, norm, small};
use kluft_mesh::structured::{Patch, tetrahedra};
use kluft_mesh::{Mesh, SurfaceRole};
use lie_core::{Closure, ClosureKind, FractureLaw, Rock};

use crate::linear::iterative::Iterative;
use crate::linear::split_aggregates::SplitAggregates;
use crate::linear::tangent_solver::TangentSolver;
use crate::problem::{Condition, Fracture, Problem, Support};
use crate::system::{Discretisation, System};

const CUBES: usize = 10;
/// Young's modulus (Pa); the block has edges of 1 m.
const YOUNG: f64 = 1.0;

/// A block that stands on its clamped bottom, cut through by a level plane; an upright one ends on
/// it. `height` moves the planes of nodes.
pub(crate) fn problem(height: fn(f64) -> f64) -> Problem {
    let patches = [
        Patch {
            name: "level",
            contains: &|x: [f64; 3]| x[2] == 0.5,
        },
        Patch {
            name: "upright",
            contains: &|x: [f64; 3]| x[0] == 0.5 && x[2] <= 0.5 && x[1] <= 0.7,
        },
    ];
    cut_by(patches, height)
}

/// A block that stands on its clamped bottom, with fractures on two patches.
fn cut_by([one, other]: [Patch<'_>; 2], height: fn(f64) -> f64) -> Problem {
    let bottom = Patch {
        name: "bottom",
        contains: &|x: [f64; 3]| x[2] == 0.0,
    };
    let mut draft = tetrahedra([CUBES; 3], [1.0; 3], &[one, other, bottom]);
    for node in &mut draft.nodes {
        node[2] = height(node[2]);
    }
    let fracture = SurfaceRole::Fracture;
    let roles = [
        SurfaceRole::Unused,
        fracture,
        fracture,
        SurfaceRole::Boundary,
    ];
    let mesh = Mesh::build(draft, &roles).expect("a sound mesh");
    let law = FractureLaw::elastic(Closure::new(1e-4, YOUNG, ClosureKind::Linear), YOUNG);
    let rock = Rock {
        young_modulus: YOUNG,
        poisson_ratio: 0.25,
        density: 0.0,
        anisotropy: None,
    };
    Problem {
        fractures: vec![
            Fracture {
                law,
                fluid_pressure: 0.0
            };
            2
        ],
        conditions: vec![Condition {
            boundary: 0,
            load: None,
            support: Some(Support::Displacement([Some(0.0); 3])),
        }],
        ..Problem::of_rock(mesh, rock)
    }
}

pub(crate) fn system(problem: &Problem) -> System<'_> {
    System::assemble(problem, Discretisation::of(problem).expect("held"))
}

fn modes(problem: &Problem) -> Vec<[DVec3; 6]> {
    let nodes = problem.mesh.nodes.iter();
    nodes
        .map(|&node| rigid_modes(node, DVec3::splat(0.5), DMat3::IDENTITY))
        .collect()
}

/// The multigrid of the rock, and the motions of its next level.
fn prepared(system: &System<'_>) -> (Multigrid, CoarseBasis) {
    let space = system.discretisation.space(system.problem);
    let mut basis = CoarseBasis::default();
    let multigrid = Multigrid::with_basis(
        system.rock_rows(),
        &space.points.offset,
        &modes(system.problem),
        |means| {
            basis = SplitAggregates::of(space, means, &Communicator::alone()).basis(|_| true);
            basis.clone()
        },
    );
    (multigrid.expect("positive definite"), basis)
}

/// Forces without a pattern, on directions that are free.
fn forces(system: &System<'_>) -> Vec<DVec3> {
    let number = |at: usize| ((at * at * 7919 + at * 13) % 1009) as f64 / 1009.0 - 0.5;
    let supports = &system.discretisation.supports;
    (0..system.discretisation.points.len())
        .map(|at| {
            let force = DVec3::new(number(3 * at), number(3 * at + 1), number(3 * at + 2));
            supports.project(at, force)
        })
        .collect()
}

/// Iterations to 1e-8 with these stiffnesses (Pa/m) of the facet points; the residual is computed
/// anew.
fn iterations(system: &System<'_>, stiffness: impl Fn(usize) -> f64) -> usize {
    iterations_along(system, |point| DVec3::splat(stiffness(point)))
}

/// The same with stiffnesses along the axes.
fn iterations_along(system: &System<'_>, stiffness: impl Fn(usize) -> DVec3) -> usize {
    let interface = &system.discretisation.interface;
    let tangents: Vec<DMat3> = (0..interface.points.len())
        .map(|point| DMat3::from_diagonal(stiffness(point)))
        .collect();
    let mut solver = Iterative::new(system).expect("positive definite");
    let (fixed, stiffness) = (system.fixed_part(), interface.stiffness(&tangents));
    let updated = solver.update(fixed, stiffness.clone());
    updated.expect("positive definite");
    let right = forces(system);
    let solution = solver.solve(fixed, &right, 1e-8).expect("converges");
    assert!(remaining(system, &stiffness, &solution.unknowns, &right) < 1e-7);
    solution.iterations
}

/// Walls that press on each other and slide have motions of their own on every level.
#[test]
fn walls_that_slide_cost_hardly_more_iterations_than_glued_ones() {
    let problem = problem(|z| z);
    let system = system(&problem);
    let beside = YOUNG * CUBES as f64;
    for across in [1.0, 1e2, 1e6] {
        for along in [1e-1, 1e-2, 1e-3, 1e-4] {
            let [one, both] = [1.0, along].map(|other| {
                let stiffness = beside * DVec3::new(along, other, across);
                iterations_along(&system, |_| stiffness)
            });
            println!("K_n h/E = {across:e}, K_s h/E = {along:e}: {one}, in all directions {both}");
            assert!(
                one <= 16 && both <= 18,
                "{across:e}, {along:e}: {one}, {both}"
            );
        }
    }
}

/// What a solution leaves of the forces, as a share of them, with this stiffness of the fractures.
pub(crate) fn remaining(
    system: &System<'_>,
    stiffness: &[DMat3],
    solution: &[DVec3],
    forces: &[DVec3],
) -> f64 {
    let mut image = forces.to_vec();
    system
        .fixed_part()
        .multiply(stiffness, solution, &mut image);
    let rest: Vec<DVec3> = image.iter().zip(forces).map(|(a, b)| *a - *b).collect();
    norm(&rest) / norm(forces)
}

#[test]
fn iterations_hardly_depend_on_the_stiffness_of_fractures() {
    let problem = problem(|z| z);
    let system = system(&problem);
    // From almost free walls to almost glued ones, against the rock beside them.
    let beside = YOUNG * CUBES as f64;
    for decade in -5..=5 {
        let stiffness = beside * 10_f64.powi(decade);
        let count = iterations(&system, |_| stiffness);
        println!("K h/E = 1e{decade}: {count}");
        assert!(count <= 20, "1e{decade}: {count}");
    }
    // Beyond what single precision can tell from the rock.
    for decade in [6, 8, 10] {
        let stiff = beside * 10_f64.powi(decade);
        let [glued, sliding] = [DVec3::splat(stiff), DVec3::new(1e-3, 1e-3, stiff)]
            .map(|along| iterations_along(&system, |_| along));
        println!("K h/E = 1e{decade}: glued {glued}, sliding {sliding}");
        assert!(glued <= 20 && sliding <= 20);
    }
    // Neighbours of any stiffness.
    let count = iterations(&system, |point| {
        beside * 10_f64.powi((point * 7 % 7) as i32 - 3)
    });
    assert!(count <= 20, "{count}");
}

#[test]
fn a_sliver_beside_a_fracture_costs_no_iterations() {
    // The nodes above the level plane lie 1/20 of an edge from it.
    let thin = problem(|z| if (z - 0.6).abs() < 1e-9 { 0.505 } else { z });
    let system = system(&thin);
    let (multigrid, _) = prepared(&system);
    assert!(multigrid.cluster_count() < thin.mesh.nodes.len());
    let count = iterations(&system, |_| YOUNG);
    println!("with a sliver: {count}");
    assert!(count <= 20, "{count}");
}

/// Two cracks from one side leave a tongue of rock between them, one cell thick, that hangs on the
/// rock ahead of their edges.
#[test]
fn a_tongue_between_two_open_cracks_costs_few_iterations() {
    let patches = [
        Patch {
            name: "below",
            contains: &|x: [f64; 3]| x[2] == 0.5 && x[0] <= 0.5 && x[1] <= 0.5,
        },
        Patch {
            name: "above",
            contains: &|x: [f64; 3]| x[2] == 0.6 && x[0] <= 0.5 && x[1] <= 0.5,
        },
    ];
    let tongue = cut_by(patches, |z| z);
    let count = iterations(&system(&tongue), |_| 1e-4 * YOUNG);
    println!("with a tongue: {count}");
    assert!(count <= 16, "{count}");
}

/// The upper part moving alone, by one: a motion of the next level, as far as the clamped bottom is
/// away.
#[test]
fn parts_move_apart_exactly_on_the_next_level() {
    let problem = problem(|z| z);
    let system = system(&problem);
    let Discretisation {
        points, pattern, ..
    } = &system.discretisation;
    let (_, basis) = prepared(&system);
    let height = |unknown: usize| problem.mesh.nodes[points.node[unknown] as usize].z;
    // Copies that move a node above the plane.
    let mut is_upper = vec![false; basis.modes().len()];
    for unknown in (0..points.len()).filter(|&unknown| height(unknown) > 0.55) {
        basis
            .row(unknown)
            .for_each(|(copy, _)| is_upper[copy] = true);
    }
    let moved = |unknown: usize| {
        let mut sum = [0.0; 3];
        for (copy, block) in basis.row(unknown).filter(|(copy, _)| is_upper[*copy]) {
            for (sum, line) in sum.iter_mut().zip(small::widen(block)) {
                let along_x = basis.modes()[copy].map(|row| row[0]);
                *sum += line.iter().zip(along_x).map(|(a, b)| a * b).sum::<f64>();
            }
        }
        DVec3::from_array(sum)
    };
    let mut expected = vec![DVec3::ZERO; points.len()];
    for (slot, &point) in points.of_cell_node.iter().enumerate() {
        let (cell, _) = pattern
            .cell_of_slot
            .locate(slot as u32, &problem.mesh.cells);
        let corners = problem.mesh.corners(&problem.mesh.cells, cell);
        let middle: f64 = corners.iter().map(|corner| corner.z).sum::<f64>() / 4.0;
        expected[point as usize].x = if middle > 0.5 { 1.0 } else { 0.0 };
    }
    let vector: Vec<DVec3> = (0..points.len()).map(moved).collect();
    for point in (0..points.len()).filter(|&point| height(point) > 0.35) {
        let difference = points.displacement(&vector, point) - expected[point];
        // The motions are stored in single precision.
        assert!(difference.length() < 1e-5, "{point}: {difference}");
    }
}
