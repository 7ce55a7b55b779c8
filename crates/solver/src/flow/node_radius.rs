//! The radius at which the pressure of a node that is fed stands around it.
//!
//! In even fractures through a node the pressure beside a borehole is `-Q / Theta ln r`, but not on
//! the facets at the node, which are linear. What its pressure is there tells the same flow on the
//! facets around it, as far as the fractures go on as planes through the node: the logarithm is
//! given on the outermost ring of nodes, and what it makes of the node is `-Q / Theta ln r_e`. With
//! every ring the error of `ln r_e` falls with the square of their number. One ring is
//!
//! ```text
//! ln r_e = sum_j (-K_ij / K_ii) ln r_j - Theta / K_ii
//! ```
//!
//! which takes the nodes beside to be where the logarithm says (Peaceman 1978).

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;
use kluft_algebra::{LinearFailure, Lists, ScalarCholesky, ScalarMatrix};
use kluft_mesh::{Mesh, facet_area_vector};

use super::conductance::Conductance;
use super::numbering::FlowNodes;

/// Most rings of nodes around a borehole.
const MOST_RINGS: usize = 16;
/// Sine of the largest angle between what counts as one plane, or one line.
const STRAIGHT: f64 = 1e-6;
/// Largest difference of transmissivities that count as one.
const EVEN: f64 = 1e-3;

/// The fractures through a node.
pub(super) struct Surroundings<'s> {
    mesh: &'s Mesh,
    nodes: &'s FlowNodes,
    conductance: &'s Conductance,
    /// The row of the node.
    row: usize,
    /// Transmissivity of each fracture at the node (m^3/(Pa s)).
    through: BTreeMap<u32, f64>,
}

impl<'s> Surroundings<'s> {
    /// Those of a row.
    pub(super) fn of(
        mesh: &'s Mesh,
        nodes: &'s FlowNodes,
        conductance: &'s Conductance,
        row: usize,
    ) -> Self {
        let facets = nodes.around.of(row).iter();
        let through = facets.map(|&facet| {
            let fracture = mesh.facets.fracture[nodes.facets[facet as usize] as usize];
            (fracture, conductance.transmissivity[facet as usize])
        });
        Self {
            through: through.collect(),
            mesh,
            nodes,
            conductance,
            row,
        }
    }

    /// `ln r_e` for the sum of angles times transmissivities at the node (m^3/(Pa s)).
    pub(super) fn logarithm(&self, theta: f64) -> f64 {
        let one = BTreeSet::from([self.row as u32]);
        let around = self.interior();
        let found = self.logarithm_within(&around, theta).ok();
        let found = found.filter(|logarithm| logarithm.is_finite());
        let one_ring = || self.logarithm_within(&one, theta).unwrap_or(f64::NAN);
        found.unwrap_or_else(one_ring)
    }

    fn place(&self, row: usize) -> DVec3 {
        self.mesh.nodes[self.nodes.node[row] as usize]
    }

    /// From the node to another (m).
    fn away(&self, row: usize) -> DVec3 {
        self.place(row) - self.place(self.row)
    }

    /// The node, and rings around it between which the fractures are even planes through it.
    fn interior(&self) -> BTreeSet<u32> {
        let mut interior = BTreeSet::from([self.row as u32]);
        let mut ring = self.beyond(&interior, &interior);
        for _ in 1..MOST_RINGS {
            let goes_on = ring.iter().all(|&row| self.goes_on(row as usize));
            if ring.is_empty() || !goes_on {
                break;
            }
            let next = &interior | &ring;
            ring = self.beyond(&next, &ring);
            interior = next;
        }
        interior
    }

    /// Nodes beside a ring that are not inside.
    fn beyond(&self, inside: &BTreeSet<u32>, ring: &BTreeSet<u32>) -> BTreeSet<u32> {
        let beside = ring
            .iter()
            .flat_map(|&row| self.nodes.columns.of(row as usize));
        beside
            .filter(|row| !inside.contains(row))
            .copied()
            .collect()
    }

    /// Whether the fractures around a node are those of the borehole, as even as there, in planes
    /// through it, and end nowhere but along a line through it.
    fn goes_on(&self, row: usize) -> bool {
        let facets = self.nodes.around.of(row);
        facets.iter().all(|&facet| self.is_alike(facet as usize)) && self.has_no_rim(row)
    }

    fn is_alike(&self, facet: usize) -> bool {
        let elements = &self.mesh.facets.elements;
        let index = self.nodes.facets[facet] as usize;
        let fracture = self.mesh.facets.fracture[index];
        let own = self.conductance.transmissivity[facet];
        let is_even = self
            .through
            .get(&fracture)
            .is_some_and(|through| (own - through).abs() <= EVEN * through);
        let corners = self.mesh.corners(elements, index);
        let normal = facet_area_vector(&corners).normalize_or_zero();
        let rows = self.nodes.corners.of(facet).iter();
        let mut ways = rows.map(|&row| self.away(row as usize));
        is_even && ways.all(|way| normal.dot(way).abs() <= STRAIGHT * way.length())
    }

    /// Whether every fracture goes on behind the edges at a node, but for edges in line with the
    /// borehole.
    fn has_no_rim(&self, row: usize) -> bool {
        let mut sides: BTreeMap<(u32, u32), usize> = BTreeMap::new();
        for &facet in self.nodes.around.of(row) {
            let corners = self.nodes.corners.of(facet as usize);
            let count = corners.len();
            let local = corners.iter().position(|&corner| corner as usize == row);
            let local = local.unwrap_or(0);
            let fracture = self.mesh.facets.fracture[self.nodes.facets[facet as usize] as usize];
            for beside in [local + 1, local + count - 1] {
                *sides
                    .entry((corners[beside % count], fracture))
                    .or_default() += 1;
            }
        }
        let own = self.away(row);
        let mut rims = sides.iter().filter(|(_, count)| **count == 1);
        rims.all(|((other, _), _)| {
            let other = self.away(*other as usize);
            own.cross(other).length() <= STRAIGHT * own.length() * other.length()
        })
    }

    /// `ln r_e` by the flow inside of the ring around some rows.
    fn logarithm_within(&self, interior: &BTreeSet<u32>, theta: f64) -> Result<f64, LinearFailure> {
        let rows: Vec<u32> = interior.iter().copied().collect();
        let mut lists = Vec::with_capacity(rows.len());
        let mut values = Vec::new();
        let mut rhs = vec![0.0; rows.len()];
        for (rhs, &row) in rhs.iter_mut().zip(&rows) {
            let mut columns = Vec::new();
            for (column, value) in self.conductance.matrix.row(row as usize) {
                match rows.binary_search(&(column as u32)) {
                    Ok(place) => {
                        columns.push(place as u32);
                        values.push(value);
                    }
                    Err(_) => *rhs += value * self.away(column).length().ln(),
                }
            }
            lists.push(columns);
        }
        let fed = rows.partition_point(|&row| (row as usize) < self.row);
        rhs[fed] += theta;
        let matrix = ScalarMatrix {
            pattern: Lists::collect(&lists),
            values,
        };
        let mut factor = ScalarCholesky::of(&matrix.pattern)?;
        factor.factorise(&matrix)?;
        Ok(-factor.solve(&rhs)[fed])
    }
}
