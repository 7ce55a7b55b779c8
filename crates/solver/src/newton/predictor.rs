//! The first guess for an increment: solved for in the space of former corrections where there is
//! one, else the path of the last states continued.

use super::acceleration::Acceleration;
use super::convergence::{self, SHARE_OF_FORMER_SIZES};
use super::damping;
use super::facet_points::{self, LastTrial, Linearisation};
use super::fluid;
use super::forcing_term;
use super::iterate::Iterate;
use super::recycling::GalerkinGuess;
use super::{Iteration, Newton, Step, StepOutcome};
use crate::problem::Load;
use crate::system::{State, StateScales, System};

impl Newton {
    /// The iterate that an increment from `state` to `load` begins with.
    pub(super) fn predict(&mut self, system: &System<'_>, state: &State, load: &Load) -> Iterate {
        let mut from = state.clone();
        system.restate(&mut from);
        let start = from.load.clone();
        let recycled = self.recycled.as_mut();
        let guess = recycled.and_then(|space| space.solve(system, &from, load));
        let (mut state, last_trials, guess) = match guess {
            Some(GalerkinGuess {
                state,
                last_trials,
                last,
            }) => (state, last_trials, Some(last)),
            None => {
                if system.coupling().is_none() {
                    self.path.continue_through(system, &mut from, load);
                }
                facet_points::move_supports(system, &mut from, load);
                let last_trials = vec![LastTrial::default(); from.facet_points.len()];
                (from, last_trials, None)
            }
        };
        let flow = fluid::begin(system, &mut state, &start);
        let reached = state.reached;
        let rock_forces = system.rock_forces(&state.unknowns);
        let tractions = system.law_tractions(&state);
        let force = system.force_scale(&rock_forces, &tractions, load);
        let force = force.max(SHARE_OF_FORMER_SIZES * reached.force);
        Iterate {
            last_trials,
            guess,
            flow,
            corrections: Vec::new(),
            sizes: StateScales { force, ..reached },
            first_force: force,
            damping: damping::LEAST,
            linearisation: Linearisation::Tangents,
            acceleration: Acceleration::default(),
            rock_forces,
            forcing_term: forcing_term::first(system, &self.settings),
            merit: None,
            state,
        }
    }

    /// The last iteration of a guess in the recycled space, if it leaves nothing to do: no more
    /// than a linear solve would.
    ///
    /// # Errors
    /// If a traction is not finite.
    pub(super) fn test_guess(
        &self,
        step: &mut Step<'_>,
        iterate: &mut Iterate,
    ) -> Result<Option<Iteration>, StepOutcome> {
        let Some(guess) = &iterate.guess else {
            return Ok(None);
        };
        let (errors, change) = (guess.errors.clone(), guess.displacement);
        let iteration = convergence::measure(step, iterate, &errors, change)?;
        if step.system.is_nonlinear() {
            iterate.forcing_term = forcing_term::after(iteration.force_residual);
        }
        let is_exact = iteration.force_residual <= forcing_term::exact_enough(&self.settings);
        let is_accepted = is_exact && self.settings.accept(step.system, iterate, &iteration);
        Ok(is_accepted.then_some(iteration))
    }
}
