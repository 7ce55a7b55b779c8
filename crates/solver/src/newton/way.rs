//! How far a load step is solved, and what is known of what comes next.

use std::borrow::Cow;

use super::substep::{Half, TooLong};
use super::{Step, StepOutcome};
use crate::problem::Load;
use crate::system::{State, System};

/// Smallest substep that is divided, as a share of the load step, because it differs from two
/// halves or pushes blocks that nothing holds.
pub(super) const SMALLEST_SUBSTEP: f64 = 1.0 / 64.0;
/// Smallest substep that is tried where none has converged.
pub(super) const SMALLEST_TRIED: f64 = 1.0 / 256.0;

/// A state on the way, and the share of the step that leads to it.
pub(super) struct Reached {
    pub(super) state: State,
    pub(super) share: f64,
}

/// How far a load step is solved.
pub(super) struct Way<'a> {
    pub(super) here: Cow<'a, State>,
    /// The share of the step that leads to it.
    pub(super) share: f64,
    /// Length of the next substep.
    pub(super) increment: f64,
    /// The end of the shortest substep beyond here that converged in one increment.
    pub(super) coarse: Option<Reached>,
    /// What the increment to the end of the next substep came to, if the last was too long.
    pub(super) half: Option<Half>,
    /// Why nothing beyond here has converged in [`SMALLEST_SUBSTEP`] or less.
    pub(super) failed: Option<StepOutcome>,
}

impl Way<'_> {
    /// Asks whether fractures can bear the load step at all where no increment has come to an end.
    ///
    /// # Errors
    /// If not.
    pub(super) fn ask_for_collapse(
        &self,
        step: &mut Step<'_>,
        found: &TooLong,
        start: &Load,
    ) -> Result<(), StepOutcome> {
        let ended = found.whole.is_some() || self.coarse.is_some();
        match found.why {
            None | Some(StepOutcome::Stopped) => Ok(()),
            Some(_) if ended => Ok(()),
            Some(_) => step.ask_for_collapse(start),
        }
    }

    /// Whether a shorter substep would change nothing about a failure. Without friction a block
    /// that moves freely at the end does so whatever the path.
    pub(super) fn is_final(&self, system: &System<'_>, outcome: &StepOutcome) -> bool {
        let smallest = match (outcome, &self.coarse) {
            (StepOutcome::RigidBodyMotion, _) | (_, Some(_)) => SMALLEST_SUBSTEP,
            (_, None) => SMALLEST_TRIED,
        };
        self.increment <= smallest
            || *outcome == StepOutcome::Stopped
            || (*outcome == StepOutcome::RigidBodyMotion && !system.is_path_dependent())
    }

    /// Whether the next substep, tried as a whole, may come to an end where the first half of the
    /// last, which is the same increment, has failed: because it is tried in earnest, or from
    /// another guess.
    pub(super) fn may_succeed(&self, step: &Step<'_>) -> bool {
        let is_earnest = step.is_tried_briefly && self.increment <= SMALLEST_SUBSTEP;
        step.system.is_smooth() || is_earnest
    }
}
