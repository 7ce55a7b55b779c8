//! Lines within fractures along which fluid is driven.
//!
//! A line is shared among the corners of the facets that it runs in by their linear shape
//! functions, `w_i = int N_i ds`. Where it runs along an edge, the facets there have equal parts.

use glam::DVec3;
use kluft_mesh::Mesh;
use kluft_solver::LineShare;

/// Distance from a facet, as a share of its size, within which a line runs in it.
const WITHIN: f64 = 1e-6;
/// Shares of a corner below this are rounding: of what runs beside it.
const LEAST_SHARE: f64 = 1e-5;
/// Shares of a piece below this are rounding.
const ROUNDING: f64 = 1e-9;

/// Where a line runs in fractures.
pub(crate) struct LineShares {
    /// Of the corners of facets (m).
    pub(crate) shares: Vec<LineShare>,
    /// Length of the line, and of what runs in fractures (m).
    pub(crate) lengths: [f64; 2],
    /// Whether all of that runs along edges of facets.
    pub(crate) is_on_edges: bool,
}

/// A stretch of a piece of the line in a facet.
struct Stretch {
    facet: usize,
    /// Shares of the piece at which it begins and ends.
    along: [f64; 2],
    /// Local corners of the triangle of the facet that it runs in.
    triangle: [usize; 3],
}

impl LineShares {
    /// Those of a line of pieces (m) in some facets, ascending.
    pub(crate) fn of(mesh: &Mesh, facets: &[usize], pieces: &[[DVec3; 2]]) -> Self {
        let mut found = Self {
            shares: Vec::new(),
            lengths: [0.0; 2],
            is_on_edges: true,
        };
        let bounds: Vec<[DVec3; 2]> = facets.iter().map(|&f| bounds(mesh, f)).collect();
        for piece in pieces {
            found.lengths[0] += piece[0].distance(piece[1]);
            let [low, high] = [piece[0].min(piece[1]), piece[0].max(piece[1])];
            let near = facets
                .iter()
                .zip(&bounds)
                .filter(|(_, [least, most])| least.cmple(high).all() && low.cmple(*most).all());
            let stretches = near.flat_map(|(&facet, _)| stretches(mesh, facet, *piece));
            found.add(mesh, *piece, &stretches.collect::<Vec<_>>());
        }
        found
    }

    /// Adds what a piece has in facets, between one end of a stretch and the next.
    fn add(&mut self, mesh: &Mesh, piece: [DVec3; 2], stretches: &[Stretch]) {
        let mut ends: Vec<f64> = stretches.iter().flat_map(|one| one.along).collect();
        ends.sort_by(f64::total_cmp);
        for pair in ends.windows(2).filter(|pair| pair[1] - pair[0] > ROUNDING) {
            let middle = 0.5 * (pair[0] + pair[1]);
            let there = stretches.iter();
            let there = there.filter(|one| one.along[0] <= middle && middle <= one.along[1]);
            let mut there: Vec<&Stretch> = there.collect();
            // The two triangles of a quadrangle count as one.
            there.dedup_by_key(|one| one.facet);
            if there.is_empty() {
                continue;
            }
            let length = (pair[1] - pair[0]) * piece[0].distance(piece[1]);
            let at = piece[0].lerp(piece[1], middle);
            self.lengths[1] += length;
            for stretch in &there {
                self.share(mesh, stretch, (at, length / there.len() as f64));
            }
        }
    }

    /// Shares a length among the corners of a facet around the middle of what runs in it.
    fn share(&mut self, mesh: &Mesh, stretch: &Stretch, (at, length): (DVec3, f64)) {
        let elements = &mesh.facets.elements;
        let corners = mesh.corners(elements, stretch.facet);
        let weights = barycentric(stretch.triangle.map(|corner| corners[corner]), at);
        self.is_on_edges &= weights.iter().any(|weight| weight.abs() <= WITHIN);
        for (&corner, weight) in stretch.triangle.iter().zip(weights) {
            if weight > LEAST_SHARE {
                self.shares.push(LineShare {
                    node: elements.nodes_of(stretch.facet)[corner],
                    facet: stretch.facet as u32,
                    length: weight * length,
                });
            }
        }
    }
}

/// Lowest and highest coordinates of a facet, a little wider (m).
fn bounds(mesh: &Mesh, facet: usize) -> [DVec3; 2] {
    let corners = mesh.corners(&mesh.facets.elements, facet);
    let low = corners.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let high = corners
        .iter()
        .copied()
        .fold(DVec3::NEG_INFINITY, DVec3::max);
    let rim = DVec3::splat(WITHIN * (high - low).length());
    [low - rim, high + rim]
}

/// Where a piece runs in a facet.
fn stretches(mesh: &Mesh, facet: usize, [from, to]: [DVec3; 2]) -> Vec<Stretch> {
    let corners = mesh.corners(&mesh.facets.elements, facet);
    let fan = (1..corners.len() - 1).map(|k| [0, k, k + 1]);
    let stretch = |triangle: [usize; 3]| {
        let places = triangle.map(|corner| corners[corner]);
        let along = within(places, from, to)?;
        Some(Stretch {
            facet,
            along,
            triangle,
        })
    };
    fan.filter_map(stretch).collect()
}

/// Shares of the way from one place to another between which it runs in a triangle.
fn within([a, b, c]: [DVec3; 3], from: DVec3, to: DVec3) -> Option<[f64; 2]> {
    let normal = (b - a).cross(c - a).normalize_or_zero();
    let size = (b - a).length().max((c - a).length());
    let is_off = |place: DVec3| normal.dot(place - a).abs() > WITHIN * size;
    if normal == DVec3::ZERO || is_off(from) || is_off(to) {
        return None;
    }
    let ends = [from, to].map(|place| barycentric([a, b, c], place));
    let (mut first, mut last) = (0.0_f64, 1.0_f64);
    for (start, end) in ends[0].iter().zip(ends[1]) {
        // Inside where `start + s (end - start) >= -WITHIN`.
        let (start, rise) = (start + WITHIN, end - start);
        if rise.abs() <= ROUNDING {
            if start < 0.0 {
                return None;
            }
        } else if rise > 0.0 {
            first = first.max(-start / rise);
        } else {
            last = last.min(-start / rise);
        }
    }
    (last - first > ROUNDING).then_some([first, last])
}

/// Shares of the corners of a triangle in a place of its plane.
fn barycentric([a, b, c]: [DVec3; 3], place: DVec3) -> [f64; 3] {
    let normal = (b - a).cross(c - a);
    let whole = normal.length_squared();
    let second = (place - a).cross(c - a).dot(normal) / whole;
    let third = (b - a).cross(place - a).dot(normal) / whole;
    [1.0 - second - third, second, third]
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRIANGLE: [DVec3; 3] = [DVec3::ZERO, DVec3::X, DVec3::Y];

    #[test]
    fn a_way_runs_in_a_triangle_between_its_edges() {
        let level =
            |y: f64, z: f64| within(TRIANGLE, DVec3::new(-1.0, y, z), DVec3::new(3.0, y, z));
        let [first, last] = level(0.25, 0.0).expect("inside");
        assert!((first - 0.25).abs() < 1e-5 && (last - 0.4375).abs() < 1e-5);
        assert!(level(0.0, 0.0).is_some(), "an edge belongs to it");
        assert_eq!(level(0.25, 0.1), None);
        assert_eq!(level(1.5, 0.0), None);
        let across = within(
            TRIANGLE,
            DVec3::new(0.2, 0.2, 1.0),
            DVec3::new(0.2, 0.2, -1.0),
        );
        assert_eq!(across, None);
    }
}
