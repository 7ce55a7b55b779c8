//! What is too small for the mesh: found before gmsh, told with the names of the fractures.

use glam::DVec3;
use serde::Serialize;

use crate::clip::{Domain, FACES};
use crate::intersections::{Intersection, angle_between, distance, nearest_of_segments};
use crate::network::{Fracture, Sizes, close_pairs, tolerance};

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
    sizes: &Sizes,
    fractures: &[Fracture],
    intersections: &[([usize; 2], Intersection)],
) -> Vec<Feature> {
    let mut found = Vec::new();
    of_intersections(domain, sizes, fractures, intersections, &mut found);
    gaps(sizes, fractures, intersections, &mut found);
    for (index, fracture) in fractures.iter().enumerate() {
        at_faces(domain, sizes, fracture, &mut found);
        close_lines(domain, sizes, fractures, index, intersections, &mut found);
    }
    found
}

fn names(fractures: &[Fracture], indices: &[usize]) -> Vec<String> {
    indices
        .iter()
        .map(|&index| fractures[index].name.clone())
        .collect()
}

fn of_intersections(
    domain: &Domain,
    sizes: &Sizes,
    fractures: &[Fracture],
    intersections: &[([usize; 2], Intersection)],
    found: &mut Vec<Feature>,
) {
    let enough = sizes.small * sizes.h_intersection;
    for (pair, shared) in intersections {
        let mut report = |kind: FeatureKind, size: f64, enough: f64| {
            found.push(Feature {
                kind,
                names: names(fractures, pair),
                size,
                enough,
                at: (shared.from + shared.to) / 2.0,
            });
        };
        // A point of contact needs no cell of its own.
        if shared.length() > tolerance(domain) && shared.length() < enough {
            report(FeatureKind::ShortIntersection, shared.length(), enough);
        }
        if shared.angle < sizes.small_angle {
            report(FeatureKind::SmallAngle, shared.angle, sizes.small_angle);
        }
    }
}

fn gaps(
    sizes: &Sizes,
    fractures: &[Fracture],
    intersections: &[([usize; 2], Intersection)],
    found: &mut Vec<Feature>,
) {
    let enough = sizes.gap();
    for pair in close_pairs(fractures, enough) {
        if intersections
            .binary_search_by_key(&pair, |(pair, _)| *pair)
            .is_ok()
        {
            continue;
        }
        let [a, b] = pair.map(|index| &fractures[index].polygon);
        let (size, at) = distance(a, b);
        // Polygons of one plane that share an edge have no intersection, and no gap either.
        if size < enough && (size > 1e-9 * enough || angle_between(a, b) > 1e-3) {
            let names = names(fractures, &pair);
            found.push(Feature {
                kind: FeatureKind::Gap,
                names,
                size,
                enough,
                at,
            });
        }
    }
}

fn at_faces(domain: &Domain, sizes: &Sizes, fracture: &Fracture, found: &mut Vec<Feature>) {
    let polygon = &fracture.polygon;
    let tolerance = tolerance(domain);
    for (face, (name, axis, _)) in FACES.iter().enumerate() {
        let away = |corner: &DVec3| (corner[*axis] - domain.face(face)).abs();
        let mut report = |kind: FeatureKind, size: f64, enough: f64, at: DVec3| {
            let names = vec![fracture.name.clone(), (*name).to_owned()];
            found.push(Feature {
                kind,
                names,
                size,
                enough,
                at,
            });
        };
        let mut near: Vec<DVec3> = polygon.corners().to_vec();
        near.sort_by(|a, b| away(a).total_cmp(&away(b)));
        let touching = near
            .iter()
            .filter(|corner| away(corner) <= tolerance)
            .count();
        let angle = polygon.normal()[*axis].abs().min(1.0).acos().to_degrees();
        if touching > 0 && angle < sizes.small_angle {
            report(FeatureKind::SmallAngle, angle, sizes.small_angle, near[0]);
        }
        if let Some(corner) = near
            .get(touching)
            .filter(|corner| away(corner) < sizes.gap())
        {
            report(FeatureKind::GapToFace, away(corner), sizes.gap(), *corner);
        }
    }
}

/// A segment on a fracture: an edge of its outline, or what it shares with another.
struct Trace {
    ends: [DVec3; 2],
    other: Option<usize>,
}

fn close_lines(
    domain: &Domain,
    sizes: &Sizes,
    fractures: &[Fracture],
    own: usize,
    intersections: &[([usize; 2], Intersection)],
    found: &mut Vec<Feature>,
) {
    let enough = sizes.small * sizes.h_intersection.min(sizes.h_fracture);
    let traces = traces(fractures, own, intersections);
    for (rank, a) in traces.iter().enumerate() {
        for b in traces[rank + 1..]
            .iter()
            .filter(|b| a.other.is_some() || b.other.is_some())
        {
            let [p, q] = nearest_of_segments(a.ends, b.ends);
            let size = p.distance(q);
            if size > tolerance(domain) && size < enough {
                let involved = [Some(own), a.other, b.other];
                let involved: Vec<usize> = involved.into_iter().flatten().collect();
                let names = names(fractures, &involved);
                let at = (p + q) / 2.0;
                found.push(Feature {
                    kind: FeatureKind::CloseLines,
                    names,
                    size,
                    enough,
                    at,
                });
            }
        }
    }
}

fn traces(
    fractures: &[Fracture],
    own: usize,
    intersections: &[([usize; 2], Intersection)],
) -> Vec<Trace> {
    let edges = fractures[own].polygon.edges();
    let edges = edges.map(|ends| Trace { ends, other: None });
    let shared = intersections.iter().filter(|(pair, _)| pair.contains(&own));
    let shared = shared.map(|([a, b], shared)| Trace {
        ends: [shared.from, shared.to],
        other: Some(if *a == own { *b } else { *a }),
    });
    edges.chain(shared).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::{Given, Network};
    use crate::polygon::Polygon;

    const DOMAIN: Domain = Domain {
        low: DVec3::ZERO,
        high: DVec3::splat(10.0),
    };

    fn kinds(polygons: &[&[[f64; 3]]]) -> Vec<(FeatureKind, Vec<String>)> {
        let sizes = Sizes {
            h: 1.0,
            h_fracture: 1.0,
            h_intersection: 1.0,
            growth: 0.5,
            small: 0.2,
            small_angle: 10.0,
            mend: false,
        };
        let given = polygons.iter().enumerate().map(|(number, corners)| {
            let corners: Vec<DVec3> = corners.iter().map(|&corner| corner.into()).collect();
            Given {
                name: format!("f{number}"),
                set: String::new(),
                place: String::new(),
                polygon: Polygon::through(&corners).expect("a polygon"),
            }
        });
        let network = Network::build(DOMAIN, sizes, given.collect()).expect("a network");
        let features = network.features.into_iter();
        features
            .map(|feature| (feature.kind, feature.names))
            .collect()
    }

    const FLOOR: [[f64; 3]; 4] = [
        [2.0, 2.0, 5.0],
        [8.0, 2.0, 5.0],
        [8.0, 8.0, 5.0],
        [2.0, 8.0, 5.0],
    ];

    fn both() -> Vec<String> {
        vec!["f0".into(), "f1".into()]
    }

    #[test]
    fn a_gap_is_found() {
        let wall = [
            [5.0, 3.0, 5.1],
            [5.0, 6.0, 5.1],
            [5.0, 6.0, 7.0],
            [5.0, 3.0, 7.0],
        ];
        assert_eq!(kinds(&[&FLOOR, &wall]), [(FeatureKind::Gap, both())]);
    }

    #[test]
    fn a_dangling_end_is_two_close_lines() {
        let wall = [
            [5.0, 3.0, 4.9],
            [5.0, 6.0, 4.9],
            [5.0, 6.0, 7.0],
            [5.0, 3.0, 7.0],
        ];
        let names = vec!["f1".to_owned(), "f0".to_owned()];
        assert_eq!(kinds(&[&FLOOR, &wall]), [(FeatureKind::CloseLines, names)]);
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
