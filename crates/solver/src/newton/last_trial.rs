//! Where the linear solves of an increment have put a facet point, and where the next takes it.

use glam::{DMat3, DVec3};
use lie_core::{Separation, TrialState};

use crate::assembly::facet_point::FacetPoint;
use crate::system::FacetPointState;

/// Where the last linear solve of an increment put a facet point.
#[derive(Debug, Clone, Copy)]
pub(super) struct LastTrial {
    /// Where the walls are; none before the first solve.
    walls: Option<Walls>,
    /// Normal traction on the tangent plane (Pa); not a number where it tells nothing of the rock.
    traction: f64,
}

/// Where the walls of a facet point are.
#[derive(Debug, Clone, Copy)]
struct Walls {
    separation: Separation,
    /// Tangential jump (m), since the walls last stuck without shear.
    slip: DVec3,
}

impl Default for LastTrial {
    fn default() -> Self {
        Self {
            walls: None,
            traction: f64::NAN,
        }
    }
}

impl LastTrial {
    /// Stiffness of the surrounding rock (Pa/m) as two linear solves tell it, `-dt/dw`; 0 where
    /// they tell nothing.
    pub(super) fn secant_to(&self, trial: &TrialState) -> f64 {
        let secant = self.walls.map(|before| {
            let moved = trial.separation.beyond(before.separation);
            (self.traction - trial.normal_traction) / moved
        });
        secant.filter(|secant| secant.is_finite()).unwrap_or(0.0)
    }

    /// Tells no longer of the rock: the next linear solve is of another kind.
    pub(super) fn forget_secant(&mut self) {
        self.traction = f64::NAN;
    }

    /// Where the walls are at a state. A law that is near closure, and whose tangent is large, can
    /// be thrown so far apart that what its walls are beyond it tells no longer where they are.
    fn walls(&self, point: &FacetPoint, state: &FacetPointState) -> Walls {
        let joint = &state.joint;
        let across = state.jump_residual.dot(point.normal);
        let along = state.jump_residual - across * point.normal;
        let of_state = Walls {
            separation: joint.separation.moved(across),
            slip: joint.slip + along,
        };
        let Some(own) = self.walls else {
            return of_state;
        };
        let size = own.separation.opening.abs() + own.separation.aperture.abs();
        let is_far = joint.separation.opening.abs() > size;
        let slips_far = joint.slip.length() > own.slip.length();
        Walls {
            separation: if is_far {
                own.separation
            } else {
                of_state.separation
            },
            slip: if slips_far { own.slip } else { of_state.slip },
        }
    }

    /// Where a change of the jump (m) takes the facet point on the tangent plane of its law.
    pub(super) fn moved(
        &mut self,
        point: &FacetPoint,
        state: &FacetPointState,
        tangent: DMat3,
        change: DVec3,
    ) -> TrialState {
        let walls = self.walls(point, state);
        let opening = change.dot(point.normal);
        let slip = walls.slip + change - opening * point.normal;
        // Rounding leaves a part of the slip across the walls. Added up over a path it is more than
        // what walls without load open by.
        let rounded = slip.dot(point.normal);
        let traction =
            state.joint.traction(point.normal) + tangent * (state.jump_residual + change);
        let across = traction.dot(point.normal);
        let walls = Walls {
            separation: walls.separation.moved(opening + rounded),
            slip: slip - rounded * point.normal,
        };
        *self = LastTrial {
            walls: Some(walls),
            traction: across,
        };
        TrialState {
            separation: walls.separation,
            slip: walls.slip,
            normal_traction: across,
            shear: traction - across * point.normal,
        }
    }
}

#[cfg(test)]
mod tests {
    use lie_core::{Closure, ClosureKind, FractureLaw, JointHistory};

    use super::*;
    use crate::newton::facet_points::{follow_point, tangent};

    /// Nearly closed walls, of which an inexact solve makes so much tension that the law balances
    /// it kilometres away, are where the solves have put them.
    #[test]
    fn walls_are_found_again_where_solves_have_put_them() {
        let aperture = 1e-5;
        let kind = ClosureKind::Hyperbolic {
            max_closure: aperture,
        };
        let law = FractureLaw::elastic(Closure::new(aperture, 1e9, kind), 1e9);
        let point = FacetPoint {
            facet: 0,
            fracture: 0,
            law: 0,
            position: DVec3::ZERO,
            area: 1.0,
            normal: DVec3::Z,
            spring: 1e11,
            walls: 0,
        };
        let still = TrialState {
            separation: law.closure.opened(0.0),
            slip: DVec3::ZERO,
            normal_traction: -1e10,
            shear: DVec3::ZERO,
        };
        let history = JointHistory::default();
        let joint = law.return_map(&still, point.rock_stiffness(), &history);
        let start = joint.separation;
        let mut state = FacetPointState {
            joint,
            jump_residual: DVec3::ZERO,
            history,
        };
        let mut last = LastTrial::default();
        let mut farthest: f64 = 0.0;
        for change in [2e-3, -1e-3, -0.5e-3] {
            let exact = tangent(&law, &point, &state).exact;
            let before = last;
            let trial = last.moved(&point, &state, exact, DVec3::new(0.0, 1e-6, change));
            follow_point(&law, &point, &trial, &mut state, &before);
            farthest = farthest.max(state.joint.separation.opening);
        }
        assert!(farthest > 1e3, "{farthest} m");
        let walls = last.walls(&point, &state);
        let moved = walls.separation.beyond(start);
        assert!((moved - 0.5e-3).abs() < 1e-17, "{moved:e} m");
        assert!((walls.slip - DVec3::new(0.0, 3e-6, 0.0)).length() < 1e-20);
    }
}
