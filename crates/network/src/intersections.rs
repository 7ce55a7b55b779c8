//! Where two polygons meet, and how far apart they are.

use glam::DVec3;

use crate::polygon::Polygon;

/// Planes within this angle [radians] have no line in common that rounding leaves alone.
const PARALLEL: f64 = 1e-6;

/// The segment that two polygons share; of length 0 when they touch in a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Intersection {
    /// One end (m).
    pub from: DVec3,
    /// The other end (m).
    pub to: DVec3,
    /// Angle between the planes, 0 to 90 (degrees).
    pub angle: f64,
}

impl Intersection {
    /// Length (m).
    pub fn length(&self) -> f64 {
        self.from.distance(self.to)
    }
}

/// Angle between two planes, 0 to 90 (degrees).
pub fn angle_between(a: &Polygon, b: &Polygon) -> f64 {
    let (sin, cos) = (
        a.normal().cross(b.normal()).length(),
        a.normal().dot(b.normal()).abs(),
    );
    libm::atan2(sin, cos).to_degrees()
}

/// The line that two planes share, as a point and a unit direction; none for parallel planes.
pub(crate) fn common_line(
    (point_a, normal_a): (DVec3, DVec3),
    (point_b, normal_b): (DVec3, DVec3),
) -> Option<(DVec3, DVec3)> {
    let along = normal_a.cross(normal_b);
    let sin = along.length();
    if sin < PARALLEL {
        return None;
    }
    let along = along / sin;
    // From a's point within plane a straight to plane b.
    let across = along.cross(normal_a);
    let step = (point_b - point_a).dot(normal_b) / across.dot(normal_b);
    Some((point_a + step * across, along))
}

/// What two polygons share, if anything; corners within `tolerance` (m) of the other plane count
/// as on it, and ends as near as that as meeting. Polygons in one plane share no segment.
pub fn intersection(a: &Polygon, b: &Polygon, tolerance: f64) -> Option<Intersection> {
    let plane = |p: &Polygon| (p.middle(), p.normal());
    let (origin, along) = common_line(plane(a), plane(b))?;
    let [a_low, a_high] = span(a, b, origin, along, tolerance)?;
    let [b_low, b_high] = span(b, a, origin, along, tolerance)?;
    let (low, high) = (a_low.max(b_low), a_high.min(b_high));
    if high < low - tolerance {
        return None;
    }
    Some(Intersection {
        from: origin + low * along,
        to: origin + high.max(low) * along,
        angle: angle_between(a, b),
    })
}

/// The part of the line of both planes that lies in `polygon`, as positions along it.
fn span(
    polygon: &Polygon,
    other: &Polygon,
    origin: DVec3,
    along: DVec3,
    tolerance: f64,
) -> Option<[f64; 2]> {
    let mut ends: Option<[f64; 2]> = None;
    let mut meet = |point: DVec3| {
        let at = (point - origin).dot(along);
        let [low, high] = ends.unwrap_or([at, at]);
        ends = Some([low.min(at), high.max(at)]);
    };
    for [from, to] in polygon.edges() {
        let (a, b) = (other.height(from), other.height(to));
        if a.abs() <= tolerance {
            meet(from);
        } else if b.abs() > tolerance && a * b < 0.0 {
            meet(from + (to - from) * (a / (a - b)));
        }
    }
    ends
}

/// The nearest points of two segments.
pub(crate) fn nearest_of_segments(p: [DVec3; 2], q: [DVec3; 2]) -> [DVec3; 2] {
    let (u, v, w) = (p[1] - p[0], q[1] - q[0], p[0] - q[0]);
    let (uu, uv, vv) = (u.dot(u), u.dot(v), v.dot(v));
    let determinant = uu * vv - uv * uv;
    let mut best = [p[0], nearest_on_segment(q, p[0])];
    let mut offer = |pair: [DVec3; 2]| {
        if pair[0].distance_squared(pair[1]) < best[0].distance_squared(best[1]) {
            best = pair;
        }
    };
    offer([p[1], nearest_on_segment(q, p[1])]);
    offer([nearest_on_segment(p, q[0]), q[0]]);
    offer([nearest_on_segment(p, q[1]), q[1]]);
    if determinant > 1e-14 * uu * vv {
        let s = (uv * v.dot(w) - vv * u.dot(w)) / determinant;
        let t = (uu * v.dot(w) - uv * u.dot(w)) / determinant;
        if (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t) {
            offer([p[0] + s * u, q[0] + t * v]);
        }
    }
    best
}

/// The point of a segment nearest to `point`.
pub(crate) fn nearest_on_segment([a, b]: [DVec3; 2], point: DVec3) -> DVec3 {
    let along = b - a;
    let squared = along.length_squared();
    if squared == 0.0 {
        return a;
    }
    a + along * ((point - a).dot(along) / squared).clamp(0.0, 1.0)
}

/// The point of a polygon nearest to `point`.
fn nearest_on_polygon(polygon: &Polygon, point: DVec3) -> DVec3 {
    let foot = point - polygon.height(point) * polygon.normal();
    if polygon.depth(foot) >= 0.0 {
        return foot;
    }
    let candidates = polygon.edges().map(|edge| nearest_on_segment(edge, point));
    let nearer = |a: &DVec3, b: &DVec3| {
        a.distance_squared(point)
            .total_cmp(&b.distance_squared(point))
    };
    candidates.min_by(nearer).unwrap_or(foot)
}

/// Distance between two polygons that do not cross (m), and the middle between the nearest points.
pub fn distance(a: &Polygon, b: &Polygon) -> (f64, DVec3) {
    let on_b = a
        .corners()
        .iter()
        .map(|&corner| [corner, nearest_on_polygon(b, corner)]);
    let on_a = b
        .corners()
        .iter()
        .map(|&corner| [corner, nearest_on_polygon(a, corner)]);
    let edges = a
        .edges()
        .flat_map(|p| b.edges().map(move |q| nearest_of_segments(p, q)));
    let pairs = on_b.chain(on_a).chain(edges);
    let start = (f64::INFINITY, DVec3::ZERO);
    pairs.fold(start, |nearest, [p, q]| {
        let apart = p.distance(q);
        if apart < nearest.0 {
            (apart, (p + q) / 2.0)
        } else {
            nearest
        }
    })
}

/// Whether the bounds of two polygons come closer than `gap` (m).
fn may_meet(a: (DVec3, DVec3), b: (DVec3, DVec3), gap: f64) -> bool {
    (a.0 - b.1).cmple(DVec3::splat(gap)).all() && (b.0 - a.1).cmple(DVec3::splat(gap)).all()
}

/// Pairs of bounds that come closer than `gap` (m), in ascending order.
pub(crate) fn close_bounds(bounds: &[(DVec3, DVec3)], gap: f64) -> Vec<[usize; 2]> {
    let mut order: Vec<usize> = (0..bounds.len()).collect();
    order.sort_by(|&a, &b| bounds[a].0.x.total_cmp(&bounds[b].0.x));
    let mut pairs = Vec::new();
    for (rank, &a) in order.iter().enumerate() {
        let behind = order[rank + 1..].iter();
        for &b in behind.take_while(|&&b| bounds[b].0.x <= bounds[a].1.x + gap) {
            if may_meet(bounds[a], bounds[b], gap) {
                pairs.push([a.min(b), a.max(b)]);
            }
        }
    }
    pairs.sort_unstable();
    pairs
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polygon(corners: &[[f64; 3]]) -> Polygon {
        let corners: Vec<DVec3> = corners.iter().map(|&corner| corner.into()).collect();
        Polygon::through(&corners).expect("a polygon")
    }

    fn floor() -> Polygon {
        polygon(&[
            [0.0, 0.0, 0.0],
            [2.0, 0.0, 0.0],
            [2.0, 2.0, 0.0],
            [0.0, 2.0, 0.0],
        ])
    }

    #[test]
    fn crossing_rectangles_share_a_segment() {
        let wall = polygon(&[
            [1.0, -1.0, -1.0],
            [1.0, 1.5, -1.0],
            [1.0, 1.5, 1.0],
            [1.0, -1.0, 1.0],
        ]);
        let shared = intersection(&floor(), &wall, 1e-9).expect("shared");
        assert!((shared.length() - 1.5).abs() < 1e-12);
        assert!((shared.angle - 90.0).abs() < 1e-12);
        assert!((shared.from.x - 1.0).abs() < 1e-12 && shared.from.z.abs() < 1e-12);
    }

    #[test]
    fn an_abutting_edge_is_shared_whole() {
        let slope = polygon(&[
            [0.5, 1.0, 0.0],
            [1.5, 1.0, 0.0],
            [1.5, 2.0, 1.0],
            [0.5, 2.0, 1.0],
        ]);
        let shared = intersection(&floor(), &slope, 1e-9).expect("shared");
        assert!((shared.length() - 1.0).abs() < 1e-12);
        assert!((shared.angle - 45.0).abs() < 1e-12);
    }

    #[test]
    fn a_corner_that_touches_is_a_segment_without_length() {
        let tent = polygon(&[[1.0, 1.0, 0.0], [2.0, 1.0, 1.0], [0.0, 1.0, 1.0]]);
        let shared = intersection(&floor(), &tent, 1e-9).expect("shared");
        assert!(shared.length() < 1e-12 && shared.from.distance(DVec3::new(1.0, 1.0, 0.0)) < 1e-12);
    }

    #[test]
    fn planes_that_cross_beside_the_polygons_share_nothing() {
        let beside = polygon(&[
            [3.0, 0.0, -1.0],
            [3.0, 1.0, -1.0],
            [3.0, 1.0, 1.0],
            [3.0, 0.0, 1.0],
        ]);
        assert_eq!(intersection(&floor(), &beside, 1e-9), None);
        let above = polygon(&[
            [0.0, 0.0, 1.0],
            [2.0, 0.0, 1.0],
            [2.0, 2.0, 1.0],
            [0.0, 2.0, 1.0],
        ]);
        assert_eq!(intersection(&floor(), &above, 1e-9), None);
    }

    #[test]
    fn distances_by_hand() {
        let corner_above = polygon(&[[1.0, 1.0, 0.25], [2.0, 1.0, 1.0], [0.0, 1.0, 1.0]]);
        let edge_beside = polygon(&[[2.5, 1.0, -1.0], [2.5, 1.0, 1.0], [4.0, 1.0, 0.0]]);
        let diagonal = polygon(&[[3.0, 3.0, 0.0], [4.0, 3.0, 0.0], [3.0, 4.0, 1.0]]);
        for (other, expected) in [
            (corner_above, 0.25),
            (edge_beside, 0.5),
            (diagonal, 2.0_f64.sqrt()),
        ] {
            let (found, _) = distance(&floor(), &other);
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
            assert!((distance(&other, &floor()).0 - expected).abs() < 1e-12);
        }
    }

    #[test]
    fn crossing_segments_meet() {
        let p = [DVec3::new(-1.0, 0.0, 0.0), DVec3::new(1.0, 0.0, 0.0)];
        let q = [DVec3::new(0.3, -1.0, 0.1), DVec3::new(0.3, 1.0, 0.1)];
        let [a, b] = nearest_of_segments(p, q);
        assert!(a.distance(DVec3::new(0.3, 0.0, 0.0)) < 1e-12);
        assert!((a.distance(b) - 0.1).abs() < 1e-12);
    }
}
