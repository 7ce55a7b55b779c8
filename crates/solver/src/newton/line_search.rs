//! How far a trial follows the correction of a linear solve.
//!
//! All the way, as long as the iteration is on its way. Once it has taken more iterations than it should
//! and its errors grow, the way is halved until they do not: a search for a smaller residual.

use glam::DVec3;

use super::{
    Iteration, Linearisation, Newton, Outcome, StepRecord, Trial, assess, interface, largest, walls,
};
use crate::linear::Tangents;
use crate::schedule::Load;
use crate::system::System;

/// Iterations that take the whole way.
const WHOLE: usize = 6;
/// How often the way is halved.
const HALVINGS: usize = 4;

/// What a search compares: both measures are against what is large.
fn merit(iteration: &Iteration) -> f64 {
    iteration.force_residual + iteration.closure_error
}

impl Newton {
    /// Follows `correction` (m) on the planes of `tangents`, in iteration `count` of the step.
    ///
    /// # Errors
    /// If numbers are no longer finite.
    pub(super) fn advance(
        &self,
        system: &System<'_>,
        trial: &mut Trial,
        (correction, tangents): (&[DVec3], &Tangents),
        (count, former): (usize, Option<f64>),
        record: &mut StepRecord,
    ) -> Result<Iteration, Outcome> {
        let plain = self.settings.linearisation == Linearisation::Landed;
        let Some(former) = former.filter(|_| count > WHOLE && !plain) else {
            return self.follow(system, trial, (correction, tangents), record);
        };
        let start = trial.clone();
        let mut best: Option<(Iteration, Trial)> = None;
        for halvings in 0..=HALVINGS {
            let share = 0.5_f64.powi(halvings as i32);
            let part: Vec<DVec3> = correction.iter().map(|change| share * *change).collect();
            let mut next = start.clone();
            let reached = self.follow(system, &mut next, (&part, tangents), record);
            let Ok(iteration) = reached else {
                continue;
            };
            let better = |best: &(Iteration, Trial)| merit(&iteration) < merit(&best.0);
            if best.as_ref().is_none_or(better) {
                best = Some((iteration, next));
            }
            if merit(&iteration) < former {
                break;
            }
        }
        let Some((iteration, next)) = best else {
            return self.follow(system, trial, (correction, tangents), record);
        };
        *trial = next;
        Ok(iteration)
    }

    fn follow(
        &self,
        system: &System<'_>,
        trial: &mut Trial,
        (correction, tangents): (&[DVec3], &Tangents),
        record: &mut StepRecord,
    ) -> Result<Iteration, Outcome> {
        let unknowns = &mut trial.state.unknowns;
        for (unknown, change) in unknowns.iter_mut().zip(correction) {
            *unknown += *change;
        }
        if !unknowns.iter().all(|unknown| unknown.is_finite()) {
            return Err(Outcome::NotFinite(None));
        }
        trial.rock_forces = system.rock_forces(&trial.state.unknowns);
        let errors = walls::follow(
            system,
            self.settings.linearisation,
            &mut trial.state,
            &mut trial.landed,
            &interface(system).jumps(correction, &Load::NONE),
            tangents,
        );
        let change = largest(&system.displacements(correction, &Load::NONE));
        let iteration = assess(system, trial, change, &errors, record)?;
        trial.merit = Some(merit(&iteration));
        Ok(iteration)
    }
}
