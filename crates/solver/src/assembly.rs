//! Parallel assembly of the stiffness of the rock.
//!
//! Every node gathers what the cells around it contribute to its own rows, in ascending order of
//! the cells. One thread owns one row, so there are no locks and no colours, and the values do not
//! depend on the number of threads.
//!
//! A row of a linear tetrahedron is computed where it is needed. Other cells cost more than their
//! matrices take to store and to read, so they are computed once, in waves that bound the memory.

use std::ops::Range;

use glam::{DMat3, DVec3};
use lie_core::enrichment::coefficient;
use lie_core::kernel::{self, MAX_NODES};
use lie_mesh::Shape;
use rayon::prelude::*;

use crate::matrix::BlockMatrix;
use crate::pattern::Pattern;
use crate::points::Points;
use crate::problem::Problem;
use crate::supports::Supports;

/// Nodes that one task assembles; small enough to balance, large enough to amortise.
const NODES_PER_TASK: usize = 256;
/// Blocks of cells that are kept at a time (16 MB), unless that makes more than [`MOST_WAVES`].
const BLOCKS_PER_WAVE: usize = 1 << 18;
/// Every wave looks at all nodes.
const MOST_WAVES: usize = 32;

/// What assembly works from.
#[derive(Clone, Copy)]
pub(crate) struct Frame<'a> {
    pub(crate) problem: &'a Problem,
    pub(crate) points: &'a Points,
    pub(crate) supports: &'a Supports,
    pub(crate) pattern: &'a Pattern,
}

impl Frame<'_> {
    /// Positions of the nodes of a cell (m), in the front of `positions`.
    pub(crate) fn positions<'p>(
        &self,
        cell: usize,
        positions: &'p mut [DVec3; MAX_NODES],
    ) -> &'p [DVec3] {
        let mesh = &self.problem.mesh;
        let nodes = mesh.cells.nodes_of(cell);
        for (position, &node) in positions.iter_mut().zip(nodes) {
            *position = mesh.nodes[node as usize];
        }
        &positions[..nodes.len()]
    }

    /// Slots of a node that lie in a range of slots.
    pub(crate) fn slots(&self, node: usize, within: &Range<usize>) -> &[u32] {
        let slots = self.pattern.slots.of(node);
        let start = slots.partition_point(|&slot| (slot as usize) < within.start);
        let end = slots.partition_point(|&slot| (slot as usize) < within.end);
        &slots[start..end]
    }
}

/// Stiffness of the rock over all unknowns, held directions included: there the diagonal keeps the
/// scale of the rock, so the matrix stays positive definite.
///
/// With `u = g + P T y` it is `T^T (P K P + s (I - P)) T`.
pub(crate) fn rock_stiffness(frame: Frame<'_>) -> BlockMatrix {
    // Zeroed in parallel: most of the time goes into the first touch of the memory.
    let mut blocks: Vec<DMat3> = (0..frame.pattern.columns.len())
        .into_par_iter()
        .map(|_| DMat3::ZERO)
        .collect();
    let mut shares = split_by_nodes(frame, &mut blocks);
    let mut rock = Rock::of(frame);
    for cells in rock.waves() {
        rock.compute(cells);
        shares.par_iter_mut().for_each_init(
            || vec![0; frame.problem.mesh.nodes.len()],
            |place, (nodes, rows)| rock.add_to_share(nodes.clone(), rows, place),
        );
    }
    BlockMatrix { blocks }
}

/// Cuts the blocks of the matrix into the shares of consecutive nodes.
fn split_by_nodes<'a>(
    frame: Frame<'_>,
    blocks: &'a mut [DMat3],
) -> Vec<(Range<usize>, &'a mut [DMat3])> {
    let node_count = frame.problem.mesh.nodes.len();
    let mut rest = blocks;
    let mut shares = Vec::new();
    for start in (0..node_count).step_by(NODES_PER_TASK) {
        let end = (start + NODES_PER_TASK).min(node_count);
        let rows = frame.points.offset[start] as usize..frame.points.offset[end] as usize;
        let length = frame.pattern.row_offset[rows.end] - frame.pattern.row_offset[rows.start];
        let (share, tail) = rest.split_at_mut(length);
        shares.push((start..end, share));
        rest = tail;
    }
    shares
}

/// Source of the rows of cells, for the cells of one wave.
struct Rock<'a> {
    frame: Frame<'a>,
    /// Lamé's constants of each rock (Pa).
    lame: Vec<(f64, f64)>,
    /// Whether a node has one sector and no hold: its point is its unknown.
    is_plain: Vec<bool>,
    /// Blocks of the largest matrix of a cell that is not a linear tetrahedron.
    stride: usize,
    cells: Range<usize>,
    slots: Range<usize>,
    /// Matrices of `cells`, `stride` blocks each.
    matrices: Vec<DMat3>,
}

impl<'a> Rock<'a> {
    fn of(frame: Frame<'a>) -> Self {
        let Frame { points, .. } = frame;
        let shapes = frame.problem.mesh.cells.shapes.par_iter();
        let stored = shapes.filter(|&&shape| shape != Shape::Tet4);
        let is_plain = |node: usize| {
            let mut own = points.of_node(node);
            own.len() == 1 && own.all(|point| frame.supports.hold(point).is_none())
        };
        Self {
            frame,
            lame: frame.problem.rocks.iter().map(|rock| rock.lame()).collect(),
            is_plain: (0..frame.problem.mesh.nodes.len())
                .into_par_iter()
                .map(is_plain)
                .collect(),
            stride: stored.map(|s| s.node_count().pow(2)).max().unwrap_or(0),
            cells: 0..0,
            slots: 0..0,
            matrices: Vec::new(),
        }
    }

    fn waves(&self) -> Vec<Range<usize>> {
        let count = self.frame.problem.mesh.cells.len();
        let by_memory = BLOCKS_PER_WAVE.checked_div(self.stride).unwrap_or(count);
        let length = by_memory.max(count.div_ceil(MOST_WAVES)).max(1);
        let waves = (0..count).step_by(length);
        waves
            .map(|start| start..(start + length).min(count))
            .collect()
    }

    /// Turns to the wave `cells`.
    fn compute(&mut self, cells: Range<usize>) {
        let Frame { problem, .. } = self.frame;
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
                let positions = self.frame.positions(cell, &mut positions);
                let matrix = &mut matrix[..positions.len().pow(2)];
                kernel::stiffness(shape, positions, problem.rock(cell), matrix);
            }
        });
    }

    /// Row `local` of the stiffness of a cell; `tetrahedron` is room for it.
    fn row<'r>(
        &'r self,
        cell: usize,
        local: usize,
        tetrahedron: &'r mut [DMat3; 4],
    ) -> &'r [DMat3] {
        let Frame { problem, .. } = self.frame;
        let nodes = problem.mesh.cells.nodes_of(cell);
        if problem.mesh.cells.shapes[cell] != Shape::Tet4 {
            let start = self.stride * (cell - self.cells.start) + local * nodes.len();
            return &self.matrices[start..start + nodes.len()];
        }
        let positions = [0, 1, 2, 3].map(|b| problem.mesh.nodes[nodes[b] as usize]);
        let lame = self.lame[problem.rock_of_cell[cell] as usize];
        kernel::tetrahedron_row(&positions, lame, local, tetrahedron);
        tetrahedron
    }

    /// Adds what the cells of the wave contribute to the rows of consecutive nodes. `place` is room
    /// for a number a node.
    fn add_to_share(&self, nodes: Range<usize>, rows: &mut [DMat3], place: &mut [u32]) {
        let Frame {
            points, pattern, ..
        } = self.frame;
        let mut rest = rows;
        for node in nodes {
            let neighbours = pattern.neighbours.of(node);
            let mut length = 0;
            for &other in neighbours {
                place[other as usize] = length;
                length += points.of_node(other as usize).len() as u32;
            }
            let own = points.of_node(node);
            let (rows, tail) = rest.split_at_mut(own.len() * length as usize);
            rest = tail;
            if neighbours
                .iter()
                .all(|&other| self.is_plain[other as usize])
            {
                self.add_plain(node, rows, place);
            } else {
                self.add_general(own, node, rows, place);
            }
        }
    }

    /// The row of a node whose neighbours, like itself, have one sector and no hold.
    fn add_plain(&self, node: usize, row: &mut [DMat3], place: &[u32]) {
        let cells = &self.frame.problem.mesh.cells;
        let mut tetrahedron = [DMat3::ZERO; 4];
        for &slot in self.frame.slots(node, &self.slots) {
            let cell = self.frame.pattern.cell_of_slot[slot as usize] as usize;
            let range = cells.range(cell);
            let blocks = self.row(cell, slot as usize - range.start, &mut tetrahedron);
            for (block, &other) in blocks.iter().zip(&cells.nodes[range]) {
                row[place[other as usize] as usize] += *block;
            }
        }
    }

    /// The rows of any node, row after row of equal length.
    fn add_general(&self, own: Range<usize>, node: usize, rows: &mut [DMat3], place: &[u32]) {
        let Frame {
            points, supports, ..
        } = self.frame;
        let cells = &self.frame.problem.mesh.cells;
        let mut tetrahedron = [DMat3::ZERO; 4];
        for &slot in self.frame.slots(node, &self.slots) {
            let cell = self.frame.pattern.cell_of_slot[slot as usize] as usize;
            let range = cells.range(cell);
            let local = slot as usize - range.start;
            let blocks = self.row(cell, local, &mut tetrahedron);
            let point = points.of_cell_node[slot as usize] as usize;
            let target = Target {
                points,
                point,
                own: own.clone(),
            };
            for (block, other_slot) in blocks.iter().zip(range.clone()) {
                let other = points.of_cell_node[other_slot] as usize;
                let start = place[cells.nodes[other_slot] as usize] as usize;
                let block = supports.project_block(point, other, *block);
                target.scatter(other, block, start, rows);
            }
            if let Some(hold) = supports.hold(point) {
                let scale = trace(blocks[local]) / 3.0;
                let block = scale * (DMat3::IDENTITY - hold.free);
                target.scatter(point, block, place[node] as usize, rows);
            }
        }
    }
}

/// A point whose block row is spread over the rows of its node's unknowns `own`.
struct Target<'a> {
    points: &'a Points,
    point: usize,
    own: Range<usize>,
}

impl Target<'_> {
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

fn trace(block: DMat3) -> f64 {
    block.x_axis.x + block.y_axis.y + block.z_axis.z
}
