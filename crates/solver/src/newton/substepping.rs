//! A load step in one increment if the laws allow it, in as many as they need if not.
//!
//! Without friction, a breaking bond or a flow that takes time the end does not depend on the path,
//! so the step is divided only if it does not converge. With them, a substep is solved in one
//! increment and in two; where the jumps that the loads determine differ by more than
//! [`NewtonSettings::path`](super::NewtonSettings::path), or what the fluid fills and its pressures
//! by more than [`NewtonSettings::time`](super::NewtonSettings::time), it is divided. Loads and
//! what drives the flow walk with it. What no division resolves, walls that jump to another place
//! in an instant, is let be and recorded.

use glam::DVec3;
use kluft_algebra::largest;

use super::convergence::ratio;
use super::determinacy::{self, Determinacy};
use super::facet_points::interface;
use super::free_blocks;
use super::{Newton, Step, StepOutcome, UnresolvedCause, UnresolvedPath};
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
    middle: End,
    end: End,
    /// Whether it is not divided any more.
    is_smallest: bool,
}

/// Where an increment leads.
struct End {
    load: Load,
    /// The share of the load step up to it.
    share: f64,
}

/// What a substep came to.
enum Solved {
    /// Its end, and whether the next may be longer.
    Accepted { end: State, may_grow: bool },
    /// It is to be divided.
    TooLong {
        /// Why, if it is not for accuracy.
        why: Option<StepOutcome>,
        /// Its end in one increment, if that was found.
        whole: Option<State>,
    },
}

impl Solved {
    fn failed(outcome: StepOutcome, whole: Option<State>) -> Self {
        Self::TooLong {
            why: Some(outcome),
            whole,
        }
    }
}

/// A state on the way, and the share of the step that leads to it.
struct Reached {
    state: State,
    share: f64,
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
        let mut here = Reached {
            state: state.clone(),
            share: 0.0,
        };
        let mut increment = 1.0_f64;
        // The end of the shortest substep from here that converged in one increment.
        let mut coarse: Option<Reached> = None;
        while here.share < 1.0 {
            let end = f64::min(here.share + increment, 1.0);
            let substep = Substep {
                middle: End::between(&start, load, 0.5 * (here.share + end)),
                end: End::between(&start, load, end),
                is_smallest: increment <= SMALLEST_SUBSTEP,
            };
            // Whole steps are tried in earnest before they are divided.
            step.is_tried_briefly =
                step.system.is_path_dependent() && increment < 1.0 && !substep.is_smallest;
            let reached = |state: State| Reached { state, share: end };
            let next = match self.solve_substep(step, &here.state, &substep) {
                Solved::Accepted { end, may_grow } => {
                    increment *= if may_grow { 2.0 } else { 1.0 };
                    Some(reached(end))
                }
                Solved::TooLong { why, whole } => {
                    coarse = whole.map(reached).or(coarse);
                    let is_final = |why: &StepOutcome| is_final(step.system, why, increment);
                    if let Some(outcome) = why.filter(is_final) {
                        let end = let_be(step, outcome, coarse.take())?;
                        increment = end.share - here.share;
                        Some(end)
                    } else {
                        increment *= 0.5;
                        None
                    }
                }
            };
            if let Some(next) = next {
                self.path.remember(step.system, &here.state);
                (here, coarse) = (next, None);
                step.pushed.clear();
                step.record.completed = here.share;
            }
        }
        Ok(here.state)
    }

    fn solve_substep(&mut self, step: &mut Step<'_>, from: &State, substep: &Substep) -> Solved {
        let whole = match self.solve_counted(step, from, &substep.end) {
            Ok(whole) => whole,
            Err(outcome) => return Solved::failed(outcome, None),
        };
        let slides = step.system.is_path_dependent() && !is_elastic(from, &whole);
        let flows = step.system.coupling().is_some_and(Coupling::is_transient);
        if !slides && (!flows || self.settings.time >= 1.0) {
            return Solved::Accepted {
                end: whole,
                may_grow: true,
            };
        }
        if step.system.is_smooth() {
            self.path.lead_to(step.system, &whole);
        }
        let halves = self
            .solve_counted(step, from, &substep.middle)
            .and_then(|half| self.solve_counted(step, &half, &substep.end));
        if step.system.is_smooth() {
            self.path.lead_on();
        }
        let halves = match halves {
            Ok(halves) => halves,
            Err(outcome) => return Solved::failed(outcome, Some(whole)),
        };
        let apart = slides.then(|| difference(step.system, &whole, &halves, self.settings.path));
        let in_time = flows.then(|| flows_apart(step.system, &whole, &halves));
        let flow = in_time.map(|apart| apart / self.settings.time);
        let path = apart
            .as_ref()
            .map(|apart| apart.share() / self.settings.path);
        let error = path.into_iter().chain(flow).fold(0.0, f64::max);
        if error > 1.0 && !substep.is_smallest {
            return Solved::TooLong {
                why: None,
                whole: Some(whole),
            };
        }
        if let Some(apart) = in_time.filter(|_| flow.is_some_and(|flow| flow > 1.0)) {
            step.leave_time_error(apart);
        }
        if let Some(apart) = apart {
            step.record.path_error += apart.length;
            if apart.share() > self.settings.path {
                step.leave_unresolved(UnresolvedPath {
                    cause: UnresolvedCause::Differs(apart.share()),
                    facet_point: apart.facet_point,
                });
            }
        }
        Solved::Accepted {
            end: halves,
            may_grow: error <= GROWTH_SHARE,
        }
    }

    /// Solves an increment and records its iterations if it converges.
    fn solve_counted(
        &mut self,
        step: &mut Step<'_>,
        from: &State,
        to: &End,
    ) -> Result<State, StepOutcome> {
        let before = step.record.iterations.len();
        step.share = to.share;
        let end = self.solve_increment(step, from, &to.load)?;
        let iterations = step.record.iterations.len() - before;
        step.record.substeps.push(iterations);
        Ok(end)
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

/// Whether a shorter substep would change nothing about a failure. Without friction a block that
/// moves freely at the end does so whatever the path.
fn is_final(system: &System<'_>, outcome: &StepOutcome, increment: f64) -> bool {
    increment <= SMALLEST_SUBSTEP
        || *outcome == StepOutcome::Stopped
        || (*outcome == StepOutcome::RigidBodyMotion && !system.is_path_dependent())
}

impl End {
    /// A share of the way of a load step.
    fn between(start: &Load, end: &Load, share: f64) -> Self {
        let load = match share == 1.0 {
            true => end.clone(),
            false => Load::between(start, end, share),
        };
        Self { load, share }
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

/// How far the jumps of two states are apart.
struct Apart {
    /// Largest difference of a jump (m).
    length: f64,
    /// Largest jump in the second (m).
    size: f64,
    /// Where the difference is.
    facet_point: Option<usize>,
}

impl Apart {
    /// The largest difference against the largest jump.
    fn share(&self) -> f64 {
        ratio(self.length, self.size)
    }
}

/// The largest difference of the jumps of two states; beyond a tolerance, as a share of the largest
/// jump, of what the loads determine of them in the second.
fn difference(system: &System<'_>, a: &State, b: &State, tolerance: f64) -> Apart {
    let pairs = a.unknowns.iter().zip(&b.unknowns);
    let between: Vec<DVec3> = pairs.map(|(a, b)| *a - *b).collect();
    let mut apart = interface(system).jumps(&between, &Load::NONE);
    let size = largest(&interface(system).jumps(&b.unknowns, &b.load));
    if largest(&apart) > tolerance * size {
        leave_undetermined(system, b, &mut apart);
    }
    let length = |point: usize| apart[point].length();
    Apart {
        length: largest(&apart),
        size,
        facet_point: (0..apart.len()).max_by(|&a, &b| length(a).total_cmp(&length(b))),
    }
}

/// Takes from jumps what the loads do not determine in a state: no shorter step would.
fn leave_undetermined(system: &System<'_>, state: &State, jumps: &mut [DVec3]) {
    let Some(facets) = determinacy::floating(system, state) else {
        return;
    };
    for (jump, point) in jumps.iter_mut().zip(&interface(system).points) {
        match facets[point.facet as usize] {
            Determinacy::Aperture => *jump = DVec3::ZERO,
            Determinacy::Slip => *jump = jump.dot(point.normal) * point.normal,
            Determinacy::Determined | Determinacy::Metastable => {}
        }
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
    let facet_point = step.record.worst_facet_point;
    step.record.rigid_motions.clear();
    step.leave_unresolved(UnresolvedPath {
        cause: UnresolvedCause::HalvesDoNotEnd,
        facet_point,
    });
    Ok(end)
}

/// How far two states are apart in what their fluids fill and in their pressures.
fn flows_apart(system: &System<'_>, a: &State, b: &State) -> f64 {
    let fluids = a.fluid.as_ref().zip(b.fluid.as_ref());
    let both = system.coupling().zip(fluids);
    both.map_or(0.0, |(flow, (first, second))| {
        let largest = [b.reached.displacement, b.reached.pressure];
        flow.difference([first, second], &b.load, largest)
    })
}
