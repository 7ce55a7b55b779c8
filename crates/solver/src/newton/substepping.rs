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

use super::comparison::{Both, Compared, End, Ended};
use super::free_blocks;
use super::path_error::{self, Apart};
use super::relieved;
use super::way::{Half, Reached, SMALLEST_SUBSTEP, TooLong, Way};
use super::{Newton, Step, StepOutcome, UnresolvedCause, UnresolvedPath};
use crate::flow::Coupling;
use crate::problem::Load;
use crate::system::State;

/// Below this share of the error allowed the next substep is twice as long.
const GROWTH_SHARE: f64 = 0.25;
/// Error allowed in what is left of a load step whose path is lost by more, in path accuracies.
const MOST_LOST: f64 = 100.0;

/// A part of a load step.
struct Substep {
    start: End,
    middle: End,
    end: End,
    /// What one increment to its end comes to, if a longer substep has tried it.
    whole: Option<Result<Ended, StepOutcome>>,
    /// Whether it is not divided any more.
    is_smallest: bool,
    /// Whether it is a half of another, which is compared in any case.
    is_half: bool,
}

/// What a substep came to.
enum Solved {
    /// It stands.
    Accepted(Accepted),
    /// It is to be divided.
    TooLong(TooLong),
}

/// The end of a substep that stands.
struct Accepted {
    end: Box<State>,
    /// Whether the next substep may be longer.
    may_grow: bool,
}

impl Accepted {
    fn at(end: State) -> Self {
        Self {
            end: Box::new(end),
            may_grow: true,
        }
    }
}

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
        let mut way = Way {
            here: Cow::Borrowed(state),
            share: 0.0,
            increment: 1.0,
            coarse: None,
            half: None,
            failed: None,
        };
        while way.share < 1.0 {
            let end = f64::min(way.share + way.increment, 1.0);
            let middle = 0.5 * (way.share + end);
            let known = way.half.take().filter(|half| half.share == end);
            let substep = Substep {
                start: End::between(&start, load, way.share),
                middle: End::between(&start, load, middle),
                end: End::between(&start, load, end),
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
                    self.divide(step, &mut way, found, end)?
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

    /// Goes on after a substep to `end` that is too long: by a shorter one, or by the direct
    /// solver; where neither is left, from the end that stands for it.
    ///
    /// # Errors
    /// If there is none.
    fn divide(
        &mut self,
        step: &mut Step<'_>,
        way: &mut Way<'_>,
        found: TooLong,
        end: f64,
    ) -> Result<Option<Reached>, StepOutcome> {
        let is_torn = step.is_torn && found.whole.is_some();
        let reached = |share: f64| {
            move |state: Box<State>| Reached {
                state: *state,
                share,
            }
        };
        way.coarse = found.whole.map(reached(end)).or(way.coarse.take());
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
            Some(outcome) => {
                let end = let_be(step, outcome, way.coarse.take())?;
                way.increment = end.share - way.share;
                Ok(Some(end))
            }
        }
    }

    /// Whether a direct solver goes on where an increment of an iterative one fails for good; of
    /// blocks that are pushed the linear solver is no cause.
    fn may_fall_back(&mut self, step: &Step<'_>, outcome: &StepOutcome) -> bool {
        let has_other_cause = [StepOutcome::Stopped, StepOutcome::RigidBodyMotion];
        !has_other_cause.contains(outcome) && self.linear.fall_back(step.system)
    }

    fn solve_substep(&mut self, step: &mut Step<'_>, from: &State, substep: Substep) -> Solved {
        let known = substep.whole;
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
        if step.system.is_smooth() {
            self.path.lead_to(step.system, &whole.state);
        }
        let half = self.solve_counted(step, from, &substep.middle);
        let halves = half.as_ref().map_err(Clone::clone).and_then(|half| {
            let end = self.solve_counted(step, &half.state, &substep.end)?;
            Ok((half, end))
        });
        if step.system.is_smooth() {
            self.path.lead_on();
        }
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

    /// Whether anything slides, breaks or meets on the way of an increment.
    fn slides(&self, step: &Step<'_>, from: &State, whole: &Ended) -> bool {
        if !path_error::is_elastic(from, &whole.state) {
            return true;
        }
        if step.lost > 0.0 {
            return false;
        }
        let slips = path_error::slips_until_met(step.system, &whole.since(from));
        let slip = slips.into_iter().fold(0.0, f64::max);
        let size = step.size_at(path_error::largest_jump(step.system, &whole.state));
        slip > GROWTH_SHARE * self.path_tolerance(step) * size
    }

    /// Takes for the end of a substep that in two increments, and records how far that in one is
    /// from it.
    ///
    /// # Errors
    /// If that is too far for a substep that may be divided; with a shorter increment from its
    /// start that was tried, if there is one beside its first half.
    fn accept(&mut self, step: &mut Step<'_>, both: Both<'_>) -> Result<Accepted, Option<Half>> {
        let size = step.size_at(path_error::largest_jump(step.system, &both.end.state));
        let tolerance = self.path_tolerance(step);
        let allowed = [tolerance, self.settings.time];
        let compared = Compared::of(step, &both, size, allowed);
        let (error, is_smallest) = (compared.error, both.is_smallest);
        if error > 1.0 && !is_smallest {
            return Err(None);
        }
        let is_small = error <= GROWTH_SHARE || (step.lost > 0.0 && error <= 1.0);
        let [first, second] = both.increments();
        let is_long = 2.0 * (both.end.share - both.half.share) >= SMALLEST_SUBSTEP;
        let may_hide = both.slides && is_long && error <= 1.0 && step.lost == 0.0;
        let slid = may_hide && relieved::any_slid(step.system, &first, tolerance * size);
        // What is over in an instant, no half of a half tells more of.
        let may_turn = may_hide && !is_smallest && !(both.is_half && is_small);
        if slid || (may_turn && path_error::turns(step.system, [&first, &second], size)) {
            let apart = compared.apart.as_ref().map_or(0.0, Apart::length);
            self.compare_first_half(step, &both, tolerance * size - apart, slid)?;
        }
        let accepted = match may_hide && path_error::is_bent(step.system, &second, size) {
            true => {
                let start = (&both.half.state, both.half.place());
                let solved = self.solve_half(step, start, both.end, is_smallest);
                solved.map_err(|_| None)?
            }
            false => Accepted::at(both.end.state),
        };
        if let Some(apart) = compared.in_time.filter(|apart| *apart > self.settings.time) {
            step.leave_time_error(apart);
        }
        if let Some(apart) = compared.apart {
            self.leave_apart(step, &apart, is_smallest);
        }
        Ok(Accepted {
            may_grow: is_small && accepted.may_grow,
            ..accepted
        })
    }

    /// Solves the first half of a substep in two increments, which tell what it hides; if they do
    /// not converge, nothing, unless they `must`.
    ///
    /// # Errors
    /// If it is too long, or leads off the path by more than `allowed` (m), and may be divided;
    /// with what a shorter increment from its start came to, if one was tried. Then no error of it
    /// is recorded.
    fn compare_first_half(
        &mut self,
        step: &mut Step<'_>,
        both: &Both<'_>,
        allowed: f64,
        must: bool,
    ) -> Result<(), Option<Half>> {
        let before = (step.record.path_error, step.path_errors.clone());
        let start = (both.from, both.start.clone());
        let solved = self.solve_half(step, start, both.half.clone(), both.is_smallest);
        let is_off = step.record.path_error - before.0 > allowed && !both.is_smallest;
        let refused = match solved {
            Ok(_) if is_off => Err(None),
            Ok(_) => return Ok(()),
            Err(found) if found.why.is_some() && !must && step.go_on().is_ok() => Ok(()),
            Err(found) => Err(found.half),
        };
        (step.record.path_error, step.path_errors) = before;
        refused
    }

    /// Solves a half of a substep, whose end in one increment is known, in two increments, and a
    /// half of it in turn if need be: of what happens in it alone the whole in one increment and in
    /// two may tell nothing.
    ///
    /// # Errors
    /// If it is too long and may be divided.
    fn solve_half(
        &mut self,
        step: &mut Step<'_>,
        (from, start): (&State, End),
        end: Ended,
        is_smallest: bool,
    ) -> Result<Accepted, TooLong> {
        let to = end.place();
        let middle = End {
            load: Load::between(&start.load, &to.load, 0.5),
            share: 0.5 * (start.share + to.share),
        };
        let substep = Substep {
            start,
            middle,
            end: to,
            whole: Some(Ok(end)),
            is_smallest,
            is_half: true,
        };
        match self.solve_substep(step, from, substep) {
            Solved::Accepted(accepted) => Ok(accepted),
            Solved::TooLong(mut found) if is_smallest && step.go_on().is_ok() => {
                step.leave_torn();
                let end = found.whole.take().ok_or(found)?;
                Ok(Accepted::at(*end))
            }
            Solved::TooLong(found) => Err(found),
        }
    }

    /// Records how far the jumps of one increment and of two are apart in a substep that stands.
    fn leave_apart(&self, step: &mut Step<'_>, apart: &Apart, is_smallest: bool) {
        step.record.path_error += apart.length();
        step.add_path_errors(&apart.lengths);
        let (share, accuracy) = (apart.share(), self.settings.path);
        if share <= accuracy {
            return;
        }
        step.lost += share;
        if is_smallest {
            step.leave_unresolved(UnresolvedPath {
                cause: UnresolvedCause::Differs(share),
                facet_point: apart.facet_point(),
            });
        }
    }

    /// How far jumps may be off in a substep, against the largest: what is left of a path that is
    /// lost is not followed more closely than it has been.
    fn path_tolerance(&self, step: &Step<'_>) -> f64 {
        let accuracy = self.settings.path;
        step.lost.clamp(accuracy, MOST_LOST * accuracy)
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

/// What stands for a substep that no division resolves: the end of a longer one that converged in
/// one increment.
///
/// # Errors
/// If there is none: [`StepOutcome::RigidBodyMotion`] if a longer one pushed blocks that nothing
/// holds, else the outcome of the shortest.
fn let_be(
    step: &mut Step<'_>,
    outcome: StepOutcome,
    coarse: Option<Reached>,
) -> Result<Reached, StepOutcome> {
    if outcome == StepOutcome::Stopped {
        return Err(outcome);
    }
    let Some(end) = coarse else {
        return Err(step.failed_by(outcome));
    };
    step.record.rigid_motions.clear();
    step.leave_torn();
    Ok(end)
}
