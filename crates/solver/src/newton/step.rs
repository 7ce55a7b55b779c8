//! The load step at hand: its system, its record, and who observes it.

use std::ops::ControlFlow;

use glam::DVec3;

use crate::space::rigid_modes::FreeBody;

use super::free_blocks::{self, Bearing};
use super::iterate::Iterate;
use super::{Iteration, StepOutcome, StepRecord, UnresolvedCause, UnresolvedPath};
use crate::problem::Load;
use crate::system::{State, System};

/// Who is told of each iteration, by its number and measures, and may stop the step.
type Observe<'a> = dyn FnMut(usize, &Iteration) -> ControlFlow<()> + 'a;

/// Bisections of a load step for the share of it that fractures can bear.
const BISECTIONS: usize = 10;

/// What all that is done in a load step works with.
pub(super) struct Step<'a> {
    pub(super) system: &'a System<'a>,
    pub(super) record: StepRecord,
    /// The share of the load step that the increment at hand leads to.
    pub(super) share: f64,
    /// Whether the increment at hand is given up soon, because shorter ones are to be tried.
    pub(super) is_tried_briefly: bool,
    /// The largest jump (m) at the end of the load step as one increment has it, if it does.
    pub(super) end_size: Option<f64>,
    /// How far jumps, against the largest, are off the path because no division resolved it: the
    /// sum over its substeps.
    pub(super) lost: f64,
    /// How far the substeps so far lead the jump at each facet point off the path of the loads (m),
    /// added up; empty before the first that does.
    pub(super) path_errors: Vec<f64>,
    /// Whether, however short it was divided, one increment ended and two shorter ones did not.
    pub(super) is_torn: bool,
    /// Blocks that an increment from the same state as that at hand pushed.
    pub(super) pushed: Vec<FreeBody>,
    /// Whether the linear solve at hand is the first of its increment.
    pub(super) predicts: bool,
    /// How far the first linear solve of the last increment moves walls (m).
    pub(super) predicted: Vec<DVec3>,
    /// The state in which the last increment failed, if it did.
    pub(super) end: Option<State>,
    asked_for_collapse: bool,
    observe: &'a mut Observe<'a>,
    is_stopped: bool,
}

impl<'a> Step<'a> {
    pub(super) fn new(system: &'a System<'a>, load: &Load, observe: &'a mut Observe<'a>) -> Self {
        Self {
            system,
            record: StepRecord::new(load.clone()),
            share: 1.0,
            is_tried_briefly: false,
            end_size: None,
            lost: 0.0,
            path_errors: Vec::new(),
            is_torn: false,
            pushed: Vec::new(),
            predicts: false,
            predicted: Vec::new(),
            end: None,
            asked_for_collapse: false,
            observe,
            is_stopped: false,
        }
    }

    /// What jumps are compared with in a state on the way whose largest jump is `size` (m): the
    /// largest that the load step leads to, if they grow no faster than the load.
    pub(super) fn size_at(&self, size: f64) -> f64 {
        let at_end = self.end_size.unwrap_or(size);
        size.max(at_end.min(size / self.share))
    }

    /// Records an iteration and tells the observer.
    pub(super) fn report(&mut self, iteration: Iteration) {
        self.record.iterations.push(iteration);
        let answer = (self.observe)(self.record.iterations.len(), &iteration);
        self.is_stopped |= answer.is_break();
    }

    /// Whether the observer wants more.
    ///
    /// # Errors
    /// [`StepOutcome::Stopped`] if not.
    pub(super) fn go_on(&self) -> Result<(), StepOutcome> {
        if self.is_stopped {
            Err(StepOutcome::Stopped)
        } else {
            Ok(())
        }
    }

    /// Records a part of the step whose path is not resolved, if it is the least resolved so far.
    pub(super) fn leave_unresolved(&mut self, path: UnresolvedPath) {
        self.is_torn |= path.cause == UnresolvedCause::HalvesDoNotEnd;
        let former = self.record.unresolved.as_ref();
        if former.is_none_or(|former| former.cause < path.cause) {
            self.record.unresolved = Some(path);
        }
    }

    /// Records that one increment leads to an equilibrium and two shorter ones to none, where the
    /// last iteration had its largest error.
    pub(super) fn leave_torn(&mut self) {
        self.leave_unresolved(UnresolvedPath {
            cause: UnresolvedCause::HalvesDoNotEnd,
            facet_point: self.record.worst_facet_point,
        });
    }

    /// Adds how far a substep leads the jump at each facet point off the path of the loads (m).
    pub(super) fn add_path_errors(&mut self, lengths: &[f64]) {
        self.path_errors.resize(lengths.len(), 0.0);
        for (sum, length) in self.path_errors.iter_mut().zip(lengths) {
            *sum += length;
        }
    }

    /// Records how far the flow of a part of the step is from resolved in time, if that is the
    /// worst so far.
    pub(super) fn leave_time_error(&mut self, error: f64) {
        let worst = self
            .record
            .time_error
            .map_or(error, |former| former.max(error));
        self.record.time_error = Some(worst);
    }

    /// Records the blocks that nothing holds in the iterate where an increment failed, unless they
    /// are known.
    pub(super) fn explain(&mut self, outcome: &StepOutcome, iterate: &Iterate) {
        let is_known = !self.record.rigid_motions.is_empty() || *outcome == StepOutcome::Stopped;
        if !is_known && !self.system.is_smooth() {
            self.record.rigid_motions = free_blocks::find(self.system, iterate);
        }
    }

    /// Why a step fails whose shortest increment has an outcome: for the blocks that a longer one
    /// pushed, if the shortest knows none.
    pub(super) fn failed_by(&mut self, outcome: StepOutcome) -> StepOutcome {
        if self.record.rigid_motions.is_empty() && !self.pushed.is_empty() {
            self.record.rigid_motions = std::mem::take(&mut self.pushed);
            return StepOutcome::RigidBodyMotion;
        }
        outcome
    }

    /// Asks once, when an increment from a load has failed, whether fractures can bear the end of
    /// the load step at all.
    ///
    /// # Errors
    /// If not: with the blocks of a mechanism, and how much they can bear, in the record.
    pub(super) fn ask_for_collapse(&mut self, start: &Load) -> Result<(), StepOutcome> {
        if std::mem::replace(&mut self.asked_for_collapse, true) {
            return Ok(());
        }
        let Some(bearing) = Bearing::of(self.system) else {
            return Ok(());
        };
        let load = &self.record.load;
        let Some(along) = bearing.exceeded_by(load) else {
            return Ok(());
        };
        let collapses = |share| {
            let part = Load::between(start, load, share);
            bearing.exceeded_by(&part).is_some()
        };
        let halved = |(low, high), _| {
            let middle = 0.5 * (low + high);
            match collapses(middle) {
                true => (low, middle),
                false => (middle, high),
            }
        };
        let (_, high) = (0..BISECTIONS).fold((0.0, 1.0), halved);
        self.record.bearable = Some(high);
        self.record.rigid_motions = bearing.blocks(&along);
        Err(StepOutcome::RigidBodyMotion)
    }

    /// The record after `seconds` altogether.
    pub(super) fn finished(mut self, outcome: StepOutcome, seconds: f64) -> StepRecord {
        self.record.outcome = outcome;
        self.record.path_error_at_one_place = self.path_errors.iter().copied().fold(0.0, f64::max);
        self.record.solve_seconds = seconds - self.record.factorise_seconds;
        self.record
    }
}

/// The observer of [`Newton::solve_step`](super::Newton::solve_step) that takes no notice and never
/// stops.
pub fn unobserved(_: usize, _: &Iteration) -> ControlFlow<()> {
    ControlFlow::Continue(())
}
