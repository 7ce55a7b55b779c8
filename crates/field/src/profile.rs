//! Values that are linear in the elevation.

/// A value that varies linearly with elevation: `value + per_metre (z - at)`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Profile {
    /// Elevation of reference, `at` (m).
    pub at: f64,
    /// Its value there.
    pub value: f64,
    /// Change per metre of elevation.
    pub per_metre: f64,
}

impl Profile {
    /// Its value at an elevation (m).
    pub fn at_elevation(&self, z: f64) -> f64 {
        self.value + self.per_metre * (z - self.at)
    }
}
