//! What a linear solver for the tangent does.

use glam::{DMat3, DVec3};
use kluft_algebra::{FixedPart, LinearFailure};
use serde::{Deserialize, Serialize};

/// Tolerance of an iteration that only serves as a preconditioner.
const PRECONDITIONER: f64 = 1e-2;

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
    pub stiffness: Option<Vec<DMat3>>,
    /// Blocks of the fractures that its preconditioner was made with.
    pub preconditioned: Option<Vec<DMat3>>,
    /// Factor by which the spectrum of the preconditioner turned out to reach further than
    /// estimated.
    pub margin: Option<f64>,
    /// Whether it is a direct one that goes on where another gave up.
    pub has_fallen_back: bool,
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

/// Solves with the tangent of a system: a fixed part, which is that of the rock, and the blocks of
/// the fractures. All calls get the same fixed part.
pub trait TangentSolver: Send + Sync {
    /// Takes over the blocks of the fractures, one for each of the interface's columns.
    ///
    /// # Errors
    /// If the tangent is not positive definite or memory runs out.
    fn update(&mut self, fixed: FixedPart<'_>, stiffness: Vec<DMat3>) -> Result<(), LinearFailure>;

    /// Solves for the forces `rhs` (N), to `tolerance` times their norm if it iterates.
    ///
    /// # Errors
    /// If the iteration fails.
    fn solve(
        &mut self,
        fixed: FixedPart<'_>,
        rhs: &[DVec3],
        tolerance: f64,
    ) -> Result<LinearSolution, LinearFailure>;

    /// What later solves depend on beside the blocks and the forces; nothing, if the solver is
    /// exact.
    fn history(&self) -> SolverHistory {
        SolverHistory::default()
    }

    /// Brings a solver that has just been prepared to where one with this history is.
    ///
    /// # Errors
    /// If the tangent of that time cannot be factorised.
    fn restore(&mut self, _: FixedPart<'_>, _: SolverHistory) -> Result<(), LinearFailure> {
        Ok(())
    }

    /// Makes anew for the tangent at hand what was kept from another one, if anything was; whether
    /// it was.
    ///
    /// # Errors
    /// If the tangent is not positive definite.
    fn rebuild(&mut self, _: FixedPart<'_>) -> Result<bool, LinearFailure> {
        Ok(false)
    }

    /// `product = (fixed + stiffness) vector`, for any blocks of the fractures.
    fn multiply(
        &self,
        fixed: FixedPart<'_>,
        stiffness: &[DMat3],
        vector: &[DVec3],
        product: &mut [DVec3],
    ) {
        fixed.multiply(stiffness, vector, product);
    }

    /// An approximate solution for the forces `rhs` (N), in one go.
    ///
    /// # Errors
    /// If the solver fails.
    fn precondition(
        &mut self,
        fixed: FixedPart<'_>,
        rhs: &[DVec3],
    ) -> Result<Vec<DVec3>, LinearFailure> {
        Ok(self.solve(fixed, rhs, PRECONDITIONER)?.unknowns)
    }
}
