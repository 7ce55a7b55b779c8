//! Rock and laws in turn: the splitting of Douglas and Rachford (Lions and Mercier 1979; ALG2 of
//! Glowinski and Le Tallec 1989).
//!
//! Newton's method may go around in circles where walls begin and cease to touch and to slide. With
//! `rho` the stiffness of the rock beside a facet point, the rock is solved with springs `rho`
//! instead of the laws, and each law is then balanced with its spring:
//!
//! ```text
//! K y + B^T (t + rho (B y - w)) = f       rock: y
//! t' + rho w' = t + rho B y               laws: w', t' = t(w')
//! ```
//!
//! For laws that are monotone it always comes closer, by a factor an iteration. Its matrix never
//! changes. It ends where Newton's method converges from what it has found.

use super::facet_points::Linearisation;
use super::iterate::Iterate;
use super::{Newton, Step, StepOutcome};

/// Iterations before Newton's method is tried the first time; each time after twice as many.
const FIRST_ITERATIONS: usize = 20;
/// Iterations before it is tried where it nearly converged but does not move any more.
const LOOSENING_ITERATIONS: usize = 5;
/// How often it is tried.
const TRIALS: u32 = 3;
/// How often where shorter increments are to be tried.
const BRIEF_TRIALS: u32 = 1;
/// Iterations of such a trial.
const NEWTON_ITERATIONS: usize = 10;

impl Newton {
    /// Iterates a little by the splitting and then by Newton's method from an iterate that nearly
    /// converged but does not move any more; whether the tests hold then.
    ///
    /// # Errors
    /// If the observer stops the step.
    pub(super) fn loosen(
        &mut self,
        step: &mut Step<'_>,
        iterate: &mut Iterate,
    ) -> Result<bool, StepOutcome> {
        iterate.linearisation = Linearisation::Springs;
        match self.iterate_at_most(LOOSENING_ITERATIONS, step, iterate) {
            Err(StepOutcome::OutOfIterations) => {}
            Err(StepOutcome::Stopped) => return Err(StepOutcome::Stopped),
            ended => return Ok(ended.is_ok()),
        }
        iterate.linearisation = Linearisation::Tangents;
        iterate.forget_secants();
        match self.iterate_at_most(NEWTON_ITERATIONS, step, iterate) {
            Err(StepOutcome::Stopped) => Err(StepOutcome::Stopped),
            ended => Ok(ended.is_ok()),
        }
    }

    /// Iterates by the splitting and by Newton's method in turn until the tests hold.
    ///
    /// # Errors
    /// Why neither they nor the attempt before them, which had this `outcome`, do; or that the
    /// observer stops the step.
    pub(super) fn iterate_by_splitting(
        &mut self,
        step: &mut Step<'_>,
        iterate: &mut Iterate,
        mut outcome: StepOutcome,
    ) -> Result<(), StepOutcome> {
        let trials = match step.is_tried_briefly {
            true => BRIEF_TRIALS,
            false => TRIALS,
        };
        for trial in 0..trials {
            iterate.linearisation = Linearisation::Springs;
            match self.iterate_at_most(FIRST_ITERATIONS << trial, step, iterate) {
                Err(StepOutcome::OutOfIterations) => {}
                ended => return ended.map_err(|failed| outcome.and(failed)),
            }
            let mut tried = iterate.clone();
            tried.linearisation = Linearisation::Tangents;
            tried.forget_secants();
            match self.iterate_at_most(NEWTON_ITERATIONS, step, &mut tried) {
                Err(StepOutcome::Stopped) => return Err(StepOutcome::Stopped),
                Err(failed) => outcome = outcome.and(failed),
                Ok(()) => {
                    *iterate = tried;
                    return Ok(());
                }
            }
        }
        Err(outcome)
    }
}
