//! Any tangent of the fractures, on top of a solver for symmetric positive definite ones.

use std::cell::RefCell;

use glam::{DMat3, DVec3};
use kluft_algebra::{ConjugateGradientOutcome, ConjugateGradientSettings, LinearFailure, gmres};

use crate::flow::{LinearisedFlow, PressureSchur};
use crate::linear::coupled::{CoupledRhs, CoupledSolution, CoupledTangent};
use crate::linear::tangent_solver::{LinearSolution, SolverHistory, TangentSolver, Tangents};
use crate::system::System;

/// Iterations after which a linear solve has failed.
const MAX_ITERATIONS: usize = 240;
/// Residual, as a share of the right-hand side, that an iteration which gains nothing more may
/// leave.
const ROUNDED: f64 = 1e-3;

/// Solves with the exact tangents: directly where they are symmetric and positive, and by GMRES,
/// preconditioned by the solver for the positive ones, where they are not.
pub struct NonsymmetricSolver {
    inner: Box<dyn TangentSolver>,
    /// Exact stiffness of the fractures, where it differs from what `inner` has.
    exact: Option<Vec<DMat3>>,
    /// What `inner` has, where a flow is solved with it.
    positive: Vec<DMat3>,
    /// Factor of the pressures, where there are any.
    pressures: Option<PressureSchur>,
}

impl NonsymmetricSolver {
    /// On top of a prepared solver.
    pub fn new(inner: Box<dyn TangentSolver>) -> Self {
        Self {
            inner,
            exact: None,
            positive: Vec::new(),
            pressures: None,
        }
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
        if system.coupling().is_some() {
            self.positive.clone_from(&stiffness);
        }
        self.inner.update(system.fixed_part(), stiffness)
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
        let tangent = |stiffness| coupled(system, stiffness, flow);
        tangent(&self.positive).factorise(&mut self.pressures)?;
        let exact = self.exact.as_ref().unwrap_or(&self.positive);
        let (tangent, factor) = (tangent(exact), self.pressures.as_ref());
        match tangent.solve(&mut *self.inner, factor, rhs) {
            Err(LinearFailure::Stalled(spent)) if self.inner.rebuild(system.fixed_part())? => {
                let mut solution = tangent.solve(&mut *self.inner, factor, rhs)?;
                solution.iterations += spent;
                Ok(solution)
            }
            done => done,
        }
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
        self.rebuilding(system, |own| {
            own.inner.solve(system.fixed_part(), rhs, tolerance)
        })
    }

    /// A solution, with what `inner` kept from other tangents made anew if that stands in the way.
    fn rebuilding(
        &mut self,
        system: &System<'_>,
        attempt: impl Fn(&mut Self) -> Result<LinearSolution, LinearFailure>,
    ) -> Result<LinearSolution, LinearFailure> {
        match attempt(self) {
            Err(LinearFailure::Stalled(spent)) if self.inner.rebuild(system.fixed_part())? => {
                let mut solution = attempt(self)?;
                solution.iterations += spent;
                Ok(solution)
            }
            done => done,
        }
    }

    /// What later solves depend on beside the tangents and the forces.
    pub fn history(&self) -> SolverHistory {
        self.inner.history()
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
        self.rebuilding(system, |own| own.attempt(system, rhs, tolerance))
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
