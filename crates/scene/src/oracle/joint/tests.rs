//! Joints under a pressure, against numbers that this crate has not made.

use super::*;

const ROCK: Rock = Rock {
    young_modulus: 25e9,
    poisson_ratio: 0.25,
    density: 0.0,
    anisotropy: None,
};

const EXACT: ClosureKind = ClosureKind::Logarithmic { cutoff: None };

fn column(kind: ClosureKind, pressure: f64) -> f64 {
    let closure = Closure::new(1e-4, 1e11, kind);
    let joint = PressedJoint::Column { pressure };
    assert_eq!(joint.carried(&ROCK, &closure), Some(pressure));
    joint.aperture(&ROCK, &closure).expect("an aperture")
}

/// Tolerance: the expected numbers have six digits or are exact.
fn near(found: f64, expected: f64) {
    assert!((found / expected - 1.0).abs() < 2e-6, "{found} {expected}");
}

/// By hand: the closure is p / K_n0, and (p / K_n0) / (1 + p / (K_n0 v_m)).
#[test]
fn a_column_closes_by_the_formula_of_its_law() {
    near(column(ClosureKind::Linear, 5e6), 5e-5);
    near(column(ClosureKind::Linear, 15e6), -5e-5);
    let hyperbolic = |max_closure| ClosureKind::Hyperbolic { max_closure };
    near(column(hyperbolic(5e-5), 5e6), 7.5e-5);
    near(column(hyperbolic(1e-4), 1e16), 1e-13);
    assert_eq!(column(ClosureKind::Contact, 5e6), 0.0);
}

/// Roots of `(1 + ln^2 x) (1 - x) = q` with q = p / (K_n0 b0), from an independent computation.
#[test]
fn a_column_with_the_logarithmic_law_has_tabulated_apertures() {
    for (q, x) in [
        (0.01, 0.990001),
        (0.1, 0.901073),
        (0.5, 0.602263),
        (1.0, 0.424013),
    ] {
        near(column(EXACT, q * 1e7), x * 1e-4);
    }
}

/// Walls meet at `p = K_n0 b0 (1 - ln x_c)^2`; above the cutoff the law is the exact one.
#[test]
fn below_the_cutoff_the_law_goes_on_linearly() {
    let cut = ClosureKind::Logarithmic { cutoff: Some(1e-5) };
    let meet = 1e7 * (1.0 - 0.1_f64.ln()).powi(2);
    assert!(column(cut, meet).abs() < 1e-16);
    assert!(column(cut, 1.1 * meet) < 0.0);
    assert_eq!(column(cut, 1e7), column(EXACT, 1e7));
}

/// G. Lame's hollow sphere with E = 25 GPa, nu = 0.25, radii 1 and 2 m, 10 MPa, b0 = 0.1 mm and
/// K_n0 = 50 GPa/m: q = 8.635892 MPa, w = -7.015410e-5 m.
#[test]
fn a_spherical_joint_has_published_values() {
    let joint = PressedJoint::Sphere {
        radius: 1.0,
        outer_radius: 2.0,
        pressure: 10e6,
    };
    let closure = Closure::new(1e-4, 50e9, EXACT);
    near(
        joint.carried(&ROCK, &closure).expect("a pressure"),
        8.635892e6,
    );
    let aperture = joint.aperture(&ROCK, &closure).expect("an aperture");
    near(aperture, 1e-4 - 7.015410e-5);
    let stiff = Closure::new(1e-4, 1e20, ClosureKind::Linear);
    near(joint.carried(&ROCK, &stiff).expect("a pressure"), 10e6);
}

#[test]
fn without_a_stiffness_there_is_no_root() {
    let closure = Closure::new(1e-4, 0.0, ClosureKind::Linear);
    let joint = PressedJoint::Column { pressure: 1e6 };
    assert_eq!(joint.aperture(&ROCK, &closure), None);
}
