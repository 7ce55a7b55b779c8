//! Points on fractures and on their intersections that gmsh counts distances from.

use glam::DVec3;

use crate::intersections::Intersection;
use crate::polygon::Polygon;

/// Equally spaced points in a line: the first, the step to the next, and the number of steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Row {
    pub(crate) from: DVec3,
    pub(crate) step: DVec3,
    pub(crate) steps: usize,
}

impl Row {
    /// From one point to another (m), at most `spacing` (m) between neighbours.
    pub(crate) fn between(from: DVec3, to: DVec3, spacing: f64) -> Self {
        let steps = (from.distance(to) / spacing).ceil().max(1.0);
        Self {
            from,
            step: (to - from) / steps,
            steps: steps as usize,
        }
    }
}

/// Rows along an intersection, one.
pub(crate) fn along(shared: &Intersection, spacing: f64) -> Row {
    Row::between(shared.from, shared.to, spacing)
}

/// Rows along the edges of a polygon, and over it from edge to edge, at most `spacing` (m) apart:
/// no point of it is farther from a sample than half the diagonal of a square of that side.
pub(crate) fn over(polygon: &Polygon, spacing: f64) -> Vec<Row> {
    let corners = polygon.corners();
    let along = (corners[1] - corners[0]).normalize_or_zero();
    let across = polygon.normal().cross(along);
    let depth = |point: DVec3| (point - corners[0]).dot(across);
    let deepest = corners
        .iter()
        .map(|&corner| depth(corner))
        .fold(0.0, f64::max);
    let count = (deepest / spacing).ceil().max(1.0) as usize;
    let row = |number: usize| {
        let level = deepest * number as f64 / count as f64;
        let [from, to] = chord(polygon, along, |point| depth(point) - level)?;
        Some(Row::between(from, to, spacing))
    };
    let edges = polygon.edges().map(|[a, b]| Row::between(a, b, spacing));
    edges.chain((1..count).filter_map(row)).collect()
}

/// The part of a polygon where heights are zero, from its lowest position along a direction to its
/// highest.
fn chord(polygon: &Polygon, along: DVec3, height: impl Fn(DVec3) -> f64) -> Option<[DVec3; 2]> {
    let cuts = polygon.edges().filter_map(|[a, b]| {
        let (from, to) = (height(a), height(b));
        if from == 0.0 {
            return Some(a);
        }
        (from * to <= 0.0).then(|| a.lerp(b, from / (from - to)))
    });
    let cuts: Vec<DVec3> = cuts.collect();
    let position = |point: &&DVec3| point.dot(along);
    let by_position = |a: &&DVec3, b: &&DVec3| position(a).total_cmp(&position(b));
    let lowest = cuts.iter().min_by(by_position)?;
    let highest = cuts.iter().max_by(by_position)?;
    Some([*lowest, *highest])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Orientation, Outline};

    #[test]
    fn no_point_of_a_polygon_is_farther_from_a_sample_than_half_a_diagonal_of_their_grid() {
        let outline = Outline::Disc {
            radius: 2.0,
            sides: 12,
            rotation: 10.0,
        };
        let orientation = Orientation {
            dip: 35.0,
            dip_direction: 120.0,
        };
        let polygon = Polygon::placed(outline, DVec3::ONE, orientation);
        let spacing = 0.5;
        let rows = over(&polygon, spacing);
        let samples: Vec<DVec3> = rows
            .iter()
            .flat_map(|row| (0..=row.steps).map(|step| row.from + step as f64 * row.step))
            .collect();
        assert!(
            samples
                .iter()
                .all(|&sample| polygon.height(sample).abs() < 1e-12)
        );
        assert!(samples.iter().all(|&sample| polygon.depth(sample) > -1e-12));
        let middle = polygon.middle();
        for corner in polygon.corners() {
            for part in 0..=20 {
                let at = middle.lerp(*corner, f64::from(part) / 20.0);
                let nearest = samples.iter().map(|sample| sample.distance(at));
                let nearest = nearest.fold(f64::INFINITY, f64::min);
                assert!(nearest <= spacing / 2.0_f64.sqrt() + 1e-12, "{nearest}");
            }
        }
    }
}
