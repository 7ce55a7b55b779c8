//! What the ranks tell each other, as the solver asks for it.

use std::sync::Arc;

use kluft_solver::Communicator;

use crate::answers::machine;
use crate::petsc::{PetscFailure, World};

/// This rank among all. One that cannot be asked any more ends the run.
pub fn communicator(world: &Arc<World>) -> Communicator {
    let gathering = Arc::clone(world);
    let all_gather = move |size: usize, own: &[u8], counts: &[usize], all: &mut [u8]| {
        if let Err(failure) = gathering.gather_records(size, own, counts, all) {
            machine(failure).print();
            World::abort(1);
        }
    };
    Communicator::new(world.rank(), world.ranks(), Arc::new(all_gather))
}

impl World {
    /// The numbers of all ranks, rank by rank; each gives as many.
    ///
    /// # Errors
    /// Those of MPI.
    pub fn gather(&self, own: &[u64]) -> Result<Vec<u64>, PetscFailure> {
        let counts = vec![own.len(); self.ranks()];
        let mut all = vec![0; own.len() * self.ranks()];
        let (from, to) = (
            bytemuck::cast_slice(own),
            bytemuck::cast_slice_mut(&mut all),
        );
        self.gather_records(size_of::<u64>(), from, &counts, to)?;
        Ok(all)
    }
}
