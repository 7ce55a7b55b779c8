//! How the traction of a law changes with the jump around a state.

use glam::{DMat3, DVec3};

use crate::fracture_law::{FractureLaw, Friction};
use crate::joint_state::{JointHistory, JointState};
use crate::outer::outer;

/// How the traction changes with the jump (Pa/m).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tangent {
    /// `dt/dw`; neither symmetric nor definite where friction or a softening bond is at work.
    pub exact: DMat3,
    /// A symmetric positive semidefinite tangent that is close to it: the same wherever that is
    /// one.
    pub positive: DMat3,
}

impl FractureLaw {
    /// How the traction changes around a state of the law. `rigid` (Pa/m) takes the place of
    /// larger stiffness, which matrices do not bear: it changes how fast an iteration converges,
    /// not to what.
    pub fn tangent(
        &self,
        state: &JointState,
        history: &JointHistory,
        normal: DVec3,
        rigid: f64,
    ) -> Tangent {
        let point = TangentPoint {
            law: self,
            state,
            history,
            normal,
            rigid,
        };
        match &self.friction {
            Some(friction) if state.sliding || point.is_apart(friction) => point.slip(friction),
            _ => point.stick(),
        }
    }

    /// Whether numbers tell how stiff the closure law is at a state: not where walls are closed to
    /// less than the smallest. Walls in contact are rigid.
    pub fn answers(&self, state: &JointState, history: &JointHistory) -> bool {
        self.closure.normal_stiffness.is_infinite()
            || self.closure_slope(state, history).is_finite()
    }

    /// Slope of the closure law (Pa/m), however large.
    fn closure_slope(&self, state: &JointState, history: &JointHistory) -> f64 {
        let separation = self.undilated(state, history);
        let response = self.closure.at_after(separation, history.largest_opening);
        response.tangent
    }
}

/// A state of a law at a facet with unit `normal`.
struct TangentPoint<'a> {
    law: &'a FractureLaw,
    state: &'a JointState,
    history: &'a JointHistory,
    normal: DVec3,
    rigid: f64,
}

impl TangentPoint<'_> {
    /// Whether the walls are apart and carry no shear, although they never moved.
    fn is_apart(&self, friction: &Friction) -> bool {
        let separation = self.law.undilated(self.state, self.history);
        let limit = self.law.limit(friction, self.state, self.history);
        limit == 0.0 && self.law.closure.gap(separation) > 0.0
    }

    fn stick(&self) -> Tangent {
        let (law, normal, slip) = (self.law, self.normal, self.state.slip);
        let across = self.slope();
        let retention = law.shear_retention(self.state.separation);
        let whole = if law.friction.is_some() {
            law.shear_stiffness.min(self.rigid)
        } else {
            law.shear_stiffness * (1.0 - law.damage(self.history))
        };
        let along = retention.share * whole;
        let coupling = retention.slope * whole * slip;
        let curved = across + 0.5 * retention.curvature * whole * slip.length_squared();
        let uncoupled = |across: f64| isotropic(across, along, normal);
        let exact = uncoupled(curved) + outer(normal, coupling) + outer(coupling, normal);
        let convex = curved * along >= coupling.length_squared() && curved >= 0.0;
        Tangent {
            exact,
            positive: if convex {
                exact
            } else {
                uncoupled(across.max(0.0))
            },
        }
    }

    /// From `d lambda = a (m . dw + tan(phi) / K_s d sigma)`, `d sigma = sigma' (dw_n - tan(psi) d
    /// lambda)` and `d|t_s| = -tan(phi) d sigma`, with the direction `m` of the slip.
    fn slip(&self, friction: &Friction) -> Tangent {
        let (law, state, normal) = (self.law, self.state, self.normal);
        let direction = self.direction();
        let slope = self.slope();
        let compliance = law.shear_stiffness.recip();
        let limit = self.limit_slope(friction, slope);
        let share = 1.0 / (1.0 - compliance * friction.dilation * limit);
        let lambda = share * (direction - compliance * limit * normal);
        let apart = normal - friction.dilation * lambda;
        let turning = (state.shear.length() / state.slip.length().max(f64::MIN_POSITIVE))
            .min(law.shear_stiffness.min(self.rigid));
        let transverse = DMat3::IDENTITY - outer(normal, normal) - outer(direction, direction);
        let exact =
            outer(normal, slope * apart) + outer(direction, limit * apart) + turning * transverse;
        let across = (slope * apart.dot(normal)).max(0.0);
        let along = (limit * apart.dot(direction)).max(0.0);
        Tangent {
            exact,
            positive: outer(normal, across * normal)
                + outer(direction, along * direction)
                + turning * transverse,
        }
    }

    /// Unit vector of the slip. Right after a commit walls without elastic slip have none, but
    /// still know where they slid.
    fn direction(&self) -> DVec3 {
        if self.state.slip == DVec3::ZERO {
            self.state.shear.normalize_or_zero()
        } else {
            self.state.slip.normalize_or_zero()
        }
    }

    /// Growth of the limit of friction with the opening (Pa/m), at fixed plastic slip; none once
    /// there is no limit left. `slope` is that of the closure law.
    fn limit_slope(&self, friction: &Friction, slope: f64) -> f64 {
        let (_, bond) = self.law.bond(self.state, self.history);
        if self.law.limit(friction, self.state, self.history) > 0.0 {
            friction.cohesion * bond - friction.coefficient * slope
        } else {
            0.0
        }
    }

    /// Slope of the closure law (Pa/m), no larger than `rigid`.
    fn slope(&self) -> f64 {
        let touching = self.law.closure.normal_stiffness.is_infinite();
        if touching {
            let separation = self.law.undilated(self.state, self.history);
            let open = self.state.normal_traction >= 0.0 && separation.aperture > 0.0;
            return if open { 0.0 } else { self.rigid };
        }
        let slope = self.law.closure_slope(self.state, self.history);
        // Not `min`, which takes what is not a number for stiff.
        match slope > self.rigid {
            true => self.rigid,
            false => slope,
        }
    }
}

/// `across n n^T + along (I - n n^T)`.
fn isotropic(across: f64, along: f64, normal: DVec3) -> DMat3 {
    DMat3::from_diagonal(DVec3::splat(along)) + outer(normal, (across - along) * normal)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::closure::{Closure, ClosureKind, Separation, Tension};
    use crate::joint_state::TrialState;
    use crate::return_map::RockStiffness;

    /// State of a law without friction at a jump (m).
    fn state(law: &FractureLaw, jump: DVec3, normal: DVec3) -> JointState {
        let opening = jump.dot(normal);
        law.state_at(&TrialState {
            separation: law.closure.opened(opening),
            slip: jump - opening * normal,
            normal_traction: 0.0,
            shear: DVec3::ZERO,
        })
    }

    #[test]
    fn tangent_is_the_derivative_of_the_traction() {
        let kind = ClosureKind::Logarithmic { cutoff: Some(1e-6) };
        let mut closure = Closure::new(1e-4, 1e11, kind);
        let normal = DVec3::new(1.0, -2.0, 0.5).normalize();
        for tension in [Tension::Elastic, Tension::CutOff] {
            closure.tension = tension;
            let law = FractureLaw::elastic(closure, 3e10);
            for opening in [-9.95e-5, -5e-5, 2e-5, 7e-5, 2e-4] {
                let jump = opening * normal + DVec3::new(1e-5, 2e-5, -1e-5);
                let here = state(&law, jump, normal);
                let tangent = law.tangent(&here, &JointHistory::default(), normal, 1e20);
                for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
                    let traction = |sign: f64| {
                        state(&law, jump + sign * 1e-11 * axis, normal).traction(normal)
                    };
                    let difference = (traction(1.0) - traction(-1.0)) / 2e-11;
                    assert!((difference - tangent.exact * axis).length() < 1e-5 * 1e11);
                }
            }
        }
    }

    /// Under five hundred times `K_n b_0` a logarithmic law is far stiffer than rock, and without
    /// aperture infinitely so; it is taken for as stiff as walls in contact.
    #[test]
    fn walls_that_are_all_but_closed_are_rigid() {
        let kind = ClosureKind::Logarithmic { cutoff: None };
        let closure = Closure::new(1e-6, 1e9, kind);
        let law = FractureLaw::elastic(closure, 1e10);
        let normal = DVec3::Z;
        let trial = TrialState {
            separation: law.closure.opened(0.0),
            slip: DVec3::ZERO,
            normal_traction: -5e5,
            shear: DVec3::ZERO,
        };
        let rock = RockStiffness {
            normal: 1e-300,
            shear: 1.0,
        };
        let closed = law.return_map(&trial, rock, &JointHistory::default());
        let tangent = law.tangent(&closed, &JointHistory::default(), normal, 1e15);
        assert_eq!(tangent.exact.z_axis, 1e15 * normal);
        assert_eq!(tangent.exact.x_axis.x, 1e10);
        let nowhere = JointState {
            separation: Separation {
                opening: -1e-6,
                aperture: 0.0,
            },
            ..closed
        };
        let tangent = law.tangent(&nowhere, &JointHistory::default(), normal, 1e15);
        assert_eq!(tangent.exact.z_axis, 1e15 * normal);
        let answers = [closed, nowhere].map(|state| law.answers(&state, &JointHistory::default()));
        assert_eq!(answers, [true, false]);
    }

    /// Walls that never touched slide from the start; walls that touch do not before they have to.
    #[test]
    fn walls_that_are_apart_resist_nothing() {
        let closure = Closure::new(1e-4, f64::INFINITY, ClosureKind::Contact);
        let law = FractureLaw {
            friction: Some(Friction {
                coefficient: 0.6,
                cohesion: 0.0,
                dilation: 0.0,
            }),
            ..FractureLaw::elastic(closure, f64::INFINITY)
        };
        let resistance = |aperture: f64| {
            let state = JointState {
                separation: law.closure.opened(aperture - 1e-4),
                ..JointState::default()
            };
            let tangent = law.tangent(&state, &JointHistory::default(), DVec3::Z, 1e15);
            tangent.exact.x_axis.x
        };
        assert_eq!([resistance(1e-4), resistance(0.0)], [0.0, 1e15]);
    }
}
