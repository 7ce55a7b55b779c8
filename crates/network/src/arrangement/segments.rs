//! The segments that outlines and traces are made of, before they are cut where they cross.

use std::collections::BTreeSet;

use glam::DVec3;

use super::points::Points;
use super::sheet::Plane;
use crate::clip::{Domain, FACES};
use crate::intersections::{Intersection, intersection, nearest_on_segment};
use crate::polygon::Polygon;

/// A straight line between two points.
#[derive(Debug, Clone)]
pub(super) struct Segment {
    pub(super) ends: [usize; 2],
    /// Points on it, with its ends.
    pub(super) on: BTreeSet<usize>,
    /// The surfaces it lies in.
    pub(super) surfaces: Vec<usize>,
    pub(super) is_trace: bool,
}

/// Fractures and faces of the domain as outlines and traces.
pub(super) struct Segments {
    pub(super) tolerance: f64,
    pub(super) points: Points,
    /// Fractures, then the faces of the domain in the order of `FACES`.
    pub(super) planes: Vec<Plane>,
    pub(super) all: Vec<Segment>,
    /// The segments in each surface.
    pub(super) within: Vec<Vec<usize>>,
    /// Points where others touch each surface.
    pub(super) contacts: Vec<BTreeSet<usize>>,
}

impl Segments {
    /// Outlines and traces of polygons that share `intersections` and reach the faces of a domain.
    pub(super) fn of(
        domain: &Domain,
        polygons: &[&Polygon],
        intersections: &[([usize; 2], Intersection)],
        coplanar: &[[usize; 2]],
    ) -> Self {
        let faces: Vec<Polygon> = (0..FACES.len())
            .filter_map(|face| face_polygon(domain, face))
            .collect();
        let all: Vec<&Polygon> = polygons.iter().copied().chain(&faces).collect();
        let tolerance = domain.tolerance();
        let mut segments = Self {
            tolerance,
            points: Points::within(10.0 * tolerance),
            planes: all
                .iter()
                .map(|polygon| Plane::new(polygon.middle(), polygon.normal()))
                .collect(),
            all: Vec::new(),
            within: vec![Vec::new(); all.len()],
            contacts: vec![BTreeSet::new(); all.len()],
        };
        // Corners first: points near them become one with them, not they with the points.
        for (surface, polygon) in all.iter().enumerate() {
            for [a, b] in polygon.edges() {
                segments.outline(surface, a, b);
            }
        }
        for (pair, shared) in intersections {
            segments.trace(*pair, shared);
        }
        for (face, polygon) in faces.iter().enumerate() {
            for (own, fracture) in polygons.iter().enumerate() {
                if let Some(shared) = at_face(domain, face, fracture, polygon) {
                    segments.trace([own, polygons.len() + face], &shared);
                }
            }
        }
        for &[a, b] in coplanar {
            segments.neighbours([a, b], [polygons[a], polygons[b]]);
            segments.neighbours([b, a], [polygons[b], polygons[a]]);
        }
        segments
    }

    fn add(&mut self, ends: [usize; 2], surfaces: Vec<usize>, is_trace: bool) {
        for &surface in &surfaces {
            self.within[surface].push(self.all.len());
        }
        self.all.push(Segment {
            ends,
            on: ends.into(),
            surfaces,
            is_trace,
        });
    }

    fn outline(&mut self, surface: usize, from: DVec3, to: DVec3) {
        let ends = [self.points.number(from), self.points.number(to)];
        if ends[0] != ends[1] {
            self.add(ends, vec![surface], false);
        }
    }

    fn trace(&mut self, pair: [usize; 2], shared: &Intersection) {
        let ends = [
            self.points.number(shared.from),
            self.points.number(shared.to),
        ];
        if ends[0] == ends[1] {
            for surface in pair {
                self.contacts[surface].insert(ends[0]);
            }
        } else {
            self.add(ends, pair.to_vec(), true);
        }
    }

    /// Corners of a neighbour in the same plane that lie on the outline.
    fn neighbours(&mut self, [own, _]: [usize; 2], [polygon, other]: [&Polygon; 2]) {
        for &corner in other.corners() {
            let mut edges = polygon.edges();
            if edges.any(|edge| nearest_on_segment(edge, corner).distance(corner) <= self.tolerance)
            {
                let number = self.points.number(corner);
                self.contacts[own].insert(number);
            }
        }
    }
}

/// A face of the domain; it turns so that its normal points along the axis.
fn face_polygon(domain: &Domain, face: usize) -> Option<Polygon> {
    let (_, axis, _) = FACES[face];
    let (first, second) = ((axis + 1) % 3, (axis + 2) % 3);
    let corner = |a: bool, b: bool| {
        let mut corner = DVec3::ZERO;
        corner[axis] = domain.face(face);
        corner[first] = if a { domain.high } else { domain.low }[first];
        corner[second] = if b { domain.high } else { domain.low }[second];
        corner
    };
    let corners = [(false, false), (true, false), (true, true), (false, true)];
    let mut normal = DVec3::ZERO;
    normal[axis] = 1.0;
    Polygon::new(corners.map(|(a, b)| corner(a, b)).to_vec(), normal)
}

fn at_face(
    domain: &Domain,
    face: usize,
    fracture: &Polygon,
    polygon: &Polygon,
) -> Option<Intersection> {
    let (axis, level) = (FACES[face].1, domain.face(face));
    let (low, high) = fracture.bounds();
    let reaches =
        low[axis] - level <= domain.tolerance() && level - high[axis] <= domain.tolerance();
    reaches
        .then(|| intersection(fracture, polygon, domain.tolerance()))
        .flatten()
}
