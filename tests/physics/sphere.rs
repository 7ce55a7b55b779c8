//! The core that floats in a spherical joint: order of convergence, and the numbers of the scene.

use lie_core::ClosureKind;

use kluft_verification::oracles::spherical_joint::{self, Exact, sphere};
use kluft_verification::scenes::{self, EXACT, ROCK};

/// Relative errors of the default solution: traction, opening, core, shell.
fn errors(kind: ClosureKind, h: f64, order: u32) -> [f64; 4] {
    let problem = sphere(kind, ROCK, h, order);
    let solution = scenes::solve(&problem);
    let exact = Exact::of(kind, ROCK);
    let (errors, turn) = spherical_joint::errors(&problem, &solution, &exact);
    println!(
        "order {order}, h = {h:.3}: {:6} cells, traction {:.2e}, opening {:.2e}, core {:.2e}, shell {:.2e}, core turned by {turn:.1e}",
        problem.mesh.cells.len(),
        errors[0],
        errors[1],
        errors[2],
        errors[3]
    );
    errors
}

/// Slope of the error over `h` between the coarsest and the finest mesh.
fn orders(kind: ClosureKind, sizes: &[f64], order: u32) -> [f64; 4] {
    let table: Vec<[f64; 4]> = sizes.iter().map(|&h| errors(kind, h, order)).collect();
    let last = sizes.len() - 1;
    let ratio = (sizes[0] / sizes[last]).ln();
    let orders = [0, 1, 2, 3].map(|i| (table[0][i] / table[last][i]).ln() / ratio);
    println!("observed orders {orders:.2?}");
    orders
}

/// Facets approach the sphere at second order, and hold the rotation of the core, which costs
/// nothing on the sphere itself, by their angles alone. From h = 0.25 to 0.125 the orders are 2.02
/// (traction, opening), 2.00 (core) and 1.98 (shell).
#[test]
fn floating_core_converges_at_second_order() {
    for kind in [ClosureKind::Linear, EXACT] {
        let orders = orders(kind, &[0.35, 0.25, 0.177], 1);
        assert!(
            orders.iter().all(|order| (order - 2.0).abs() < 0.25),
            "{orders:?}"
        );
    }
}

/// About third order: from h = 0.5 to 0.177, 3.1 for traction and core and 2.3 for the shell.
#[test]
fn floating_core_of_quadratic_cells() {
    for kind in [ClosureKind::Linear, EXACT] {
        let orders = orders(kind, &[0.7, 0.5, 0.35], 2);
        assert!(orders.iter().all(|order| *order > 2.3), "{orders:?}");
    }
}

/// The numbers that the scene promises.
#[test]
fn closed_form_of_the_scene() {
    let exact = Exact::of(EXACT, ROCK);
    assert!((exact.q - 8.635_892e6).abs() < 1.0);
    assert!((exact.opening() + 1e-4 - 2.984_590e-5).abs() < 1e-11);
    assert!((exact.shell(2.0) + 4.175_385e-4).abs() < 1e-10);
    let linear = Exact::of(ClosureKind::Linear, ROCK);
    assert!((linear.q / 7.2e6 - 1.0).abs() < 1e-12);
}
