//! Coulomb friction: when joints slide, and how far.

use glam::{DMat3, DVec3};
use lie_core::{Closure, ClosureKind, FractureLaw, Friction};
use lie_solver::{Fracture, NewtonSettings, Problem};

use crate::scenes::{self, EXACT};

fn rubbing(closure: Closure, shear_stiffness: f64, degrees: f64, cohesion: f64) -> Fracture {
    Fracture {
        law: FractureLaw {
            closure,
            shear_stiffness,
            friction: Some(Friction {
                coefficient: degrees.to_radians().tan(),
                cohesion,
                dilation: 0.0,
            }),
        },
        fluid_pressure: 0.0,
    }
}

fn laws() -> [Closure; 4] {
    [
        Closure::new(1e-4, 50e9, ClosureKind::Linear),
        Closure::new(1e-4, 50e9, EXACT),
        Closure::new(1e-4, 50e9, ClosureKind::Hyperbolic { max_closure: 1e-4 }),
        Closure::contact(0.0),
    ]
}

/// A column with a joint at 60 degrees under an axial stress.
fn column(fracture: Fracture, axial: f64) -> Problem {
    let draft = scenes::geometry("inclined-joint", &[("dip", 60.0), ("h", 0.4)]);
    let mesh = scenes::build(draft);
    let mut problem = scenes::problem(mesh, fracture);
    scenes::load_with_stress(
        &mut problem,
        DMat3::from_diagonal(DVec3::new(0.0, 0.0, -axial)),
    );
    let (low, high) = problem.mesh.bounds();
    scenes::fix_rigid_motions(
        &mut problem,
        [
            DVec3::new(low.x, low.y, low.z),
            DVec3::new(high.x, low.y, low.z),
            DVec3::new(low.x, high.y, low.z),
        ],
    );
    problem
}

/// Jaeger's plane of weakness: sliding starts at
/// `s1 = s3 + 2 (c + s3 tan(phi)) / ((1 - tan(phi) cot(beta)) sin(2 beta))`; for c = 1 MPa, phi = 30
/// and beta = 60 degrees, s3 = 0: 3.4641 MPa.
#[test]
fn a_plane_of_weakness_slides_at_jaegers_load() {
    for closure in laws() {
        for stiffness in [20e9, f64::INFINITY] {
            for (axial, slides) in [(3.4606e6, false), (3.4676e6, true)] {
                let problem = column(rubbing(closure, stiffness, 30.0, 1e6), axial);
                let start = std::time::Instant::now();
                let (record, solution, _) = scenes::try_solve(&problem, NewtonSettings::default());
                println!(
                    "{:?} {stiffness:e} {axial}: {:?} {:?} {}",
                    closure.kind,
                    record.outcome,
                    record.parts,
                    record.iterations.len()
                );
                assert_eq!(record.converged(), !slides);
                let largest = solution
                    .facet_points
                    .iter()
                    .map(|p| p.slip.length())
                    .fold(0.0, f64::max);
                let sliding = solution
                    .facet_points
                    .iter()
                    .filter(|p| p.state == lie_solver::FacetState::Slipping)
                    .count();
                println!(
                    "   slip {largest:e} {sliding} of {} {:?}",
                    solution.facet_points.len(),
                    start.elapsed()
                );
            }
        }
    }
}
