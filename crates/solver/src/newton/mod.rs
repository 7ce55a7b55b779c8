//! Newton's method that does not see the cutoff.
//!
//! The law stiffens so fast that plain Newton, linearising at the opening where its last linear
//! solve put the walls, overshoots. Here each facet point is linearised at the aperture that
//! balances the law with the rock around it: after the linear solve gives opening `w` and traction
//! `t`, the monotone scalar equation `sigma_n(w~) + k w~ = t + k w` gives `w~`, and the tangent is
//! taken there. The iteration sees loads and stiffnesses only, whatever the cutoff.
//!
//! `k` is the stiffness of the rock as the facet point feels it, measured by the secant through the
//! last two linear solves of the step, `-dt/dw`, between 0 and `E/h`; 0 for the first. Too large a
//! `k` overshoots towards closure, where the tangent is enormous and the way back is long; too
//! small a `k` comes down from the open side step by step. A fixed `E/h` fails for joints that are
//! soft against their elements.
//!
//! A load step is solved in one increment or in several ([`substepping`]). An increment is
//! predicted ([`predictor`]), iterated ([`iteration`]) until the tests hold ([`convergence`]), and
//! committed.

mod convergence;
mod extrapolation;
mod facet_points;
mod forcing_term;
mod iteration;
mod line_search;
mod predictor;
mod record;
mod recycling;
mod restart;
mod rigid_motion;
mod settings;
mod step;
mod substepping;

use kluft_algebra::LinearFailure;
use std::ops::ControlFlow;
use std::time::Instant;

use glam::DVec3;

use crate::linear::{LinearMethod, NonsymmetricSolver, Plan, Unknowns, Workload};
use crate::problem::Load;
use crate::system::{State, System};
use extrapolation::Path;
use iteration::Iterate;
use recycling::RecycledSpace;
use step::Step;

pub use record::{Iteration, StepOutcome, StepRecord};
pub(crate) use recycling::bytes as recycling_bytes;
pub use restart::RestartState;
pub use settings::NewtonSettings;
pub use step::unobserved;

/// The nonlinear solver of a system; it keeps what the linear solver prepared.
///
/// The same solver serves a system whose fracture laws are changed between two steps, because the
/// rock, which is all that was prepared, stays.
pub struct Newton {
    settings: NewtonSettings,
    linear: NonsymmetricSolver,
    path: Path,
    /// Corrections of former steps, if the linear solver iterates.
    recycled: Option<RecycledSpace>,
}

impl Newton {
    /// Chooses and prepares the linear solver.
    ///
    /// # Errors
    /// If it cannot be prepared.
    pub fn new(system: &System<'_>, settings: NewtonSettings) -> Result<Self, LinearFailure> {
        let unknowns = Unknowns::from(&system.discretisation);
        let workload = Workload::of_system(system);
        let plan = Plan::of(unknowns, workload, settings.linear, usize::MAX)?;
        Self::planned(system, settings, plan)
    }

    /// Prepares the linear solver of a plan.
    ///
    /// # Errors
    /// If it cannot be prepared.
    pub fn planned(
        system: &System<'_>,
        settings: NewtonSettings,
        plan: Plan,
    ) -> Result<Self, LinearFailure> {
        let recycles = plan.method == LinearMethod::Iterative;
        Ok(Self {
            recycled: recycles.then(RecycledSpace::default),
            linear: NonsymmetricSolver::new(plan.prepare(system)?),
            path: Path::default(),
            settings,
        })
    }

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
        let outcome = match self.solve_in_substeps(&mut step, state, load) {
            Ok(end) => {
                *state = end;
                StepOutcome::Converged
            }
            Err(outcome) => outcome,
        };
        let seconds = start.elapsed().as_secs_f64();
        step.finished(outcome, seconds)
    }

    /// Unknowns (m) in answer to small `forces` (N) on top of the last state, to `tolerance` times
    /// their norm; friction keeps its limit.
    ///
    /// # Errors
    /// If the linear solve fails.
    pub fn respond(
        &mut self,
        system: &System<'_>,
        forces: &[DVec3],
        tolerance: f64,
    ) -> Result<Vec<DVec3>, LinearFailure> {
        let solution = self.linear.solve_positive(system, forces, tolerance)?;
        Ok(solution.unknowns)
    }

    /// Solves from one state to a load in one increment: predicts, iterates until the tests hold,
    /// and commits.
    ///
    /// # Errors
    /// If the tests do not come to hold; then with the blocks in the record that nothing holds.
    fn solve_increment(
        &mut self,
        step: &mut Step<'_>,
        from: &State,
        load: &Load,
    ) -> Result<State, StepOutcome> {
        step.go_on()?;
        step.record.rigid_motions.clear();
        let mut iterate = self.predict(step.system, from, load);
        let converged = self.iterate_to_convergence(step, &mut iterate);
        if let Err(outcome) = converged {
            step.explain(&outcome, &iterate.state);
            return Err(outcome);
        }
        Ok(self.commit(step.system, iterate))
    }

    /// Makes a converged iterate the state that the next increment starts from.
    fn commit(&mut self, system: &System<'_>, iterate: Iterate) -> State {
        if let Some(recycled) = self.recycled.as_mut() {
            recycled.add(iterate.guess, iterate.corrections);
        }
        let mut state = iterate.state;
        facet_points::commit(system, &mut state);
        state.reached = iterate.sizes.or_share(1.0, state.reached);
        state
    }
}
