//! A run shared by many processes, the ranks: each goes through the same stages with the same
//! numbers, the rows of the linear solver are divided among them, and the first one alone writes
//! what is not divided.

use std::fmt;

use kluft_mesh::Defect;
use kluft_solver::{Communicator, LinearFailure, System, TangentSolver};

/// The linear solver of a system, its rows divided among the ranks.
pub type MakeSolver<'a> =
    &'a (dyn Fn(&mut System<'_>) -> Result<Box<dyn TangentSolver>, LinearFailure> + Sync);

/// This process as one of many. What it asks of the others, all of them must ask alike.
#[derive(Clone, Copy)]
pub struct Ranks<'a> {
    /// Its number and that of all, and what one tells the others.
    pub communicator: &'a Communicator,
    /// How many of them share the memory of this machine, this one included.
    pub on_machine: usize,
    /// The linear solver.
    pub solver: MakeSolver<'a>,
    /// Rank of each point that has unknowns, once there is a solver.
    pub owner: &'a (dyn Fn() -> Vec<u32> + Sync),
    /// Memory that the solver of so many rows, with so many blocks, takes on each of so many ranks
    /// (bytes).
    pub solver_bytes: &'a (dyn Fn(usize, usize, usize) -> usize + Sync),
}

impl fmt::Debug for Ranks<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.communicator.fmt(formatter)
    }
}

impl Ranks<'_> {
    /// Whether this is the first rank.
    pub fn is_first(&self) -> bool {
        self.rank() == 0
    }

    /// Number of this rank, from 0.
    pub fn rank(&self) -> usize {
        self.communicator.rank()
    }

    /// Number of all ranks.
    pub fn count(&self) -> usize {
        self.communicator.size()
    }

    /// What all ranks have done if each of them could, and else the defects; none where another
    /// rank names them.
    ///
    /// # Errors
    /// If one of the ranks has an error.
    pub fn agree<T>(&self, result: Result<T, Vec<Defect>>) -> Result<T, Vec<Defect>> {
        let failures = self.communicator.gathered(&[u8::from(result.is_err())]);
        match failures.iter().all(|failed| *failed == 0) {
            true => result,
            false => result.and(Err(Vec::new())),
        }
    }
}

/// [`Ranks::agree`] if there are ranks.
///
/// # Errors
/// If one of the ranks has an error.
pub fn agreed<T>(
    ranks: Option<Ranks<'_>>,
    result: Result<T, Vec<Defect>>,
) -> Result<T, Vec<Defect>> {
    match ranks {
        Some(ranks) => ranks.agree(result),
        None => result,
    }
}
