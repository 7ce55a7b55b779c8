//! Outer faces that lie back to back in one plane and cover each other, whatever their nodes.

use glam::{DVec2, DVec3};
use rayon::prelude::*;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

use super::outer::OuterFaces;
use super::pairs::FacePair;
use super::places::SAME_PLACE;

/// Faces cover each other when they share more than this part of the smaller one: less is what
/// rounding leaves between neighbours.
const COVERED: f64 = 1e-3;

/// A direction that no plane of a body is likely to hold. It tells one side of a plane from the
/// other; faces that hold it all the same count for both sides.
const ACROSS: DVec3 = DVec3::new(0.762_531, 0.532_197, 0.368_449);

/// A face in its plane.
struct PlaneFace {
    /// Its place in [`OuterFaces`].
    index: usize,
    corners: Vec<DVec3>,
    normal: DVec3,
    area: f64,
    /// How far from the plane a point still lies in it (m).
    thickness: f64,
}

/// Pairs of faces that cover each other in part, ascending; `taken` are left out.
pub(super) fn covering(outer: &OuterFaces, nodes: &[DVec3], taken: &[bool]) -> Vec<FacePair> {
    let indices = (0..outer.faces.len()).into_par_iter();
    let faces = indices.filter(|&index| !taken[index]);
    let faces: Vec<PlaneFace> = faces
        .filter_map(|index| PlaneFace::of(index, outer.corners(index, nodes)))
        .collect();
    let behind = faces
        .iter()
        .enumerate()
        .filter(|(_, face)| face.across() < SAME_PLACE);
    let boxes = behind.map(|(place, face)| {
        let [low, high] = face.bounds();
        GeomWithData::new(Rectangle::from_corners(low, high), place)
    });
    let tree = RTree::bulk_load(boxes.collect());
    let before = faces.par_iter().filter(|face| face.across() > -SAME_PLACE);
    let pairs = before.flat_map_iter(|face| {
        let [low, high] = face.bounds();
        let near = tree.locate_in_envelope_intersecting(&AABB::from_corners(low, high));
        near.filter_map(|found| face.covers(&faces[found.data]))
    });
    let mut pairs: Vec<FacePair> = pairs.collect();
    pairs.sort_unstable_by_key(|pair| pair.faces);
    pairs.dedup_by_key(|pair| pair.faces);
    pairs
}

impl PlaneFace {
    /// None for a face without area.
    fn of(index: usize, corners: Vec<DVec3>) -> Option<Self> {
        let vector = crate::geometry::facet_area_vector(&corners);
        let normal = vector.try_normalize()?;
        let ends = corners.iter().cycle().skip(1);
        let edges = corners.iter().zip(ends).map(|(a, b)| a.distance(*b));
        Some(Self {
            index,
            normal,
            area: vector.length(),
            thickness: SAME_PLACE * edges.fold(0.0, f64::max),
            corners,
        })
    }

    /// Cosine of the angle between the normal and [`ACROSS`].
    fn across(&self) -> f64 {
        self.normal.dot(ACROSS)
    }

    fn bounds(&self) -> [[f64; 3]; 2] {
        let ends = [
            (
                DVec3::INFINITY,
                DVec3::min as fn(DVec3, DVec3) -> DVec3,
                -self.thickness,
            ),
            (DVec3::NEG_INFINITY, DVec3::max, self.thickness),
        ];
        ends.map(|(start, further, more)| {
            let end = self.corners.iter().copied().fold(start, further);
            (end + DVec3::splat(more)).to_array()
        })
    }

    /// The pair of both, if they cover each other back to back.
    fn covers(&self, other: &Self) -> Option<FacePair> {
        let thickness = self.thickness.max(other.thickness);
        let origin = self.corners[0];
        let is_off = |corner: &DVec3| (*corner - origin).dot(self.normal).abs() > thickness;
        if self.normal.dot(other.normal) > 0.0 || other.corners.iter().any(is_off) {
            return None;
        }
        let (u, v) = self.normal.any_orthonormal_pair();
        let flat = |corner: &DVec3| {
            let from = *corner - origin;
            DVec2::new(from.dot(u), from.dot(v))
        };
        let own: Vec<DVec2> = self.corners.iter().map(flat).collect();
        // The other runs round the other way.
        let others = other.corners.iter().rev().map(flat).collect();
        let area = area(&clipped(others, &own));
        (area > COVERED * self.area.min(other.area)).then(|| FacePair {
            faces: [self.index.min(other.index), self.index.max(other.index)],
            area,
            back_to_back: true,
        })
    }
}

/// The part of a polygon within another, a convex one that runs counter-clockwise (Sutherland and
/// Hodgman 1974).
fn clipped(polygon: Vec<DVec2>, by: &[DVec2]) -> Vec<DVec2> {
    let ends = by.iter().cycle().skip(1);
    by.iter().zip(ends).fold(polygon, |polygon, (&from, &to)| {
        let side = |x: DVec2| (to - from).perp_dot(x - from);
        let nexts = polygon.iter().cycle().skip(1);
        let mut kept = Vec::with_capacity(polygon.len() + 1);
        for (&a, &b) in polygon.iter().zip(nexts) {
            let (at_a, at_b) = (side(a), side(b));
            if at_a >= 0.0 {
                kept.push(a);
            }
            if (at_a > 0.0 && at_b < 0.0) || (at_a < 0.0 && at_b > 0.0) {
                kept.push(a.lerp(b, at_a / (at_a - at_b)));
            }
        }
        kept
    })
}

fn area(polygon: &[DVec2]) -> f64 {
    let Some(&origin) = polygon.first() else {
        return 0.0;
    };
    let triangles = polygon.windows(2);
    let twice = triangles.map(|edge| (edge[0] - origin).perp_dot(edge[1] - origin));
    0.5 * twice.sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polygons_are_clipped_to_what_both_cover() {
        let square = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(DVec2::from);
        let moved = |by: DVec2| square.iter().map(|x| *x + by).collect::<Vec<_>>();
        let common = |by: (f64, f64)| area(&clipped(moved(by.into()), &square));
        assert!((common((0.25, 0.5)) - 0.375).abs() < 1e-15);
        assert!((common((0.0, 0.0)) - 1.0).abs() < 1e-15);
        assert_eq!(common((1.0, 0.0)), 0.0);
        assert_eq!(common((3.0, 0.0)), 0.0);
        // A diamond whose corners are the middles of the edges.
        let diamond = [(0.5, 0.0), (1.0, 0.5), (0.5, 1.0), (0.0, 0.5)].map(DVec2::from);
        assert!((area(&clipped(square.to_vec(), &diamond)) - 0.5).abs() < 1e-15);
    }
}
