//! Cells under several displacements at once, which share all that depends on places only.

use glam::DVec3;
use kluft_mesh::Shape;
use lie_core::kernel::{self, MAX_NODES};
use lie_core::{RulePoint, SymmetricStress};

use crate::problem::Problem;
use crate::space::cell::{StrainOffsets, components, positions};
use crate::space::sector_nodes::SectorNodes;
use crate::system::System;

/// Displacements of the points (m), and what strains cells beside them.
#[derive(Clone, Copy)]
pub struct Deformation<'a> {
    displacements: &'a [DVec3],
    offsets: Option<&'a StrainOffsets>,
}

impl<'a> Deformation<'a> {
    /// That of a state of a system.
    pub fn of(system: &'a System<'_>, displacements: &'a [DVec3]) -> Self {
        Self {
            displacements,
            offsets: Some(system.strain_offsets()),
        }
    }

    /// That of a [`dual_solution`](super::dual_solution).
    pub fn of_dual(displacements: &'a [DVec3]) -> Self {
        Self {
            displacements,
            offsets: None,
        }
    }
}

/// A mesh under `S` deformations, looked at cell by cell.
pub(super) struct DeformedCell<'a, const S: usize> {
    problem: &'a Problem,
    points: &'a SectorNodes,
    deformations: [Deformation<'a>; S],
    /// The cell that is looked at, if any is.
    cell: Option<usize>,
    count: usize,
    nodes: [DVec3; MAX_NODES],
    moved: [[DVec3; MAX_NODES]; S],
}

impl<'a, const S: usize> DeformedCell<'a, S> {
    pub(super) fn of(
        problem: &'a Problem,
        points: &'a SectorNodes,
        deformations: [Deformation<'a>; S],
    ) -> Self {
        Self {
            problem,
            points,
            deformations,
            cell: None,
            count: 0,
            nodes: [DVec3::ZERO; MAX_NODES],
            moved: [[DVec3::ZERO; MAX_NODES]; S],
        }
    }

    /// Looks at a cell; its shape.
    pub(super) fn look_at(&mut self, cell: usize) -> Shape {
        if self.cell != Some(cell) {
            self.cell = Some(cell);
            self.count = positions(&self.problem.mesh, cell, &mut self.nodes).len();
            let slots = self.problem.mesh.cells.range(cell);
            for (moved, of) in self.moved.iter_mut().zip(self.deformations) {
                for (moved, slot) in moved.iter_mut().zip(slots.clone()) {
                    *moved = of.displacements[self.points.of_cell_node[slot] as usize];
                }
                if let Some(offsets) = of.offsets {
                    offsets.add_to(moved, cell);
                }
            }
        }
        self.problem.mesh.cells.shapes[cell]
    }

    /// Nodes of the cell (m).
    pub(super) fn nodes(&self) -> &[DVec3] {
        &self.nodes[..self.count]
    }

    /// The first slot of the cell in the flat list of nodes.
    pub(super) fn first_slot(&self) -> usize {
        self.problem.mesh.cells.range(self.cell.unwrap_or(0)).start
    }

    /// Stresses (Pa) of the cell at one of its points, and the volume of that point (m^3).
    pub(super) fn stresses(&self, point: &RulePoint) -> ([SymmetricStress; S], f64) {
        let rock = self.problem.rock(self.cell.unwrap_or(0));
        let (inverse, volume) = kernel::inverse_jacobian(point, self.nodes());
        let stresses = self.moved.each_ref().map(|moved| {
            let gradient = kernel::gradient(point, inverse, &moved[..self.count]);
            components(rock.stress(gradient))
        });
        (stresses, volume)
    }
}
