//! What the ranks said to each other, in words.

use kluft_run::Outcome;

use crate::partition::Partition;
use crate::petsc::{PetscFailure, World};

/// Reductions, exchanges, messages, bytes, balance; every rank must ask.
///
/// # Errors
/// Those of MPI.
pub fn told(
    world: &World,
    partition: Option<&Partition>,
    outcome: &Outcome,
) -> Result<Vec<String>, PetscFailure> {
    let own = world.traffic()?;
    let all = world.gather(&[own.messages as u64, own.bytes as u64])?;
    // Who sends and who receives count a message both.
    let sum = |at: usize| all.chunks_exact(2).map(|numbers| numbers[at]).sum::<u64>() as f64 / 2.0;
    let steps = outcome.summary.steps.iter();
    let measures = steps.filter_map(|step| step.measures.as_ref());
    let iterations: usize = measures.map(|measures| measures.linear_iterations).sum();
    let each = 1.0 / iterations.max(1) as f64;
    Ok(vec![
        format!(
            "{iterations} iterations of the linear solver; in each {:.1} reductions, {:.1} halo \
             exchanges, {:.1} messages and {:.1} kB of all ranks together",
            own.reductions * each,
            own.exchanges * each,
            sum(0) * each,
            1e-3 * sum(1) * each
        ),
        format!(
            "the largest rank has {:.3} times the mean number of unknowns",
            partition.map_or(1.0, Partition::imbalance)
        ),
    ])
}
