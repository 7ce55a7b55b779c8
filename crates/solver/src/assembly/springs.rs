//! Springs on the outer surface: stiffness `int N_i N_j K dA` between the points of each facet.
//!
//! Springs act on few nodes, one facet after the other in the order of the mesh.

use glam::{DMat3, DVec3};
use kluft_algebra::{BlockMatrix, BlockPattern};
use lie_core::enrichment::coefficient;
use lie_core::{FacetQuadrature, facet_points};

use crate::problem::{Problem, Spring};
use crate::space::Space;
use crate::space::sector_nodes::SectorNodes;

/// A facet with springs.
pub(crate) struct SpringFacet {
    /// Point of each node.
    pub(crate) points: Vec<u32>,
    /// Stiffness between the nodes (N/m), row by row.
    pub(crate) stiffness: Vec<DMat3>,
}

impl SpringFacet {
    /// Forces of the springs on the nodes (N), where the displacement of all points is given (m).
    pub(crate) fn forces(&self, displacement: impl Fn(u32) -> DVec3) -> Vec<DVec3> {
        let moved: Vec<DVec3> = self
            .points
            .iter()
            .map(|&point| displacement(point))
            .collect();
        let rows = self.stiffness.chunks(self.points.len());
        let force = |row: &[DMat3]| -> DVec3 {
            row.iter()
                .zip(&moved)
                .map(|(block, u)| -(*block * *u))
                .sum()
        };
        rows.map(force).collect()
    }
}

/// The facets of all springs.
pub(crate) fn facets<'a>(
    problem: &'a Problem,
    points: &'a SectorNodes,
) -> impl Iterator<Item = SpringFacet> + 'a {
    problem.springs.iter().flat_map(move |spring| {
        let count = problem.mesh.boundaries[spring.boundary].elements.len();
        (0..count).map(move |facet| of_facet(problem, points, spring, facet))
    })
}

/// A facet of the boundary of a spring.
pub(crate) fn of_facet(
    problem: &Problem,
    points: &SectorNodes,
    spring: &Spring,
    facet: usize,
) -> SpringFacet {
    let mesh = &problem.mesh;
    let boundary = &mesh.boundaries[spring.boundary];
    let nodes = boundary.elements.nodes_of(facet).iter();
    let positions: Vec<DVec3> = nodes.map(|&node| mesh.nodes[node as usize]).collect();
    let (_, shear_modulus) = problem.rock(boundary.cell[facet] as usize).lame();
    let count = positions.len();
    let mut stiffness = vec![DMat3::ZERO; count * count];
    let shape = boundary.elements.shapes[facet];
    for point in facet_points(shape, &positions, FacetQuadrature::Gauss) {
        let area = point.area.length();
        let normal = point.area / area;
        let own = area * spring.stiffness.at(point.position, normal, shear_modulus);
        for &(a, at_a) in &point.nodes {
            for &(b, at_b) in &point.nodes {
                stiffness[a as usize * count + b as usize] += at_a * at_b * own;
            }
        }
    }
    let slots = &boundary.slots[boundary.elements.range(facet)];
    let of_slot = |&slot: &u32| points.of_cell_node[slot as usize];
    SpringFacet {
        points: slots.iter().map(of_slot).collect(),
        stiffness,
    }
}

/// Adds the stiffness of all springs to that of the rock: `T^T P K P T`. Rows without blocks in the
/// pattern of the matrix are left out.
pub(crate) fn add(space: Space<'_>, pattern: &BlockPattern, matrix: &mut BlockMatrix) {
    for facet in facets(space.problem, space.points) {
        let pairs = facet.points.iter().flat_map(|&a| {
            let others = facet.points.iter();
            others.map(move |&b| (a as usize, b as usize))
        });
        for ((a, b), block) in pairs.zip(&facet.stiffness) {
            let block = space.supports.project_block(a, b, *block);
            scatter(space.points, (a, b), block, (pattern, matrix));
        }
    }
}

/// Adds a block between two points to the unknowns of their nodes, `K_kl += c_ik c_jl K_ij`.
fn scatter(
    points: &SectorNodes,
    (a, b): (usize, usize),
    block: DMat3,
    (pattern, matrix): (&BlockPattern, &mut BlockMatrix),
) {
    let ((sector, sectors), (other, others)) = (points.sector(a), points.sector(b));
    let (first, other_first) = (a - sector as usize, b - other as usize);
    for k in 0..sectors {
        let row = first + k as usize;
        let columns = &pattern.columns[pattern.row(row)];
        if columns.is_empty() {
            return;
        }
        // The unknowns of one node stand side by side.
        let start = columns.partition_point(|&column| (column as usize) < other_first);
        let weight = coefficient(sectors, sector, k);
        for l in 0..others {
            if let Some(address) = pattern.address(row, start + l as usize) {
                matrix.blocks[address] += weight * coefficient(others, other, l) * block;
            }
        }
    }
}

/// Adds the forces (N) by which springs resist the prescribed displacements of a load case, `K g`,
/// to those on all points.
pub(crate) fn add_prescribed(space: Space<'_>, case: usize, forces: &mut [DVec3]) {
    for facet in facets(space.problem, space.points) {
        let own = facet.forces(|point| space.supports.prescribed(point as usize, case));
        for (&point, force) in facet.points.iter().zip(own) {
            forces[point as usize] -= force;
        }
    }
}
