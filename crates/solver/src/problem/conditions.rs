//! What acts on the outer surface, and what holds it.

use glam::DVec3;

/// A load on a part of the outer surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SurfaceLoad {
    /// Force per area in global axes (Pa).
    Traction(DVec3),
    /// Force per area along the inward normal (Pa).
    Pressure(f64),
}

impl SurfaceLoad {
    /// Force (N) on a node, for which `int N dA` is given (m^2), of the size and as a vector along
    /// the outward normal.
    pub fn force(self, (size, area): (f64, DVec3)) -> DVec3 {
        match self {
            Self::Traction(traction) => size * traction,
            Self::Pressure(pressure) => -pressure * area,
        }
    }
}

/// A support of a part of the outer surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Support {
    /// Prescribed displacement of the named components (m); the others are free.
    Displacement([Option<f64>; 3]),
    /// No displacement along the normal: a roller on any plane.
    Symmetry,
}

/// What acts on one part of the outer surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Condition {
    /// Index into [`kluft_mesh::MeshData::boundaries`].
    pub boundary: usize,
    /// Its load, if any.
    pub load: Option<SurfaceLoad>,
    /// Its support, if any.
    pub support: Option<Support>,
}

/// A node held in some components, in all its sectors.
#[derive(Debug, Clone, PartialEq)]
pub struct FixedPoint {
    /// Node index.
    pub node: u32,
    /// Prescribed components (m).
    pub displacement: [Option<f64>; 3],
    /// How the user calls it, for messages.
    pub name: String,
}
