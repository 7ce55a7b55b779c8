//! What a run keeps in memory beside its linear solver.

use kluft_mesh::Mesh;

use crate::estimate::estimate_bytes;
use crate::linear::{ExtraMemory, Workload};
use crate::newton::recycling_bytes;

impl Workload {
    /// Counts in what estimates of errors and moves of former steps take, on a mesh with this
    /// number of unknown 3-vectors.
    pub fn with_extra_memory(self, mesh: &Mesh, unknowns: usize) -> Self {
        let increments = self.is_smooth.then_some(self.steps);
        let recycles = self.flow.is_none() && increments != Some(1);
        let iterative = if recycles {
            recycling_bytes(unknowns, increments)
        } else {
            0
        };
        let estimate = estimate_bytes(mesh);
        // One load step is estimated when there is no solver any more.
        let (always, after) = match self.steps {
            1 => (0, estimate),
            _ => (estimate, 0),
        };
        Self {
            extra: ExtraMemory {
                always,
                iterative,
                after,
            },
            ..self
        }
    }
}
