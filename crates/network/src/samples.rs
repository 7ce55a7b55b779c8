//! Fractures and sizes that the tests of several files share.

use glam::DVec3;

use crate::clip::Domain;
use crate::fracture::{CellSizes, InputFracture, NetworkFracture};
use crate::polygon::Polygon;

pub(crate) const DOMAIN: Domain = Domain {
    low: DVec3::ZERO,
    high: DVec3::splat(10.0),
};

/// Gaps are small below 0.2 m.
pub(crate) const SIZES: CellSizes = CellSizes {
    h: 1.0,
    h_fracture: 1.0,
    h_intersection: 1.0,
    growth: 0.5,
    small: 0.2,
    small_angle: 10.0,
    snap: true,
};

/// A horizontal square in the middle of the domain.
pub(crate) const FLOOR: [[f64; 3]; 4] = [
    [2.0, 2.0, 5.0],
    [8.0, 2.0, 5.0],
    [8.0, 8.0, 5.0],
    [2.0, 8.0, 5.0],
];

/// A vertical rectangle over or through the floor, from `low` to 7 m.
pub(crate) fn wall(low: f64) -> [[f64; 3]; 4] {
    [
        [5.0, 3.0, low],
        [5.0, 6.0, low],
        [5.0, 6.0, 7.0],
        [5.0, 3.0, 7.0],
    ]
}

/// A fracture as a list gives it.
pub(crate) fn input(name: &str, corners: &[[f64; 3]]) -> InputFracture {
    InputFracture {
        name: name.into(),
        set: "set".into(),
        place: format!("list.csv:{name}"),
        polygon: polygon(corners),
    }
}

/// A fracture of a network.
pub(crate) fn fracture(name: &str, corners: &[[f64; 3]]) -> NetworkFracture {
    let input = input(name, corners);
    NetworkFracture {
        name: input.name,
        set: input.set,
        place: input.place,
        area_given: input.polygon.area(),
        polygon: input.polygon,
        changes: Vec::new(),
        farthest_move: 0.0,
    }
}

fn polygon(corners: &[[f64; 3]]) -> Polygon {
    let corners: Vec<DVec3> = corners.iter().map(|&corner| corner.into()).collect();
    Polygon::through(&corners).expect("a polygon")
}
