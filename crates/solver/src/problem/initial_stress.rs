//! Stress before any load.

use glam::{DMat3, DVec3};
use kluft_field::Field;

/// Stress before any load, components `xx, yy, zz, xy, yz, xz`. Rock and fractures start in
/// equilibrium with it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct InitialStress {
    /// The six components (Pa).
    pub components: [Field; 6],
}

impl InitialStress {
    /// Stress at a position (Pa).
    pub fn at(&self, position: DVec3) -> DMat3 {
        let [xx, yy, zz, xy, yz, xz] =
            [0, 1, 2, 3, 4, 5].map(|index: usize| self.components[index].at(position, 0.0));
        DMat3::from_cols(
            DVec3::new(xx, xy, xz),
            DVec3::new(xy, yy, yz),
            DVec3::new(xz, yz, zz),
        )
    }
}
