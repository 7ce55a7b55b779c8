//! Load steps, one or many, from the state before any load.

use kluft_solver::{
    Discretisation, Load, Newton, NewtonSettings, Problem, Solution, State, StepRecord, System,
    solution, unobserved,
};

/// Solves one load step at factor 1 with the given settings.
pub fn try_solve(problem: &Problem, settings: NewtonSettings) -> (StepRecord, Solution, State) {
    let discretisation = Discretisation::of(problem).unwrap_or_else(|d| panic!("{d:?}"));
    let system = System::assemble(problem, discretisation);
    let mut newton = Newton::new(&system, settings).expect("analysis");
    let mut state = system.initial_state();
    let record = newton.solve_step(&system, &mut state, &Load::proportional(1.0), unobserved);
    let solution = solution(&system, &state);
    (record, solution, state)
}

/// Solves one load step at factor 1, which must converge.
pub fn solve(problem: &Problem) -> Solution {
    let (record, solution, _) = try_solve(problem, NewtonSettings::default());
    assert!(record.converged(), "{record:?}");
    solution
}

/// Solves load steps one after the other, from the state before any load; the record and the
/// solution of each.
pub fn solve_path(
    problem: &Problem,
    settings: NewtonSettings,
    loads: impl IntoIterator<Item = f64>,
) -> Vec<(StepRecord, Solution)> {
    let discretisation = Discretisation::of(problem).unwrap_or_else(|d| panic!("{d:?}"));
    let system = System::assemble(problem, discretisation);
    let mut newton = Newton::new(&system, settings).expect("analysis");
    let mut state = system.initial_state();
    let solved = loads.into_iter().map(|load| {
        let record = newton.solve_step(&system, &mut state, &Load::proportional(load), unobserved);
        (record, solution(&system, &state))
    });
    solved.collect()
}
