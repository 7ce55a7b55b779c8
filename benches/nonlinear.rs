//! What a nonlinear run costs against one linear solve of the same system; see README.md.
//!
//!     cargo bench --bench nonlinear -- [CUBES [METHOD [once] [uneven]]]
#![allow(clippy::print_stdout, reason = "the table is what it is run for")]

use std::time::Instant;

use glam::DVec3;
use kluft_solver::{
    Discretisation, LinearMethod, Load, Newton, NewtonSettings, Problem, SurfaceLoad, System,
    unobserved,
};
use kluft_verification::scenes::block;
use lie_core::FractureLaw;

/// Seconds that `work` takes, and what it gives.
fn timed<T>(work: impl FnOnce() -> T) -> (f64, T) {
    let start = Instant::now();
    let result = work();
    (start.elapsed().as_secs_f64(), result)
}

fn settings(method: Option<LinearMethod>) -> NewtonSettings {
    NewtonSettings {
        linear: method,
        ..NewtonSettings::default()
    }
}

/// Solver and load steps of equal size from the start; returns Newton and linear iterations.
fn run(system: &System<'_>, method: Option<LinearMethod>, steps: usize) -> (usize, usize) {
    let mut newton = Newton::new(system, settings(method)).expect("a plan");
    let mut state = system.initial_state();
    let mut counts = (0, 0);
    for step in 1..=steps {
        let load = step as f64 / steps as f64;
        let record = newton.solve_step(system, &mut state, &Load::proportional(load), unobserved);
        assert!(record.converged(), "{record:?}");
        counts.0 += record.iterations.len();
        counts.1 += record.linear_iterations();
    }
    counts
}

/// One step for each of `count` stiffnesses between `K_n0 / 2` and `2 K_n0`, with one set-up.
fn sweep(system: &mut System<'_>, method: Option<LinearMethod>, count: usize) -> (usize, usize) {
    let laws: Vec<FractureLaw> = system.problem().fractures.iter().map(|f| f.law).collect();
    let mut newton = Newton::new(system, settings(method)).expect("a plan");
    let mut counts = (0, 0);
    let mut state = system.initial_state();
    for number in 0..count {
        let factor = 4.0_f64.powf(number as f64 / (count - 1) as f64 - 0.5);
        let mut stiffened = laws.clone();
        for law in &mut stiffened {
            law.closure.normal_stiffness *= factor;
        }
        system.set_laws(stiffened);
        let record = newton.solve_step(system, &mut state, &Load::proportional(1.0), unobserved);
        assert!(record.converged(), "{record:?}");
        counts.0 += record.iterations.len();
        counts.1 += record.linear_iterations();
    }
    system.set_laws(laws);
    counts
}

/// Sheared patches of stiffnesses tenfold apart: their points close one after the other.
fn uneven(cubes: usize) -> Problem {
    let mut problem = block::problem(cubes, &block::PATCHES);
    problem.fractures[1].law.closure.normal_stiffness *= 10.0;
    let pressed = SurfaceLoad::Traction(DVec3::new(10e6, 0.0, -85e6));
    for condition in &mut problem.conditions {
        condition.load = condition.load.map(|_| pressed);
    }
    problem
}

/// What the command line asks for.
struct Arguments {
    cubes: usize,
    method: Option<LinearMethod>,
    is_uneven: bool,
    /// Whether to stop after one step.
    once: bool,
}

impl Arguments {
    fn read() -> Self {
        let words: Vec<String> = std::env::args()
            .skip(1)
            .filter(|a| a != "--bench")
            .collect();
        let cubes = words
            .first()
            .map_or(32, |size| size.parse().expect("a number of cubes"));
        let method = match words.get(1).map(String::as_str) {
            None | Some("chosen") => None,
            Some(name) => Some(name.parse().expect("a method")),
        };
        let flag = |name: &str| words.iter().skip(2).any(|word| word == name);
        Self {
            cubes,
            method,
            is_uneven: flag("uneven"),
            once: flag("once"),
        }
    }
}

/// Prints what a run took, beside the seconds of another.
fn tell(what: &str, seconds: f64, (newton, linear): (usize, usize), base: f64) {
    println!(
        "{what}: {seconds:.2} s, {newton} Newton, {linear} linear iterations, ratio {:.2}",
        seconds / base
    );
}

fn main() {
    let arguments = Arguments::read();
    let problem = if arguments.is_uneven {
        uneven(arguments.cubes)
    } else {
        block::problem(arguments.cubes, &block::TWO_PLANES)
    };
    let discretisation = Discretisation::of(&problem).expect("supported");
    let fractured = discretisation.points().jump_count() as f64;
    println!(
        "{} unknowns, {} of them jumps, {:.1} % of the nodes on fractures",
        discretisation.unknown_count(),
        3 * discretisation.points().jump_count(),
        100.0 * fractured / discretisation.points().node_count() as f64,
    );
    measure(&mut System::assemble(&problem, discretisation), &arguments);
}

/// One linear solve, one nonlinear step, many steps, and many stiffnesses.
fn measure(system: &mut System<'_>, arguments: &Arguments) {
    let method = arguments.method;
    let closing: Vec<FractureLaw> = system.problem().fractures.iter().map(|f| f.law).collect();
    let mut linear = closing.clone();
    for law in &mut linear {
        law.closure.kind = lie_core::ClosureKind::Linear;
    }
    system.set_laws(linear);
    let (once, counts) = timed(|| run(system, method, 1));
    println!(
        "one linear solve: {once:.2} s, {} linear iterations",
        counts.1
    );
    system.set_laws(closing);
    let (one, counts) = timed(|| run(system, method, 1));
    tell("one step, nonlinear", one, counts, once);
    if arguments.once {
        return;
    }
    let (seconds, counts) = timed(|| run(system, method, 100));
    tell("100 steps", seconds, counts, one);
    let (seconds, counts) = timed(|| sweep(system, method, 50));
    tell("50 stiffnesses", seconds, counts, one);
}
