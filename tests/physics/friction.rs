//! Coulomb friction: when joints slide, and how far.

use glam::{DMat3, DVec3};
use kluft_solver::{Discretisation, FacetState, Fracture, NewtonSettings, Problem, StepOutcome};
use lie_core::{Closure, ClosureKind, FractureLaw, Friction, Tension};

use kluft_verification::scenes::{self, EXACT};

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

/// Jaeger's plane of weakness: sliding starts at `s1 = s3 + 2 (c + s3 tan(phi)) / ((1 - tan(phi)
/// cot(beta)) sin(2 beta))`; for c = 1 MPa, phi = 30 and beta = 60 degrees, s3 = 0: 3.4641 MPa.
/// Nothing holds the upper block then.
#[test]
fn a_plane_of_weakness_slides_at_jaegers_load() {
    let jaeger = 3.4641e6;
    for closure in laws() {
        for stiffness in [20e9, f64::INFINITY] {
            let fracture = rubbing(closure, stiffness, 30.0, 1e6);
            let below = column(fracture, 0.999 * jaeger);
            let (record, solution, _) = scenes::try_solve(&below, NewtonSettings::default());
            assert!(record.converged() && record.substeps[0] <= 4, "{record:?}");
            for point in &solution.facet_points {
                assert_ne!(point.state, FacetState::Slipping);
                let elastic = 0.999 * jaeger * 60_f64.to_radians().sin() * 0.5 / stiffness;
                assert!((point.slip.length() - elastic).abs() < 1e-12);
            }
            for beyond in [1.001, 1.1] {
                let above = column(fracture, beyond * jaeger);
                let (record, ..) = scenes::try_solve(&above, NewtonSettings::default());
                assert_eq!(record.outcome, StepOutcome::RigidBodyMotion);
                // What joints without tension bear is told, of others how far the load went.
                match (closure.tension, record.bearable) {
                    (Tension::CutOff, Some(share)) => {
                        assert!((0.0..2e-3).contains(&(share * beyond - 1.0)), "{share}");
                    }
                    (Tension::Elastic, None) => {
                        let reached = record.completed * beyond;
                        assert!((0.96..1.0).contains(&reached), "{reached}");
                    }
                    other => panic!("{other:?}"),
                }
                let told = &record.rigid_motions[0].told;
                assert!(told.problem.contains("nothing holds it"), "{told}");
                assert!(told.remedy.contains("`joint`"), "{told}");
            }
        }
    }
}

/// A closed crack of half-length 1 under 100 MPa at 20 degrees to it slides against a friction of
/// 30 degrees (Phan et al. 2003): `4 (1 - nu^2)/E p sin psi (cos psi - sin psi tan phi) sqrt(1 -
/// x^2)`, 3.807850e-3 m in the middle, under a normal traction of -11.697778 MPa. Within 1 %
/// outside the outer fifth at each front, where quadratic triangles of 0.025 do not follow the
/// root.
#[test]
fn an_inclined_crack_slides_as_far_as_in_closed_form() {
    let draft = scenes::geometry_in_plane("line-crack", &[("h", 0.025)], 2);
    let mesh = scenes::build(draft);
    let fracture = rubbing(Closure::contact(0.0), f64::INFINITY, 30.0, 0.0);
    let mut problem = scenes::problem(mesh, fracture);
    let (pressure, psi) = (100e6, 20_f64.to_radians());
    let along = DVec3::new(psi.cos(), psi.sin(), 0.0);
    let stress = -pressure * DMat3::from_cols(along * along.x, along * along.y, along * along.z);
    scenes::load_faces_with_stress(&mut problem, &["left", "right", "bottom", "top"], stress);
    let corner = |x: f64| DVec3::new(x, -20.0, 0.0);
    scenes::fix(&mut problem, corner(-20.0), [Some(0.0), Some(0.0), None]);
    scenes::fix(&mut problem, corner(20.0), [None, Some(0.0), None]);
    let (record, solution, _) = scenes::try_solve(&problem, NewtonSettings::default());
    assert!(record.converged(), "{:?}", record.outcome);
    assert!(record.substeps.iter().all(|&count| count <= 25));
    let largest = 3.807850e-3;
    let nodes = &problem.mesh.facets.elements.nodes;
    let mut worst = 0.0_f64;
    let interface = Discretisation::of(&problem)
        .expect("supported")
        .into_interface();
    let results = solution.facet_nodes(&problem, &interface);
    for (point, &node) in std::iter::zip(&results, nodes) {
        let x = problem.mesh.nodes[node as usize].x.abs();
        if x < 0.8 {
            let wanted = largest * (1.0 - x * x).sqrt();
            worst = worst.max((point.slip.length() / wanted - 1.0).abs());
            assert_eq!(point.state, FacetState::Slipping);
            assert_eq!(point.aperture, 0.0);
        }
    }
    assert!(worst < 0.01, "{worst}");
}
