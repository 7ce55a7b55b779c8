//! What the ranks said to each other, in words.

use crate::partition::Partition;
use crate::petsc::{PetscFailure, World};

/// Reductions, exchanges, messages, bytes, balance; every rank must ask.
///
/// # Errors
/// Those of MPI.
pub fn told(world: &World, partition: Option<&Partition>) -> Result<Vec<String>, PetscFailure> {
    let own = world.traffic()?;
    let all = world.gather(&[own.messages as u64, own.bytes as u64])?;
    let each = 1.0 / own.iterations.max(1.0);
    let mean = |at: usize| {
        let sum: u64 = all.chunks_exact(2).map(|numbers| numbers[at]).sum();
        sum as f64 * each / world.ranks() as f64
    };
    Ok(vec![
        format!(
            "an iteration of the linear solver takes {:.1} reductions and {:.1} halo exchanges over \
             {:.0} levels; a rank sends {:.1} messages of {:.2} kB in it",
            own.reductions * each,
            own.exchanges * each,
            own.levels,
            mean(0),
            1e-3 * mean(1) / mean(0).max(1.0)
        ),
        format!(
            "the largest rank has {:.3} times the mean number of unknowns",
            partition.map_or(1.0, Partition::imbalance)
        ),
    ])
}
