//! From given fractures to a network that gmsh can mesh: clipped, mended, checked.

use glam::DVec3;
use kluft_defect::Defect;

use crate::clip::Domain;
use crate::intersections::{Intersection, angle_between, intersection, may_meet};
use crate::polygon::Polygon;
use crate::small_features::{Feature, small_features};
use crate::treat::treat;

/// A fracture as a list or a set gives it.
#[derive(Debug, Clone, PartialEq)]
pub struct Given {
    /// Its name, no other fracture's.
    pub name: String,
    /// The set it belongs to.
    pub set: String,
    /// File and line, or the set that drew it.
    pub place: String,
    /// The whole of it.
    pub polygon: Polygon,
}

/// A fracture of the network.
#[derive(Debug, Clone, PartialEq)]
pub struct Fracture {
    /// Its name.
    pub name: String,
    /// The set it belongs to.
    pub set: String,
    /// File and line, or the set that drew it.
    pub place: String,
    /// Area as given (m^2).
    pub area_given: f64,
    /// What is in the geometry.
    pub polygon: Polygon,
    /// What was changed besides clipping, one line a change.
    pub changes: Vec<String>,
}

/// A given fracture that is not in the network.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LeftOut {
    /// Its name.
    pub name: String,
    /// The set it belongs to.
    pub set: String,
    /// Why.
    pub reason: String,
}

/// Cell sizes, and what is too small for them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sizes {
    /// Cell size away from fractures (m).
    pub h: f64,
    /// Cell size on fractures (m).
    pub h_fracture: f64,
    /// Cell size on intersections of fractures (m).
    pub h_intersection: f64,
    /// Growth of the cell size per length away from fractures.
    pub growth: f64,
    /// Lengths below this part of the local cell size are too small.
    pub small: f64,
    /// Angles below this are too small (degrees).
    pub small_angle: f64,
    /// Whether features that are too small are mended where that is possible.
    pub mend: bool,
}

impl Sizes {
    /// Distances below this are too small (m).
    pub fn gap(&self) -> f64 {
        self.small * self.h_fracture
    }
}

/// OpenCASCADE takes points closer than 1e-7 m for one, whatever the size of the domain (m).
const FINEST: f64 = 1e-5;

/// A network ready for gmsh.
#[derive(Debug, Clone)]
pub struct Network {
    /// The rock.
    pub domain: Domain,
    /// Cell sizes.
    pub sizes: Sizes,
    /// The fractures.
    pub fractures: Vec<Fracture>,
    /// What was given and is not among them.
    pub left_out: Vec<LeftOut>,
    /// What pairs of fractures share: indices, ascending, and the segment.
    pub intersections: Vec<([usize; 2], Intersection)>,
    /// What is too small for the mesh and stays.
    pub features: Vec<Feature>,
}

impl Network {
    /// Clips the fractures to the domain, mends ends that nearly touch and lists what remains too
    /// small for the mesh.
    ///
    /// # Errors
    /// Fractures that overlap in one plane, by name; cells too fine for gmsh.
    pub fn build(domain: Domain, sizes: Sizes, given: Vec<Given>) -> Result<Self, Vec<Defect>> {
        if sizes.h_intersection < FINEST {
            let problem = format!("cells of {:e} m are asked for", sizes.h_intersection);
            let remedy = "gmsh takes points closer than 1e-7 m for one: give lengths in metres, cells above 1e-5";
            return Err(vec![Defect::new("the network", problem, remedy)]);
        }
        let (mut fractures, left_out) = clip_all(&domain, &sizes, given);
        let defects = overlaps(&domain, &fractures);
        if !defects.is_empty() {
            return Err(defects);
        }
        if sizes.mend {
            treat(&domain, &sizes, &mut fractures);
            // Ends that were mended may have grown onto a neighbour in the same plane.
            let defects = overlaps(&domain, &fractures);
            if !defects.is_empty() {
                return Err(defects);
            }
        }
        let intersections = intersections(&domain, &fractures);
        let features = small_features(&domain, &sizes, &fractures, &intersections);
        Ok(Self {
            domain,
            sizes,
            fractures,
            left_out,
            intersections,
            features,
        })
    }
}

/// Lengths that rounding may leave (m).
pub(crate) fn tolerance(domain: &Domain) -> f64 {
    1e-9 * domain.diagonal()
}

fn clip_all(domain: &Domain, sizes: &Sizes, given: Vec<Given>) -> (Vec<Fracture>, Vec<LeftOut>) {
    let (mut fractures, mut left_out) = (Vec::new(), Vec::new());
    for given in given {
        match clip_one(domain, sizes.gap(), &given.polygon) {
            Ok(polygon) => fractures.push(Fracture {
                name: given.name,
                set: given.set,
                place: given.place,
                area_given: given.polygon.area(),
                polygon,
                changes: Vec::new(),
            }),
            Err(reason) => left_out.push(LeftOut {
                name: given.name,
                set: given.set,
                reason,
            }),
        }
    }
    (fractures, left_out)
}

/// What is in the domain of a polygon, or why nothing is; a rest less than `gap` (m) across is
/// nothing.
pub(crate) fn clip_one(domain: &Domain, gap: f64, polygon: &Polygon) -> Result<Polygon, String> {
    let Some(clipped) = domain.clip(polygon) else {
        return Err("outside the domain".into());
    };
    if let Some(face) = domain.face_under(&clipped, 1e3 * tolerance(domain)) {
        let reason =
            format!("it lies on the face `{face}` of the domain, with rock on one side only");
        return Err(reason);
    }
    let (low, high) = clipped.bounds();
    if low.distance(high) < gap || clipped.area() < gap * gap {
        return Err(format!(
            "only {:.3e} m2 of it, {:.3e} m across, are inside the domain: too small for the cells",
            clipped.area(),
            low.distance(high)
        ));
    }
    Ok(clipped)
}

/// Pairs of fractures whose bounds come closer than `gap` (m), in ascending order.
pub(crate) fn close_pairs(fractures: &[Fracture], gap: f64) -> Vec<[usize; 2]> {
    let bounds: Vec<(DVec3, DVec3)> = fractures.iter().map(|f| f.polygon.bounds()).collect();
    let mut order: Vec<usize> = (0..fractures.len()).collect();
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

fn intersections(domain: &Domain, fractures: &[Fracture]) -> Vec<([usize; 2], Intersection)> {
    let tolerance = tolerance(domain);
    let pairs = close_pairs(fractures, tolerance).into_iter();
    pairs
        .filter_map(|[a, b]| {
            let shared = intersection(&fractures[a].polygon, &fractures[b].polygon, tolerance)?;
            Some(([a, b], shared))
        })
        .collect()
}

/// Fractures that lie on top of each other: no mesh can tell whose a facet is.
fn overlaps(domain: &Domain, fractures: &[Fracture]) -> Vec<Defect> {
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

    const DOMAIN: Domain = Domain {
        low: DVec3::ZERO,
        high: DVec3::splat(10.0),
    };
    const SIZES: Sizes = Sizes {
        h: 1.0,
        h_fracture: 1.0,
        h_intersection: 1.0,
        growth: 0.5,
        small: 0.2,
        small_angle: 10.0,
        mend: true,
    };

    fn given(name: &str, corners: &[[f64; 3]]) -> Given {
        let corners: Vec<DVec3> = corners.iter().map(|&corner| corner.into()).collect();
        Given {
            name: name.into(),
            set: "set".into(),
            place: format!("list.csv:{name}"),
            polygon: Polygon::through(&corners).expect("a polygon"),
        }
    }

    fn level(name: &str, [x, y, z]: [f64; 3], side: f64) -> Given {
        let (a, b) = (x + side, y + side);
        given(name, &[[x, y, z], [a, y, z], [a, b, z], [x, b, z]])
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
            .left_out
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
        let sizes = Sizes {
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
