//! Samples in a plane: linear in their Delaunay triangles.
//!
//! The triangles come from spade; where a position lies is found here, because the result must not
//! depend on what was asked before.

use glam::DVec3;
use rstar::RTree;
use rstar::primitives::{GeomWithData, Rectangle};
use spade::{DelaunayTriangulation, HasPosition, Point2, Triangulation};

use super::frame::Frame;
use super::sample::Sample;

/// How far outside a triangle a position still belongs to it, as a share of its height: rounding,
/// and what flat triangles leave open.
const SLACK: f64 = 1e-6;
/// Height of a triangle, as a share of its longest edge, below which it is none: what rounding
/// makes of samples on a straight edge.
const FLAT: f64 = 1e-8;

/// Triangles between samples in a plane.
#[derive(Debug, Clone)]
pub(crate) struct Triangles {
    /// Samples at the corners.
    corners: Vec<[usize; 3]>,
    /// Positions of all samples in the frame of the plane (m).
    places: Vec<DVec3>,
    boxes: RTree<GeomWithData<Rectangle<[f64; 2]>, usize>>,
}

struct Vertex {
    place: Point2<f64>,
    index: usize,
}

impl HasPosition for Vertex {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        self.place
    }
}

impl Triangles {
    /// The triangles between positions that lie in the plane of `frame`.
    ///
    /// # Errors
    /// Coordinates that are too large or too small for a triangulation.
    pub(crate) fn of(positions: &[DVec3], frame: &Frame) -> Result<Self, [String; 2]> {
        let places: Vec<DVec3> = positions.iter().map(|at| frame.in_frame(*at)).collect();
        // The smallest numbers are rounding, and no coordinates for the predicates.
        let clean = |x: f64| if x.abs() < 1e-100 { 0.0 } else { x };
        let vertices = places.iter().enumerate().map(|(index, at)| Vertex {
            place: Point2::new(clean(at.x), clean(at.y)),
            index,
        });
        let found = DelaunayTriangulation::<Vertex>::bulk_load_stable(vertices.collect());
        let found = found.map_err(|error| {
            let problem = format!("the samples cannot be joined by triangles: {error}");
            [problem, "write method = \"nearest\"".to_owned()]
        })?;
        let faces = found.inner_faces();
        let mut corners: Vec<[usize; 3]> = faces
            .map(|face| {
                let mut corners = face.vertices().map(|vertex| vertex.data().index);
                corners.sort_unstable();
                corners
            })
            .collect();
        corners.retain(|corners| !is_flat(corners.map(|corner| places[corner])));
        corners.sort_unstable();
        let boxes = corners.iter().enumerate().map(|(number, corners)| {
            let [a, b, c] = corners.map(|corner| places[corner].truncate());
            let (low, high) = (a.min(b).min(c), a.max(b).max(c));
            let slack = glam::DVec2::splat(SLACK * (high - low).max_element());
            let corners = ((low - slack).to_array(), (high + slack).to_array());
            GeomWithData::new(Rectangle::from_corners(corners.0, corners.1), number)
        });
        Ok(Self {
            boxes: RTree::bulk_load(boxes.collect()),
            corners,
            places,
        })
    }

    /// The value at a place in the frame; not a number outside.
    pub(crate) fn at(&self, place: DVec3, samples: &[Sample]) -> f64 {
        let around = self.boxes.locate_all_at_point(&[place.x, place.y]);
        let mut numbers: Vec<usize> = around.map(|found| found.data).collect();
        numbers.sort_unstable();
        let mut values = numbers.into_iter().filter_map(|number| {
            let corners = self.corners[number];
            let shares = shares(place, corners.map(|corner| self.places[corner]))?;
            let values = corners.map(|corner| samples[corner].value);
            Some(std::iter::zip(shares, values).map(|(s, v)| s * v).sum())
        });
        values.next().unwrap_or(f64::NAN)
    }
}

/// Twice the area of a triangle, positive if it turns to the left (m^2).
fn area([p, q, r]: [DVec3; 3]) -> f64 {
    (q - p).truncate().perp_dot((r - p).truncate())
}

fn is_flat([a, b, c]: [DVec3; 3]) -> bool {
    let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
    area([a, b, c]).abs() <= FLAT * longest * longest
}

/// Barycentric coordinates of a place in a triangle, if it lies inside.
fn shares(place: DVec3, [a, b, c]: [DVec3; 3]) -> Option<[f64; 3]> {
    let whole = area([a, b, c]);
    let parts = [[place, b, c], [a, place, c], [a, b, place]];
    let shares = parts.map(|part| area(part) / whole);
    shares
        .iter()
        .all(|share| *share >= -SLACK)
        .then_some(shares)
}
