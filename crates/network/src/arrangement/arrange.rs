//! The arrangement of a network: its points, and its fractures and faces of the domain by them.

use glam::DVec3;

use super::crossings::cross;
use super::segments::{Segment, Segments};
use super::sheet::{Sheet, edge};
use crate::clip::Domain;
use crate::intersections::Intersection;
use crate::polygon::Polygon;

/// Fractures and faces of the domain, cut where they meet.
///
/// Edges that several surfaces share have the same two points in all of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Arrangement {
    /// The points (m).
    pub points: Vec<DVec3>,
    /// The fractures, then the faces of the domain in the order of `FACES`.
    pub sheets: Vec<Sheet>,
}

impl Arrangement {
    /// The arrangement of polygons in a domain, that share `intersections` by twos; `coplanar` are
    /// the pairs that lie side by side in one plane.
    pub fn of(
        domain: &Domain,
        polygons: &[&Polygon],
        intersections: &[([usize; 2], Intersection)],
        coplanar: &[[usize; 2]],
    ) -> Self {
        let mut segments = Segments::of(domain, polygons, intersections, coplanar);
        cross(&mut segments);
        let sheets = (0..segments.planes.len()).map(|surface| sheet(&segments, surface));
        Self {
            sheets: sheets.collect(),
            points: segments.points.into_all(),
        }
    }
}

fn sheet(segments: &Segments, surface: usize) -> Sheet {
    let mut sheet = Sheet {
        plane: segments.planes[surface],
        outline: Vec::new(),
        traces: Default::default(),
        contacts: segments.contacts[surface].clone(),
    };
    for &segment in &segments.within[surface] {
        let segment = &segments.all[segment];
        let chain = chain(segment, segments.points.all());
        if segment.is_trace {
            let pieces = chain.windows(2).map(|piece| edge(piece[0], piece[1]));
            sheet.traces.extend(pieces);
        } else {
            sheet.outline.extend(&chain[..chain.len() - 1]);
        }
    }
    sheet.tidy();
    sheet
}

/// The points on a segment from its first end to its last.
fn chain(segment: &Segment, points: &[DVec3]) -> Vec<usize> {
    let [first, last] = segment.ends;
    let along = points[last] - points[first];
    let between = segment.on.iter().copied();
    let mut between: Vec<(f64, usize)> = between
        .filter(|point| !segment.ends.contains(point))
        .map(|point| ((points[point] - points[first]).dot(along), point))
        .collect();
    between.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let between = between.into_iter().map(|(_, point)| point);
    let chain = std::iter::once(first).chain(between);
    chain.chain(std::iter::once(last)).collect()
}
