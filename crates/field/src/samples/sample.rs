//! A sample, and how values follow from several.

use glam::DVec3;

/// How a value follows from samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Method {
    /// That of the nearest sample.
    #[default]
    Nearest,
    /// Linear between samples: along their line, in the Delaunay triangles of their plane, or in
    /// the cells of their grid.
    Linear,
}

/// A position (m) and its value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sample {
    pub(crate) position: DVec3,
    pub(crate) value: f64,
}
