//! Who prescribes displacements of which points, and along which directions.

use std::collections::BTreeMap;

use glam::DVec3;
use kluft_mesh::{Mesh, facet_area_vector};

use crate::problem::{HeldPart, Problem, Support, VaryingDisplacement};
use crate::space::sector_nodes::SectorNodes;

/// Facets whose normals differ by less than 30 degrees count as one smooth face for `symmetry`.
const SMOOTH_COSINE: f64 = 0.866;
/// Who holds the points of a mesh of the plane.
const PLANE: &str = "plane strain";

/// One prescribed direction of a point, and who prescribes it.
pub(super) struct Demand<'a> {
    pub(super) direction: DVec3,
    /// Displacements along it (m) at load factor 1 other than 0, each behind its load case.
    pub(super) values: Vec<(usize, f64)>,
    /// Largest displacement along it (m) that its source prescribes anywhere in one load case: what
    /// rounding is small against.
    pub(super) scale: f64,
    pub(super) source: &'a str,
}

impl Demand<'_> {
    /// Displacement along it (m) at load factor 1 of a load case.
    pub(super) fn value(&self, case: usize) -> f64 {
        let own = self.values.iter().filter(|(of, _)| *of == case);
        own.fold(0.0, |sum, (_, value)| sum + value)
    }
}

/// What is asked of each point that anything holds, in the order of the problem.
pub(super) fn demands<'a>(
    problem: &'a Problem,
    points: &'a SectorNodes,
) -> BTreeMap<u32, Vec<Demand<'a>>> {
    let mut collected = Collected {
        problem,
        points,
        of_point: BTreeMap::new(),
    };
    if problem.mesh.is_plane() {
        collected.hold_plane();
    }
    for (index, condition) in problem.conditions.iter().enumerate() {
        match condition.support {
            Some(Support::Displacement(components)) => {
                collected.hold_components(index, components);
            }
            Some(Support::Symmetry) => collected.hold_normals(condition.boundary),
            None => {}
        }
    }
    for index in 0..problem.fixed_points.len() {
        collected.hold_node(index);
    }
    collected.of_point
}

struct Collected<'a> {
    problem: &'a Problem,
    points: &'a SectorNodes,
    of_point: BTreeMap<u32, Vec<Demand<'a>>>,
}

impl<'a> Collected<'a> {
    fn hold_plane(&mut self) {
        let wanted = Wanted {
            components: [None, None, Some(0.0)],
            case: 0,
            varying: Vec::new(),
            source: PLANE,
        };
        self.hold((0..self.points.len() as u32).collect(), &wanted);
    }

    fn hold_components(&mut self, index: usize, components: [Option<f64>; 3]) {
        let mesh = &self.problem.mesh;
        let boundary = &mesh.boundaries[self.problem.conditions[index].boundary];
        let wanted = Wanted {
            components,
            case: self.problem.schedule.cases.of_condition(index),
            varying: self.varying(HeldPart::Condition(index)),
            source: &boundary.name,
        };
        let of_slot = |&slot: &u32| self.points.of_cell_node[slot as usize];
        let mut on_face: Vec<u32> = boundary.slots.iter().map(of_slot).collect();
        on_face.sort_unstable();
        on_face.dedup();
        self.hold(on_face, &wanted);
    }

    fn hold_node(&mut self, index: usize) {
        let fixed = &self.problem.fixed_points[index];
        let wanted = Wanted {
            components: fixed.displacement,
            case: self.problem.schedule.cases.of_fixed_point(index),
            varying: self.varying(HeldPart::FixedPoint(index)),
            source: &fixed.name,
        };
        let points = self.points.of_node(fixed.node as usize);
        self.hold(points.map(|point| point as u32).collect(), &wanted);
    }

    fn varying(&self, held: HeldPart) -> Vec<&'a VaryingDisplacement> {
        let all = self.problem.varying.displacements.iter();
        all.filter(|own| own.held == held).collect()
    }

    fn hold(&mut self, on: Vec<u32>, wanted: &Wanted<'a>) {
        let nodes = &self.problem.mesh.nodes;
        let place = |point: u32| nodes[self.points.node[point as usize] as usize];
        let scales = wanted.scales(on.iter().map(|&point| place(point)));
        for point in on {
            let list = self.of_point.entry(point).or_default();
            list.extend(wanted.demands(place(point), scales));
        }
    }

    /// Facets of one smooth face share one direction at a point, their mean normal: the facets of a
    /// curved face would otherwise clamp it.
    fn hold_normals(&mut self, boundary: usize) {
        let mesh = &self.problem.mesh;
        let source = &mesh.boundaries[boundary].name;
        for (point, smooth) in smooth_faces(mesh, self.points, boundary) {
            let list = self.of_point.entry(point).or_default();
            list.extend(smooth.iter().map(|sum| Demand {
                direction: sum.normalize(),
                values: Vec::new(),
                scale: 0.0,
                source,
            }));
        }
    }
}

/// Area vectors (m^2) of the smooth faces of a boundary that meet in each point of it.
fn smooth_faces(mesh: &Mesh, points: &SectorNodes, boundary: usize) -> BTreeMap<u32, Vec<DVec3>> {
    let boundary = &mesh.boundaries[boundary];
    let mut faces: BTreeMap<u32, Vec<DVec3>> = BTreeMap::new();
    for facet in 0..boundary.elements.len() {
        let area = facet_area_vector(&mesh.corners(&boundary.elements, facet));
        for &slot in &boundary.slots[boundary.elements.range(facet)] {
            let smooth = faces.entry(points.of_cell_node[slot as usize]).or_default();
            let own = smooth
                .iter_mut()
                .find(|sum| sum.normalize().dot(area.normalize()) > SMOOTH_COSINE);
            match own {
                Some(sum) => *sum += area,
                None => smooth.push(area),
            }
        }
    }
    faces
}

/// Components that one source prescribes.
struct Wanted<'a> {
    /// Displacements (m) along the axes, where they are prescribed.
    components: [Option<f64>; 3],
    /// The load case that scales them.
    case: usize,
    /// What is added to them.
    varying: Vec<&'a VaryingDisplacement>,
    source: &'a str,
}

impl<'a> Wanted<'a> {
    /// Largest displacement (m) along each axis in one load case over some places (m).
    fn scales(&self, places: impl Iterator<Item = DVec3> + Clone) -> [f64; 3] {
        let mut scales = self.components.map(|value| value.unwrap_or(0.0).abs());
        for own in &self.varying {
            let sizes = places.clone().map(|at| own.field.at(at, own.time).abs());
            scales[own.axis] = sizes.fold(scales[own.axis], f64::max);
        }
        scales
    }

    /// What is asked of a point at a place (m).
    fn demands(&self, place: DVec3, scales: [f64; 3]) -> impl Iterator<Item = Demand<'a>> {
        let axes = [DVec3::X, DVec3::Y, DVec3::Z].into_iter().enumerate();
        axes.filter_map(move |(axis, direction)| {
            let plain = [(self.case, self.components[axis]?)].into_iter();
            let own = self.varying.iter().filter(|own| own.axis == axis);
            let varying = own.map(|own| (own.case, own.field.at(place, own.time)));
            let values = plain.chain(varying).filter(|(_, value)| *value != 0.0);
            Some(Demand {
                direction,
                values: values.collect(),
                scale: scales[axis],
                source: self.source,
            })
        })
    }
}
