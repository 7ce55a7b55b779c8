//! Whether a substep stands: how far one increment is from two, and what neither tells.

use super::comparison::{Both, Compared, End, Ended};
use super::path_error::{self, Apart};
use super::relieved;
use super::substep::{Accepted, Half, Solved, Substep, TooLong};
use super::way::SMALLEST_SUBSTEP;
use super::{Newton, Step, UnresolvedCause, UnresolvedPath};
use crate::problem::Load;
use crate::system::State;

/// Below this share of the error allowed the next substep is twice as long.
const GROWTH_SHARE: f64 = 0.25;
/// Error allowed in what is left of a load step whose path is lost by more, in path accuracies.
const MOST_LOST: f64 = 100.0;

impl Newton {
    /// Whether anything slides, breaks or meets on the way of an increment.
    pub(super) fn slides(&self, step: &Step<'_>, from: &State, whole: &Ended) -> bool {
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
    pub(super) fn accept(
        &mut self,
        step: &mut Step<'_>,
        both: Both<'_>,
    ) -> Result<Accepted, Option<Half>> {
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
        let may_have_slid = may_turn
            && (path_error::turns(step.system, [&first, &second], size)
                || relieved::any_may_have_slid(step.system, &first, tolerance * size));
        if slid || may_have_slid {
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
}
