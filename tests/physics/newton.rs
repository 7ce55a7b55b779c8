//! Newton's counts over loads and cutoffs, beside plain Newton's.
#![allow(
    clippy::print_stdout,
    reason = "the table of counts is what the test is read for"
)]

use std::ops::ControlFlow;

use glam::DVec3;
use kluft_solver::{
    Discretisation, Load, Newton, NewtonSettings, Problem, StepOutcome, StepRecord, Support,
    System, unobserved,
};
use lie_core::ClosureKind;

use kluft_verification::methods::plain_newton;
use kluft_verification::scenes::closing::{column, inclined_joint, three_planes};
use kluft_verification::scenes::{self, EXACT};

const LOADS: [f64; 9] = [0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0];
const CUTOFFS: [Option<f64>; 12] = [
    None,
    Some(1e-2),
    Some(1e-3),
    Some(1e-4),
    Some(1e-5),
    Some(1e-6),
    Some(1e-7),
    Some(1e-8),
    Some(1e-9),
    Some(1e-10),
    Some(1e-11),
    Some(1e-12),
];

fn solve(problem: &Problem) -> StepRecord {
    scenes::try_solve(problem, NewtonSettings::default()).0
}

fn count(record: &StepRecord) -> String {
    if record.converged() {
        record.iterations.len().to_string()
    } else {
        "-".to_owned()
    }
}

/// Prints the counts over all loads and cutoffs beside plain Newton's, and holds ours to the
/// promise: at most 8 iterations in one load step, and no closed walls without a cutoff.
fn table(name: &str, scene: impl Fn(ClosureKind, f64) -> Problem) {
    let mut text = format!("{name}: iterations (plain Newton), over |sigma| / (K_n0 b0)\n");
    let heads: String = LOADS.iter().map(|q| format!("{q:>9}")).collect();
    text += &format!("cutoff / b0 {heads}\n");
    for cutoff in CUTOFFS {
        let kind = ClosureKind::Logarithmic {
            cutoff: cutoff.map(|c| c * 1e-4),
        };
        text += &cutoff.map_or("none       ".to_owned(), |c| format!("{c:<11e}"));
        for q in LOADS {
            let problem = scene(kind, q);
            let ours = solve(&problem);
            let plain = plain_newton::solve(&problem, NewtonSettings::default()).0;
            text += &format!("{:>9}", format!("{} ({})", count(&ours), count(&plain)));
            assert!(
                ours.converged() && ours.iterations.len() <= 8,
                "{name} {cutoff:?} {q}: {ours:?}"
            );
            let smallest = ours
                .iterations
                .last()
                .map_or(0.0, |last| last.smallest_aperture);
            assert!(
                cutoff.is_some() || smallest > 0.0,
                "{name} {q}: aperture {smallest}"
            );
        }
        text += "\n";
    }
    println!("{text}");
}

#[test]
fn column_takes_at_most_8_iterations() {
    table("column", column);
}

#[test]
fn inclined_joint_takes_at_most_8_iterations() {
    let draft = scenes::geometry("inclined-joint", &[("h", 0.4)]);
    table("inclined joint", |kind, q| inclined_joint(&draft, kind, q));
}

#[test]
fn three_planes_take_at_most_8_iterations() {
    table("three planes", three_planes);
}

/// Joints stiff and soft against the rock, closed by a load or by a displacement: the spring beside
/// the joint ranges from nothing to a thousand times the joint's stiffness.
#[test]
fn any_stiffness_of_the_rock_beside_the_joint() {
    for stiffness in [50e9, 1e9, 1e7] {
        for q in LOADS {
            let mut loaded = column(EXACT, 0.0);
            let closure = &mut loaded.fractures[0].law.closure;
            closure.normal_stiffness = stiffness;
            let closing = closure.balanced(0.0, -q * stiffness * 1e-4).opening;
            let mut pushed = loaded.clone();
            let sigma = -q * stiffness * 1e-4;
            scenes::load(&mut loaded, "top", DVec3::new(0.0, 0.0, sigma));
            let shortening = closing + 2.0 * sigma / scenes::ROCK.young_modulus;
            let push = Support::Displacement([None, None, Some(shortening)]);
            scenes::support(&mut pushed, "top", push);
            for problem in [loaded, pushed] {
                let record = solve(&problem);
                let count = record.iterations.len();
                assert!(
                    record.converged() && count <= 8,
                    "K {stiffness:e}, q {q}: {record:?}"
                );
            }
        }
    }
}

/// An observer that stops a step leaves the state that the step began with, and the solver ready to
/// go on.
#[test]
fn a_stopped_step_leaves_the_last_state() {
    let problem = three_planes(EXACT, 20.0);
    let discretisation = Discretisation::of(&problem).expect("supported");
    let system = System::assemble(&problem, discretisation);
    let mut newton = Newton::new(&system, NewtonSettings::default()).expect("prepared");
    let load = Load::proportional(1.0);
    let mut state = system.initial_state();
    let record = newton.solve_step(&system, &mut state, &load, |number, _| match number {
        2 => ControlFlow::Break(()),
        _ => ControlFlow::Continue(()),
    });
    assert_eq!(
        (record.outcome, record.iterations.len()),
        (StepOutcome::Stopped, 2)
    );
    assert!(state.unknowns.iter().all(|unknown| *unknown == DVec3::ZERO));
    let whole = newton.solve_step(&system, &mut state, &load, unobserved);
    assert!(whole.converged() && whole.iterations[..2] == record.iterations);
    // Who stops after the last iteration has the whole step.
    let last = whole.iterations.len();
    let mut state = system.initial_state();
    let stopped = newton.solve_step(&system, &mut state, &load, |number, _| {
        if number == last {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    });
    assert!(stopped.converged());
}
