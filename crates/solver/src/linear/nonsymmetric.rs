//! Any tangent of the fractures, on top of a solver for symmetric positive definite ones.

use std::cell::RefCell;

use glam::{DMat3, DVec3};
use kluft_algebra::{
    ConjugateGradientOutcome, ConjugateGradientSettings, LinearFailure, ScalarCholesky, gmres, norm,
};
use rayon::prelude::*;

use crate::flow::LinearisedFlow;
use crate::linear::choice::Plan;
use crate::linear::coupled::{CoupledRhs, CoupledSolution, CoupledTangent};
use crate::linear::tangent_solver::{LinearSolution, SolverHistory, TangentSolver, Tangents};
use crate::system::System;

/// Iterations after which a linear solve has failed.
const MAX_ITERATIONS: usize = 240;
/// Iterations of one solve after which a direct solver goes on: twenty times those that the choice
/// between them counts on.
const SLOW: usize = 400;
/// Largest error of a linear solve that is done at all, against what it begins with.
pub(crate) const LARGEST_TOLERANCE: f64 = 0.1;
/// Residual, as a share of the right-hand side, that an iteration which gains nothing more may
/// leave.
const ROUNDED: f64 = 1e-3;

/// Solves with the exact tangents: directly where they are symmetric and positive, and by GMRES,
/// preconditioned by the solver for the positive ones, where they are not. Where an iteration gives
/// up, a direct solver goes on from there if it may and fits in memory.
pub struct NonsymmetricSolver {
    inner: Box<dyn TangentSolver>,
    /// Exact stiffness of the fractures, where it differs from what `inner` has.
    exact: Option<Vec<DMat3>>,
    /// What `inner` has.
    positive: Vec<DMat3>,
    /// Factor of the pressures, where there are any.
    pressures: Option<ScalarCholesky>,
    /// Memory (bytes) for a direct solver that goes on where `inner` gives up; none if none may.
    fallback_memory: Option<usize>,
    /// Whether a direct solver goes on.
    has_fallen_back: bool,
}

impl NonsymmetricSolver {
    /// On top of a prepared solver.
    pub fn new(inner: Box<dyn TangentSolver>) -> Self {
        Self {
            inner,
            exact: None,
            positive: Vec::new(),
            pressures: None,
            fallback_memory: None,
            has_fallen_back: false,
        }
    }

    /// With this memory (bytes) for a direct solver that goes on where the prepared one gives up.
    pub(crate) fn with_fallback(self, memory_bytes: usize) -> Self {
        Self {
            fallback_memory: Some(memory_bytes),
            ..self
        }
    }

    /// Whether a direct solver has gone on.
    pub(crate) fn has_fallen_back(&self) -> bool {
        self.has_fallen_back
    }

    /// Lets a direct solver go on, if it may and fits; whether it does from now on. It has the last
    /// tangents.
    pub(crate) fn fall_back(&mut self, system: &System<'_>) -> bool {
        let memory = self.fallback_memory.take();
        let direct = memory.and_then(|memory| Plan::direct_within(system, memory));
        let direct = direct.and_then(|plan| plan.prepare(system).ok());
        let Some(mut direct) = direct else {
            return false;
        };
        // One without tangents yet gets them before it solves.
        let has_tangents = !self.positive.is_empty();
        if has_tangents
            && direct
                .update(system.fixed_part(), self.positive.clone())
                .is_err()
        {
            return false;
        }
        self.inner = direct;
        self.has_fallen_back = true;
        true
    }

    /// Takes over the tangents of the facet points.
    ///
    /// # Errors
    /// If the positive tangent is not definite or memory runs out.
    pub fn update(
        &mut self,
        system: &System<'_>,
        tangents: &Tangents,
    ) -> Result<(), LinearFailure> {
        let interface = &system.discretisation.interface;
        self.exact = tangents
            .positive
            .is_some()
            .then(|| interface.stiffness(&tangents.exact));
        let positive = tangents.positive.as_ref().unwrap_or(&tangents.exact);
        let stiffness = interface.stiffness(positive);
        self.positive.clone_from(&stiffness);
        self.inner.update(system.fixed_part(), stiffness)
    }

    /// Blocks of the exact tangent of the fractures, one for each of the interface's columns.
    pub(crate) fn stiffness(&self) -> &[DMat3] {
        self.exact.as_ref().unwrap_or(&self.positive)
    }

    /// Whether that tangent is symmetric.
    pub(crate) fn is_symmetric(&self) -> bool {
        self.exact.is_none()
    }

    /// Solves for forces and for what is missing in a flow, together.
    ///
    /// # Errors
    /// If the iteration fails.
    pub(crate) fn solve_coupled(
        &mut self,
        system: &System<'_>,
        flow: &LinearisedFlow<'_, '_>,
        rhs: &CoupledRhs<'_>,
    ) -> Result<CoupledSolution, LinearFailure> {
        coupled(system, &self.positive, flow).factorise(&mut self.pressures)?;
        let mut spent = 0;
        loop {
            let exact = self.exact.as_ref().unwrap_or(&self.positive);
            let factor = self.pressures.as_ref();
            let solved = coupled(system, exact, flow).solve(&mut *self.inner, factor, rhs);
            match solved {
                Err(LinearFailure::Stalled(count)) if self.improve(system)? => spent += count,
                done => {
                    let mut solution = done?;
                    solution.iterations += spent;
                    return Ok(solution);
                }
            }
        }
    }

    /// Makes `inner` serve better after it has given up: anew for the tangents at hand what it kept
    /// from others, else a direct solver in its place; whether either was possible.
    fn improve(&mut self, system: &System<'_>) -> Result<bool, LinearFailure> {
        Ok(self.inner.rebuild(system.fixed_part())? || self.fall_back(system))
    }

    /// A change that leaves nothing missing in a flow where every unknown and pressure answers as
    /// the preconditioner of the last coupled solve has it; none before the first.
    pub(crate) fn conserving(
        &self,
        system: &System<'_>,
        flow: &LinearisedFlow<'_, '_>,
        missing: &[f64],
    ) -> Option<CoupledSolution> {
        let factor = self.pressures.as_ref()?;
        let tangent = coupled(system, &self.positive, flow);
        let (unknowns, potentials) = tangent.conserving(factor, missing);
        Some(CoupledSolution {
            unknowns,
            potentials,
            iterations: 0,
        })
    }

    /// Solves with the positive tangents for the forces `rhs` (N), to `tolerance` times their norm.
    ///
    /// # Errors
    /// If the solver fails.
    pub fn solve_positive(
        &mut self,
        system: &System<'_>,
        rhs: &[DVec3],
        tolerance: f64,
    ) -> Result<LinearSolution, LinearFailure> {
        self.improving(system, |own| {
            own.inner.solve(system.fixed_part(), rhs, tolerance)
        })
    }

    /// A solution, with `inner` improved as long as it gives up.
    fn improving(
        &mut self,
        system: &System<'_>,
        attempt: impl Fn(&mut Self) -> Result<LinearSolution, LinearFailure>,
    ) -> Result<LinearSolution, LinearFailure> {
        let mut spent = 0;
        loop {
            match attempt(self) {
                Err(LinearFailure::Stalled(count)) if self.improve(system)? => spent += count,
                done => {
                    let mut solution = done?;
                    if solution.iterations > SLOW {
                        self.fall_back(system);
                    }
                    solution.iterations += spent;
                    return Ok(solution);
                }
            }
        }
    }

    /// What later solves depend on beside the tangents and the forces.
    pub fn history(&self) -> SolverHistory {
        SolverHistory {
            has_fallen_back: self.has_fallen_back,
            ..self.inner.history()
        }
    }

    /// Brings a solver that has just been prepared to where one with this history is.
    ///
    /// # Errors
    /// If the tangent of that time cannot be factorised.
    pub fn restore(
        &mut self,
        system: &System<'_>,
        history: SolverHistory,
    ) -> Result<(), LinearFailure> {
        if history.has_fallen_back && !self.fall_back(system) {
            let why = "the direct solver that the run went on with does not fit in memory";
            return Err(LinearFailure::Analysis(why.to_owned()));
        }
        self.inner.restore(system.fixed_part(), history)
    }

    /// Solves for the forces `rhs` (N), to `tolerance` times their norm if it iterates.
    ///
    /// # Errors
    /// If the iteration fails.
    pub fn solve(
        &mut self,
        system: &System<'_>,
        rhs: &[DVec3],
        tolerance: f64,
    ) -> Result<LinearSolution, LinearFailure> {
        self.improving(system, |own| own.attempt(system, rhs, tolerance))
    }

    /// The same, beginning with `guess` (m) if that leaves less of the forces than there is. What
    /// it leaves may be small and all of it on a fracture: it is reduced unless it is far below
    /// what is asked.
    ///
    /// # Errors
    /// If the iteration fails.
    pub(crate) fn solve_from(
        &mut self,
        system: &System<'_>,
        guess: Vec<DVec3>,
        rhs: &[DVec3],
        tolerance: f64,
    ) -> Result<LinearSolution, LinearFailure> {
        let rest = self.remaining(system, &guess, rhs);
        let [size, left] = [rhs, &rest].map(norm);
        if left.is_nan() || left >= size {
            return self.solve(system, rhs, tolerance);
        }
        let tolerance = tolerance * size / left;
        if LARGEST_TOLERANCE * tolerance >= 1.0 {
            return Ok(LinearSolution {
                unknowns: guess,
                iterations: 0,
            });
        }
        let mut solution = self.solve(system, &rest, tolerance.min(LARGEST_TOLERANCE))?;
        let pairs = solution.unknowns.par_iter_mut().zip(guess);
        pairs.for_each(|(change, guess)| *change += guess);
        Ok(solution)
    }

    /// What `unknowns` (m) leave of the forces `rhs` (N) on the exact tangents.
    fn remaining(&self, system: &System<'_>, unknowns: &[DVec3], rhs: &[DVec3]) -> Vec<DVec3> {
        let (fixed, stiffness) = (system.fixed_part(), self.stiffness());
        let mut rest = vec![DVec3::ZERO; rhs.len()];
        self.inner.multiply(fixed, stiffness, unknowns, &mut rest);
        let pairs = rest.par_iter_mut().zip(rhs);
        pairs.for_each(|(image, force)| *image = *force - *image);
        rest
    }

    /// Solves with `inner` as it stands.
    fn attempt(
        &mut self,
        system: &System<'_>,
        rhs: &[DVec3],
        tolerance: f64,
    ) -> Result<LinearSolution, LinearFailure> {
        let Some(exact) = &self.exact else {
            return self.inner.solve(system.fixed_part(), rhs, tolerance);
        };
        let fixed = system.fixed_part();
        let mut failure = None;
        let mut unknowns = vec![DVec3::ZERO; rhs.len()];
        // The iteration asks for one of them at a time.
        let inner = RefCell::new(&mut self.inner);
        let report = gmres(
            |vector, product| inner.borrow().multiply(fixed, exact, vector, product),
            |residual, correction| match inner.borrow_mut().precondition(fixed, residual) {
                Ok(approximation) => correction.copy_from_slice(&approximation),
                Err(error) => failure = Some(error),
            },
            rhs,
            &mut unknowns,
            ConjugateGradientSettings {
                tolerance,
                max_iterations: MAX_ITERATIONS,
            },
        );
        let last = report.residuals.last().copied().unwrap_or(f64::NAN);
        match (failure, report.outcome) {
            (Some(failure), _) => Err(failure),
            (_, ConjugateGradientOutcome::NotFinite) => Err(LinearFailure::NotFinite),
            _ if last <= tolerance.max(ROUNDED) => Ok(LinearSolution {
                unknowns,
                iterations: report.iterations,
            }),
            _ => Err(LinearFailure::Stalled(report.iterations)),
        }
    }
}

/// The tangent of rock and flow, for a stiffness of the fractures.
fn coupled<'s, 'a>(
    system: &'s System<'_>,
    stiffness: &'s [DMat3],
    flow: &'s LinearisedFlow<'s, 'a>,
) -> CoupledTangent<'s, 'a> {
    CoupledTangent {
        fixed: system.fixed_part(),
        interface: &system.discretisation.interface,
        stiffness,
        flow,
    }
}

#[cfg(test)]
mod tests {
    use kluft_algebra::FixedPart;

    use super::*;
    use crate::linear::fractured_tests::{problem, remaining, system};
    use crate::linear::iterative::Iterative;

    /// An iterative solver that never comes to an end.
    struct Stalling;

    impl TangentSolver for Stalling {
        fn update(&mut self, _: FixedPart<'_>, _: Vec<DMat3>) -> Result<(), LinearFailure> {
            Ok(())
        }

        fn solve(
            &mut self,
            _: FixedPart<'_>,
            _: &[DVec3],
            _: f64,
        ) -> Result<LinearSolution, LinearFailure> {
            Err(LinearFailure::Stalled(7))
        }
    }

    /// A guess that is far better than asked is the solution, one that is worse than nothing is
    /// forgotten, and what another leaves is reduced tenfold at least.
    #[test]
    fn a_solve_begins_with_a_guess_that_helps() {
        let problem = problem(|z| z);
        let system = system(&problem);
        let interface = &system.discretisation.interface;
        let tangents: Tangents = vec![DMat3::IDENTITY; interface.points.len()].into();
        let stiffness = interface.stiffness(&tangents.exact);
        let mut rhs = vec![DVec3::ZERO; system.discretisation.points.len()];
        rhs[interface.unknowns[0] as usize] = DVec3::new(1.0, -2.0, 0.5);
        let inner = Iterative::new(&system).expect("definite");
        let mut solver = NonsymmetricSolver::new(Box::new(inner));
        solver.update(&system, &tangents).expect("definite");
        let exact = solver.solve(&system, &rhs, 1e-10).expect("solved").unknowns;
        let alone = solver.solve(&system, &rhs, 1e-3).expect("solved");
        let mut from = |share: f64| {
            let guess = exact.iter().map(|entry| share * *entry).collect();
            let solved = solver.solve_from(&system, guess, &rhs, 1e-3);
            let LinearSolution {
                unknowns,
                iterations,
            } = solved.expect("solved");
            (
                remaining(&system, &stiffness, &unknowns, &rhs),
                iterations,
                unknowns,
            )
        };
        let (left, iterations, _) = from(1.0 + 1e-5);
        assert!(
            iterations == 0 && (left / 1e-5 - 1.0).abs() < 1e-3,
            "{left:e}"
        );
        let (left, iterations, _) = from(1.0 + 9e-4);
        assert!(iterations > 0 && left < 0.1 * 9e-4, "{left:e}");
        let (_, iterations, unknowns) = from(2.5);
        assert_eq!((iterations, unknowns), (alone.iterations, alone.unknowns));
    }

    #[test]
    fn a_direct_solver_goes_on_where_an_iteration_gives_up() {
        let problem = problem(|z| z);
        let system = system(&problem);
        let interface = &system.discretisation.interface;
        let tangents: Tangents = vec![DMat3::IDENTITY; interface.points.len()].into();
        let mut rhs = vec![DVec3::ZERO; system.discretisation.points.len()];
        rhs[interface.unknowns[0] as usize] = DVec3::new(1.0, -2.0, 0.5);
        let solve = |memory: Option<usize>| {
            let mut solver = NonsymmetricSolver::new(Box::new(Stalling));
            if let Some(memory) = memory {
                solver = solver.with_fallback(memory);
            }
            solver.update(&system, &tangents).expect("definite");
            (solver.solve(&system, &rhs, 1e-8), solver.history())
        };
        // None is allowed, and none fits in memory.
        for memory in [None, Some(1000)] {
            let (stalled, history) = solve(memory);
            assert!(matches!(stalled, Err(LinearFailure::Stalled(7))));
            assert!(!history.has_fallen_back);
        }
        let (solved, history) = solve(Some(usize::MAX));
        let solution = solved.expect("solved");
        let stiffness = interface.stiffness(&tangents.exact);
        assert!(remaining(&system, &stiffness, &solution.unknowns, &rhs) < 1e-9);
        assert_eq!(solution.iterations, 7);
        // A run that is continued from here goes on with the direct solver.
        assert!(history.has_fallen_back);
        let mut restored = NonsymmetricSolver::new(Box::new(Stalling)).with_fallback(usize::MAX);
        restored.restore(&system, history).expect("room for it");
        restored.update(&system, &tangents).expect("definite");
        let again = restored.solve(&system, &rhs, 1e-8).expect("solved");
        assert_eq!(again.unknowns, solution.unknowns);
        assert_eq!(again.iterations, 0);
    }
}
