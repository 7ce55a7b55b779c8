//! A point of a facet, where a law is integrated.

use glam::DVec3;
use lie_core::RockStiffness;

/// Stiffness of the rock along a facet, as a share of that across.
const SHEAR_SHARE: f64 = 0.3;

/// One point of one facet.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub struct FacetPoint {
    /// Facet it belongs to.
    pub facet: u32,
    /// Index of its fracture.
    pub fracture: u32,
    /// Index of its law: that of its fracture, or one of its own.
    pub law: u32,
    /// Place (m).
    pub position: DVec3,
    /// Area it stands for (m^2); negative at the tip of a quarter-point facet, where nothing moves.
    pub area: f64,
    /// Unit normal, from minus to plus.
    pub normal: DVec3,
    /// Upper bound of the stiffness of the rock next to it, about `E/h` (Pa/m): constrained modulus
    /// over the height of the cells on both sides, in series.
    pub spring: f64,
    /// Place of its walls among those that carry the initial stress, see
    /// [`Interface::initial_walls`](super::interface::Interface::initial_walls).
    pub(crate) walls: u32,
}

impl FacetPoint {
    /// Stiffness of the rock beside it.
    pub fn rock_stiffness(&self) -> RockStiffness {
        RockStiffness {
            normal: self.spring,
            shear: SHEAR_SHARE * self.spring,
        }
    }
}
