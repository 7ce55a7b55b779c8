//! Linear solvers for the tangent: the rock, which never changes, and the fractures, which do.

mod analysis;
mod cholesky;
mod condensed;
mod iterative;
mod jump_problem;
mod ordering;
mod plan;
mod substitution;
mod tangent;
mod whole;

use glam::{DMat3, DVec3};
use serde::{Deserialize, Serialize};

use crate::system::System;

pub use analysis::Analysis;
pub use cholesky::Cholesky;
pub use condensed::Condensed;
pub use iterative::Iterative;
pub use ordering::NodeOrder;
pub use plan::{LinearMethod, Plan, Prediction, Unknowns, Workload};
pub use tangent::AnyTangent;
pub use whole::Whole;

pub(crate) use cholesky::parallelism;

/// Tolerance of an iteration that only serves as a preconditioner.
const PRECONDITIONER: f64 = 1e-2;

/// Why a linear system could not be solved.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum LinearFailure {
    /// The factor does not fit in memory.
    OutOfMemory,
    /// The matrix is not positive definite; the block row where it showed.
    Indefinite(usize),
    /// The ordering or the symbolic analysis failed.
    Analysis(String),
    /// A number is not finite.
    NotFinite,
    /// The iteration did not converge in this many steps.
    Stalled(usize),
}

/// Solution of a linear system.
#[derive(Debug, Clone)]
pub struct LinearSolution {
    /// Unknown 3-vectors (m).
    pub unknowns: Vec<DVec3>,
    /// Iterations it took; 0 for a direct solver.
    pub iterations: usize,
}

/// What the solves of a solver depend on that earlier steps left behind.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct SolverHistory {
    /// Blocks of the fractures that it solves with, or that its factor was made with.
    stiffness: Option<Vec<DMat3>>,
    /// Blocks of the fractures that its preconditioner was made with.
    preconditioned: Option<Vec<DMat3>>,
    /// Factor by which the spectrum of the preconditioner turned out to reach further than estimated.
    margin: Option<f64>,
}

impl SolverHistory {
    /// Whether it speaks of this number of blocks of the fractures.
    pub(crate) fn fits(&self, blocks: usize) -> bool {
        let both = [&self.stiffness, &self.preconditioned];
        let mut known = both.into_iter().flatten();
        known.all(|stiffness| stiffness.len() == blocks)
    }
}

/// Tangents of the facet points (Pa/m).
#[derive(Debug, Clone, PartialEq)]
pub struct Tangents {
    /// `dt/dw`.
    pub exact: Vec<DMat3>,
    /// Symmetric positive semidefinite tangents close to them, unless they are that themselves.
    pub positive: Option<Vec<DMat3>>,
}

impl From<Vec<DMat3>> for Tangents {
    /// Tangents that are symmetric and positive semidefinite.
    fn from(exact: Vec<DMat3>) -> Self {
        Self {
            exact,
            positive: None,
        }
    }
}

/// Solves with the tangent of a system, `rock + fractures`.
pub trait TangentSolver: Send + Sync {
    /// Takes over the tangents of the facet points (Pa/m).
    ///
    /// # Errors
    /// If the tangent is not positive definite or memory runs out.
    fn update(&mut self, system: &System<'_>, tangents: &[DMat3]) -> Result<(), LinearFailure>;

    /// Solves for the forces `right` (N), to `tolerance` times their norm if it iterates.
    ///
    /// # Errors
    /// If the iteration fails.
    fn solve(
        &mut self,
        system: &System<'_>,
        right: &[DVec3],
        tolerance: f64,
    ) -> Result<LinearSolution, LinearFailure>;

    /// What later solves depend on beside the tangents and the forces; nothing, if the solver is exact.
    fn history(&self) -> SolverHistory {
        SolverHistory::default()
    }

    /// Brings a solver that has just been prepared to where one with this history is.
    ///
    /// # Errors
    /// If the tangent of that time cannot be factorised.
    fn restore(&mut self, _: &System<'_>, _: SolverHistory) -> Result<(), LinearFailure> {
        Ok(())
    }

    /// Makes anew for the tangent at hand what was kept from another one, if anything was; whether it was.
    ///
    /// # Errors
    /// If the tangent is not positive definite.
    fn renew(&mut self, _: &System<'_>) -> Result<bool, LinearFailure> {
        Ok(false)
    }

    /// An approximate solution for the forces `right` (N), in one go.
    ///
    /// # Errors
    /// If the solver fails.
    fn precondition(
        &mut self,
        system: &System<'_>,
        right: &[DVec3],
    ) -> Result<Vec<DVec3>, LinearFailure> {
        Ok(self.solve(system, right, PRECONDITIONER)?.unknowns)
    }
}
