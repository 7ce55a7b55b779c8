//! The way of one load step: in one part if the laws allow it, in as many as they need if not.
//!
//! Without friction or a breaking bond the end does not depend on the way, so the step is divided only
//! if it does not converge. With them, a part of the way is walked in one go and in two; where the
//! jumps differ by more than [`NewtonSettings::path`], it is divided.

use glam::DVec3;

use super::{Iteration, Linearisation, Newton, Outcome, StepRecord, interface, largest};
use crate::problem::Load;
use crate::system::{State, System};

/// Smallest part of a load step that is tried; what it differs from two halves is let be.
const SMALLEST: f64 = 1.0 / 64.0;
/// Below this share of the error allowed the next part is twice as long.
const LONGER: f64 = 0.25;

/// What a part of the way came to.
enum Part {
    /// Where it ended, and whether the next may be longer.
    Walked(State, bool),
    /// It is to be divided; why, if it is not for accuracy.
    TooLong(Option<Outcome>),
}

impl Newton {
    /// Walks from `state` to `load`; `state` is where that leads, and stays if it leads nowhere.
    pub(super) fn march(
        &mut self,
        system: &System<'_>,
        state: &mut State,
        load: &Load,
        record: &mut StepRecord,
        observe: &mut dyn FnMut(usize, &Iteration),
    ) -> Outcome {
        if self.settings.linearisation == Linearisation::Landed {
            return match self.attempt(system, state, load, record, observe) {
                Ok(end) => {
                    record.walked = 1.0;
                    *state = end;
                    Outcome::Converged
                }
                Err(outcome) => outcome,
            };
        }
        let start = state.load.clone();
        let mut here = state.clone();
        // Without friction a block that flies at the end flies whatever the way.
        let divides = system.is_path_dependent();
        let mut share = 1.0_f64;
        while record.walked < 1.0 {
            let end = f64::min(record.walked + share, 1.0);
            let at = |way: f64| match way {
                1.0 => load.clone(),
                _ => Load::between(&start, load, way),
            };
            let middle = at(0.5 * (record.walked + end));
            let allowed = if share <= SMALLEST {
                f64::INFINITY
            } else {
                self.settings.path
            };
            let part = self.part(system, &here, [&middle, &at(end)], allowed, record, observe);
            match part {
                Part::Walked(next, may_grow) => {
                    self.path.remember(system, &here);
                    (here, record.walked) = (next, end);
                    share = if may_grow { 2.0 * share } else { share };
                }
                Part::TooLong(Some(outcome))
                    if share <= SMALLEST || (outcome == Outcome::Loose && !divides) =>
                {
                    return outcome;
                }
                Part::TooLong(_) => share *= 0.5,
            }
        }
        *state = here;
        Outcome::Converged
    }

    fn part(
        &mut self,
        system: &System<'_>,
        from: &State,
        [middle, end]: [&Load; 2],
        allowed: f64,
        record: &mut StepRecord,
        observe: &mut dyn FnMut(usize, &Iteration),
    ) -> Part {
        let mut walk = |from: &State, to: &Load, record: &mut StepRecord| {
            let before = record.iterations.len();
            let reached = self.attempt(system, from, to, record, observe);
            if reached.is_ok() {
                record.parts.push(record.iterations.len() - before);
            }
            reached
        };
        let whole = match walk(from, end, record) {
            Ok(whole) => whole,
            Err(outcome) => return Part::TooLong(Some(outcome)),
        };
        if !system.is_path_dependent() || is_elastic(from, &whole) {
            return Part::Walked(whole, true);
        }
        let halves = walk(from, middle, record).and_then(|half| walk(&half, end, record));
        let halves = match halves {
            Ok(halves) => halves,
            Err(outcome) => return Part::TooLong(Some(outcome)),
        };
        let error = difference(system, &whole, &halves);
        if error <= allowed {
            Part::Walked(halves, error <= LONGER * self.settings.path)
        } else {
            Part::TooLong(None)
        }
    }
}

/// Whether nothing slid or broke on the way.
fn is_elastic(from: &State, to: &State) -> bool {
    let pairs = from.facet_points.iter().zip(&to.facet_points);
    let unbroken = |(from, to): (&crate::FacetPointState, &crate::FacetPointState)| {
        !to.joint.sliding && from.history.largest_opening == to.history.largest_opening
    };
    pairs.into_iter().all(unbroken)
}

/// Largest difference of the jumps of two states, against the largest jump.
fn difference(system: &System<'_>, a: &State, b: &State) -> f64 {
    let between: Vec<DVec3> = a
        .unknowns
        .iter()
        .zip(&b.unknowns)
        .map(|(a, b)| *a - *b)
        .collect();
    let apart = largest(&interface(system).jumps(&between, &Load::NONE));
    let size = largest(&interface(system).jumps(&b.unknowns, &b.load));
    super::ratio(apart, size)
}
