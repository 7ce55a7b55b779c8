//! One plane surface of an arrangement: a fracture, or a face of the domain.

use std::collections::BTreeSet;

use glam::{DVec2, DVec3};

/// A plane with axes in it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plane {
    /// A point of it (m).
    pub origin: DVec3,
    /// Its unit normal.
    pub normal: DVec3,
    axes: [DVec3; 2],
}

impl Plane {
    /// The plane through a point (m) with a unit normal.
    pub(super) fn new(origin: DVec3, normal: DVec3) -> Self {
        let first = normal.any_orthonormal_vector();
        Self {
            origin,
            normal,
            axes: [first, normal.cross(first)],
        }
    }

    /// Coordinates within the plane (m); they turn around the normal as points do in space.
    pub fn flat(&self, point: DVec3) -> DVec2 {
        let from = point - self.origin;
        DVec2::new(from.dot(self.axes[0]), from.dot(self.axes[1]))
    }

    /// Height above the plane (m), along the normal.
    pub fn height(&self, point: DVec3) -> f64 {
        (point - self.origin).dot(self.normal)
    }
}

/// A plane surface by the numbers of its points.
#[derive(Debug, Clone, PartialEq)]
pub struct Sheet {
    /// The plane that all its points are in.
    pub plane: Plane,
    /// Points around it, counter-clockwise around the normal.
    pub outline: Vec<usize>,
    /// Edges inside of it where others meet it, each with the smaller number first.
    pub traces: BTreeSet<[usize; 2]>,
    /// Points inside of it where others touch it, on no edge.
    pub contacts: BTreeSet<usize>,
}

/// An edge with the smaller number first.
pub(super) fn edge(a: usize, b: usize) -> [usize; 2] {
    [a.min(b), a.max(b)]
}

impl Sheet {
    /// Edges around it, from point to point.
    pub fn rim(&self) -> impl Iterator<Item = [usize; 2]> + '_ {
        let next = self.outline.iter().cycle().skip(1);
        self.outline.iter().zip(next).map(|(&a, &b)| [a, b])
    }

    /// All its edges, each with the smaller number first.
    pub fn edges(&self) -> BTreeSet<[usize; 2]> {
        let rim = self.rim().map(|[a, b]| edge(a, b));
        rim.chain(self.traces.iter().copied()).collect()
    }

    /// Whether an edge, with the smaller number first, is one of its edges.
    pub(super) fn has_edge(&self, ends: [usize; 2]) -> bool {
        self.traces.contains(&ends) || self.rim().any(|[a, b]| edge(a, b) == ends)
    }

    /// Whether a point is one of its points.
    pub(super) fn has_point(&self, point: usize) -> bool {
        self.outline.contains(&point)
            || self.contacts.contains(&point)
            || self.traces.iter().any(|ends| ends.contains(&point))
    }

    /// The other ends of the edges at a point.
    pub(super) fn edges_at(&self, point: usize) -> BTreeSet<usize> {
        let edges = self.rim().chain(self.traces.iter().copied());
        let at_point = edges.filter(|ends| ends.contains(&point));
        at_point
            .map(|[a, b]| if a == point { b } else { a })
            .collect()
    }

    /// All its points.
    pub fn points(&self) -> BTreeSet<usize> {
        let outline = self.outline.iter().copied();
        let traces = self.traces.iter().flatten().copied();
        let contacts = self.contacts.iter().copied();
        outline.chain(traces).chain(contacts).collect()
    }

    /// Drops traces that run along the outline, and contacts that are on an edge.
    pub(super) fn tidy(&mut self) {
        let rim: BTreeSet<[usize; 2]> = self.rim().map(|[a, b]| edge(a, b)).collect();
        self.traces.retain(|trace| !rim.contains(trace));
        let ends: BTreeSet<usize> = self.edges().into_iter().flatten().collect();
        self.contacts.retain(|contact| !ends.contains(contact));
    }

    /// Area within the outline (m^2), of points by their numbers.
    pub fn area(&self, points: &[DVec3]) -> f64 {
        ring_area(&self.plane, &self.outline, points)
    }
}

/// Signed area within a ring of points (m^2); positive if it turns around the normal.
pub(super) fn ring_area(plane: &Plane, ring: &[usize], points: &[DVec3]) -> f64 {
    let Some(&first) = ring.first() else {
        return 0.0;
    };
    let from = plane.flat(points[first]);
    let flat = |number: usize| plane.flat(points[number]) - from;
    let pairs = ring.windows(2);
    let twice: f64 = pairs
        .map(|pair| flat(pair[0]).perp_dot(flat(pair[1])))
        .sum();
    twice / 2.0
}
