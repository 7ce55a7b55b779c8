//! What is too small for the mesh: found before gmsh, told with the names of the fractures.

use glam::DVec3;
use serde::Serialize;

use crate::clip::{Domain, FACES};
use crate::fracture::{CellSizes, NetworkFracture, close_pairs};
use crate::intersections::{Intersection, angle_between, distance, nearest_of_segments};

/// What kind of small feature.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FeatureKind {
    /// Two fractures share a short segment (m).
    ShortIntersection,
    /// Two fractures come close without touching (m).
    Gap,
    /// Two fractures, or a fracture and a face, meet at a small angle (degrees).
    SmallAngle,
    /// On one fracture, lines that others leave on it, or its outline, come close (m).
    CloseLines,
    /// A fracture comes close to a face of the domain without touching it (m).
    GapToFace,
}

/// One feature that is too small for the mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Feature {
    /// What kind.
    pub kind: FeatureKind,
    /// Names of the fractures, and of a face.
    pub names: Vec<String>,
    /// Its size [m or degrees].
    pub size: f64,
    /// What would be large enough [m or degrees].
    pub enough: f64,
    /// Where it is (m).
    pub at: DVec3,
}

/// Lists everything too small for the cell sizes.
pub fn small_features(
    domain: &Domain,
    sizes: &CellSizes,
    fractures: &[NetworkFracture],
    intersections: &[([usize; 2], Intersection)],
) -> Vec<Feature> {
    let mut of = vec![Vec::new(); fractures.len()];
    for (index, (pair, _)) in intersections.iter().enumerate() {
        for &fracture in pair {
            of[fracture].push(index);
        }
    }
    let mut search = Search {
        domain,
        sizes,
        fractures,
        intersections,
        of,
        found: Vec::new(),
    };
    search.of_intersections();
    search.gaps();
    for (index, fracture) in fractures.iter().enumerate() {
        search.at_faces(fracture);
        search.close_lines(index);
    }
    search.found
}

/// A network, and what has been found so far.
struct Search<'a> {
    domain: &'a Domain,
    sizes: &'a CellSizes,
    fractures: &'a [NetworkFracture],
    intersections: &'a [([usize; 2], Intersection)],
    /// The intersections of each fracture.
    of: Vec<Vec<usize>>,
    found: Vec<Feature>,
}

impl Search<'_> {
    fn names(&self, indices: &[usize]) -> Vec<String> {
        let names = indices.iter().map(|&index| &self.fractures[index].name);
        names.cloned().collect()
    }

    fn of_intersections(&mut self) {
        let (least, small_angle) = (self.domain.tolerance(), self.sizes.small_angle);
        let enough = self.sizes.small * self.sizes.h_intersection;
        for (pair, shared) in self.intersections {
            let names = self.names(pair);
            let mut report = |kind: FeatureKind, size: f64, enough: f64| {
                self.found.push(Feature {
                    kind,
                    names: names.clone(),
                    size,
                    enough,
                    at: (shared.from + shared.to) / 2.0,
                });
            };
            // A point of contact needs no cell of its own.
            if shared.length() > least && shared.length() < enough {
                report(FeatureKind::ShortIntersection, shared.length(), enough);
            }
            if shared.angle < small_angle {
                report(FeatureKind::SmallAngle, shared.angle, small_angle);
            }
        }
    }

    fn gaps(&mut self) {
        let enough = self.sizes.gap();
        for pair in close_pairs(self.fractures, enough) {
            let meeting = self
                .intersections
                .binary_search_by_key(&pair, |(pair, _)| *pair);
            if meeting.is_ok() {
                continue;
            }
            let [a, b] = pair.map(|index| &self.fractures[index].polygon);
            let (size, at) = distance(a, b);
            // Polygons of one plane that share an edge have no intersection, and no gap either.
            if size < enough && (size > 1e-9 * enough || angle_between(a, b) > 1e-3) {
                self.found.push(Feature {
                    kind: FeatureKind::Gap,
                    names: self.names(&pair),
                    size,
                    enough,
                    at,
                });
            }
        }
    }

    fn at_faces(&mut self, fracture: &NetworkFracture) {
        let polygon = &fracture.polygon;
        let (gap, small_angle) = (self.sizes.gap(), self.sizes.small_angle);
        for (face, (name, axis, _)) in FACES.iter().enumerate() {
            let level = self.domain.face(face);
            let away = |corner: &DVec3| (corner[*axis] - level).abs();
            let mut report = |kind: FeatureKind, size: f64, enough: f64, at: DVec3| {
                self.found.push(Feature {
                    kind,
                    names: vec![fracture.name.clone(), (*name).to_owned()],
                    size,
                    enough,
                    at,
                });
            };
            let mut near: Vec<DVec3> = polygon.corners().to_vec();
            near.sort_by(|a, b| away(a).total_cmp(&away(b)));
            let touching = near
                .iter()
                .filter(|corner| away(corner) <= self.domain.tolerance())
                .count();
            let angle = polygon.normal()[*axis].abs().min(1.0).acos().to_degrees();
            if touching > 0 && angle < small_angle {
                report(FeatureKind::SmallAngle, angle, small_angle, near[0]);
            }
            if let Some(corner) = near.get(touching).filter(|corner| away(corner) < gap) {
                report(FeatureKind::GapToFace, away(corner), gap, *corner);
            }
        }
    }

    fn close_lines(&mut self, own: usize) {
        let sizes = self.sizes;
        let enough = sizes.small * sizes.h_intersection.min(sizes.h_fracture);
        let traces = self.traces(own);
        for (rank, a) in traces.iter().enumerate() {
            let others = traces[rank + 1..].iter();
            for b in others.filter(|b| a.other.is_some() || b.other.is_some()) {
                let [p, q] = nearest_of_segments(a.ends, b.ends);
                let size = p.distance(q);
                if size > self.domain.tolerance() && size < enough {
                    let involved = [Some(own), a.other, b.other];
                    let involved: Vec<usize> = involved.into_iter().flatten().collect();
                    self.found.push(Feature {
                        kind: FeatureKind::CloseLines,
                        names: self.names(&involved),
                        size,
                        enough,
                        at: (p + q) / 2.0,
                    });
                }
            }
        }
    }

    fn traces(&self, own: usize) -> Vec<Trace> {
        let edges = self.fractures[own].polygon.edges();
        let edges = edges.map(|ends| Trace { ends, other: None });
        let own_pairs = self.of[own].iter().map(|&index| &self.intersections[index]);
        let shared = own_pairs.map(|([a, b], shared)| Trace {
            ends: [shared.from, shared.to],
            other: Some(if *a == own { *b } else { *a }),
        });
        edges.chain(shared).collect()
    }
}

/// A segment on a fracture: an edge of its outline, or what it shares with another.
struct Trace {
    ends: [DVec3; 2],
    other: Option<usize>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::Network;
    use crate::samples::{DOMAIN, FLOOR, SIZES, input, wall};

    fn kinds(polygons: &[&[[f64; 3]]]) -> Vec<(FeatureKind, Vec<String>)> {
        let sizes = CellSizes {
            snap: false,
            ..SIZES
        };
        let polygons = polygons.iter().enumerate();
        let list = polygons.map(|(number, corners)| input(&format!("f{number}"), corners));
        let network = Network::build(DOMAIN, sizes, list.collect()).expect("a network");
        let features = network.features.into_iter();
        features
            .map(|feature| (feature.kind, feature.names))
            .collect()
    }

    fn both() -> Vec<String> {
        vec!["f0".into(), "f1".into()]
    }

    #[test]
    fn a_gap_is_found() {
        assert_eq!(kinds(&[&FLOOR, &wall(5.1)]), [(FeatureKind::Gap, both())]);
    }

    #[test]
    fn a_dangling_end_is_two_close_lines() {
        let names = vec!["f1".to_owned(), "f0".to_owned()];
        assert_eq!(
            kinds(&[&FLOOR, &wall(4.9)]),
            [(FeatureKind::CloseLines, names)]
        );
    }

    #[test]
    fn a_sliver_is_found() {
        let low = [
            [2.0, 3.0, 4.5],
            [8.0, 3.0, 5.5],
            [8.0, 6.0, 5.5],
            [2.0, 6.0, 4.5],
        ];
        let found = kinds(&[&FLOOR, &low]);
        assert_eq!(found, [(FeatureKind::SmallAngle, both())]);
    }

    #[test]
    fn a_short_intersection_is_found() {
        let corner = [
            [7.9, 5.0, 3.0],
            [9.0, 5.0, 3.0],
            [9.0, 5.0, 7.0],
            [7.9, 5.0, 7.0],
        ];
        let found = kinds(&[&FLOOR, &corner]);
        assert!(
            found.contains(&(FeatureKind::ShortIntersection, both())),
            "{found:?}"
        );
    }

    #[test]
    fn a_gap_to_a_face_is_found() {
        let near = [
            [0.1, 3.0, 4.0],
            [3.0, 3.0, 4.0],
            [3.0, 6.0, 4.0],
            [0.1, 6.0, 4.0],
        ];
        let names = vec!["f0".to_owned(), "left".to_owned()];
        assert_eq!(kinds(&[&near]), [(FeatureKind::GapToFace, names)]);
    }
}
