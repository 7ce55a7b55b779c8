//! Cracks against numbers of the literature.

use lie_core::{ClosureKind, FractureLaw};

use super::*;

const ROCK: Rock = Rock {
    young_modulus: 25e9,
    poisson_ratio: 0.25,
    density: 0.0,
    anisotropy: None,
};

fn disc() -> Oracle {
    Oracle {
        extent: Extent::Disc {
            centre: DVec3::ZERO,
            radius: 1.0,
        },
        opening: Some(Prescribed::Stress(2e6)),
        slip: Some(Prescribed::Stress(2e6)),
        normal_traction: None,
        joint: None,
        ring: RING,
    }
}

fn near(found: f64, expected: f64) {
    assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
}

/// Numbers of the literature for E = 25 GPa, nu = 0.25, 2 MPa, radius 1 m.
#[test]
fn a_disc_has_published_values() {
    let opening = disc().opening(&ROCK).expect("an opening");
    near(opening.at(DVec3::ZERO), 1.909859e-4);
    near(opening.volume(0.0), 4.0e-4);
    near(disc().stress_intensity().expect("K_I"), 2.256758e6);
    near(
        disc().slip(&ROCK).expect("a slip").at(DVec3::ZERO),
        2.182696e-4,
    );
    assert_eq!(opening.at(DVec3::X), 0.0);
}

#[test]
fn a_strip_has_published_values() {
    let extent = Extent::Strip {
        centre: DVec3::ZERO,
        along: DVec3::X,
        half_length: 1.0,
    };
    let strip = Oracle { extent, ..disc() };
    let opening = strip.opening(&ROCK).expect("an opening");
    near(opening.at(DVec3::new(0.0, 7.0, 0.0)), 3.0e-4);
    near(opening.volume(2.0), 4.712389e-4);
    near(strip.stress_intensity().expect("K_I"), 3.544908e6);
}

#[test]
fn a_pressed_joint_needs_a_stiffness_and_a_sphere_no_fluid() {
    let fracture = |normal_stiffness, fluid_pressure| Fracture {
        law: FractureLaw {
            closure: Closure::new(1e-4, normal_stiffness, ClosureKind::Linear),
            shear_stiffness: 0.0,
            friction: None,
        },
        fluid_pressure,
    };
    let pressed = |joint| Oracle {
        extent: Extent::Everywhere,
        opening: None,
        slip: None,
        joint: Some(joint),
        ..disc()
    };
    let column = pressed(PressedJoint::Column { pressure: 1e6 });
    let sphere = pressed(PressedJoint::Sphere {
        radius: 1.0,
        outer_radius: 2.0,
        pressure: 1e6,
    });
    let remedy =
        |oracle: Oracle, fracture: Fracture| oracle.refusal(&fracture, true).map(|[_, r]| r);
    assert_eq!(remedy(column, fracture(1e11, 1e6)), None);
    assert_eq!(remedy(sphere, fracture(1e11, 0.0)), None);
    assert_eq!(remedy(disc(), fracture(0.0, 1e6)), None);
    let stiffness = remedy(column, fracture(0.0, 0.0)).expect("a remedy");
    assert!(stiffness.contains("normal_stiffness"), "{stiffness}");
    let fluid = remedy(sphere, fracture(1e11, 1e6)).expect("a remedy");
    assert!(fluid.contains("fluid_pressure"), "{fluid}");
    let closure = fracture(1e11, 0.0).law.closure;
    assert_eq!(column.normal_traction(&ROCK, &closure), Some(-1e6));
    let aperture = column.aperture(&ROCK, &closure).expect("an aperture");
    near(aperture, 9e-5);
}
