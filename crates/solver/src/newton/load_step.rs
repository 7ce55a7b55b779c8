//! A load step and its increments: predict, iterate until the tests hold, commit.

use std::ops::ControlFlow;
use std::time::Instant;

use super::facet_points::{self, interface};
use super::iterate::Iterate;
use super::{Iteration, Newton, Step, StepOutcome, StepRecord};
use crate::problem::Load;
use crate::system::{State, System};

/// Iterations that walls may take to slide to rest, against those of an increment: close to the
/// largest load that friction bears each leaves a fixed share of the way.
const SETTLING: usize = 8;

impl Newton {
    /// Solves one load step from `state` to `load`. A step that the laws make too difficult or too
    /// coarse is divided.
    ///
    /// `observe` is called after each iteration with its number and measures, and may stop the step
    /// there. `state` is replaced if the step converges and kept if it does not or is stopped.
    pub fn solve_step(
        &mut self,
        system: &System<'_>,
        state: &mut State,
        load: &Load,
        mut observe: impl FnMut(usize, &Iteration) -> ControlFlow<()>,
    ) -> StepRecord {
        let start = Instant::now();
        let mut step = Step::new(system, load, &mut observe);
        let had_fallen_back = self.linear.has_fallen_back();
        let outcome = match self.solve_in_substeps(&mut step, state, load) {
            Ok(end) => {
                *state = end;
                StepOutcome::Converged
            }
            Err(outcome) => outcome,
        };
        step.record.fell_back = self.linear.has_fallen_back() && !had_fallen_back;
        let seconds = start.elapsed().as_secs_f64();
        step.finished(outcome, seconds)
    }

    /// Lets `state` come to rest under the load that it has, as after its laws have changed: in one
    /// increment, which no division would make shorter, of more iterations than one of a load step.
    /// `observe` and `state` are as those of [`Self::solve_step`]. Where it does not come to rest,
    /// the state in which the iterations ended comes with the record: on the way of what moves.
    pub fn settle(
        &mut self,
        system: &System<'_>,
        state: &mut State,
        mut observe: impl FnMut(usize, &Iteration) -> ControlFlow<()>,
    ) -> (StepRecord, Option<State>) {
        let start = Instant::now();
        let load = state.load.clone();
        let mut step = Step::new(system, &load, &mut observe);
        let most = self.settings.max_iterations;
        self.settings.max_iterations = SETTLING * most;
        let outcome = match self.solve_increment(&mut step, state, &load) {
            Ok(end) => {
                *state = end;
                step.record.completed = 1.0;
                StepOutcome::Converged
            }
            Err(outcome) => outcome,
        };
        self.settings.max_iterations = most;
        let seconds = start.elapsed().as_secs_f64();
        let end = step.end.take();
        (step.finished(outcome, seconds), end)
    }

    /// Solves from one state to a load in one increment: predicts, iterates until the tests hold,
    /// and commits.
    ///
    /// # Errors
    /// If the tests do not come to hold; then with the blocks in the record that nothing holds.
    pub(super) fn solve_increment(
        &mut self,
        step: &mut Step<'_>,
        from: &State,
        load: &Load,
    ) -> Result<State, StepOutcome> {
        step.go_on()?;
        step.record.rigid_motions.clear();
        step.end = None;
        step.predicted.clear();
        step.predicts = step.system.is_path_dependent();
        let mut iterate = self.predict(step.system, from, load);
        let converged = self.iterate_to_convergence(step, &mut iterate);
        if let Err(outcome) = converged {
            let outcome = placed(step.system, &iterate.state, outcome);
            step.explain(&outcome, &iterate);
            step.end = Some(iterate.state);
            return Err(outcome);
        }
        Ok(self.commit(step.system, iterate))
    }

    /// Makes a converged iterate the state that the next increment starts from.
    pub(super) fn commit(&mut self, system: &System<'_>, iterate: Iterate) -> State {
        if let Some(recycled) = self.recycled.as_mut() {
            recycled.add(iterate.guess, iterate.corrections);
        }
        let mut state = iterate.state;
        let flow = iterate.flow.as_ref().zip(state.fluid.as_mut());
        if let (Some(coupling), Some((flow, fluid))) = (system.coupling(), flow) {
            flow.commit(coupling, fluid, &state.load);
        }
        facet_points::commit(system, &mut state);
        state.reached = iterate.sizes.or_share(1.0, state.reached);
        state
    }
}

/// The outcome of an increment that failed, at the facet point whose law no longer answers if that
/// is why.
fn placed(system: &System<'_>, state: &State, outcome: StepOutcome) -> StepOutcome {
    if !matches!(
        outcome,
        StepOutcome::NotFinite(None) | StepOutcome::OutOfIterations
    ) {
        return outcome;
    }
    let mut points = interface(system).points.iter().zip(&state.facet_points);
    let broken =
        points.position(|(point, own)| !system.law(point).answers(&own.joint, &own.history));
    broken.map_or(outcome, |broken| StepOutcome::NotFinite(Some(broken)))
}
