//! From given fractures to a network that gmsh can mesh: clipped, snapped, checked.

use glam::DVec3;
use kluft_defect::Defect;

use crate::arrangement::{Arrangement, Moved, collapse};
use crate::clip::{Domain, FACES};
use crate::fracture::{CellSizes, InputFracture, NetworkFracture, Rejected, close_pairs};
use crate::intersections::{Intersection, angle_between, intersection};
use crate::polygon::Polygon;
use crate::small_features::{Feature, small_features};
use crate::snap::snap;

/// OpenCASCADE takes points closer than 1e-7 m for one, whatever the size of the domain (m).
const FINEST: f64 = 1e-5;

/// A network ready for gmsh.
#[derive(Debug, Clone)]
pub struct Network {
    /// The rock.
    pub domain: Domain,
    /// Cell sizes.
    pub sizes: CellSizes,
    /// The fractures.
    pub fractures: Vec<NetworkFracture>,
    /// What was given and is not among them.
    pub rejected: Vec<Rejected>,
    /// What pairs of fractures share: indices, ascending, and the segment.
    pub intersections: Vec<([usize; 2], Intersection)>,
    /// What is too small for the mesh and stays.
    pub features: Vec<Feature>,
    /// Fractures and faces of the domain, cut where they meet.
    pub arrangement: Arrangement,
}

impl Network {
    /// Clips the fractures to the domain, snaps ends that nearly touch and lists what remains too
    /// small for the mesh.
    ///
    /// # Errors
    /// Fractures that overlap in one plane, by name; cells too fine for gmsh.
    pub fn build(
        domain: Domain,
        sizes: CellSizes,
        given: Vec<InputFracture>,
    ) -> Result<Self, Vec<Defect>> {
        if sizes.h_intersection < FINEST {
            let problem = format!("cells of {:e} m are asked for", sizes.h_intersection);
            let remedy = "gmsh takes points closer than 1e-7 m for one: give lengths in metres, cells above 1e-5";
            return Err(vec![Defect::new("the network", problem, remedy)]);
        }
        let (mut fractures, rejected) = clip_all(&domain, &sizes, given);
        let defects = overlaps(&domain, &fractures);
        if !defects.is_empty() {
            return Err(defects);
        }
        if sizes.snap {
            snap(&domain, &sizes, &mut fractures);
            // Ends that have moved may have grown onto a neighbour in the same plane.
            let defects = overlaps(&domain, &fractures);
            if !defects.is_empty() {
                return Err(defects);
            }
        }
        let intersections = intersections(&domain, &fractures);
        let arrangement = arrange(&domain, &sizes, &mut fractures, &intersections);
        let features = small_features(&domain, &sizes, &fractures, &intersections);
        Ok(Self {
            domain,
            sizes,
            fractures,
            rejected,
            intersections,
            features,
            arrangement,
        })
    }

    /// Area of a fracture in the geometry (m^2).
    pub fn area(&self, fracture: usize) -> f64 {
        self.arrangement.sheets[fracture].area(&self.arrangement.points)
    }
}

fn clip_all(
    domain: &Domain,
    sizes: &CellSizes,
    given: Vec<InputFracture>,
) -> (Vec<NetworkFracture>, Vec<Rejected>) {
    let (mut fractures, mut rejected) = (Vec::new(), Vec::new());
    for given in given {
        match domain.clip_large(&given.polygon, sizes.gap()) {
            Ok(polygon) => fractures.push(NetworkFracture {
                name: given.name,
                set: given.set,
                place: given.place,
                area_given: given.polygon.area(),
                polygon,
                changes: Vec::new(),
                farthest_move: 0.0,
            }),
            Err(reason) => rejected.push(Rejected {
                name: given.name,
                set: given.set,
                reason,
            }),
        }
    }
    (fractures, rejected)
}

pub(crate) fn intersections(
    domain: &Domain,
    fractures: &[NetworkFracture],
) -> Vec<([usize; 2], Intersection)> {
    let tolerance = domain.tolerance();
    let pairs = close_pairs(fractures, tolerance).into_iter();
    pairs
        .filter_map(|[a, b]| {
            let shared = intersection(&fractures[a].polygon, &fractures[b].polygon, tolerance)?;
            Some(([a, b], shared))
        })
        .collect()
}

/// Cuts fractures and faces of the domain where they meet; if corners are snapped, edges far too
/// short for the cells go, and the fractures whose outlines move for it are told.
fn arrange(
    domain: &Domain,
    sizes: &CellSizes,
    fractures: &mut [NetworkFracture],
    intersections: &[([usize; 2], Intersection)],
) -> Arrangement {
    let polygons: Vec<&Polygon> = fractures.iter().map(|one| &one.polygon).collect();
    let coplanar = coplanar_neighbours(domain, fractures);
    let mut arrangement = Arrangement::of(domain, &polygons, intersections, &coplanar);
    if !sizes.snap {
        return arrangement;
    }
    for Moved { sheet, by, onto } in collapse(&mut arrangement, sizes.short(), domain.tolerance()) {
        // Faces of the domain do not change.
        if sheet >= fractures.len() {
            continue;
        }
        let name = |other: &usize| match fractures.get(*other) {
            Some(fracture) => format!("`{}`", fracture.name),
            None => format!("the face `{}`", FACES[other - fractures.len()].0),
        };
        let onto: Vec<String> = onto.iter().map(name).collect();
        let text = format!(
            "its outline was moved by {by:.3e} m at {}",
            onto.join(" and ")
        );
        fractures[sheet].changes.push(text);
        fractures[sheet].farthest_move = fractures[sheet].farthest_move.max(by);
    }
    arrangement
}

/// Pairs of fractures side by side in one plane.
pub(crate) fn coplanar_neighbours(
    domain: &Domain,
    fractures: &[NetworkFracture],
) -> Vec<[usize; 2]> {
    let tolerance = domain.tolerance();
    let pairs = close_pairs(fractures, tolerance).into_iter();
    let is_flat = |a: &Polygon, b: &Polygon| {
        let mut corners = b.corners().iter();
        corners.all(|&corner| a.height(corner).abs() <= tolerance)
    };
    pairs
        .filter(|[a, b]| is_flat(&fractures[*a].polygon, &fractures[*b].polygon))
        .collect()
}

/// Fractures that lie on top of each other: no mesh can tell whose a facet is.
fn overlaps(domain: &Domain, fractures: &[NetworkFracture]) -> Vec<Defect> {
    let flat = 1e-5 * domain.diagonal();
    let overlapping = close_pairs(fractures, flat)
        .into_iter()
        .filter_map(|[a, b]| {
            let area = overlap_area(&fractures[a].polygon, &fractures[b].polygon, flat)?;
            let (first, second) = (&fractures[a], &fractures[b]);
            Some(Defect::new(
                format!("{}, fracture `{}`", second.place, second.name),
                format!(
                    "it overlaps fracture `{}` ({}) in one plane, over {area:.3e} m2",
                    first.name, first.place
                ),
                "remove one, cut the overlap from one, or turn or shift it out of the plane",
            ))
        });
    overlapping.collect()
}

/// The area that two polygons share if they are in one plane within `flat` (m).
fn overlap_area(a: &Polygon, b: &Polygon, flat: f64) -> Option<f64> {
    if angle_between(a, b) > 1.0 {
        return None;
    }
    let mut shared = a.clone();
    for [from, to] in b.edges() {
        let inwards = b.normal().cross(to - from).normalize_or_zero();
        shared = half(&shared, from, inwards)?;
    }
    let is_flat = shared
        .corners()
        .iter()
        .all(|&corner| b.height(corner).abs() < flat);
    let area = shared.area();
    (is_flat && area > flat * flat).then_some(area)
}

/// The part of a polygon on the side of a plane that `inwards` points to.
fn half(polygon: &Polygon, point: DVec3, inwards: DVec3) -> Option<Polygon> {
    let depth = |corner: DVec3| (corner - point).dot(inwards);
    let mut corners = Vec::new();
    for [a, b] in polygon.edges() {
        let (from, to) = (depth(a), depth(b));
        if from >= 0.0 {
            corners.push(a);
        }
        if from * to < 0.0 {
            corners.push(a + (b - a) * (from / (from - to)));
        }
    }
    let (low, high) = polygon.bounds();
    crate::clip::drop_doubles(&mut corners, 1e-9 * low.distance(high));
    Polygon::new(corners, polygon.normal())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::{DOMAIN, SIZES, input};

    fn level(name: &str, [x, y, z]: [f64; 3], side: f64) -> InputFracture {
        let (a, b) = (x + side, y + side);
        input(name, &[[x, y, z], [a, y, z], [a, b, z], [x, b, z]])
    }

    #[test]
    fn every_fracture_is_in_the_network_or_named_with_a_reason() {
        let list = vec![
            level("in", [1.0, 1.0, 5.0], 2.0),
            level("out", [20.0, 1.0, 5.0], 2.0),
            level("lid", [1.0, 1.0, 10.0], 2.0),
            level("crumb", [9.9, 9.9, 5.0], 2.0),
            level("cut", [9.0, 1.0, 5.0], 2.0),
        ];
        let network = Network::build(DOMAIN, SIZES, list).expect("a network");
        let names: Vec<&str> = network.fractures.iter().map(|f| f.name.as_str()).collect();
        assert_eq!(names, ["in", "cut"]);
        assert!((network.fractures[1].polygon.area() - 2.0).abs() < 1e-12);
        let reasons: Vec<&str> = network
            .rejected
            .iter()
            .map(|one| one.reason.as_str())
            .collect();
        assert!(reasons[0].contains("outside the domain"));
        assert!(reasons[1].contains("`top`"));
        assert!(reasons[2].contains("too small"), "{}", reasons[2]);
    }

    #[test]
    fn overlap_in_a_plane_is_refused_by_name() {
        let list = vec![
            level("a", [1.0, 1.0, 5.0], 2.0),
            level("b", [2.0, 2.0, 5.0], 2.0),
        ];
        let defects = Network::build(DOMAIN, SIZES, list).expect_err("refused");
        let text = defects[0].to_string();
        assert!(
            text.contains("`a`") && text.contains("`b`") && text.contains("1.000e0 m2"),
            "{text}"
        );
    }

    #[test]
    fn cells_below_the_tolerance_of_the_kernel_are_refused() {
        let sizes = CellSizes {
            h_intersection: 1e-6,
            ..SIZES
        };
        let defects = Network::build(DOMAIN, sizes, Vec::new()).expect_err("refused");
        assert!(defects[0].remedy.contains("1e-7"));
    }

    #[test]
    fn neighbours_in_a_plane_are_no_overlap() {
        let list = vec![
            level("a", [1.0, 1.0, 5.0], 2.0),
            level("b", [3.0, 1.0, 5.0], 2.0),
        ];
        assert!(Network::build(DOMAIN, SIZES, list).is_ok());
    }
}
