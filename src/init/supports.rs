//! What a scene without loads may assume: a body that stands on rollers and carries a load on top.

use glam::DVec3;
use kluft_mesh::{Boundary, Mesh, facet_area_vector};

/// A surface is flat if its area as a vector is this share of its area, and level or upright if its
/// normal points that much along an axis.
const FLAT: f64 = 0.999;
/// How near to the side of the box a flat surface lies on it, as a share of the box.
const NEAR: f64 = 1e-3;

/// What is assumed of a part of the surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Assumed {
    /// It slides along itself: the lower end of the body along an axis.
    Roller(&'static str),
    /// It is pressed: the upper end of the body.
    Pressed,
    /// Nothing acts on it, and why.
    Free(&'static str),
}

/// The axes along which the body can move; the last one points upwards.
pub fn axes(mesh: &Mesh) -> &'static [&'static str] {
    match mesh.is_plane() {
        true => &["x", "y"],
        false => &["x", "y", "z"],
    }
}

/// What is assumed of each part of the outer surface.
pub fn assumed(mesh: &Mesh) -> Vec<Assumed> {
    let (low, high) = mesh.bounds();
    let parts = mesh.boundaries.iter();
    parts.map(|part| of_part(mesh, part, [low, high])).collect()
}

fn of_part(mesh: &Mesh, part: &Boundary, [low, high]: [DVec3; 2]) -> Assumed {
    let (mut vector, mut area, mut middle) = (DVec3::ZERO, 0.0, DVec3::ZERO);
    for element in 0..part.elements.len() {
        let corners = mesh.corners(&part.elements, element);
        let own = facet_area_vector(&corners);
        let centre = corners.iter().sum::<DVec3>() / corners.len() as f64;
        vector += own;
        area += own.length();
        middle += own.length() * centre;
    }
    if area == 0.0 || vector.length() < FLAT * area {
        return Assumed::Free("not flat");
    }
    let (normal, middle) = (vector.normalize(), middle / area);
    let axes = axes(mesh);
    let up = axes.len() - 1;
    let mut size = high - low;
    if mesh.is_plane() {
        size.z = 0.0;
    }
    let reach = NEAR * size.length();
    for (axis, &name) in axes.iter().enumerate() {
        if normal[axis] < -FLAT && middle[axis] - low[axis] < reach {
            return Assumed::Roller(name);
        }
        if axis == up && normal[axis] > FLAT && high[axis] - middle[axis] < reach {
            return Assumed::Pressed;
        }
    }
    Assumed::Free("no lower side of the body, and not its top")
}
