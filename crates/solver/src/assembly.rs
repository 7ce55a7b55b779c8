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

use crate::cell;
use crate::matrix::BlockMatrix;
use crate::pattern::{self, Pattern};
use crate::points::Points;
use crate::problem::Problem;
use crate::supports::Supports;

/// Nodes that one task assembles; small enough to balance, large enough to amortise.
const NODES_PER_TASK: usize = 256;
/// Blocks of cells that are kept at a time (16 MB), unless that makes more than [`MOST_WAVES`].
const BLOCKS_PER_WAVE: usize = 1 << 18;
/// Nodes of a linear tetrahedron; no other cell has as many.
const TETRAHEDRON: usize = 4;
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
    let first_block: Vec<usize> = frame
        .points
        .offset
        .iter()
        .map(|&row| frame.pattern.row_offset[row as usize])
        .collect();
    let mut shares = pattern::split(&mut blocks, &first_block, NODES_PER_TASK);
    let mut rock = Rock::of(frame);
    for cells in rock.waves() {
        rock.compute(cells);
        shares.par_iter_mut().for_each_init(
            || Scratch::of(frame),
            |scratch, (nodes, rows)| rock.add_to_share(nodes.clone(), rows, scratch),
        );
    }
    BlockMatrix { blocks }
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
                let positions = cell::positions(&problem.mesh, cell, &mut positions);
                let matrix = &mut matrix[..positions.len().pow(2)];
                kernel::stiffness(shape, positions, problem.rock(cell), matrix);
            }
        });
    }

    /// Row of a cell's stiffness; `tetrahedron` is room for it.
    fn row<'r>(&'r self, visit: &Visit, tetrahedron: &'r mut [DMat3; 4]) -> &'r [DMat3] {
        let count = visit.count as usize;
        if count != TETRAHEDRON {
            let matrix = self.stride * (visit.cell as usize - self.cells.start);
            return &self.matrices[matrix + visit.local as usize * count..][..count];
        }
        let mesh = &self.frame.problem.mesh;
        let positions = visit.nodes.map(|node| mesh.nodes[node as usize]);
        let lame = self.lame[visit.rock as usize];
        kernel::tetrahedron_row(&positions, lame, visit.local as usize, tetrahedron);
        tetrahedron
    }

    fn visit(&self, slot: u32) -> Visit {
        let Frame {
            problem, pattern, ..
        } = self.frame;
        let cells = &problem.mesh.cells;
        let (cell, range) = pattern.cell_of_slot.locate(slot, cells);
        let mut nodes = [0; TETRAHEDRON];
        if range.len() == TETRAHEDRON {
            nodes.copy_from_slice(&cells.nodes[range.clone()]);
        }
        Visit {
            cell: cell as u32,
            local: slot - range.start as u32,
            count: range.len() as u32,
            nodes,
            rock: match self.lame.len() {
                1 => 0,
                _ => problem.rock_of_cell[cell],
            },
        }
    }

    /// Adds what the cells of the wave contribute to the rows of consecutive nodes.
    fn add_to_share(&self, nodes: Range<usize>, rows: &mut [DMat3], scratch: &mut Scratch) {
        let Frame {
            points, pattern, ..
        } = self.frame;
        let Scratch { place, visits } = scratch;
        // Apart from the sums, because the cells lie anywhere in memory: here nothing waits for them.
        visits.clear();
        for node in nodes.clone() {
            let slots = self.frame.slots(node, &self.slots).iter();
            visits.extend(slots.map(|&slot| self.visit(slot)));
        }
        let (mut rest, mut visits) = (rows, visits.as_slice());
        for node in nodes {
            let neighbours = pattern.neighbours.of(node);
            let mut length = 0;
            for &other in neighbours {
                place[other as usize] = length;
                length += points.of_node(other as usize).len() as u32;
            }
            let (rows, tail) = rest.split_at_mut(points.of_node(node).len() * length as usize);
            rest = tail;
            let slots = self.frame.slots(node, &self.slots);
            let (own, others) = visits.split_at(slots.len());
            visits = others;
            let is_plain = |&other: &u32| self.is_plain[other as usize];
            if !neighbours.iter().all(is_plain) {
                self.add_general(node, slots, own, rows, place);
            } else if let Some(lame) = self.tetrahedra_of_one_rock(own) {
                let diagonal = place[node] as usize;
                self.set_row(own, lame, place, (diagonal, rows));
            } else {
                self.add_plain(slots, own, rows, place);
            }
        }
    }

    /// Lamé's constants (Pa) of the cells around a node if all are linear tetrahedra of one rock.
    fn tetrahedra_of_one_rock(&self, visits: &[Visit]) -> Option<(f64, f64)> {
        let first = visits.first()?.rock;
        let alike = |v: &Visit| v.rock == first && v.count as usize == TETRAHEDRON;
        let all_here = self.stride == 0 && visits.iter().all(alike);
        all_here.then(|| self.lame[first as usize])
    }

    /// The row of a node whose neighbours, like itself, have one sector and no hold, and whose cells are
    /// linear tetrahedra of one rock: sums of `int g_a (x) g_b dV` become stiffnesses once, at the end.
    fn set_row(
        &self,
        visits: &[Visit],
        lame: (f64, f64),
        place: &[u32],
        (diagonal, row): (usize, &mut [DMat3]),
    ) {
        let positions = &self.frame.problem.mesh.nodes;
        for visit in visits {
            let nodes = [0, 1, 2, 3].map(|k| visit.nodes[visit.local as usize ^ k]);
            let moments = kernel::tetrahedron_moments(&nodes.map(|node| positions[node as usize]));
            for (moment, &other) in moments.into_iter().zip(&nodes[1..]) {
                row[place[other as usize] as usize] += moment;
            }
        }
        let sum: DMat3 = row.iter().copied().sum();
        row[diagonal] = -sum;
        for block in row {
            *block = kernel::of_moments(*block, lame);
        }
    }

    /// The row of a node whose neighbours, like itself, have one sector and no hold.
    fn add_plain(&self, slots: &[u32], visits: &[Visit], row: &mut [DMat3], place: &[u32]) {
        let mut tetrahedron = [DMat3::ZERO; 4];
        for (&slot, visit) in slots.iter().zip(visits) {
            let blocks = self.row(visit, &mut tetrahedron);
            let first = (slot - visit.local) as usize;
            let nodes = match visit.count as usize {
                TETRAHEDRON => &visit.nodes,
                count => &self.frame.problem.mesh.cells.nodes[first..first + count],
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
        visits: &[Visit],
        rows: &mut [DMat3],
        place: &[u32],
    ) {
        let Frame {
            points, supports, ..
        } = self.frame;
        let cells = &self.frame.problem.mesh.cells;
        let mut tetrahedron = [DMat3::ZERO; 4];
        for (&slot, visit) in slots.iter().zip(visits) {
            let blocks = self.row(visit, &mut tetrahedron);
            let point = points.of_cell_node[slot as usize] as usize;
            let target = Target {
                points,
                point,
                own: points.of_node(node),
            };
            for (block, other_slot) in blocks.iter().zip((slot - visit.local) as usize..) {
                let other = points.of_cell_node[other_slot] as usize;
                let start = place[cells.nodes[other_slot] as usize] as usize;
                let block = supports.project_block(point, other, *block);
                target.scatter(other, block, start, rows);
            }
            if let Some(hold) = supports.hold(point) {
                let scale = trace(blocks[visit.local as usize]) / 3.0;
                let block = scale * (DMat3::IDENTITY - hold.free);
                target.scatter(point, block, place[node] as usize, rows);
            }
        }
    }
}

/// One occurrence of a node in a cell.
struct Visit {
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
struct Scratch {
    /// For the neighbours of a node, where their blocks start in its rows.
    place: Vec<u32>,
    visits: Vec<Visit>,
}

impl Scratch {
    fn of(frame: Frame<'_>) -> Self {
        Self {
            place: vec![0; frame.problem.mesh.nodes.len()],
            visits: Vec::new(),
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
