//! The state of a fracture at one point: where its walls are, what they carry, and what they
//! remember.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::closure::{NormalSpring, Separation, Tension};
use crate::fracture_law::FractureLaw;

/// Where the walls are and what they carry.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct JointState {
    /// How far the walls are apart.
    pub separation: Separation,
    /// Tangential jump (m), since the walls last stuck without shear.
    pub slip: DVec3,
    /// Normal traction (Pa), tension positive.
    pub normal_traction: f64,
    /// Tangential traction (Pa).
    pub shear: DVec3,
    /// Slip that is not elastic, since the last commit (m).
    pub plastic_slip: f64,
    /// Whether the walls slide.
    pub sliding: bool,
}

/// History variables: what former steps left behind.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct JointHistory {
    /// Opening by dilation (m).
    pub dilation: f64,
    /// Largest opening (m), of a bond that may break.
    pub largest_opening: f64,
}

/// Where a linear solve has put the walls, and the traction that it gave them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrialState {
    /// How far the walls are apart.
    pub separation: Separation,
    /// Tangential jump (m), since the walls last stuck without shear.
    pub slip: DVec3,
    /// Normal traction (Pa).
    pub normal_traction: f64,
    /// Tangential traction (Pa).
    pub shear: DVec3,
}

impl TrialState {
    /// The rock across the walls, `stiffness` (Pa/m) stiff.
    pub(crate) fn spring(&self, stiffness: f64) -> NormalSpring {
        NormalSpring {
            stiffness,
            separation: self.separation,
            traction: self.normal_traction,
        }
    }
}

impl JointState {
    /// Traction (Pa) across a facet with unit `normal`.
    pub fn traction(&self, normal: DVec3) -> DVec3 {
        self.normal_traction * normal + self.shear
    }
}

impl FractureLaw {
    /// The state that carries `traction` (Pa) as far as the law can before anything has moved: what
    /// initial stress leaves behind. Shear beyond the limit of friction starts to slide in the
    /// first step.
    pub fn under_initial_stress(&self, traction: DVec3, normal: DVec3) -> JointState {
        let across = traction.dot(normal);
        let load = self.closure.spring(0.0, across);
        let balance = self.closure.balanced_after(&load, 0.0);
        let shear = if self.shear_stiffness > 0.0 {
            traction - across * normal
        } else {
            DVec3::ZERO
        };
        JointState {
            separation: balance.separation,
            slip: shear / self.shear_stiffness.max(f64::MIN_POSITIVE),
            normal_traction: balance.traction,
            shear,
            ..JointState::default()
        }
    }

    /// Makes a converged state the one that the next step starts from.
    pub fn commit(&self, state: &mut JointState, history: &mut JointHistory) {
        if matches!(self.closure.tension, Tension::Cohesive { .. }) {
            let opening = state.separation.opening - history.dilation;
            history.largest_opening = history.largest_opening.max(opening);
        }
        let Some(friction) = &self.friction else {
            return;
        };
        history.dilation += friction.dilation * state.plastic_slip;
        state.plastic_slip = 0.0;
        state.slip = state.shear / self.shear_stiffness;
    }

    /// Share of a cohesive bond that former steps broke.
    pub(crate) fn damage(&self, history: &JointHistory) -> f64 {
        let stiffness = self.closure.normal_stiffness;
        self.closure
            .tension
            .damage(stiffness, history.largest_opening)
    }
}
