//! Walls that snap to another place, at the pace of dashpots.
//!
//! Where fractures let go of shear as they open, or rigid walls rub at many places, loads may lead
//! to where no equilibrium is near: however short the increment, Newton's method and the splitting
//! go around in circles. With dashpots of `eta = c rho` on the facet points, `rho` the stiffness of
//! the rock beside them, the walls take the way there in steps of implicit Euler (the proximal
//! point algorithm, Rockafellar 1976), the loads being at rest:
//!
//! ```text
//! F(u') + B^T eta B (u' - u) = 0
//! ```
//!
//! Each step is an increment of its own, the better conditioned the larger `c`. It becomes smaller
//! from one step that converges to the next and larger after one that does not. The relaxation ends
//! where Newton's method converges without dashpots, whose equilibrium is one of the laws alone, or
//! they carry no more than forces may be out of balance.

use kluft_algebra::norm;

use super::comparison::End;
use super::convergence::ratio;
use super::damping::Damping;
use super::dashpots::Dashpots;
use super::facet_points::Linearisation;
use super::free_blocks;
use super::iterate::Iterate;
use super::{Newton, Step, StepOutcome, UnresolvedCause, UnresolvedPath};
use crate::system::{State, System};

/// Share of the stiffness of the rock beyond which stiffer dashpots help no more.
const LARGEST: f64 = 1e4;
/// Share of the largest traction that dashpots carry at most where Newton's method is tried without
/// them the first time.
const CARRIED: f64 = 1e-2;
/// What they carry at most where it is tried again, against what they did the last time.
const LESS: f64 = 0.1;
/// Most steps.
const STEPS: usize = 400;
/// Steps in a row after which blocks have been pushed that nothing holds: a mechanism.
const MOST_PUSHES: usize = 3;
/// Most iterations of a step.
const ITERATIONS: usize = 15;

/// How stiff the dashpots of the next step are.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Pace {
    /// Against the rock beside them.
    share: f64,
    /// Factor to the next if the step converges.
    softer: f64,
}

impl Pace {
    const FIRST: Self = Self {
        share: 1.0,
        softer: Self::SOFTEST,
    };
    /// Least factor from one step to the next.
    const SOFTEST: f64 = 0.25;
    /// Factor after a step that does not converge.
    const STIFFER: f64 = 4.0;
    /// Factor after the first step that converges then; its square after the second, and so on.
    const AFTER_FAILURE: f64 = 0.9;

    fn faster(self) -> Self {
        Self {
            share: self.softer * self.share,
            softer: (self.softer * self.softer).max(Self::SOFTEST),
        }
    }

    fn slower(self) -> Self {
        Self {
            share: Self::STIFFER * self.share,
            softer: Self::AFTER_FAILURE,
        }
    }
}

/// Where a relaxation may begin.
struct Starts {
    /// Where the increment that failed has come to, if laws answer there.
    failed: Option<Iterate>,
    /// The state before it, under its load.
    before: Iterate,
}

impl Newton {
    /// The state to which walls relax from a state under the load of an `end`, or from where the
    /// last increment to it has failed; recorded as a path that is not resolved there.
    ///
    /// # Errors
    /// [`StepOutcome::RigidBodyMotion`], with the blocks in the record, if it is one that goes on
    /// for ever; [`StepOutcome::OutOfIterations`] if walls do not come to rest; why its steps do
    /// not converge, if none does; [`StepOutcome::Stopped`].
    pub(super) fn relax(
        &mut self,
        step: &mut Step<'_>,
        from: &State,
        end: &End,
    ) -> Result<State, StepOutcome> {
        let place = step.record.worst_facet_point;
        let before = step.record.iterations.len();
        step.share = end.share;
        step.predicts = false;
        let starts = self.before_relaxation(step, from, end);
        let relaxed = self.relax_from(step, starts);
        step.pushed.clear();
        step.record.worst_facet_point = place;
        let iterate = relaxed?;
        step.leave_unresolved(UnresolvedPath {
            cause: UnresolvedCause::Snaps,
            facet_point: place,
        });
        step.record.rigid_motions.clear();
        let iterations = step.record.iterations.len() - before;
        step.record.substeps.push(iterations);
        Ok(self.commit(step.system, iterate))
    }

    /// Where a relaxation begins: where the increment that failed has come to, as near to an
    /// equilibrium as that may be; and the state before it, for where that went astray.
    fn before_relaxation(&mut self, step: &mut Step<'_>, from: &State, end: &End) -> Starts {
        let system = step.system;
        let is_usable = |failed: &State| {
            let mut tractions = system.law_tractions(failed).into_iter();
            failed.load == end.load && tractions.all(|traction| traction.is_finite())
        };
        let failed = step.end.take().filter(is_usable).map(|failed| {
            let rock_forces = system.rock_forces(&failed.unknowns);
            self.iterate_at(system, failed, rock_forces)
        });
        Starts {
            failed,
            before: self.predict(system, from, &end.load),
        }
    }

    /// Takes one step with dashpots after another until Newton's method converges without.
    ///
    /// # Errors
    /// As those of [`Self::relax`].
    fn relax_from(&mut self, step: &mut Step<'_>, starts: Starts) -> Result<Iterate, StepOutcome> {
        let (mut iterate, mut other) = match starts.failed {
            Some(failed) => (failed, Some(starts.before)),
            None => (starts.before, None),
        };
        let (mut pace, mut most) = (Pace::FIRST, CARRIED);
        let (mut moves, mut pushes) = (false, 0);
        for _ in 0..STEPS {
            match self.with_dashpots(step, &iterate, pace.share) {
                Ok(next) => iterate = next,
                Err(StepOutcome::Stopped) => return Err(StepOutcome::Stopped),
                Err(failed) if pace.share > LARGEST && !moves => {
                    iterate = other.take().ok_or(failed)?;
                    pace = Pace::FIRST;
                    continue;
                }
                Err(_) if pace.share > LARGEST => break,
                Err(_) => {
                    pace = pace.slower();
                    continue;
                }
            }
            (moves, pace) = (true, pace.faster());
            step.record.rigid_motions = free_blocks::find(step.system, &iterate);
            pushes = match step.record.rigid_motions.is_empty() {
                true => 0,
                false => pushes + 1,
            };
            if pushes == MOST_PUSHES {
                return Err(StepOutcome::RigidBodyMotion);
            }
            if self.is_at_rest(step.system, &iterate) {
                return Ok(iterate);
            }
            let largest = iterate.dashpots.largest(step.system);
            let carried = ratio(largest, iterate.sizes.traction);
            if carried > most {
                continue;
            }
            most = LESS * carried;
            match self.with_dashpots(step, &iterate, 0.0) {
                Ok(end) => return Ok(end),
                Err(StepOutcome::Stopped) => return Err(StepOutcome::Stopped),
                Err(_) => {}
            }
        }
        Err(StepOutcome::OutOfIterations)
    }

    /// Whether an iterate beside dashpots is one of the laws alone, to the tolerance: a block that
    /// friction all but holds creeps for long.
    fn is_at_rest(&self, system: &System<'_>, iterate: &Iterate) -> bool {
        let tractions = system.law_tractions(&iterate.state);
        let residual = system.residual(&iterate.rock_forces, &tractions, &iterate.state.load);
        ratio(norm(&residual), iterate.sizes.force) <= self.settings.force
    }

    /// Where Newton's method takes an iterate beside dashpots, whose stiffness is a `share` of that
    /// of the rock beside them.
    ///
    /// # Errors
    /// If it does not converge.
    fn with_dashpots(
        &mut self,
        step: &mut Step<'_>,
        start: &Iterate,
        share: f64,
    ) -> Result<Iterate, StepOutcome> {
        let dashpots = Dashpots::at_rest(share, start.state.facet_points.len());
        let mut iterate = Iterate {
            damping: match dashpots.hold() {
                true => Damping::beside_dashpots(share),
                false => Damping::FIRST,
            },
            dashpots,
            linearisation: Linearisation::Tangents,
            merit: None,
            ..start.clone()
        };
        iterate.forget_secants();
        self.iterate_at_most(ITERATIONS, step, &mut iterate)?;
        Ok(iterate)
    }
}

#[cfg(test)]
mod tests {
    use lie_core::{ClosureKind, Tension};

    use super::*;
    use crate::newton::facet_points::interface;
    use crate::newton::mean_strain::tests::{PRESSURE, problem};
    use crate::newton::{NewtonSettings, unobserved};
    use crate::{Discretisation, System};

    /// A closed joint under a pressure beside dashpots, `K_n w' + eta (w' - w) = -p`, whatever the
    /// rock.
    #[test]
    fn dashpots_let_walls_go_a_part_of_their_way() {
        let mut problem = problem(ClosureKind::Linear);
        let closure = &mut problem.fractures[0].law.closure;
        closure.tension = Tension::CutOff;
        let stiffness = closure.normal_stiffness;
        let system = System::assemble(&problem, Discretisation::of(&problem).expect("held"));
        let mut newton = Newton::new(&system, NewtonSettings::default()).expect("analysis");
        let load = &problem.schedule.steps[0].load;
        let mut observe = unobserved;
        let mut step = Step::new(&system, load, &mut observe);
        let mut iterate = newton.predict(&system, &system.initial_state(), load);
        let mut before = 0.0;
        for share in [1.0, 0.1, 1e-6] {
            let next = newton.with_dashpots(&mut step, &iterate, share);
            iterate = next.expect("converges");
            let points = &interface(&system).points;
            let eta = share * points[0].spring;
            let wanted = (eta * before - PRESSURE) / (eta + stiffness);
            for (point, state) in points.iter().zip(&iterate.state.facet_points) {
                assert!((point.spring / points[0].spring - 1.0).abs() < 1e-12);
                let opening = state.joint.separation.opening;
                assert!((opening / wanted - 1.0).abs() < 1e-8, "{opening} {wanted}");
            }
            before = wanted;
        }
    }

    /// Where an increment has led to numbers that no dashpots lead out of, walls are relaxed from
    /// the state before it, to the closed joint `w = -p / K_n`.
    #[test]
    fn walls_are_relaxed_from_the_state_before_where_an_increment_went_astray() {
        let mut problem = problem(ClosureKind::Linear);
        problem.fractures[0].law.closure.tension = Tension::CutOff;
        let stiffness = problem.fractures[0].law.closure.normal_stiffness;
        let system = System::assemble(&problem, Discretisation::of(&problem).expect("held"));
        let mut newton = Newton::new(&system, NewtonSettings::default()).expect("analysis");
        let load = &problem.schedule.steps[0].load;
        let mut observe = unobserved;
        let mut step = Step::new(&system, load, &mut observe);
        let before = newton.predict(&system, &system.initial_state(), load);
        let mut astray = before.clone();
        astray.state.unknowns.fill(glam::DVec3::NAN);
        let starts = Starts {
            failed: Some(astray),
            before,
        };
        let end = newton.relax_from(&mut step, starts).expect("comes to rest");
        for state in &end.state.facet_points {
            let opening = state.joint.separation.opening;
            assert!((opening * stiffness / PRESSURE + 1.0).abs() < 1e-6);
        }
    }

    /// Dashpots soften ever faster, and gently again after a step that fails.
    #[test]
    fn a_pace_that_fails_is_taken_up_again_with_care() {
        let mut pace = Pace::FIRST;
        for _ in 0..3 {
            pace = pace.faster();
        }
        assert_eq!(pace.share, Pace::SOFTEST.powi(3));
        let failed = pace.share;
        pace = pace.slower().faster();
        assert!(pace.share > 3.0 * failed);
        let steps = (0..).map_while(|_| {
            pace = pace.faster();
            (pace.share > failed).then_some(())
        });
        assert_eq!(steps.count(), 2);
        assert_eq!(pace.softer, Pace::SOFTEST);
    }
}
