//! Loads beyond what fractures can bear are told as such, with how much they can, whatever the
//! solver.

use crate::harness::Run;
use crate::one_answer::{SOLVERS, ran_by};

/// Runs of a layer on another, 1 m high and wide, with each solver.
fn runs(edits: &[(&str, &str)]) -> Vec<Run> {
    let ran = ran_by(&SOLVERS, "pushed_layer.toml", edits);
    ran.map(|(run, _)| run).collect()
}

/// The share of a load step, in percent, that a run says fractures can bear at most.
fn bearable(run: &Run) -> f64 {
    let words = "the fractures can bear at most ";
    let (_, rest) = run.err.split_once(words).unwrap_or_else(|| {
        panic!("no share in {}", run.err);
    });
    let number = rest.split(' ').next().expect("a number");
    number.parse().expect("a number")
}

/// Pushed to a side with 0.15 of what presses it down, all of the joint stays closed and the layer
/// slides when `T > N tan(phi) + c A`: at `c / (T - N tan(phi))` of the load. An increment up to
/// just below that is solved.
#[test]
fn a_layer_slides_when_friction_and_cohesion_are_used_up() {
    let limit = 5e4 / (1.5e5 - 1e6 * 3_f64.to_radians().tan());
    for run in runs(&[]) {
        assert_eq!(run.code, Some(1), "{}", run.err);
        assert!(run.err.contains("nothing holds any more"), "{}", run.err);
        assert!(run.err.contains("translation along x"), "{}", run.err);
        let share = bearable(&run) / 100.0;
        assert!((share - limit).abs() < 2e-3, "{share} instead of {limit}");
    }
    let below = format!("steps = [{}]", 0.99 * limit);
    for run in runs(&[("steps = [1.0]", &below)]) {
        assert_eq!(run.code, Some(0), "{}", run.err);
    }
}

/// Pushed with more than half of what presses it down, a layer as high as wide topples about its
/// lower edge, however rough the joint and however small the load.
#[test]
fn a_layer_topples_over_its_edge_under_any_share_of_the_load() {
    let pushed = |push| {
        [
            ("friction_angle = 3", "friction_angle = 60"),
            ("cohesion = 5e4", "cohesion = 5e6"),
            ("1.5e5", push),
        ]
    };
    for run in runs(&pushed("5.5e5")) {
        assert_eq!(run.code, Some(1), "{}", run.err);
        assert!(run.err.contains("rotation about y"), "{}", run.err);
        assert!(!run.err.contains("can bear at most"), "{}", run.err);
    }
    for run in runs(&pushed("1.5e5")) {
        assert_eq!(run.code, Some(0), "{}", run.err);
    }
}

/// Cohesion that would keep a layer from sliding does not keep it from being lifted off.
#[test]
fn a_layer_is_lifted_off_whatever_its_cohesion() {
    let lifted = [
        ("friction_angle = 3", "friction_angle = 60"),
        ("cohesion = 5e4", "cohesion = 4e6"),
        ("traction = [1.5e5, 0, -1e6]", "traction = [6e4, 0, 8.5e4]"),
    ];
    for run in runs(&lifted) {
        assert_eq!(run.code, Some(1), "{}", run.err);
        assert!(run.err.contains("translation along z"), "{}", run.err);
    }
}
