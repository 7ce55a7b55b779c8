//! Rows of the rock's stiffness from the matrices of cells that are not linear tetrahedra.
//!
//! Such matrices cost more to compute than to store and to read, so they are computed once, in
//! waves that bound the memory.

use std::ops::Range;

use glam::{DMat3, DVec3};
use kluft_algebra::trace;
use kluft_mesh::Shape;
use lie_core::enrichment::coefficient;
use lie_core::kernel::{self, MAX_NODES};
use lie_core::{Elasticity, Rock};
use rayon::prelude::*;

use crate::assembly::node_blocks::NodeBlocks;
use crate::space::Space;
use crate::space::cell;
use crate::space::sector_nodes::SectorNodes;

/// Blocks of cells that are kept at a time, which take little memory, unless that makes more than
/// [`MOST_WAVES`].
const BLOCKS_PER_WAVE: usize = 1 << 18;
/// Nodes of a linear tetrahedron; no other cell has as many.
const TETRAHEDRON: usize = 4;
/// Every wave looks at all nodes.
const MOST_WAVES: usize = 32;

/// Source of the rows of cells, for the cells of one wave; nodes in linear tetrahedra only are
/// passed over.
pub(crate) struct CellMatrices<'a> {
    space: Space<'a>,
    elasticity: Vec<Elasticity<'a>>,
    is_wanted: &'a [bool],
    in_tetrahedra: &'a [bool],
    is_plain: &'a [bool],
    /// Blocks of the largest matrix of a cell that is not a linear tetrahedron.
    stride: usize,
    cells: Range<usize>,
    slots: Range<usize>,
    /// Matrices of `cells`, `stride` blocks each.
    matrices: Vec<DMat3>,
}

impl<'a> CellMatrices<'a> {
    pub(crate) fn of(
        space: Space<'a>,
        (is_wanted, in_tetrahedra): (&'a [bool], &'a [bool]),
        is_plain: &'a [bool],
    ) -> Self {
        let shapes = space.problem.mesh.cells.shapes.par_iter();
        let stored = shapes.filter(|&&shape| shape != Shape::Tet4);
        Self {
            space,
            elasticity: space.problem.rocks.iter().map(Rock::elasticity).collect(),
            is_wanted,
            in_tetrahedra,
            is_plain,
            stride: stored.map(|s| s.node_count().pow(2)).max().unwrap_or(0),
            cells: 0..0,
            slots: 0..0,
            matrices: Vec::new(),
        }
    }

    /// Cells of each wave.
    pub(crate) fn waves(&self) -> Vec<Range<usize>> {
        if self.in_tetrahedra.iter().all(|&alone| alone) {
            return Vec::new();
        }
        let count = self.space.problem.mesh.cells.len();
        let by_memory = BLOCKS_PER_WAVE.checked_div(self.stride).unwrap_or(count);
        let length = by_memory.max(count.div_ceil(MOST_WAVES)).max(1);
        let waves = (0..count).step_by(length);
        waves
            .map(|start| start..(start + length).min(count))
            .collect()
    }

    /// Turns to the wave `cells`.
    pub(crate) fn compute(&mut self, cells: Range<usize>) {
        let Space { problem, .. } = self.space;
        let elements = &problem.mesh.cells;
        self.slots = elements.offsets[cells.start] as usize..elements.offsets[cells.end] as usize;
        self.cells = cells.clone();
        if self.stride == 0 {
            return;
        }
        let length = self.stride * cells.len();
        self.matrices.resize(length, DMat3::ZERO);
        let matrices = self.matrices.par_chunks_mut(self.stride);
        matrices.zip(cells).for_each(|(matrix, cell)| {
            let shape = elements.shapes[cell];
            if shape != Shape::Tet4 {
                let mut positions = [DVec3::ZERO; MAX_NODES];
                let positions = cell::positions(&problem.mesh, cell, &mut positions);
                let matrix = &mut matrix[..positions.len().pow(2)];
                kernel::stiffness(shape, positions, problem.rock(cell), matrix);
            }
        });
    }

    /// Row of a cell's stiffness; `tetrahedron` is room for it.
    fn row<'r>(&'r self, visit: &CellRow, tetrahedron: &'r mut [DMat3; 4]) -> &'r [DMat3] {
        let count = visit.count as usize;
        if count != TETRAHEDRON {
            let matrix = self.stride * (visit.cell as usize - self.cells.start);
            return &self.matrices[matrix + visit.local as usize * count..][..count];
        }
        let mesh = &self.space.problem.mesh;
        let positions = visit.nodes.map(|node| mesh.nodes[node as usize]);
        let elasticity = self.elasticity[visit.rock as usize];
        kernel::tetrahedron_row(&positions, elasticity, visit.local as usize, tetrahedron);
        tetrahedron
    }

    fn visit(&self, slot: u32) -> CellRow {
        let Space {
            problem, pattern, ..
        } = self.space;
        let cells = &problem.mesh.cells;
        let (cell, range) = pattern.cell_of_slot.locate(slot, cells);
        let mut nodes = [0; TETRAHEDRON];
        if range.len() == TETRAHEDRON {
            nodes.copy_from_slice(&cells.nodes[range.clone()]);
        }
        CellRow {
            cell: cell as u32,
            local: slot - range.start as u32,
            count: range.len() as u32,
            nodes,
            rock: match self.elasticity.len() {
                1 => 0,
                _ => problem.rock_of_cell[cell],
            },
        }
    }

    /// Adds what the cells of the wave contribute to the rows of consecutive nodes.
    pub(crate) fn add_to_share(&self, mut target: NodeBlocks<'_>, scratch: &mut RowScratch) {
        let Space {
            points, pattern, ..
        } = self.space;
        let RowScratch {
            place,
            visits,
            rows,
        } = scratch;
        // Apart from the sums, because the cells lie anywhere in memory: here nothing waits for
        // them.
        visits.clear();
        let is_served = |node: &usize| self.is_wanted[*node] && !self.in_tetrahedra[*node];
        for node in target.nodes().filter(is_served) {
            let slots = self.space.slots(node, &self.slots).iter();
            visits.extend(slots.map(|&slot| self.visit(slot)));
        }
        let mut visits = visits.as_slice();
        for node in target.nodes().filter(is_served) {
            let slots = self.space.slots(node, &self.slots);
            if slots.is_empty() {
                continue;
            }
            let (own, others) = visits.split_at(slots.len());
            visits = others;
            let (mut length, mut is_plain) = (0, true);
            for other in pattern.around(node, points) {
                place[other as usize] = length;
                length += points.of_node(other as usize).len() as u32;
                is_plain &= self.is_plain[other as usize];
            }
            rows.clear();
            rows.resize(points.of_node(node).len() * length as usize, DMat3::ZERO);
            if is_plain {
                self.add_plain(slots, own, rows, place);
            } else {
                self.add_general(node, slots, own, rows, place);
            }
            target.add(node, rows);
        }
    }

    /// The row of a node whose neighbours, like itself, have one sector and no constraint.
    fn add_plain(&self, slots: &[u32], visits: &[CellRow], row: &mut [DMat3], place: &[u32]) {
        let mut tetrahedron = [DMat3::ZERO; 4];
        for (&slot, visit) in slots.iter().zip(visits) {
            let blocks = self.row(visit, &mut tetrahedron);
            let first = (slot - visit.local) as usize;
            let nodes = match visit.count as usize {
                TETRAHEDRON => &visit.nodes,
                count => &self.space.problem.mesh.cells.nodes[first..first + count],
            };
            for (block, &other) in blocks.iter().zip(nodes) {
                row[place[other as usize] as usize] += *block;
            }
        }
    }

    /// The rows of any node, row after row of equal length.
    fn add_general(
        &self,
        node: usize,
        slots: &[u32],
        visits: &[CellRow],
        rows: &mut [DMat3],
        place: &[u32],
    ) {
        let Space {
            points, supports, ..
        } = self.space;
        let mut tetrahedron = [DMat3::ZERO; 4];
        for (&slot, visit) in slots.iter().zip(visits) {
            let blocks = self.row(visit, &mut tetrahedron);
            let point = points.of_cell_node[slot as usize] as usize;
            let target = TargetRows {
                points,
                point,
                own: points.of_node(node),
            };
            for (block, other_slot) in blocks.iter().zip((slot - visit.local) as usize..) {
                let other = points.of_cell_node[other_slot] as usize;
                let start = place[points.node[other] as usize] as usize;
                let block = supports.project_block(point, other, *block);
                target.scatter(other, block, start, rows);
            }
            if let Some(constraint) = supports.constraint(point) {
                let scale = trace(blocks[visit.local as usize]) / 3.0;
                let block = scale * (DMat3::IDENTITY - constraint.free);
                target.scatter(point, block, place[node] as usize, rows);
            }
        }
    }
}

/// One occurrence of a node in a cell.
struct CellRow {
    cell: u32,
    /// Number of the node within the cell.
    local: u32,
    /// Number of the cell's nodes.
    count: u32,
    /// Nodes of a linear tetrahedron.
    nodes: [u32; TETRAHEDRON],
    rock: u32,
}

/// Room that a thread uses again and again.
pub(crate) struct RowScratch {
    /// For the neighbours of a node, where their blocks start in its rows.
    place: Vec<u32>,
    visits: Vec<CellRow>,
    /// Rows of a node, those blocks included that are not stored.
    rows: Vec<DMat3>,
}

impl RowScratch {
    pub(crate) fn of(space: Space<'_>) -> Self {
        Self {
            place: vec![0; space.problem.mesh.nodes.len()],
            visits: Vec::new(),
            rows: Vec::new(),
        }
    }
}

/// A point whose block row is spread over the rows of its node's unknowns `own`.
struct TargetRows<'a> {
    points: &'a SectorNodes,
    point: usize,
    own: Range<usize>,
}

impl TargetRows<'_> {
    /// Adds a block between two points to the unknowns of their nodes, `K_kl += c_ik c_jl K_ij`;
    /// those of `other` stand at `start` in every row.
    fn scatter(&self, other: usize, block: DMat3, start: usize, rows: &mut [DMat3]) {
        let (sector, sectors) = self.points.sector(self.point);
        let (other_sector, other_sectors) = self.points.sector(other);
        let length = rows.len() / self.own.len();
        for k in 0..sectors {
            let row = &mut rows[k as usize * length..][start..];
            let weight = coefficient(sectors, sector, k);
            for l in 0..other_sectors {
                row[l as usize] += weight * coefficient(other_sectors, other_sector, l) * block;
            }
        }
    }
}
