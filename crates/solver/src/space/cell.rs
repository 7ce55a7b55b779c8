//! A cell with what moves it.

use std::collections::BTreeMap;

use glam::{DMat3, DVec3};
use kluft_mesh::{Mesh, Shape};
use lie_core::kernel::MAX_NODES;
use lie_core::{Rock, SymmetricStress};

use crate::problem::Problem;
use crate::space::sector_nodes::SectorNodes;

/// What strains cells beside the displacement of their points (m), node by node: of cells that were
/// added after their points had moved, and of cells at points that were several before.
#[derive(Debug, Clone, Default)]
pub(crate) struct StrainOffsets(pub(crate) BTreeMap<u32, Vec<DVec3>>);

impl StrainOffsets {
    /// Adds those of a cell to the displacements of its nodes (m).
    pub(crate) fn add_to(&self, moved: &mut [DVec3], cell: usize) {
        let own = self.0.get(&(cell as u32)).into_iter().flatten();
        for (moved, offset) in moved.iter_mut().zip(own) {
            *moved += *offset;
        }
    }
}

/// Nodes and displacements of one cell.
pub(crate) struct Cell<'a> {
    pub(crate) shape: Shape,
    pub(crate) rock: &'a Rock,
    count: usize,
    nodes: [DVec3; MAX_NODES],
    moved: [DVec3; MAX_NODES],
}

impl<'a> Cell<'a> {
    pub(crate) fn of(
        problem: &'a Problem,
        points: &SectorNodes,
        displacements: &[DVec3],
        cell: usize,
    ) -> Self {
        let mesh = &problem.mesh;
        let mut nodes = [DVec3::ZERO; MAX_NODES];
        let mut moved = [DVec3::ZERO; MAX_NODES];
        let count = positions(mesh, cell, &mut nodes).len();
        for (moved, slot) in moved.iter_mut().zip(mesh.cells.range(cell)) {
            *moved = displacements[points.of_cell_node[slot] as usize];
        }
        Self {
            shape: mesh.cells.shapes[cell],
            rock: problem.rock(cell),
            count,
            nodes,
            moved,
        }
    }

    /// The same, with the displacements that strain it.
    pub(crate) fn strained(mut self, offsets: &StrainOffsets, cell: usize) -> Self {
        offsets.add_to(&mut self.moved, cell);
        self
    }

    /// Places of the nodes (m).
    pub(crate) fn nodes(&self) -> &[DVec3] {
        &self.nodes[..self.count]
    }

    /// Displacements of the nodes (m).
    pub(crate) fn moved(&self) -> &[DVec3] {
        &self.moved[..self.count]
    }
}

/// Places of the nodes of a cell (m), in the front of `positions`.
pub(crate) fn positions<'p>(
    mesh: &Mesh,
    cell: usize,
    positions: &'p mut [DVec3; MAX_NODES],
) -> &'p [DVec3] {
    let nodes = mesh.cells.nodes_of(cell);
    for (position, &node) in positions.iter_mut().zip(nodes) {
        *position = mesh.nodes[node as usize];
    }
    &positions[..nodes.len()]
}

/// Components of a symmetric tensor.
pub(crate) fn components(s: DMat3) -> SymmetricStress {
    [
        s.x_axis.x, s.y_axis.y, s.z_axis.z, s.x_axis.y, s.y_axis.z, s.x_axis.z,
    ]
}
