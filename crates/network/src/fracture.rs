//! Fractures as they are given and as they are in a network, and the sizes of cells that tell which
//! of their features are too small.

use glam::DVec3;

use crate::intersections::close_bounds;
use crate::polygon::Polygon;

/// A fracture as a list or a set gives it.
#[derive(Debug, Clone, PartialEq)]
pub struct InputFracture {
    /// Its name, no other fracture's.
    pub name: String,
    /// The set it belongs to.
    pub set: String,
    /// File and line, or the set that drew it.
    pub place: String,
    /// The whole of it.
    pub polygon: Polygon,
}

/// A fracture of the network.
#[derive(Debug, Clone, PartialEq)]
pub struct NetworkFracture {
    /// Its name.
    pub name: String,
    /// The set it belongs to.
    pub set: String,
    /// File and line, or the set that drew it.
    pub place: String,
    /// Area as given (m^2).
    pub area_given: f64,
    /// What is in the geometry.
    pub polygon: Polygon,
    /// What was changed besides clipping, one line a change.
    pub changes: Vec<String>,
    /// Farthest that a corner of it was moved at once (m).
    pub farthest_move: f64,
}

/// A given fracture that is not in the network.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Rejected {
    /// Its name.
    pub name: String,
    /// The set it belongs to.
    pub set: String,
    /// Why.
    pub reason: String,
}

/// Cell sizes, and what is too small for them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CellSizes {
    /// Cell size away from fractures (m).
    pub h: f64,
    /// Cell size on fractures (m).
    pub h_fracture: f64,
    /// Cell size on intersections of fractures (m).
    pub h_intersection: f64,
    /// Growth of the cell size per length away from fractures.
    pub growth: f64,
    /// Lengths below this part of the local cell size are too small.
    pub small: f64,
    /// Angles below this are too small (degrees).
    pub small_angle: f64,
    /// Whether corners that nearly touch something are moved onto it.
    pub snap: bool,
}

impl CellSizes {
    /// Edges shorter than this lose one of their ends (m).
    pub fn short(&self) -> f64 {
        0.5 * self.small * self.h_fracture.min(self.h_intersection)
    }

    /// Distances below this are too small (m).
    pub fn gap(&self) -> f64 {
        self.small * self.h_fracture
    }
}

/// Pairs of fractures whose bounds come closer than `gap` (m), in ascending order.
pub(crate) fn close_pairs(fractures: &[NetworkFracture], gap: f64) -> Vec<[usize; 2]> {
    let bounds: Vec<(DVec3, DVec3)> = fractures.iter().map(|f| f.polygon.bounds()).collect();
    close_bounds(&bounds, gap)
}
