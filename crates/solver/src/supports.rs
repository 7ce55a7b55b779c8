//! Which points are held, in which directions, and where.
//!
//! A held point moves as `u = g + P v`: `P` projects on the directions left free and `g` is the
//! prescribed displacement along the others. Every sector of a node has its own `P`, so two blocks
//! that meet at an edge can be held differently, and a face that a fracture cuts is held on both
//! sides.

use std::collections::BTreeMap;

use glam::{DMat3, DVec3};
use lie_mesh::{Defect, Mesh, facet_area_vector};

use crate::points::Points;
use crate::problem::{Problem, Support};

/// Directions closer than this to the span of others (sine of the angle) count as dependent.
const DEPENDENT: f64 = 1e-4;
/// Facets whose normals differ by less than 30 degrees count as one smooth face for `symmetry`.
const SMOOTH_COSINE: f64 = 0.866;
/// Prescribed values of one direction that differ by more than this share contradict each other.
const CONTRADICTION: f64 = 1e-9;

/// How a held point may move.
#[derive(Debug, Clone, Copy)]
pub struct Hold {
    /// Projector on the free directions, `P`.
    pub free: DMat3,
    /// Prescribed displacement at load factor 1, `g` (m).
    pub prescribed: DVec3,
}

/// The holds of all points.
#[derive(Debug, Clone)]
pub struct Supports {
    index: Vec<u32>,
    holds: Vec<Hold>,
    /// Number of scalar unknowns that the supports remove.
    pub held_directions: usize,
}

/// One prescribed direction of a point, and who prescribes it.
struct Demand<'a> {
    direction: DVec3,
    value: f64,
    source: &'a str,
}

const UNHELD: u32 = u32::MAX;

impl Supports {
    /// Collects the supports of a problem.
    ///
    /// # Errors
    /// Conditions that prescribe different displacements for one point, each with the node and the
    /// conditions' names.
    pub fn of(problem: &Problem, points: &Points) -> Result<Self, Vec<Defect>> {
        let mesh = &problem.mesh;
        let mut demands: BTreeMap<u32, Vec<Demand<'_>>> = BTreeMap::new();
        for condition in &problem.conditions {
            match condition.support {
                Some(Support::Displacement(components)) => {
                    demand_components(mesh, points, condition.boundary, components, &mut demands);
                }
                Some(Support::Symmetry) => {
                    demand_symmetry(mesh, points, condition.boundary, &mut demands);
                }
                None => {}
            }
        }
        for fixed in &problem.fixed_points {
            for point in points.of_node(fixed.node as usize) {
                let list = demands.entry(point as u32).or_default();
                list.extend(components(fixed.displacement, &fixed.name));
            }
        }
        Self::resolve(mesh, points, &demands)
    }

    fn resolve(
        mesh: &Mesh,
        points: &Points,
        demands: &BTreeMap<u32, Vec<Demand<'_>>>,
    ) -> Result<Self, Vec<Defect>> {
        let mut supports = Self {
            index: vec![UNHELD; points.len()],
            holds: Vec::new(),
            held_directions: 0,
        };
        let mut defects = Vec::new();
        for (&point, list) in demands {
            let tag = mesh.node_tags[points.node[point as usize] as usize];
            match hold(list) {
                Ok((hold, directions)) => {
                    supports.index[point as usize] = supports.holds.len() as u32;
                    supports.holds.push(hold);
                    supports.held_directions += directions;
                }
                Err((first, second)) => defects.push(contradiction(tag, first, second)),
            }
        }
        // One contradiction along a shared edge repeats at each of its nodes.
        defects.dedup_by(|a: &mut Defect, b| a.problem == b.problem);
        if defects.is_empty() {
            Ok(supports)
        } else {
            Err(defects)
        }
    }

    /// The hold of a point, if it is held at all.
    pub fn hold(&self, point: usize) -> Option<&Hold> {
        self.holds.get(self.index[point] as usize)
    }

    /// `P f`: the part of a force that can do work at a point.
    pub fn project(&self, point: usize, force: DVec3) -> DVec3 {
        self.hold(point).map_or(force, |hold| hold.free * force)
    }

    /// `P K` for a block row, `K P` being its transpose.
    pub fn project_block(&self, row: usize, column: usize, block: DMat3) -> DMat3 {
        let left = self.hold(row).map_or(block, |hold| hold.free * block);
        self.hold(column).map_or(left, |hold| left * hold.free)
    }

    /// Displacement of a point: `g + P v`, with prescribed values scaled by `factor`.
    pub fn apply(&self, point: usize, displacement: DVec3, factor: f64) -> DVec3 {
        self.hold(point).map_or(displacement, |hold| {
            hold.free * displacement + factor * hold.prescribed
        })
    }

    /// Prescribed displacement of a point at load factor 1 (m); zero where nothing is prescribed.
    pub fn prescribed(&self, point: usize) -> DVec3 {
        self.hold(point).map_or(DVec3::ZERO, |hold| hold.prescribed)
    }
}

fn components(values: [Option<f64>; 3], source: &str) -> impl Iterator<Item = Demand<'_>> {
    let named = [DVec3::X, DVec3::Y, DVec3::Z].into_iter().zip(values);
    named.filter_map(move |(direction, value)| {
        value.map(|value| Demand {
            direction,
            value,
            source,
        })
    })
}

fn demand_components<'a>(
    mesh: &'a Mesh,
    points: &Points,
    boundary: usize,
    values: [Option<f64>; 3],
    demands: &mut BTreeMap<u32, Vec<Demand<'a>>>,
) {
    let boundary = &mesh.boundaries[boundary];
    let mut on_face: Vec<u32> = boundary
        .slots
        .iter()
        .map(|&slot| points.of_cell_node[slot as usize])
        .collect();
    on_face.sort_unstable();
    on_face.dedup();
    for point in on_face {
        let list = demands.entry(point).or_default();
        list.extend(components(values, &boundary.name));
    }
}

/// Facets of one smooth face share one direction at a point, their mean normal: the facets of a
/// curved face would otherwise clamp it.
fn demand_symmetry<'a>(
    mesh: &'a Mesh,
    points: &Points,
    boundary: usize,
    demands: &mut BTreeMap<u32, Vec<Demand<'a>>>,
) {
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
    for (point, smooth) in faces {
        let list = demands.entry(point).or_default();
        list.extend(smooth.iter().map(|sum| Demand {
            direction: sum.normalize(),
            value: 0.0,
            source: &boundary.name,
        }));
    }
}

/// Orthogonalises the demands (Gram-Schmidt); fails with the two that contradict each other.
fn hold<'a>(demands: &'a [Demand<'a>]) -> Result<(Hold, usize), (&'a Demand<'a>, &'a Demand<'a>)> {
    let mut basis: Vec<(DVec3, f64)> = Vec::new();
    for demand in demands {
        let (mut direction, mut value) = (demand.direction, demand.value);
        for (held, at) in &basis {
            let share = demand.direction.dot(*held);
            direction -= share * *held;
            value -= share * at;
        }
        let rest = direction.length();
        if rest > DEPENDENT {
            basis.push((direction / rest, value / rest));
        } else if value.abs() > CONTRADICTION * largest(demands) {
            let other = demands
                .iter()
                .find(|other| other.direction.dot(demand.direction).abs() > DEPENDENT);
            return Err((other.unwrap_or(demand), demand));
        }
    }
    let mut hold = Hold {
        free: DMat3::IDENTITY,
        prescribed: DVec3::ZERO,
    };
    for (direction, value) in &basis {
        hold.free -= DMat3::from_cols(
            *direction * direction.x,
            *direction * direction.y,
            *direction * direction.z,
        );
        hold.prescribed += *value * *direction;
    }
    if basis.len() == 3 {
        hold.free = DMat3::ZERO;
    }
    Ok((hold, basis.len()))
}

fn largest(demands: &[Demand<'_>]) -> f64 {
    demands
        .iter()
        .map(|demand| demand.value.abs())
        .fold(0.0, f64::max)
}

fn contradiction(tag: u64, first: &Demand<'_>, second: &Demand<'_>) -> Defect {
    Defect::new(
        format!("node {tag}"),
        format!(
            "`{}` and `{}` prescribe different displacements along ({:.3}, {:.3}, {:.3})",
            first.source, second.source, second.direction.x, second.direction.y, second.direction.z
        ),
        "let only one of them name this component, or give both the same value",
    )
}
