//! A load step in one increment if the laws allow it, in as many as they need if not.
//!
//! Without friction, a breaking bond or a flow that takes time the end does not depend on the path,
//! so the step is divided only if it does not converge. With them, a substep is solved in one
//! increment and in two; where the jumps that the loads determine differ by more than
//! [`NewtonSettings::path`](super::NewtonSettings::path), or what the fluid fills and its pressures
//! by more than [`NewtonSettings::time`](super::NewtonSettings::time), it is divided. Loads and
//! what drives the flow walk with it. What no division resolves, walls that jump to another place
//! in an instant, is let be and recorded.

use std::borrow::Cow;

use super::comparison::{Both, End, Ended};
use super::free_blocks;
use super::path_error;
use super::substep::{Accepted, Half, Solved, Substep, TooLong};
use super::way::{Reached, SMALLEST_SUBSTEP, Way};
use super::{Newton, Step, StepOutcome, UnresolvedCause, UnresolvedPath};
use crate::flow::Coupling;
use crate::problem::Load;
use crate::system::State;

impl Newton {
    /// The state that a load step from `state` to `load` leads to.
    ///
    /// # Errors
    /// Why the step leads nowhere.
    pub(super) fn solve_in_substeps(
        &mut self,
        step: &mut Step<'_>,
        state: &State,
        load: &Load,
    ) -> Result<State, StepOutcome> {
        let flows = step.system.coupling().is_some_and(Coupling::is_transient);
        let start = match flows {
            true => step.system.problem.schedule.walked_from(&state.load),
            false => state.load.clone(),
        };
        tell_falls(step, state, load);
        let mut way = Way::from(state);
        while way.share < 1.0 {
            let end = f64::min(way.share + way.increment, 1.0);
            let middle = 0.5 * (way.share + end);
            let known = way.half.take().filter(|half| half.share == end);
            let to = End::between(&start, load, end);
            let substep = Substep {
                start: End::between(&start, load, way.share),
                middle: End::between(&start, load, middle),
                end: to.clone(),
                whole: known.map(|half| half.end.map(|end| *end)),
                is_smallest: way.increment <= SMALLEST_SUBSTEP,
                is_half: false,
            };
            // Whole steps are tried in earnest before they are divided.
            step.is_tried_briefly =
                step.system.is_path_dependent() && way.increment < 1.0 && !substep.is_smallest;
            let next = match self.solve_substep(step, &way.here, substep) {
                Solved::Accepted(accepted) => {
                    way.increment *= if accepted.may_grow { 2.0 } else { 1.0 };
                    Some(Reached {
                        state: *accepted.end,
                        share: end,
                    })
                }
                Solved::TooLong(found) => {
                    way.ask_for_collapse(step, &found, &start)?;
                    self.divide(step, &mut way, found, &to)?
                }
            };
            if let Some(next) = next {
                self.path.remember(step.system, &way.here);
                way.coarse = way.coarse.take().filter(|end| end.share > next.share);
                (way.here, way.share) = (Cow::Owned(next.state), next.share);
                way.failed = None;
                step.pushed.clear();
                step.record.completed = way.share;
            }
        }
        Ok(way.here.into_owned())
    }

    /// Goes on after a substep `to` an end that is too long: by a shorter one, or by the direct
    /// solver; where neither is left, from the end that stands for it.
    ///
    /// # Errors
    /// If there is none.
    fn divide(
        &mut self,
        step: &mut Step<'_>,
        way: &mut Way<'_>,
        found: TooLong,
        to: &End,
    ) -> Result<Option<Reached>, StepOutcome> {
        let is_torn = step.is_torn && found.whole.is_some();
        let reached = |share: f64| {
            move |state: Box<State>| Reached {
                state: *state,
                share,
            }
        };
        way.coarse = found.whole.map(reached(to.share)).or(way.coarse.take());
        let is_final = |why: &StepOutcome| is_torn || way.is_final(step.system, why);
        let ends = found.why.as_ref().is_some_and(is_final);
        let why = match (way.failed.take(), found.why) {
            (Some(former), Some(outcome)) => Some(former.and(outcome)),
            (_, why) => why,
        };
        if way.increment <= SMALLEST_SUBSTEP {
            way.failed.clone_from(&why);
        }
        match why.filter(|_| ends) {
            None => {
                let length = f64::min(way.increment, 1.0 - way.share);
                let tried = found.half.as_ref();
                let tried = tried.map_or(length, |half| half.share - way.share);
                way.increment = f64::min(0.5 * length, tried);
                let would_differ = |half: &Half| half.end.is_err() && way.may_succeed(step);
                way.half = found.half.filter(|half| !would_differ(half));
                Ok(None)
            }
            Some(outcome) if self.may_fall_back(step, &outcome) => Ok(None),
            Some(outcome) => match way.coarse.take() {
                Some(next) => {
                    let next = let_be(step, outcome, next)?;
                    way.increment = next.share - way.share;
                    Ok(Some(next))
                }
                None => {
                    let relaxed = self.relaxed(step, way, outcome, to);
                    way.after_relaxation(relaxed)
                }
            },
        }
    }

    /// The state that walls relax to at the end of a substep that no division resolves and no
    /// increment leads to.
    ///
    /// # Errors
    /// If they do not: why. Mechanisms are not relaxed: [`StepOutcome::RigidBodyMotion`] if a
    /// longer substep pushed blocks that nothing holds.
    fn relaxed(
        &mut self,
        step: &mut Step<'_>,
        way: &Way<'_>,
        outcome: StepOutcome,
        to: &End,
    ) -> Result<Reached, StepOutcome> {
        let system = step.system;
        let is_ended = outcome.is_beyond_attempts() || !step.pushed.is_empty();
        if is_ended || system.is_smooth() || system.coupling().is_some() {
            return Err(step.failed_by(outcome));
        }
        let state = self.relax(step, &way.here, to);
        let share = to.share;
        state
            .map(|state| Reached { state, share })
            .map_err(|failed| outcome.and(failed))
    }

    /// Whether a direct solver goes on where an increment of an iterative one fails for good; of
    /// blocks that are pushed the linear solver is no cause.
    fn may_fall_back(&mut self, step: &Step<'_>, outcome: &StepOutcome) -> bool {
        !outcome.is_beyond_attempts() && self.linear.fall_back(step.system)
    }

    /// Solves a substep in one increment and, if its end depends on the path, in two.
    pub(super) fn solve_substep(
        &mut self,
        step: &mut Step<'_>,
        from: &State,
        mut substep: Substep,
    ) -> Solved {
        let known = substep.whole.take();
        let solved = known.unwrap_or_else(|| self.solve_counted(step, from, &substep.end));
        let whole = match solved {
            Ok(whole) => whole,
            Err(outcome) => return Solved::TooLong(TooLong::because(outcome)),
        };
        let mut found = TooLong::default();
        if step.system.is_path_dependent() && substep.end.share == 1.0 {
            let size = path_error::largest_jump(step.system, &whole.state);
            step.end_size.get_or_insert(size);
        }
        let slides =
            step.system.is_path_dependent() && (substep.is_half || self.slides(step, from, &whole));
        let flows = step.system.coupling().is_some_and(Coupling::is_transient);
        if !slides && (!flows || self.settings.time >= 1.0) {
            return Solved::Accepted(Accepted::at(whole.state));
        }
        let [half, end] = self.solve_halves(step, from, &whole.state, &substep);
        let halves = half.as_ref().map_err(Clone::clone);
        let halves = halves.and_then(|half| Ok((half, end?)));
        let accepted = match halves {
            Ok((half, end)) => {
                let both = Both {
                    from,
                    start: &substep.start,
                    whole: &whole.state,
                    half,
                    end,
                    slides,
                    is_smallest: substep.is_smallest,
                    is_half: substep.is_half,
                };
                self.accept(step, both)
            }
            Err(outcome) => {
                found.why = Some(outcome);
                Err(None)
            }
        };
        accepted.map_or_else(
            |shorter| {
                let own = || Half::of(&substep.middle, half);
                found.half = Some(shorter.unwrap_or_else(own));
                found.whole = Some(Box::new(whole.state));
                Solved::TooLong(found)
            },
            Solved::Accepted,
        )
    }

    /// The ends of a substep's halves, whose end in one increment is `whole`.
    fn solve_halves(
        &mut self,
        step: &mut Step<'_>,
        from: &State,
        whole: &State,
        substep: &Substep,
    ) -> [Result<Ended, StepOutcome>; 2] {
        if step.system.is_smooth() {
            self.path.lead_to(step.system, whole);
        }
        let half = self.solve_counted(step, from, &substep.middle);
        let begun = half.as_ref().map_err(Clone::clone);
        let end = begun.and_then(|half| self.solve_counted(step, &half.state, &substep.end));
        if step.system.is_smooth() {
            self.path.lead_on();
        }
        [half, end]
    }

    /// Solves an increment and records its iterations if it converges.
    fn solve_counted(
        &mut self,
        step: &mut Step<'_>,
        from: &State,
        to: &End,
    ) -> Result<Ended, StepOutcome> {
        let before = step.record.iterations.len();
        step.share = to.share;
        let state = self.solve_increment(step, from, &to.load)?;
        let predicted = std::mem::take(&mut step.predicted);
        let iterations = step.record.iterations.len() - before;
        step.record.substeps.push(iterations);
        Ok(Ended {
            state,
            share: to.share,
            predicted,
        })
    }
}

/// Records that blocks fall where only friction tells where they come to rest.
fn tell_falls(step: &mut Step<'_>, from: &State, load: &Load) {
    if step.system.is_path_dependent() && free_blocks::fall(step.system, from, load) {
        step.leave_unresolved(UnresolvedPath {
            cause: UnresolvedCause::Falls,
            facet_point: None,
        });
    }
}

/// What stands for a substep that no division resolves: the end of a longer one, the `next` state
/// on the way, that converged in one increment.
///
/// # Errors
/// If the observer stopped it.
fn let_be(
    step: &mut Step<'_>,
    outcome: StepOutcome,
    next: Reached,
) -> Result<Reached, StepOutcome> {
    if outcome == StepOutcome::Stopped {
        return Err(outcome);
    }
    step.record.rigid_motions.clear();
    step.leave_torn();
    Ok(next)
}
