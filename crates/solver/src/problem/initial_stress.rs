//! Stress before any load.

use glam::{DMat3, DVec3};
use kluft_field::Field;

use super::field_place::FieldPlace;

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
        self.tensor(|field| field.at(position, 0.0))
    }

    /// Stress at a facet point (Pa), whose place is that for its `position` (m).
    pub(crate) fn at_place(&self, position: DVec3, place: &FieldPlace) -> DMat3 {
        self.tensor(|field| match field {
            Field::Profile(profile) => profile.at_elevation(position.z),
            other => place.value(|at| other.at(at, 0.0)),
        })
    }

    fn tensor(&self, value: impl Fn(&Field) -> f64) -> DMat3 {
        let [xx, yy, zz, xy, yz, xz] =
            [0, 1, 2, 3, 4, 5].map(|index: usize| value(&self.components[index]));
        DMat3::from_cols(
            DVec3::new(xx, xy, xz),
            DVec3::new(xy, yy, yz),
            DVec3::new(xz, yz, zz),
        )
    }
}
