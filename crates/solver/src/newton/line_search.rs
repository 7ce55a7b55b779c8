//! How far a trial follows the correction of a linear solve.
//!
//! All the way, as long as the iteration is on its way. Once it has taken more iterations than it should
//! and its errors grow, the way is halved until they do not: a search for a smaller residual.

use rayon::prelude::*;

use super::{
    Iteration, Linearisation, Move, Newton, Outcome, StepRecord, Trial, assess, interface, walls,
};
use crate::linear::Tangents;
use crate::problem::Load;
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
    /// Follows a move on the planes of `tangents`, in iteration `count` of the step.
    ///
    /// # Errors
    /// If numbers are no longer finite.
    pub(super) fn advance(
        &self,
        system: &System<'_>,
        trial: &mut Trial,
        (moved, tangents): (&Move, &Tangents),
        (count, former): (usize, Option<f64>),
        record: &mut StepRecord,
    ) -> Result<Iteration, Outcome> {
        let plain = self.settings.linearisation == Linearisation::Landed;
        let Some(former) = former.filter(|_| count > WHOLE && !plain) else {
            return self.follow(system, trial, (moved, tangents), record);
        };
        let start = trial.clone();
        let mut best: Option<(Iteration, Trial)> = None;
        for halvings in 0..=HALVINGS {
            let share = 0.5_f64.powi(halvings as i32);
            let part = moved.scaled(share);
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
            return self.follow(system, trial, (moved, tangents), record);
        };
        *trial = next;
        Ok(iteration)
    }

    fn follow(
        &self,
        system: &System<'_>,
        trial: &mut Trial,
        (moved, tangents): (&Move, &Tangents),
        record: &mut StepRecord,
    ) -> Result<Iteration, Outcome> {
        let unknowns = &mut trial.state.unknowns;
        for (unknown, change) in unknowns.iter_mut().zip(&moved.unknowns) {
            *unknown += *change;
        }
        if !unknowns.iter().all(|unknown| unknown.is_finite()) {
            return Err(Outcome::NotFinite(None));
        }
        match &moved.rock_forces {
            Some(change) => {
                let pairs = trial.rock_forces.par_iter_mut().zip(change);
                pairs.for_each(|(force, change)| *force += *change);
            }
            None => trial.rock_forces = system.rock_forces(&trial.state.unknowns),
        }
        let errors = walls::follow(
            system,
            self.settings.linearisation,
            &mut trial.state,
            &mut trial.landed,
            &interface(system).jumps(&moved.unknowns, &Load::NONE),
            tangents,
        );
        let iteration = assess(system, trial, moved.size, &errors, record)?;
        trial.merit = Some(merit(&iteration));
        Ok(iteration)
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use kluft_mesh::structured::{Patch, cells_of};
    use kluft_mesh::{Mesh, Shape, SurfaceRole};
    use lie_core::Rock;

    use super::*;
    use crate::{Condition, Discretisation, NewtonSettings, Problem, Support, SurfaceLoad};

    /// A block on a fixed base, pulled at its top.
    fn block() -> Problem {
        let (bottom, top) = (|x: [f64; 3]| x[2] == 0.0, |x: [f64; 3]| x[2] == 1.0);
        let patches = [
            Patch {
                name: "bottom",
                contains: &bottom,
            },
            Patch {
                name: "top",
                contains: &top,
            },
        ];
        let draft = cells_of(Shape::Tet4, [2; 3], [1.0; 3], &patches);
        let mesh = Mesh::build(draft, &[SurfaceRole::Boundary; 3]).expect("a box");
        let condition = |boundary, load, support| Condition {
            boundary,
            load,
            support,
        };
        let pull = SurfaceLoad::Traction(DVec3::new(1e6, 0.0, 2e6));
        let rock = Rock {
            young_modulus: 25e9,
            poisson_ratio: 0.25,
            density: 0.0,
        };
        Problem {
            conditions: vec![
                condition(0, None, Some(Support::Displacement([Some(0.0); 3]))),
                condition(1, Some(pull), None),
            ],
            ..Problem::of_rock(mesh, rock)
        }
    }

    /// Without fractures the correction of one solve is exact. Four times of it leaves three times the
    /// loads out of balance; a search halves it twice and is there.
    #[test]
    fn a_correction_that_goes_too_far_is_halved_once_the_iteration_is_late() {
        let problem = block();
        let system = System::assemble(&problem, Discretisation::of(&problem).expect("held"));
        let mut newton = Newton::new(&system, NewtonSettings::default()).expect("analysis");
        let load = Load::proportional(1.0);
        let start = newton.start(&system, &system.initial_state(), &load);
        let tangents = walls::tangents(&system, &start.state);
        newton.linear.update(&system, &tangents).expect("definite");
        let residual = system.residual(&start.rock_forces, &[], &load);
        let solved = newton.linear.solve(&system, &residual, 1e-12);
        let exact = solved.expect("solvable").unknowns;
        let far: Vec<DVec3> = exact.iter().map(|change| 4.0 * *change).collect();
        let far = [true, false].map(|remembered| Move::of(&system, far.clone(), remembered));
        let mut record = StepRecord::new(load);
        let mut residual_in = |far: &Move, count: usize| {
            let mut trial = start.clone();
            let former = (count, Some(1e-3));
            let reached =
                newton.advance(&system, &mut trial, (far, &tangents), former, &mut record);
            reached.expect("finite").force_residual
        };
        for far in &far {
            // Forces are measured against the largest, which then are those of the rock: 3 / 4.
            assert!((residual_in(far, 1) - 0.75).abs() < 1e-9);
            assert!(residual_in(far, NewtonSettings::default().max_iterations) < 1e-9);
        }
    }
}
