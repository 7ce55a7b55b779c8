//! How much of its shear stiffness a fracture keeps as it opens.

use crate::closure::{Separation, Tension};
use crate::fracture_law::FractureLaw;
use crate::joint_state::JointState;

/// The share of the shear stiffness that is left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ShearRetention {
    /// `g`, from 1 to 0.
    pub(crate) share: f64,
    /// `dg/dw_n` (1/m).
    pub(crate) slope: f64,
    /// `d^2 g/dw_n^2` (1/m^2).
    pub(crate) curvature: f64,
}

impl ShearRetention {
    const WHOLE: Self = Self {
        share: 1.0,
        slope: 0.0,
        curvature: 0.0,
    };

    /// `g = (1 - z)^2 (1 + 2 z)` with `z = opening / range` between 0 and 1.
    pub(crate) fn fading(opening: f64, range: f64) -> Self {
        let z = if range > 0.0 {
            opening / range
        } else {
            f64::from(u8::from(opening > 0.0))
        };
        if z <= 0.0 {
            return Self::WHOLE;
        }
        if z >= 1.0 {
            return Self {
                share: 0.0,
                slope: 0.0,
                curvature: 0.0,
            };
        }
        Self {
            share: (1.0 - z).powi(2) * (1.0 + 2.0 * z),
            slope: -6.0 * z * (1.0 - z) / range,
            curvature: (12.0 * z - 6.0) / (range * range),
        }
    }
}

impl FractureLaw {
    /// How much of the shear stiffness is left at a separation.
    ///
    /// If tension is cut off, an open fracture has no business carrying shear. To drop it all at
    /// once would make the law jump, and to drop it without a word to the normal traction would
    /// make it give or take energy over a cycle of loads. So the stiffness fades over one aperture,
    /// and the energy that the slip loses by it pushes the walls apart.
    pub(crate) fn shear_retention(&self, separation: Separation) -> ShearRetention {
        let fades = self.closure.tension == Tension::CutOff && self.friction.is_none();
        if fades && self.closure.normal_stiffness > 0.0 {
            ShearRetention::fading(self.closure.gap(separation), self.closure.aperture)
        } else {
            ShearRetention::WHOLE
        }
    }
    /// Largest traction (Pa) by which the slip of a closed state could push the walls apart, were
    /// they open: `max |dg/dw_n| K_s |w_s|^2 / 2` with `max |dg/dw_n| = 3 / (2 b0)`. Pressed less,
    /// the state is metastable: open walls would balance the same tractions. 0 if the fracture is
    /// open or keeps its shear.
    pub fn largest_thrust(&self, state: &JointState) -> f64 {
        let fades = self.closure.tension == Tension::CutOff && self.friction.is_none();
        if !fades || self.closure.gap(state.separation) > 0.0 {
            return 0.0;
        }
        let energy = 0.5 * state.shear.dot(state.slip);
        1.5 / self.closure.aperture * energy
    }
}
