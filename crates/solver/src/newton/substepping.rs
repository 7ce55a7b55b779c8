//! A load step in one increment if the laws allow it, in as many as they need if not.
//!
//! Without friction, a breaking bond or a flow that takes time the end does not depend on the path,
//! so the step is divided only if it does not converge. With them, a substep is solved in one
//! increment and in two; where the jumps differ by more than
//! [`NewtonSettings::path`](super::NewtonSettings::path), or what the fluid fills and its pressures
//! by more than [`NewtonSettings::time`](super::NewtonSettings::time), it is divided. Loads and
//! what drives the flow walk with it.

use glam::DVec3;
use kluft_algebra::largest;

use super::convergence::ratio;
use super::facet_points::interface;
use super::{Newton, Step, StepOutcome};
use crate::FacetPointState;
use crate::flow::Coupling;
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
    /// Whether it may be divided.
    is_divisible: bool,
}

/// What a substep came to.
enum Solved {
    /// Its end, and whether the next may be longer.
    Accepted { end: Box<State>, may_grow: bool },
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
        let flows = step.system.coupling().is_some_and(Coupling::is_transient);
        let start = match flows {
            true => step.system.problem.schedule.walked_from(&state.load),
            false => state.load.clone(),
        };
        let mut increment = 1.0_f64;
        while step.record.completed < 1.0 {
            let completed = step.record.completed;
            let end = f64::min(completed + increment, 1.0);
            let substep = Substep {
                middle: between(&start, load, 0.5 * (completed + end)),
                end: between(&start, load, end),
                is_divisible: increment > SMALLEST_SUBSTEP,
            };
            match self.solve_substep(step, &here, &substep) {
                Solved::Accepted {
                    end: next,
                    may_grow,
                } => {
                    self.path.remember(step.system, &here);
                    (here, step.record.completed) = (*next, end);
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
        let slides = step.system.is_path_dependent() && !is_elastic(from, &whole);
        let flows = step.system.coupling().is_some_and(Coupling::is_transient);
        if !slides && (!flows || self.settings.time >= 1.0) {
            return Solved::Accepted {
                end: Box::new(whole),
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
        let allowed = [
            slides.then(|| difference(step.system, &whole, &halves) / self.settings.path),
            flows.then(|| flows_apart(step.system, &whole, &halves) / self.settings.time),
        ];
        let error = allowed.into_iter().flatten().fold(0.0, f64::max);
        if error <= 1.0 || !substep.is_divisible {
            Solved::Accepted {
                end: Box::new(halves),
                may_grow: error <= GROWTH_SHARE,
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

/// How far two states are apart in what their fluids fill and in their pressures.
fn flows_apart(system: &System<'_>, a: &State, b: &State) -> f64 {
    let fluids = a.fluid.as_ref().zip(b.fluid.as_ref());
    let both = system.coupling().zip(fluids);
    both.map_or(0.0, |(flow, (first, second))| {
        flow.difference([first, second], &b.load, b.reached.displacement)
    })
}
