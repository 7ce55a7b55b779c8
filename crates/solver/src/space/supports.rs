//! Which points are held, in which directions, and where.
//!
//! A held point moves as `u = g + P v`: `P` projects on the directions left free and `g` is the
//! prescribed displacement along the others, `g = sum_c f_c g_c` over the load cases `c` with their
//! factors `f_c`. Every sector of a node has its own `P`, so two blocks
//! that meet at an edge can be held differently, and a face that a fracture cuts is held on both
//! sides.

use std::collections::BTreeMap;

use glam::{DMat3, DVec3};
use kluft_mesh::{Defect, Mesh};

use crate::problem::{Load, Problem};
use crate::space::demands::{Demand, demands};
use crate::space::sector_nodes::SectorNodes;

/// Directions closer than this to the span of others (sine of the angle) count as dependent.
const DEPENDENT: f64 = 1e-4;
/// Prescribed values of one direction that differ by more than this share contradict each other.
const CONTRADICTION: f64 = 1e-9;

/// How a held point may move.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Constraint {
    /// Projector on the free directions, `P`.
    pub free: DMat3,
    /// Prescribed displacement at load factor 1, `g_c` (m), of each load case that prescribes any
    /// but 0.
    pub prescribed: Vec<(usize, DVec3)>,
}

/// The constraints of all points.
#[derive(Debug, Clone)]
pub struct Supports {
    index: Vec<u32>,
    constraints: Vec<Constraint>,
    /// Number of scalar unknowns that the supports remove.
    pub(crate) held_directions: usize,
}

const UNHELD: u32 = u32::MAX;

impl Supports {
    /// Collects the supports of a problem.
    ///
    /// # Errors
    /// Conditions that prescribe different displacements for one point, each with the node and the
    /// conditions' names.
    pub fn of(problem: &Problem, points: &SectorNodes) -> Result<Self, Vec<Defect>> {
        Self::resolve(&problem.mesh, points, &demands(problem, points))
    }

    fn resolve(
        mesh: &Mesh,
        points: &SectorNodes,
        demands: &BTreeMap<u32, Vec<Demand<'_>>>,
    ) -> Result<Self, Vec<Defect>> {
        let mut supports = Self {
            index: vec![UNHELD; points.len()],
            constraints: Vec::new(),
            held_directions: 0,
        };
        let mut defects = Vec::new();
        for (&point, list) in demands {
            let tag = mesh.node_tags[points.node[point as usize] as usize];
            match constraint(list) {
                Ok((constraint, directions)) => {
                    supports.index[point as usize] = supports.constraints.len() as u32;
                    supports.constraints.push(constraint);
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

    /// The constraint of a point, if it is held at all.
    pub fn constraint(&self, point: usize) -> Option<&Constraint> {
        self.constraints.get(self.index[point] as usize)
    }

    /// `P f`: the part of a force that can do work at a point.
    pub fn project(&self, point: usize, force: DVec3) -> DVec3 {
        self.constraint(point)
            .map_or(force, |constraint| constraint.free * force)
    }

    /// `P K` for a block row, `K P` being its transpose.
    pub fn project_block(&self, row: usize, column: usize, block: DMat3) -> DMat3 {
        let left = self
            .constraint(row)
            .map_or(block, |constraint| constraint.free * block);
        self.constraint(column)
            .map_or(left, |constraint| left * constraint.free)
    }

    /// Displacement of a point: `g + P v`, with `g` as `load` has it.
    pub fn apply(&self, point: usize, displacement: DVec3, load: &Load) -> DVec3 {
        self.constraint(point).map_or(displacement, |constraint| {
            let prescribed = constraint.prescribed.iter();
            let prescribed: DVec3 = prescribed.map(|(case, g)| load.factor(*case) * *g).sum();
            constraint.free * displacement + prescribed
        })
    }

    /// Whether a load case prescribes displacements other than zero.
    pub(crate) fn prescribe(&self, case: usize) -> bool {
        let mut constraints = self.constraints.iter();
        constraints.any(|constraint| constraint.prescribed.iter().any(|(of, _)| *of == case))
    }

    /// Prescribed displacement of a point at load factor 1 of a case (m); zero where nothing is
    /// prescribed.
    pub fn prescribed(&self, point: usize, case: usize) -> DVec3 {
        let prescribed = self
            .constraint(point)
            .map_or(&[][..], |constraint| &constraint.prescribed);
        let own = prescribed.iter().find(|(of, _)| *of == case);
        own.map_or(DVec3::ZERO, |(_, displacement)| *displacement)
    }
}

/// Two demands that contradict each other.
type Contradiction<'a> = (&'a Demand<'a>, &'a Demand<'a>);

/// Constraint that meets all demands, and the number of directions it takes.
fn constraint<'a>(demands: &'a [Demand<'a>]) -> Result<(Constraint, usize), Contradiction<'a>> {
    let values = demands.iter().flat_map(|demand| &demand.values);
    let mut cases: Vec<usize> = values.map(|(case, _)| *case).collect();
    cases.sort_unstable();
    cases.dedup();
    let mut constraint = Constraint {
        free: DMat3::IDENTITY,
        prescribed: Vec::new(),
    };
    let basis = orthogonal(demands, cases.first().copied().unwrap_or(0))?;
    for (direction, _) in &basis {
        constraint.free -= DMat3::from_cols(
            *direction * direction.x,
            *direction * direction.y,
            *direction * direction.z,
        );
    }
    if basis.len() == 3 {
        constraint.free = DMat3::ZERO;
    }
    for case in cases {
        let basis = orthogonal(demands, case)?.into_iter();
        let prescribed = basis.map(|(direction, value)| value * direction).sum();
        constraint.prescribed.push((case, prescribed));
    }
    Ok((constraint, basis.len()))
}

/// Orthogonalises the demands (Gram-Schmidt), with what they prescribe in one load case. The
/// directions are the same for all cases.
fn orthogonal<'a>(
    demands: &'a [Demand<'a>],
    case: usize,
) -> Result<Vec<(DVec3, f64)>, Contradiction<'a>> {
    let mut basis: Vec<(DVec3, f64)> = Vec::new();
    for demand in demands {
        let (mut direction, mut value) = (demand.direction, demand.value(case));
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
    Ok(basis)
}

fn largest(demands: &[Demand<'_>]) -> f64 {
    let scales = demands.iter().map(|demand| demand.scale);
    scales.fold(0.0, f64::max)
}

fn contradiction(tag: u64, first: &Demand<'_>, second: &Demand<'_>) -> Defect {
    Defect::new(
        format!("node {tag}"),
        format!(
            "`{}` and `{}` prescribe different displacements along ({:.3}, {:.3}, {:.3})",
            first.source, second.source, second.direction.x, second.direction.y, second.direction.z
        ),
        "let only one of them name this component, or give both the same value and history",
    )
}
