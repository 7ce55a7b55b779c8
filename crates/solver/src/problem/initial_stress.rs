//! Stress before any load.

use glam::{DMat3, DVec3};

/// A stress component or pressure that varies linearly with elevation:
/// `value + per_metre (z - at)` (Pa).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Profile {
    /// Elevation of reference, `at` (m).
    pub at: f64,
    /// Its value there (Pa).
    pub value: f64,
    /// Change per metre of elevation (Pa/m).
    pub per_metre: f64,
}

impl Profile {
    /// Its value at an elevation (m).
    pub fn at_elevation(&self, z: f64) -> f64 {
        self.value + self.per_metre * (z - self.at)
    }
}

/// Stress before any load, components `xx, yy, zz, xy, yz, xz`. Rock and fractures start in
/// equilibrium with it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct InitialStress {
    /// The six components.
    pub components: [Profile; 6],
}

impl InitialStress {
    /// Stress at a position (Pa).
    pub fn at(&self, position: DVec3) -> DMat3 {
        let [xx, yy, zz, xy, yz, xz] = self
            .components
            .map(|profile| profile.at_elevation(position.z));
        DMat3::from_cols(
            DVec3::new(xx, xy, xz),
            DVec3::new(xy, yy, yz),
            DVec3::new(xz, yz, zz),
        )
    }
}
