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
    /// Smallest substep that is tried before walls are relaxed: twice as long after each in which
    /// they were, as shorter ones do not find the path again that was lost there.
    pub(super) smallest: f64,
}

impl<'a> Way<'a> {
    /// The whole of a load step, from a state.
    pub(super) fn from(state: &'a State) -> Self {
        Self {
            here: Cow::Borrowed(state),
            share: 0.0,
            increment: 1.0,
            coarse: None,
            half: None,
            failed: None,
            smallest: SMALLEST_TRIED,
        }
    }
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
            (_, None) => self.smallest,
        };
        self.increment <= smallest
            || *outcome == StepOutcome::Stopped
            || (*outcome == StepOutcome::RigidBodyMotion && !system.is_path_dependent())
    }

    /// The end of a substep to which walls were relaxed, from where the next is longer; none if
    /// they did not come to rest in it, for which shorter ones are to be tried.
    ///
    /// # Errors
    /// If none is shorter, or would change anything: why.
    pub(super) fn after_relaxation(
        &mut self,
        relaxed: Result<Reached, StepOutcome>,
    ) -> Result<Option<Reached>, StepOutcome> {
        match relaxed {
            Err(why) if self.increment <= SMALLEST_TRIED || why.is_beyond_attempts() => Err(why),
            Err(_) => {
                self.smallest = SMALLEST_TRIED;
                self.increment *= 0.5;
                Ok(None)
            }
            Ok(reached) => {
                self.smallest = 2.0 * f64::max(self.smallest, reached.share - self.share);
                self.increment = self.smallest;
                Ok(Some(reached))
            }
        }
    }

    /// Whether the next substep, tried as a whole, may come to an end where the first half of the
    /// last, which is the same increment, has failed: because it is tried in earnest, or from
    /// another guess.
    pub(super) fn may_succeed(&self, step: &Step<'_>) -> bool {
        let is_earnest = step.is_tried_briefly && self.increment <= SMALLEST_SUBSTEP;
        step.system.is_smooth() || is_earnest
    }
}

#[cfg(test)]
mod tests {
    use lie_core::ClosureKind;

    use super::*;
    use crate::Discretisation;
    use crate::newton::mean_strain::tests::problem;

    /// After each relaxation substeps are twice as long, and the shortest again after one that does
    /// not come to rest; only that is a failure of the shortest.
    #[test]
    fn substeps_grow_while_walls_are_relaxed_and_begin_anew_where_they_do_not_rest() {
        let problem = problem(ClosureKind::Linear);
        let system = System::assemble(&problem, Discretisation::of(&problem).expect("held"));
        let state = system.initial_state();
        let mut way = Way::from(&state);
        way.increment = SMALLEST_TRIED;
        for factor in [2.0, 4.0] {
            let state = state.clone();
            let share = way.share + way.increment;
            let relaxed = way.after_relaxation(Ok(Reached { state, share }));
            assert!(relaxed.is_ok_and(|reached| reached.is_some_and(|to| to.share == share)));
            assert_eq!(way.increment, factor * SMALLEST_TRIED);
            way.share = share;
            assert!(way.is_final(&system, &StepOutcome::OutOfIterations));
        }
        let fails = || Err(StepOutcome::OutOfIterations);
        assert!(
            way.after_relaxation(fails())
                .is_ok_and(|reached| reached.is_none())
        );
        assert_eq!(way.increment, 2.0 * SMALLEST_TRIED);
        assert!(!way.is_final(&system, &StepOutcome::OutOfIterations));
        way.increment = SMALLEST_TRIED;
        assert!(way.after_relaxation(fails()).is_err());
    }
}
