//! A load step in one increment if the laws allow it, in as many as they need if not.
//!
//! Without friction or a breaking bond the end does not depend on the path, so the step is divided
//! only if it does not converge. With them, a substep is solved in one increment and in two; where
//! the jumps differ by more than [`NewtonSettings::path`](super::NewtonSettings::path), it is
//! divided.

use glam::DVec3;
use kluft_algebra::largest;

use super::convergence::ratio;
use super::facet_points::interface;
use super::{Newton, Step, StepOutcome};
use crate::FacetPointState;
use crate::problem::Load;
use crate::system::{State, System};

/// Smallest substep that is tried, as a share of the load step; what it differs from two halves is
/// let be.
const SMALLEST_SUBSTEP: f64 = 1.0 / 64.0;
/// Below this share of the error allowed the next substep is twice as long.
const GROWTH_SHARE: f64 = 0.25;

/// A part of a load step.
struct Substep {
    middle: Load,
    end: Load,
    /// Largest difference between one increment and two.
    largest_error: f64,
}

/// What a substep came to.
enum Solved {
    /// Its end, and whether the next may be longer.
    Accepted { end: State, may_grow: bool },
    /// It is to be divided; why, if it is not for accuracy.
    TooLong(Option<StepOutcome>),
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
        let mut here = state.clone();
        let mut increment = 1.0_f64;
        while step.record.completed < 1.0 {
            let completed = step.record.completed;
            let end = f64::min(completed + increment, 1.0);
            let substep = Substep {
                middle: between(&state.load, load, 0.5 * (completed + end)),
                end: between(&state.load, load, end),
                largest_error: if increment <= SMALLEST_SUBSTEP {
                    f64::INFINITY
                } else {
                    self.settings.path
                },
            };
            match self.solve_substep(step, &here, &substep) {
                Solved::Accepted {
                    end: next,
                    may_grow,
                } => {
                    self.path.remember(step.system, &here);
                    (here, step.record.completed) = (next, end);
                    increment *= if may_grow { 2.0 } else { 1.0 };
                }
                Solved::TooLong(Some(outcome)) if is_final(step.system, &outcome, increment) => {
                    return Err(outcome);
                }
                Solved::TooLong(_) => increment *= 0.5,
            }
        }
        Ok(here)
    }

    fn solve_substep(&mut self, step: &mut Step<'_>, from: &State, substep: &Substep) -> Solved {
        let whole = match self.solve_counted(step, from, &substep.end) {
            Ok(whole) => whole,
            Err(outcome) => return Solved::TooLong(Some(outcome)),
        };
        if !step.system.is_path_dependent() || is_elastic(from, &whole) {
            return Solved::Accepted {
                end: whole,
                may_grow: true,
            };
        }
        let halves = self
            .solve_counted(step, from, &substep.middle)
            .and_then(|half| self.solve_counted(step, &half, &substep.end));
        let halves = match halves {
            Ok(halves) => halves,
            Err(outcome) => return Solved::TooLong(Some(outcome)),
        };
        let error = difference(step.system, &whole, &halves);
        if error <= substep.largest_error {
            Solved::Accepted {
                end: halves,
                may_grow: error <= GROWTH_SHARE * self.settings.path,
            }
        } else {
            Solved::TooLong(None)
        }
    }

    /// Solves an increment and records its iterations if it converges.
    fn solve_counted(
        &mut self,
        step: &mut Step<'_>,
        from: &State,
        load: &Load,
    ) -> Result<State, StepOutcome> {
        let before = step.record.iterations.len();
        let end = self.solve_increment(step, from, load)?;
        let iterations = step.record.iterations.len() - before;
        step.record.substeps.push(iterations);
        Ok(end)
    }
}

/// Whether a shorter substep would change nothing about a failure. Without friction a block that
/// moves freely at the end does so whatever the path.
fn is_final(system: &System<'_>, outcome: &StepOutcome, increment: f64) -> bool {
    increment <= SMALLEST_SUBSTEP
        || *outcome == StepOutcome::Stopped
        || (*outcome == StepOutcome::RigidBodyMotion && !system.is_path_dependent())
}

/// The load at a share of a step.
fn between(start: &Load, end: &Load, share: f64) -> Load {
    if share == 1.0 {
        end.clone()
    } else {
        Load::between(start, end, share)
    }
}

/// Whether nothing slid or broke on the way.
fn is_elastic(from: &State, to: &State) -> bool {
    let pairs = from.facet_points.iter().zip(&to.facet_points);
    let unbroken = |(from, to): (&FacetPointState, &FacetPointState)| {
        !to.joint.sliding && from.history.largest_opening == to.history.largest_opening
    };
    pairs.into_iter().all(unbroken)
}

/// Largest difference of the jumps of two states, against the largest jump.
fn difference(system: &System<'_>, a: &State, b: &State) -> f64 {
    let pairs = a.unknowns.iter().zip(&b.unknowns);
    let between: Vec<DVec3> = pairs.map(|(a, b)| *a - *b).collect();
    let apart = largest(&interface(system).jumps(&between, &Load::NONE));
    let size = largest(&interface(system).jumps(&b.unknowns, &b.load));
    ratio(apart, size)
}
