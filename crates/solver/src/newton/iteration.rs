//! One iteration: linearise, solve, correct, measure; and iterations until the tests hold.

use std::sync::Arc;
use std::time::Instant;

use glam::DVec3;
use kluft_algebra::{LinearFailure, norm};
use rayon::prelude::*;

use super::convergence;
use super::facet_points::{self, Linearisation, Linearised, interface};
use super::fluid;
use super::forcing_term;
use super::iterate::{Correction, Iterate, Update};
use super::line_search;
use super::recycling::KEPT_AT_KINKS;
use super::rigid_motion::RigidBodyMotion;
use super::{Iteration, Newton, Step, StepOutcome};
use crate::linear::{CoupledRhs, Tangents};
use crate::problem::Load;
use crate::system::System;

/// Forces of an iterate, against those that its increment began with, which no path of the loads
/// leads to.
const OVERSHOOT: f64 = 100.0;
/// Errors below which an iteration is about to end.
const NEARLY_CONVERGED: f64 = 1e-6;
/// Iterations beyond the most ones that one may take that is about to end.
const LAST_ITERATIONS: usize = 5;
/// Change of an iteration, against the largest displacement, below which nothing moves any more.
const STILL: f64 = 1e-9;
/// Share of the errors before that an iteration keeps which leads nowhere.
const KEPT: f64 = 0.9;
/// Iterations in a row that lead nowhere and move nothing, after which none will.
const MOST_STILL: usize = 2;

impl Iterate {
    /// Adds a correction to the unknowns, lets the facet points follow, and measures the errors.
    ///
    /// # Errors
    /// If numbers are no longer finite.
    pub(super) fn correct(
        &mut self,
        step: &mut Step<'_>,
        update: Update<'_>,
    ) -> Result<Iteration, StepOutcome> {
        let (system, correction) = (step.system, update.correction);
        let unknowns = &mut self.state.unknowns;
        for (unknown, change) in unknowns.iter_mut().zip(&correction.unknowns) {
            *unknown += *change;
        }
        if !unknowns.iter().all(|unknown| unknown.is_finite()) {
            return Err(StepOutcome::NotFinite(None));
        }
        self.correct_rock_forces(system, correction);
        let changes = interface(system).jumps(&correction.unknowns, &Load::NONE);
        if update.planes.by == Linearisation::Springs {
            let advance = self.acceleration.advance(system, &self.state, &changes);
            facet_points::pull(system, &mut self.state, &advance);
        }
        self.dashpots.follow(&changes);
        let errors = facet_points::follow(
            system,
            &mut self.state,
            &mut self.last_trials,
            &changes,
            update.planes,
        );
        if let Some(flow) = &mut self.flow {
            flow.follow(system, &mut self.state, &correction.potentials);
        }
        let iteration = convergence::measure(step, self, &errors, correction.size)?;
        self.merit = Some(line_search::merit(&iteration));
        Ok(iteration)
    }

    fn correct_rock_forces(&mut self, system: &System<'_>, correction: &Correction) {
        match &correction.rock_forces {
            Some(change) => {
                let pairs = self.rock_forces.par_iter_mut().zip(change);
                pairs.for_each(|(force, change)| *force += *change);
            }
            None => self.rock_forces = system.rock_forces(&self.state.unknowns),
        }
    }
}

/// The test whether an iteration goes nowhere because nothing moves any more: rigid walls at the
/// limit of friction hardly turn their tractions while they stick.
#[derive(Default)]
struct Stall {
    /// Errors after the last iteration.
    merit: f64,
    /// Iterations in a row that led nowhere.
    count: usize,
}

impl Stall {
    /// Whether the iterations up to this one have gone nowhere.
    fn has_come_with(&mut self, iteration: &Iteration) -> bool {
        let merit = line_search::merit(iteration);
        let goes_nowhere = iteration.increment < STILL && merit > KEPT * self.merit;
        self.count = if goes_nowhere { self.count + 1 } else { 0 };
        self.merit = merit;
        self.count == MOST_STILL
    }
}

impl Newton {
    /// Iterates until the tests hold.
    ///
    /// # Errors
    /// Once it is clear that they will not, or the observer stops the step.
    pub(super) fn iterate_to_convergence(
        &mut self,
        step: &mut Step<'_>,
        iterate: &mut Iterate,
    ) -> Result<(), StepOutcome> {
        if let Some(iteration) = self.test_guess(step, iterate)? {
            step.report(iteration);
            return Ok(());
        }
        let start = (!step.system.is_smooth()).then(|| iterate.clone());
        let most = self.settings.max_iterations;
        let failed = self.iterate_at_most(most, step, iterate);
        match (failed, start) {
            (Ok(()), _) => Ok(()),
            (Err(outcome), Some(start)) if outcome != StepOutcome::Stopped => {
                let is_near = iterate.merit.is_some_and(|merit| merit < NEARLY_CONVERGED);
                if is_near && self.loosen(step, iterate)? {
                    return Ok(());
                }
                *iterate = start;
                self.iterate_by_splitting(step, iterate, outcome)
            }
            (failed, _) => failed,
        }
    }

    /// Iterates until the tests hold, at `most` so often, and a little more if they nearly hold.
    ///
    /// # Errors
    /// [`StepOutcome::OutOfIterations`] if they do not; why, once it is clear that they will not,
    /// or the observer stops the step.
    pub(super) fn iterate_at_most(
        &mut self,
        most: usize,
        step: &mut Step<'_>,
        iterate: &mut Iterate,
    ) -> Result<(), StepOutcome> {
        let mut rigid_body_motion = RigidBodyMotion::default();
        let mut stall = Stall::default();
        let mut is_near = false;
        for count in 1..=most + LAST_ITERATIONS {
            if count > most && !is_near {
                break;
            }
            let iteration = self.iterate(step, iterate, count)?;
            step.report(iteration);
            if self.settings.accept(step.system, iterate, &iteration) {
                return Ok(());
            }
            is_near = line_search::merit(&iteration) < NEARLY_CONVERGED;
            step.go_on()?;
            // Springs and dashpots hold every block.
            if iterate.linearisation == Linearisation::Tangents && !iterate.dashpots.hold() {
                rigid_body_motion.test(step, iterate, &iteration, count)?;
                if stall.has_come_with(&iteration) && !step.system.is_smooth() {
                    break;
                }
            }
        }
        Err(StepOutcome::OutOfIterations)
    }

    /// Iteration `count` of an increment.
    ///
    /// # Errors
    /// If the linear solve fails or numbers are no longer finite.
    fn iterate(
        &mut self,
        step: &mut Step<'_>,
        iterate: &mut Iterate,
        count: usize,
    ) -> Result<Iteration, StepOutcome> {
        let is_split = iterate.linearisation == Linearisation::Springs;
        if step.system.is_smooth() || is_split {
            return self.advance(step, iterate, count);
        }
        let mut spent = 0;
        loop {
            let start = iterate.clone();
            let advanced = self.advance(step, iterate, count);
            let mut iteration = match (advanced, start.damping.as_at_first()) {
                (Err(StepOutcome::Linear(_)), Some(damping)) => {
                    *iterate = Iterate { damping, ..start };
                    continue;
                }
                (advanced, _) => advanced?,
            };
            iteration.linear_iterations += spent;
            spent = iteration.linear_iterations;
            let overshoots = iterate.sizes.force > OVERSHOOT * start.first_force;
            match start.damping.stronger() {
                Some(damping) if overshoots => *iterate = Iterate { damping, ..start },
                _ => {
                    step.predicts = false;
                    iterate.damping = iterate.damping.weaker(count);
                    return Ok(iteration);
                }
            }
        }
    }

    /// Linearises, solves, corrects and measures.
    ///
    /// # Errors
    /// If the linear solve fails or numbers are no longer finite.
    fn advance(
        &mut self,
        step: &mut Step<'_>,
        iterate: &mut Iterate,
        count: usize,
    ) -> Result<Iteration, StepOutcome> {
        let system = step.system;
        let planes = Linearised {
            dashpots: iterate.dashpots.share,
            ..facet_points::linearised(system, &iterate.state, iterate.linearisation)
        };
        let share = iterate.damping.share + planes.dashpots;
        self.update_tangent(step, &planes.tangents, share)?;
        let solved = self.solve_linearised(system, iterate, &planes.tangents);
        let (correction, spent) = solved.map_err(|failure| match failure {
            LinearFailure::NotFinite => StepOutcome::NotFinite(None),
            failure => StepOutcome::Linear(failure),
        })?;
        if step.predicts {
            step.predicted = predicted(system, iterate, &correction);
        }
        let update = Update {
            correction: &correction,
            planes: &planes,
        };
        let mut iteration = match planes.by {
            Linearisation::Tangents => line_search::advance(step, iterate, update, count)?,
            Linearisation::Springs => iterate.correct(step, update)?,
        };
        iteration.linear_iterations = spent;
        if correction.rock_forces.is_some() {
            iterate.corrections.push(Arc::new(correction));
        }
        iterate.forcing_term = forcing_term::after(iteration.increment);
        Ok(self.conserve(step, iterate, iteration))
    }

    /// Gives the linear solver the tangents.
    ///
    /// # Errors
    /// If one is not finite, where its law no longer answers, or the solver fails.
    fn update_tangent(
        &mut self,
        step: &mut Step<'_>,
        tangents: &Tangents,
        damping: f64,
    ) -> Result<(), StepOutcome> {
        let broken = tangents.exact.iter().position(|one| !one.is_finite());
        if broken.is_some() {
            return Err(StepOutcome::NotFinite(broken));
        }
        let start = Instant::now();
        let system = step.system;
        let updated = if system.is_smooth() {
            self.linear.update(system, tangents)
        } else {
            let damped = facet_points::damped(system, tangents, damping);
            self.linear.update(system, &damped)
        };
        updated.map_err(StepOutcome::Linear)?;
        step.record.factorise_seconds += start.elapsed().as_secs_f64();
        Ok(())
    }

    /// The correction that leaves no force out of balance on the tangent planes, and nothing of the
    /// flow missing, to the forcing term; and the iterations of the linear solver.
    fn solve_linearised(
        &mut self,
        system: &System<'_>,
        iterate: &Iterate,
        tangents: &Tangents,
    ) -> Result<(Correction, usize), LinearFailure> {
        let state = &iterate.state;
        let tractions = facet_points::linearised_tractions(system, state, tangents);
        let mut tractions = fluid::total_tractions(system, state, tractions);
        iterate.dashpots.add_to(system, &mut tractions);
        let residual = system.residual(&iterate.rock_forces, &tractions, &state.load);
        let parts = (system.coupling(), &state.fluid, &iterate.flow);
        let (Some(coupling), Some(fluid), Some(flow)) = parts else {
            let size = norm(&residual);
            let tolerance = forcing_term::tolerance(system, &self.settings, iterate, size);
            let guess = self.guess(system, iterate, &residual);
            let solution = match guess {
                Some(guess) => self.linear.solve_from(system, guess, &residual, tolerance),
                None => self.linear.solve(system, &residual, tolerance),
            }?;
            let is_recycled = self.is_recycled(system, iterate);
            let correction = Correction::of(system, solution.unknowns, is_recycled);
            return Ok((correction, solution.iterations));
        };
        let linearised = flow.linearised(coupling, fluid, &state.load);
        let missing = linearised.missing();
        let rhs = CoupledRhs {
            forces: &residual,
            missing: &missing,
            goals: &|sizes| {
                let settings = (system, &self.settings);
                forcing_term::coupled_goals(settings, iterate, sizes, missing.len())
            },
        };
        let mut solution = self.linear.solve_coupled(system, &linearised, &rhs)?;
        if fluid::goes_far(system, state, &solution.unknowns) {
            let spent = solution.iterations;
            let frozen = linearised.frozen();
            solution = self.linear.solve_coupled(system, &frozen, &rhs)?;
            solution.iterations += spent;
        }
        let correction = Correction::of(system, solution.unknowns, false);
        let correction = correction.with_potentials(solution.potentials);
        Ok((correction, solution.iterations))
    }

    /// The unknowns (m) that a linear solve for `forces` (N) begins with, from the space of former
    /// corrections like it; none for smooth laws, whose increments begin there.
    fn guess(
        &self,
        system: &System<'_>,
        iterate: &Iterate,
        forces: &[DVec3],
    ) -> Option<Vec<DVec3>> {
        let begins = !system.is_smooth() && self.is_recycled(system, iterate);
        let space = self.recycled.as_ref().filter(|_| begins)?;
        space.answer(system, &self.linear, forces)
    }

    /// Whether the correction at hand is to be recycled.
    fn is_recycled(&self, system: &System<'_>, iterate: &Iterate) -> bool {
        let is_of_tangents = iterate.linearisation == Linearisation::Tangents;
        let is_kept = system.is_smooth() || iterate.corrections.len() < KEPT_AT_KINKS;
        self.recycled.is_some() && is_of_tangents && is_kept
    }
}

/// How far the first linear solve of an increment moves walls (m).
fn predicted(system: &System<'_>, start: &Iterate, correction: &Correction) -> Vec<DVec3> {
    let mut moved = interface(system).jumps(&correction.unknowns, &Load::NONE);
    for (moved, state) in moved.iter_mut().zip(&start.state.facet_points) {
        *moved += state.jump_residual;
    }
    moved
}

#[cfg(test)]
mod tests {
    use super::*;

    fn iteration(increment: f64, error: f64) -> Iteration {
        Iteration {
            force_residual: error,
            increment,
            closure_error: 0.0,
            pressure_increment: 0.0,
            mass_error: 0.0,
            smallest_aperture: 0.0,
            linear_iterations: 0,
            share: 1.0,
        }
    }

    /// Neither small corrections that make errors smaller nor large ones that do not are a stall.
    #[test]
    fn iterations_stall_where_nothing_moves_and_errors_stay() {
        let stalls = |iterations: &[[f64; 2]]| {
            let mut stall = Stall::default();
            let mut found = iterations.iter();
            found.any(|&[increment, error]| stall.has_come_with(&iteration(increment, error)))
        };
        assert!(stalls(&[
            [1e-2, 1e-3],
            [1e-11, 1e-8],
            [1e-12, 1e-8],
            [1e-12, 1e-8]
        ]));
        assert!(!stalls(&[
            [1e-10, 1e-6],
            [1e-11, 1e-7],
            [1e-12, 1e-8],
            [1e-13, 1e-9]
        ]));
        assert!(!stalls(&[
            [1e-3, 1e-3],
            [1e-3, 1e-3],
            [1e-3, 1e-3],
            [1e-3, 1e-3]
        ]));
    }
}
