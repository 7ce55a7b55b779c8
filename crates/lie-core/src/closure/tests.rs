//! Closure laws against references, differences and each other.

use super::*;

const CUTOFFS: [Option<f64>; 6] = [
    None,
    Some(1e-2),
    Some(1e-4),
    Some(1e-8),
    Some(1e-12),
    Some(1.0),
];

fn unit(cutoff: Option<f64>) -> Closure {
    Closure::new(1.0, 1.0, ClosureKind::Logarithmic { cutoff })
}

/// Independently computed values of the law: closing load, aperture, tangent.
#[test]
fn reference_table() {
    let table = [
        (0.01, 0.990001, 1.000),
        (0.1, 0.901073, 1.034),
        (0.5, 0.602263, 1.927),
        (1.0, 0.424013, 4.067),
        (2.0, 0.268121, 9.919),
        (5.0, 0.115641, 38.65),
        (10.0, 0.0459915, 138.2),
        (20.0, 0.0124296, 717.5),
        (50.0, 9.0892e-4, 1.545e4),
        (100.0, 4.7722e-5, 4.171e5),
    ];
    for (q, x, tangent) in table {
        let aperture = unit(None).balanced(0.0, -q).aperture;
        assert!((aperture / x - 1.0).abs() < 2e-5, "q = {q}: {aperture}");
        let slope = unit(None).at_aperture(aperture).tangent;
        assert!((slope / tangent - 1.0).abs() < 1e-3, "q = {q}: {slope}");
    }
}

#[test]
fn derivatives_agree_with_differences_on_all_branches() {
    for cutoff in CUTOFFS {
        for x in [-3.0_f64, -0.5, 0.005, 0.02, 0.3, 0.7, 0.999, 1.001, 2.0] {
            if cutoff.is_none() && x <= 0.0 {
                continue;
            }
            let law = unit(cutoff);
            let h = 1e-6 * f64::max(x.abs(), 1e-3);
            let (below, above) = (law.at_aperture(x - h), law.at_aperture(x + h));
            let here = law.at_aperture(x);
            let slope = (above.traction - below.traction) / (2.0 * h);
            assert!((slope / here.tangent - 1.0).abs() < 1e-5, "{cutoff:?} {x}");
            let force = (above.potential - below.potential) / (2.0 * h);
            let scale = here.traction.abs().max(1e-3);
            assert!(
                (force - here.traction).abs() / scale < 1e-4,
                "{cutoff:?} {x}"
            );
        }
    }
}

#[test]
fn branches_join_smoothly() {
    for cutoff in [1e-2, 1e-6] {
        let law = unit(Some(cutoff));
        for x in [cutoff, 1.0] {
            let h = 1e-9 * x;
            let (below, above) = (law.at_aperture(x - h), law.at_aperture(x + h));
            assert!((below.traction - above.traction).abs() < 1e-6);
            assert!((below.tangent / above.tangent - 1.0).abs() < 1e-6);
            assert!((below.potential - above.potential).abs() < 1e-6);
        }
    }
}

#[test]
fn balance_holds_for_any_spring_load_and_cutoff() {
    for cutoff in CUTOFFS {
        for spring in [0.0, 1e-3, 1.0, 1e3] {
            for load in [-1e5, -300.0, -20.0, -1.0, -1e-3, 0.0, 1e-3, 5.0] {
                let law = unit(cutoff);
                let balance = law.balanced(spring, load);
                let b = balance.aperture;
                let response = law.at(balance);
                let rest = response.traction + spring * balance.opening - load;
                // The tangent turns the rounding of b itself into traction.
                let rounding = 1e-14 * (load.abs() + (response.tangent + spring) * b.abs());
                assert!(
                    rest.abs() <= 10.0 * rounding + 1e-15,
                    "{cutoff:?} {spring} {load}: {rest}"
                );
                assert!(cutoff.is_some() || b > 0.0);
            }
        }
    }
}

#[test]
fn tiny_openings_keep_their_digits() {
    for load in [-1e-12, 1e-12, -1e-20] {
        let balance = unit(None).balanced(0.0, load);
        assert!((balance.opening / load - 1.0).abs() < 1e-12);
        assert!((unit(None).at(balance).traction / load - 1.0).abs() < 1e-15);
    }
}

#[test]
fn walls_meet_at_the_predicted_load() {
    for x_c in [0.1_f64, 0.01, 0.001] {
        let touching = (1.0 - x_c.ln()).powi(2);
        assert!(unit(Some(x_c)).balanced(0.0, -touching).aperture.abs() < 1e-12);
    }
}

#[test]
fn cutoff_at_the_initial_aperture_is_the_linear_law() {
    for b in [-2.0, 0.5, 1.0, 3.0] {
        let response = unit(Some(1.0)).at_aperture(b);
        assert_eq!((response.traction, response.tangent), (b - 1.0, 1.0));
    }
    assert!(unit(Some(1.0)).is_linear());
}
