//! The test whether an iteration fails because blocks move as rigid bodies.

use super::free_blocks::find;
use super::{Iteration, Step, StepOutcome};
use crate::system::State;

/// Iterations of an increment before free blocks are looked for.
const ITERATIONS_BEFORE_SEARCH: usize = 8;
/// Force out of balance, against the largest, that may be due to free blocks.
const UNBALANCED: f64 = 1e-4;
/// Iterations in a row with free blocks after which the loads are taken to push them.
const UNCONSTRAINED_ITERATIONS: usize = 3;

/// The test whether an iteration goes nowhere because blocks move as rigid bodies.
#[derive(Default)]
pub(super) struct RigidBodyMotion {
    /// Iterations in a row that had free blocks.
    unconstrained: usize,
}

impl RigidBodyMotion {
    /// Looks at the state after iteration `count` of an increment.
    ///
    /// # Errors
    /// [`StepOutcome::RigidBodyMotion`], with the blocks in the record.
    pub(super) fn test(
        &mut self,
        step: &mut Step<'_>,
        state: &State,
        iteration: &Iteration,
        count: usize,
    ) -> Result<(), StepOutcome> {
        let is_late = count >= ITERATIONS_BEFORE_SEARCH && !step.system.is_smooth();
        if is_late && iteration.force_residual > UNBALANCED {
            step.record.rigid_motions = find(step.system, state);
            self.unconstrained = if step.record.rigid_motions.is_empty() {
                0
            } else {
                self.unconstrained + 1
            };
        }
        if self.unconstrained == UNCONSTRAINED_ITERATIONS {
            return Err(StepOutcome::RigidBodyMotion);
        }
        Ok(())
    }
}
