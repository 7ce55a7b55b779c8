//! The first guess for an increment: solved for in the space of former corrections where there is
//! one, else the path of the last states continued.

use glam::DVec3;

use super::acceleration::Acceleration;
use super::convergence::{self, SHARE_OF_FORMER_SIZES};
use super::damping::Damping;
use super::dashpots::Dashpots;
use super::drained;
use super::facet_points::{self, Linearisation};
use super::fluid;
use super::forcing_term;
use super::iterate::Iterate;
use super::last_trial::LastTrial;
use super::mean_strain;
use super::recycling::GalerkinGuess;
use super::{Iteration, Newton, Step, StepOutcome};
use crate::flow::Coupling;
use crate::problem::Load;
use crate::system::{State, StateScales, System};

impl Newton {
    /// The iterate that an increment from `state` to `load` begins with.
    pub(super) fn predict(&mut self, system: &System<'_>, state: &State, load: &Load) -> Iterate {
        let from = system.restated(state);
        if let Some(space) = &mut self.recycled {
            space.condense(system, &from);
        }
        let recycled = self.recycled.as_ref();
        let guess = recycled.and_then(|space| space.solve(system, &from, load));
        let (mut state, last_trials, guess) = match guess {
            Some(GalerkinGuess {
                state,
                last_trials,
                last,
            }) => (state, last_trials, Some(last)),
            None => {
                let continued = self.continued(system, &from, load);
                let last_trials = vec![LastTrial::default(); from.facet_points.len()];
                (continued, last_trials, None)
            }
        };
        let flow = fluid::begin(system, &from, &mut state);
        let rock_forces = system.rock_forces(&state.unknowns);
        if guess.is_none() && self.path.len() == 0 {
            mean_strain::close(system, &from.load, &rock_forces, &mut state);
        }
        Iterate {
            last_trials,
            guess,
            flow,
            ..self.iterate_at(system, state, rock_forces)
        }
    }

    /// The iterate at a state, under its load, which its rock resists with forces (N), before any
    /// iteration.
    pub(super) fn iterate_at(
        &self,
        system: &System<'_>,
        state: State,
        rock_forces: Vec<DVec3>,
    ) -> Iterate {
        let reached = state.reached;
        let tractions = system.law_tractions(&state);
        let force = system.force_scale(&rock_forces, &tractions, &state.load);
        let force = force.max(SHARE_OF_FORMER_SIZES * reached.force);
        Iterate {
            last_trials: vec![LastTrial::default(); state.facet_points.len()],
            guess: None,
            flow: None,
            corrections: Vec::new(),
            sizes: StateScales { force, ..reached },
            first_force: force,
            damping: Damping::FIRST,
            dashpots: Dashpots::default(),
            linearisation: Linearisation::Tangents,
            conserves: system.coupling().is_some_and(Coupling::is_transient),
            acceleration: Acceleration::default(),
            rock_forces,
            forcing_term: forcing_term::first(system, &self.settings),
            merit: None,
            state,
        }
    }

    /// The path continued to a load. Where a fluid spreads, states of long ago may mislead: of the
    /// ways to continue the path the one with the least mass error is taken, if none but the
    /// present state. Where there is no path a joint may open wide.
    fn continued(&self, system: &System<'_>, from: &State, load: &Load) -> State {
        let guess = |state: &mut State, most: usize| {
            let used = self.path.continue_through(system, state, load, most);
            fluid::move_load(system, state, load);
            facet_points::move_supports(system, state, load);
            used
        };
        let mut best = from.clone();
        let mut most = guess(&mut best, self.path.len());
        if system.coupling().is_none() {
            return best;
        }
        if most == 0 {
            return drained::guess(system, from, load).unwrap_or(best);
        }
        let error = |state: &State| fluid::mass_error(system, from, state);
        let mut least = error(&best);
        let mut other = from.clone();
        loop {
            most = guess(&mut other, most - 1);
            let own = error(&other);
            if own < least {
                std::mem::swap(&mut best, &mut other);
                least = own;
            }
            if most == 0 {
                return best;
            }
            other.copy_from(from);
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
