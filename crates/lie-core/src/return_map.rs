//! Return mapping: the state of a law that balances the rock beside a facet point.
//!
//! After a linear solve has put the walls at a jump `w` with a traction `t`, the trial state, the
//! state `w~, t~` of the law is the one with `t~ + k w~ = t + k w`, `k` the stiffness of the rock.
//! Friction is integrated on the total normal law. With the slip `s` since the walls last stuck
//! without shear, the plastic slip `lambda` of the step and the limit `L = c - tan(phi) sigma_n`:
//!
//! ```text
//! stick   t_s = K_s s,         |t_s| < L
//! slip    t_s = L s / |s|,     |s| = L / K_s + lambda,    w_n = w_n(sigma_n) + tan(psi) lambda
//! ```

use glam::DVec3;

use crate::closure::{NormalBalance, NormalSpring, Separation, Tension};
use crate::fracture_law::{FractureLaw, Friction};
use crate::joint_state::{JointHistory, JointState, TrialState};
use crate::root::root;
use crate::shear_retention::ShearRetention;

/// Stiffness of the rock beside a facet point (Pa/m).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RockStiffness {
    /// Across.
    pub normal: f64,
    /// Along; positive if the law has friction.
    pub shear: f64,
}

impl FractureLaw {
    /// The state of the law that balances the rock, see the module.
    pub fn return_map(
        &self,
        trial: &TrialState,
        rock: RockStiffness,
        history: &JointHistory,
    ) -> JointState {
        match &self.friction {
            Some(friction) => FrictionalReturn {
                law: self,
                friction,
                trial,
                rock,
                history,
            }
            .state(),
            None => self.elastic_return(trial, rock, history),
        }
    }

    /// The state of the law at the jump of a trial state, of a law without friction that never
    /// broke.
    pub fn state_at(&self, trial: &TrialState) -> JointState {
        let across = NormalBalance {
            separation: trial.separation,
            traction: self.closure.at(trial.separation).traction,
        };
        self.elastic_state(across, trial.slip, self.shear_stiffness)
    }

    fn elastic_return(
        &self,
        trial: &TrialState,
        rock: RockStiffness,
        history: &JointHistory,
    ) -> JointState {
        let spring = trial.spring(rock.normal);
        let slip = trial.slip;
        let stiffness = self.shear_stiffness * (1.0 - self.damage(history));
        let thrust = |separation: Separation| self.thrust(separation, slip, stiffness);
        let mut balance = self
            .closure
            .balanced_after(&spring, history.largest_opening);
        // Where the fracture lets go of its shear, what pushes its walls apart is part of the
        // balance.
        if thrust(balance.separation) < 0.0 {
            let from = balance.separation;
            let longest = self.closure.aperture - from.opening;
            let excess = |moved: f64| rock.normal * moved + thrust(from.moved(moved));
            balance.separation = from.moved(root(excess, longest));
        }
        self.elastic_state(balance, slip, stiffness)
    }

    /// A state without friction: `across` is where the walls are and what the closure law carries
    /// there.
    fn elastic_state(&self, across: NormalBalance, slip: DVec3, stiffness: f64) -> JointState {
        JointState {
            separation: across.separation,
            slip,
            normal_traction: across.traction + self.thrust(across.separation, slip, stiffness),
            shear: self.shear_retention(across.separation).share * stiffness * slip,
            ..JointState::default()
        }
    }

    /// Normal traction (Pa) by which a fracture that lets go of its shear pushes its walls apart.
    fn thrust(&self, separation: Separation, slip: DVec3, stiffness: f64) -> f64 {
        self.shear_retention(separation).slope * (0.5 * stiffness * slip.length_squared())
    }

    /// Separation as the closure law sees it: without what dilation opened.
    pub fn undilated(&self, state: &JointState, history: &JointHistory) -> Separation {
        let dilation = self.friction.map_or(0.0, |friction| friction.dilation);
        let opened = history.dilation + dilation * state.plastic_slip;
        state.separation.moved(-opened)
    }

    /// Largest shear traction (Pa).
    pub(crate) fn limit(
        &self,
        friction: &Friction,
        state: &JointState,
        history: &JointHistory,
    ) -> f64 {
        let (bond, _) = self.bond(state, history);
        (friction.cohesion * bond - friction.coefficient * state.normal_traction).max(0.0)
    }

    /// Shear traction of a state beyond what friction bears (Pa), negative below; all is below
    /// without friction.
    pub fn overload(&self, state: &JointState, history: &JointHistory) -> f64 {
        self.friction.map_or(f64::NEG_INFINITY, |friction| {
            state.shear.length() - self.limit(&friction, state, history)
        })
    }

    /// Share of the cohesion that is left, and how it changes with the opening (1/m).
    pub(crate) fn bond(&self, state: &JointState, history: &JointHistory) -> (f64, f64) {
        match self.closure.tension {
            Tension::Elastic => (1.0, 0.0),
            Tension::Cohesive { .. } => (1.0 - self.damage(history), 0.0),
            Tension::CutOff => {
                let gap = self.closure.gap(self.undilated(state, history));
                let retention = ShearRetention::fading(gap, self.closure.aperture);
                (retention.share, retention.slope)
            }
        }
    }
}

/// Return mapping of one trial state with friction.
struct FrictionalReturn<'a> {
    law: &'a FractureLaw,
    friction: &'a Friction,
    trial: &'a TrialState,
    rock: RockStiffness,
    history: &'a JointHistory,
}

impl FrictionalReturn<'_> {
    fn state(&self) -> JointState {
        let compliance = self.law.shear_stiffness.recip();
        let k = self.rock.shear;
        let pull = self.trial.shear + k * self.trial.slip;
        let size = pull.length();
        let (missing, stick) = self.excess(size, 0.0);
        if missing >= 0.0 {
            let slip = pull / (self.law.shear_stiffness + k);
            return JointState {
                // The stiffness may be infinite.
                slip: if compliance > 0.0 { slip } else { DVec3::ZERO },
                shear: pull / (1.0 + k * compliance),
                ..stick
            };
        }
        let lambda = self.plastic_slip(size, -missing / k);
        let state = self.after(lambda);
        let limit = self.law.limit(self.friction, &state, self.history);
        let direction = pull / size;
        JointState {
            slip: (limit * compliance + lambda) * direction,
            shear: limit * direction,
            sliding: true,
            ..state
        }
    }

    /// The plastic slip `lambda` (m) that balances a `pull` (Pa), at `undilated` (m) if the limit
    /// stays what it is before.
    fn plastic_slip(&self, pull: f64, undilated: f64) -> f64 {
        if self.friction.dilation == 0.0 {
            return undilated;
        }
        let excess = |lambda: f64| self.excess(pull, lambda).0;
        // Dilation presses walls together, whose limit grows; but those of a bond that softens are
        // pulled more the less they have opened, and slip further, to no limit at most.
        let may_soften = matches!(self.law.closure.tension, Tension::Cohesive { .. });
        let most = match may_soften && excess(undilated) < 0.0 {
            true => pull / self.rock.shear,
            false => undilated,
        };
        root(excess, most)
    }

    /// What a plastic slip `lambda` (m) asks for beyond the `pull` (Pa) that there is, and the
    /// state after it.
    fn excess(&self, pull: f64, lambda: f64) -> (f64, JointState) {
        let (k, compliance) = (self.rock.shear, self.law.shear_stiffness.recip());
        let state = self.after(lambda);
        let limit = self.law.limit(self.friction, &state, self.history);
        (limit * (1.0 + k * compliance) + k * lambda - pull, state)
    }

    /// The state balanced across, after a plastic slip (m).
    fn after(&self, plastic_slip: f64) -> JointState {
        let (trial, rock) = (self.trial, self.rock);
        let dilation = self.history.dilation + self.friction.dilation * plastic_slip;
        let spring = NormalSpring {
            separation: trial.separation.moved(-dilation),
            ..trial.spring(rock.normal)
        };
        let closure = &self.law.closure;
        let balance = closure.balanced_after(&spring, self.history.largest_opening);
        JointState {
            separation: balance.separation.moved(dilation),
            normal_traction: balance.traction,
            plastic_slip,
            ..JointState::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::closure::{Closure, ClosureKind};

    /// Rock that is softer along the walls.
    fn beside(stiffness: f64) -> RockStiffness {
        RockStiffness {
            normal: stiffness,
            shear: 0.3 * stiffness,
        }
    }

    /// How far a return mapping to walls that slide leaves them out of balance with the rock (Pa).
    fn out_of_balance(law: &FractureLaw, trial: &TrialState, rock: RockStiffness) -> f64 {
        let end = law.return_map(trial, rock, &JointHistory::default());
        assert!(end.sliding);
        let across = end.normal_traction - trial.normal_traction
            + rock.normal * end.separation.beyond(trial.separation);
        let along = end.shear - trial.shear + rock.shear * (end.slip - trial.slip);
        across.abs().max(along.length())
    }

    /// A bond that is pulled beyond its strength slips: dilation takes it back to before its
    /// strength, whichever traction is larger.
    #[test]
    fn a_bond_that_softens_balances_the_rock_while_it_dilates() {
        let kind = ClosureKind::Hyperbolic {
            max_closure: 2.72e-3,
        };
        let mut closure = Closure::new(2.72e-3, 7.12e10, kind);
        closure.tension = Tension::Cohesive {
            strength: 1.08e6,
            energy: 4.46e3,
        };
        let law = FractureLaw {
            friction: Some(Friction {
                coefficient: 0.577,
                cohesion: 8.17e6,
                dilation: 0.268,
            }),
            ..FractureLaw::elastic(closure, 3.22e11)
        };
        let trial = TrialState {
            separation: law.closure.opened(3.975e-5),
            slip: 1.1535e-4 * DVec3::Y,
            normal_traction: 1.0768e6,
            shear: 7.548e6 * DVec3::Y,
        };
        for stiffness in [1e11, 1e13, 1e15] {
            let rounding = 1e-15 * stiffness * trial.slip.length();
            let left = out_of_balance(&law, &trial, beside(stiffness));
            assert!(
                left < rounding.max(1e-7),
                "{left} of {rounding} Pa at {stiffness:e}"
            );
        }
    }

    /// What closed walls bear decides how far soft ones shear, to the last digit: no rounding of
    /// the aperture that they had may be in it.
    #[test]
    fn soft_walls_that_touch_balance_the_rock() {
        let law = FractureLaw {
            friction: Some(Friction {
                coefficient: 5.67,
                cohesion: 0.0,
                dilation: 0.14,
            }),
            ..FractureLaw::elastic(Closure::contact(8.92e-4), 1.12e6)
        };
        let stiffness = 4e11;
        for (aperture, traction) in [(1.9e-12, -3e-6), (1.9e-12, -1e-6), (0.0, -1e-6)] {
            let trial = TrialState {
                separation: Separation {
                    opening: aperture - 8.92e-4,
                    aperture,
                },
                slip: 1.6e-11 * DVec3::Y,
                normal_traction: traction - stiffness * aperture,
                shear: 3e-6 * DVec3::Y,
            };
            let rock = beside(stiffness);
            let left = out_of_balance(&law, &trial, rock);
            let pull = trial.shear.length() + rock.shear * trial.slip.length();
            assert!(left < 1e-9 * pull, "{left} of {pull} Pa at {traction:e}");
        }
    }
}
