//! What PETSc answers.

use kluft_mesh::Defect;
use kluft_program::failure::Failure;
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

/// An error of PETSc or MPI outside of a linear solve.
pub fn machine(PetscFailure(code): PetscFailure) -> Failure {
    let problem = format!("MPI or PETSc reports its error {code}");
    let remedy = "see what mpiexec says above, and the log of the batch system";
    Failure::Machine(vec![Defect::new("ranks", problem, remedy)])
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

impl From<[f64; 6]> for Traffic {
    /// In this order.
    fn from([iterations, exchanges, messages, bytes, reductions, levels]: [f64; 6]) -> Self {
        Self {
            iterations,
            exchanges,
            messages,
            bytes,
            reductions,
            levels,
        }
    }
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

impl From<[f64; 4]> for Solved {
    /// In this order, what is true being 1.
    fn from([iterations, converged, broke, residual]: [f64; 4]) -> Self {
        Self {
            iterations: iterations as usize,
            converged: converged != 0.0,
            broke: broke != 0.0,
            residual,
        }
    }
}
