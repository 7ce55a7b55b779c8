//! What PETSc answers.

use kluft_solver::LinearFailure;

/// PETSc's code of an allocation that failed.
const OUT_OF_MEMORY: i32 = 55;

/// An error of PETSc or MPI, by PETSc's number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PetscFailure(pub i32);

impl From<PetscFailure> for LinearFailure {
    fn from(PetscFailure(code): PetscFailure) -> Self {
        match code {
            OUT_OF_MEMORY => Self::OutOfMemory(0),
            code => Self::Analysis(format!("PETSc reports its error {code}")),
        }
    }
}

/// What was counted on this rank since the start.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Traffic {
    /// Iterations of linear solves, the first of each left out: vectors are made in it.
    pub iterations: f64,
    /// Halo exchanges in them.
    pub exchanges: f64,
    /// Messages that this rank sent.
    pub messages: f64,
    /// Their bytes.
    pub bytes: f64,
    /// Reductions.
    pub reductions: f64,
    /// Levels of the last solver, the finest included.
    pub levels: f64,
}

/// What became of a solve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solved {
    /// Iterations.
    pub iterations: usize,
    /// Whether the residual came below the tolerance.
    pub converged: bool,
    /// Whether matrix or preconditioner turned out not to be positive definite.
    pub broke: bool,
    /// Norm of the residual as a share of that of the right-hand side.
    pub residual: f64,
}
