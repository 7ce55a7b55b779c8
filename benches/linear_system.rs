//! One linear elastic system, solved by multigrid or by factorisation.
//!
//!     cargo bench --bench linear_system -- CUBES [multigrid|cholesky]
//!
//! The unit cube of `CUBES^3` cubes of six tetrahedra, the face z = 0 clamped, E = 1, nu = 0.3, a
//! pseudo-random right-hand side. Prints one line of JSON for each solver.
#![allow(clippy::print_stdout, reason = "the lines are what it is run for")]

use std::time::Instant;

use glam::{DMat3, DVec3};
use kluft_algebra::multigrid::{Multigrid, rigid_modes};
use kluft_algebra::{
    Analysis, Cholesky, ConjugateGradientSettings, NodeOrder, conjugate_gradients,
};
use kluft_mesh::structured::{Patch, tetrahedra};
use kluft_mesh::{Mesh, SurfaceRole};
use kluft_run::memory;
use kluft_solver::{Condition, Discretisation, Problem, Support, System};
use lie_core::Rock;

/// Unknowns from which on the factor takes more than 16 GB; it is made only if asked for.
const LARGEST_FACTORISED: usize = 600_000;

fn main() {
    // Cargo adds `--bench`.
    let arguments = std::env::args().skip(1).filter(|a| a != "--bench");
    let arguments: Vec<String> = arguments.collect();
    let cubes = arguments.first().and_then(|text| text.parse().ok());
    let (Some(cubes), solver) = (cubes, arguments.get(1).map(String::as_str)) else {
        println!("usage: linear_system CUBES [multigrid|cholesky]");
        return;
    };
    let problem = problem(cubes);
    let discretisation = Discretisation::of(&problem).expect("a clamped cube");
    let system = System::assemble(&problem, discretisation);
    let right = right_hand_side(&system);
    if solver != Some("cholesky") {
        by_multigrid(&system, &right);
    }
    let fits = system.discretisation().unknown_count() < LARGEST_FACTORISED;
    if solver == Some("cholesky") || (solver.is_none() && fits) {
        by_cholesky(&system, &right);
    }
}

fn problem(cubes: usize) -> Problem {
    let at_bottom = |x: [f64; 3]| x[2] == 0.0;
    let bottom = Patch {
        name: "bottom",
        contains: &at_bottom,
    };
    let draft = tetrahedra([cubes; 3], [1.0; 3], &[bottom]);
    let roles = vec![SurfaceRole::Boundary; draft.groups.len()];
    let mesh = Mesh::build(draft, &roles).expect("a good mesh");
    let rock = Rock {
        young_modulus: 1.0,
        poisson_ratio: 0.3,
        density: 0.0,
        anisotropy: None,
    };
    Problem {
        conditions: vec![Condition {
            boundary: 0,
            load: None,
            support: Some(Support::Displacement([Some(0.0); 3])),
        }],
        ..Problem::of_rock(mesh, rock)
    }
}

/// Forces between -1/2 and 1/2, the same on every machine; none at held nodes.
fn right_hand_side(system: &System<'_>) -> Vec<DVec3> {
    let mut bits = 1_u64;
    let mut number = || {
        bits = bits
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (bits >> 40) as f64 / (1 << 24) as f64 - 0.5
    };
    let supports = system.discretisation().supports();
    (0..system.discretisation().points().len())
        .map(|point| supports.project(point, DVec3::new(number(), number(), number())))
        .collect()
}

fn by_multigrid(system: &System<'_>, right: &[DVec3]) {
    let discretisation = system.discretisation();
    let matrix = system.rock_rows();
    let start = Instant::now();
    let nodes = &system.problem().mesh.nodes;
    let modes: Vec<[DVec3; 6]> = (0..right.len())
        .map(|point| {
            let constraint = discretisation.supports().constraint(point);
            let free = constraint.map_or(DMat3::IDENTITY, |constraint| constraint.free);
            rigid_modes(nodes[point], DVec3::splat(0.5), free)
        })
        .collect();
    let multigrid = Multigrid::new(matrix, &modes).expect("positive definite");
    drop(modes);
    let setup = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let mut workspace = multigrid.workspace();
    let mut solution = vec![DVec3::ZERO; right.len()];
    let report = conjugate_gradients(
        |vector, product| matrix.multiply(vector, product),
        |residual, correction| multigrid.apply(residual, correction, &mut workspace),
        right,
        &mut solution,
        ConjugateGradientSettings {
            tolerance: 1e-8,
            max_iterations: 500,
        },
    );
    let solve = start.elapsed().as_secs_f64();
    print(system, "multigrid", setup, solve, report.iterations);
}

fn by_cholesky(system: &System<'_>, right: &[DVec3]) {
    let start = Instant::now();
    let points = system.discretisation().points();
    let graph = system.discretisation().pattern().node_graph(points);
    let first_unknown = &points.offset;
    let order = NodeOrder::of(&graph, first_unknown);
    let order = order.expect("ordered").all(first_unknown);
    let rows = system.rock_rows();
    let analysis =
        Analysis::of(&rows.pattern.row_offset, &rows.pattern.columns, order).expect("analysed");
    let mut solver = Cholesky::new(analysis, rows);
    solver.factorise().expect("positive definite");
    let setup = start.elapsed().as_secs_f64();
    let start = Instant::now();
    solver.solve(right);
    print(system, "cholesky", setup, start.elapsed().as_secs_f64(), 0);
}

fn print(system: &System<'_>, solver: &str, setup: f64, solve: f64, iterations: usize) {
    let unknowns = system.discretisation().unknown_count();
    let memory = memory::peak_bytes();
    println!(
        "{{\"unknowns\":{unknowns},\"solver\":\"{solver}\",\"setup_seconds\":{setup:.3},\
         \"solve_seconds\":{solve:.3},\"iterations\":{iterations},\"peak_memory_bytes\":{memory}}}"
    );
}
