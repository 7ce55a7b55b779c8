//! Coulomb friction: when joints slide, and how far.

use glam::{DMat3, DVec3};
use lie_core::{Closure, ClosureKind, FractureLaw, Friction};
use lie_solver::{FacetState, Fracture, NewtonSettings, Outcome, Problem};

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
    let hyperbolic = ClosureKind::Hyperbolic { max_closure: 1e-4 };
    [
        Closure::new(1e-4, 50e9, ClosureKind::Linear),
        Closure::new(1e-4, 50e9, EXACT),
        Closure::new(1e-4, 50e9, hyperbolic),
        Closure::contact(0.0),
    ]
}

/// A column with a joint at 60 degrees under an axial stress.
fn column(fracture: Fracture, axial: f64) -> Problem {
    let draft = scenes::geometry("inclined-joint", &[("dip", 60.0), ("h", 0.4)]);
    let mesh = scenes::build(draft);
    let mut problem = scenes::problem(mesh, fracture);
    let stress = DMat3::from_diagonal(DVec3::new(0.0, 0.0, -axial));
    scenes::load_with_stress(&mut problem, stress);
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
/// and beta = 60 degrees, s3 = 0: 3.4641 MPa. Nothing holds the upper block then.
#[test]
fn a_plane_of_weakness_slides_at_jaegers_load() {
    let jaeger = 3.4641e6;
    for closure in laws() {
        for stiffness in [20e9, f64::INFINITY] {
            let fracture = rubbing(closure, stiffness, 30.0, 1e6);
            let below = column(fracture, 0.999 * jaeger);
            let (record, solution, _) = scenes::try_solve(&below, NewtonSettings::default());
            assert!(record.converged() && record.parts[0] <= 4, "{record:?}");
            for point in &solution.facet_points {
                assert_ne!(point.state, FacetState::Slipping);
                let elastic = 0.999 * jaeger * 60_f64.to_radians().sin() * 0.5 / stiffness;
                assert!((point.slip.length() - elastic).abs() < 1e-12);
            }
            let above = column(fracture, 1.001 * jaeger);
            let (record, ..) = scenes::try_solve(&above, NewtonSettings::default());
            assert_eq!(record.outcome, Outcome::Loose);
            assert!((0.96..1.0).contains(&record.walked), "{}", record.walked);
            assert!(record.loose[0].problem.contains("nothing holds it"));
            assert!(record.loose[0].remedy.contains("`joint`"));
        }
    }
}
