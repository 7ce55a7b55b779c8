//! The test whether an iteration fails because blocks move as rigid bodies.

use super::free_blocks::{UNBALANCED, find};
use super::iterate::Iterate;
use super::{Iteration, Step, StepOutcome};

/// Iterations of an increment before free blocks are looked for.
const ITERATIONS_BEFORE_SEARCH: usize = 8;
/// Iterations in a row with pushed blocks after which the loads are taken to push them.
const UNCONSTRAINED_ITERATIONS: usize = 3;

/// The test whether an iteration goes nowhere because blocks move as rigid bodies.
#[derive(Default)]
pub(super) struct RigidBodyMotion {
    /// Iterations in a row that had pushed blocks.
    unconstrained: usize,
}

impl RigidBodyMotion {
    /// Looks at the iterate after iteration `count` of an increment.
    ///
    /// # Errors
    /// [`StepOutcome::RigidBodyMotion`], with the blocks in the record.
    pub(super) fn test(
        &mut self,
        step: &mut Step<'_>,
        iterate: &Iterate,
        iteration: &Iteration,
        count: usize,
    ) -> Result<(), StepOutcome> {
        let is_late = count >= ITERATIONS_BEFORE_SEARCH && !step.system.is_smooth();
        if is_late && iteration.force_residual > UNBALANCED {
            step.record.rigid_motions = find(step.system, iterate);
            self.unconstrained = if step.record.rigid_motions.is_empty() {
                0
            } else {
                self.unconstrained + 1
            };
        }
        if self.unconstrained == UNCONSTRAINED_ITERATIONS {
            step.pushed = step.record.rigid_motions.clone();
            return Err(StepOutcome::RigidBodyMotion);
        }
        Ok(())
    }
}
