//! Rows of the rock's stiffness at nodes in linear tetrahedra only.
//!
//! With `w = sqrt(V) grad N`, a tetrahedron adds `M_ab = w_a (x) w_b` between its nodes, of which
//! the elasticity of its rock makes `K_ab`. Each task computes the `w` of the cells around its
//! nodes once, where they stay in the cache, and then sums up row after row, cells ascending. Sums
//! run between points; what sectors and holds make of them is linear, so it waits until the sums
//! stand.

use std::cmp::Ordering;
use std::ops::Range;

use glam::{DMat3, DVec3};
use kluft_algebra::trace;
use kluft_mesh::Shape;
use lie_core::enrichment::coefficient;
use lie_core::{Elasticity, Rock, kernel};
use rayon::prelude::*;

use crate::assembly::node_blocks::NodeBlocks;
use crate::space::Space;

/// Nodes of a linear tetrahedron.
const NODES: usize = 4;

/// Whether all cells around a node are linear tetrahedra.
pub(crate) fn nodes(space: Space<'_>) -> Vec<bool> {
    let Space {
        problem, pattern, ..
    } = space;
    let cells = &problem.mesh.cells;
    let all = cells.shapes.par_iter().all(|&shape| shape == Shape::Tet4);
    let is_tetrahedron = |&slot: &u32| {
        let (cell, _) = pattern.cell_of_slot.locate(slot, cells);
        cells.shapes[cell] == Shape::Tet4
    };
    (0..problem.mesh.nodes.len())
        .into_par_iter()
        .map(|node| all || pattern.slots_of(node).iter().all(is_tetrahedron))
        .collect()
}

/// Source of the rows of the nodes `in_tetrahedra` that are `is_wanted`.
pub(crate) struct Tetrahedra<'a> {
    space: Space<'a>,
    is_wanted: &'a [bool],
    in_tetrahedra: &'a [bool],
    /// Whether a node has one sector and no constraint: its point is its unknown.
    is_plain: &'a [bool],
    elasticity: Vec<Elasticity<'a>>,
}

/// A cell, with all that rows need of it.
struct Tetrahedron {
    /// `sqrt(V) grad N` (m^1/2) of its nodes.
    gradients: [DVec3; NODES],
    points: [u32; NODES],
    rock: u32,
}

/// One occurrence of a node in a cell.
struct Corner {
    /// Number of the cell among those of the task.
    cell: u32,
    /// Number of the node within the cell.
    local: u32,
}

/// Room that a thread uses again and again.
pub(crate) struct CellScratch {
    /// Number of each cell among those of the task, plus `base`; less if it is not among them yet.
    number: Vec<u32>,
    base: u32,
    /// The first visit's slot of each cell of the task.
    firsts: Vec<u32>,
    cells: Vec<Tetrahedron>,
    visits: Vec<Corner>,
    /// For the points around a node, the number of their blocks in its rows.
    place: Vec<u32>,
    /// Rows of a node, those blocks included that are not stored.
    rows: Vec<DMat3>,
}

impl<'a> Tetrahedra<'a> {
    pub(crate) fn of(
        space: Space<'a>,
        (is_wanted, in_tetrahedra): (&'a [bool], &'a [bool]),
        is_plain: &'a [bool],
    ) -> Self {
        Self {
            space,
            is_wanted,
            in_tetrahedra,
            is_plain,
            elasticity: space.problem.rocks.iter().map(Rock::elasticity).collect(),
        }
    }

    pub(crate) fn scratch(&self) -> CellScratch {
        CellScratch {
            number: vec![0; self.space.problem.mesh.cells.len()],
            base: 1,
            firsts: Vec::new(),
            cells: Vec::new(),
            visits: Vec::new(),
            place: vec![0; self.space.points.len()],
            rows: Vec::new(),
        }
    }

    /// Writes the rows of those of consecutive nodes that are wanted and in tetrahedra only, and
    /// zeros into the others.
    pub(crate) fn set_share(&self, mut target: NodeBlocks<'_>, scratch: &mut CellScratch) {
        let Space {
            points, pattern, ..
        } = self.space;
        let is_served = |node: &usize| self.is_wanted[*node] && self.in_tetrahedra[*node];
        if target.nodes().any(|node| !self.in_tetrahedra[node]) {
            // Written before it is read: untouched memory would be mapped twice.
            target.clear();
        }
        // Apart from the sums, because the cells lie anywhere in memory: here nothing waits for
        // them.
        scratch.gather(self, target.nodes().filter(is_served));
        let mut visits = scratch.visits.as_slice();
        for node in target.nodes().filter(is_served) {
            let own = points.of_node(node);
            if own.is_empty() {
                continue;
            }
            let columns = &pattern.blocks.columns[pattern.blocks.row(own.start)];
            scratch.rows.clear();
            scratch.rows.resize(own.len() * columns.len(), DMat3::ZERO);
            for (number, &column) in columns.iter().enumerate() {
                scratch.place[column as usize] = number as u32;
            }
            let (here, others) = visits.split_at(pattern.slots_of(node).len());
            visits = others;
            let mut rows = Rows {
                first: own.start,
                length: columns.len(),
                blocks: &mut scratch.rows,
                place: &scratch.place,
            };
            self.sum(&scratch.cells, here, &mut rows);
            for other in pattern.around(node, points) {
                if !(self.is_plain[node] && self.is_plain[other as usize]) {
                    self.enrich(node, other as usize, &mut rows);
                }
            }
            target.set(node, &scratch.rows);
        }
    }

    /// Stiffness between the points of a node and those around it.
    fn sum(&self, cells: &[Tetrahedron], visits: &[Corner], rows: &mut Rows<'_>) {
        let rock = cells[visits[0].cell as usize].rock;
        let is_other = |visit: &Corner| cells[visit.cell as usize].rock != rock;
        if visits.iter().any(is_other) {
            rows.add(cells, visits, |cell, moment| {
                self.elasticity[cell.rock as usize].block(moment)
            });
            return rows.close();
        }
        rows.add(cells, visits, |_, moment| moment);
        rows.close();
        for block in &mut *rows.blocks {
            *block = self.elasticity[rock as usize].block(*block);
        }
    }

    /// Turns blocks between the points of the rows' node and of another one into blocks between
    /// their unknowns: `T^T (P K P + s (I - P)) T`.
    fn enrich(&self, node: usize, other: usize, rows: &mut Rows<'_>) {
        let points = self.space.points;
        let (own, others) = (points.of_node(node), points.of_node(other));
        let start = rows.place[others.start] as usize;
        for (row, point) in rows.blocks.chunks_mut(rows.length).zip(own.clone()) {
            for (block, other) in row[start..].iter_mut().zip(others.clone()) {
                *block = self.project(point, other, *block);
            }
        }
        // In one order for a block and its transpose, so that they agree to the last bit.
        match node.cmp(&other) {
            Ordering::Less => {
                rows.transform_columns(start..start + others.len());
                rows.transform_rows(start..start + others.len());
            }
            Ordering::Greater => {
                rows.transform_rows(start..start + others.len());
                rows.transform_columns(start..start + others.len());
            }
            Ordering::Equal => rows.transform_diagonal(start),
        }
    }

    /// `P K P`, or `P K P + s (I - P)` of a point with itself.
    fn project(&self, point: usize, other: usize, block: DMat3) -> DMat3 {
        let projected = self.space.supports.project_block(point, other, block);
        let constraint = self
            .space
            .supports
            .constraint(point)
            .filter(|_| other == point);
        constraint.map_or(projected, |constraint| {
            projected + trace(block) / 3.0 * (DMat3::IDENTITY - constraint.free)
        })
    }

    #[inline]
    fn tetrahedron(&self, slot: u32) -> Tetrahedron {
        let Space {
            problem,
            points,
            pattern,
            ..
        } = self.space;
        let mesh = &problem.mesh;
        let (cell, slots) = pattern.cell_of_slot.locate(slot, &mesh.cells);
        let positions = |k| mesh.nodes[mesh.cells.nodes[slots.start + k] as usize];
        let rock = match self.elasticity.len() {
            1 => 0,
            _ => problem.rock_of_cell[cell],
        };
        Tetrahedron {
            gradients: kernel::tetrahedron_gradients(&std::array::from_fn(positions)),
            points: std::array::from_fn(|k| points.of_cell_node[slots.start + k]),
            rock,
        }
    }
}

impl CellScratch {
    /// Computes the cells around `nodes`, each once.
    fn gather(&mut self, source: &Tetrahedra<'_>, nodes: impl Iterator<Item = usize>) {
        let Space {
            problem, pattern, ..
        } = source.space;
        self.base += self.cells.len() as u32;
        self.visits.clear();
        let mut count = 0;
        for node in nodes {
            let slots = pattern.slots_of(node);
            self.firsts.resize(count as usize + slots.len() + 1, 0);
            self.visits.extend(slots.iter().map(|&slot| {
                let (cell, own) = pattern.cell_of_slot.locate(slot, &problem.mesh.cells);
                // Without a branch, which no processor could predict.
                let known = self.number[cell];
                let is_new = known < self.base;
                let number = if is_new { self.base + count } else { known };
                self.number[cell] = number;
                self.firsts[count as usize] = slot;
                count += u32::from(is_new);
                Corner {
                    cell: number - self.base,
                    local: slot - own.start as u32,
                }
            }));
        }
        self.cells.clear();
        let firsts = self.firsts[..count as usize].iter();
        let cells = firsts.map(|&slot| source.tetrahedron(slot));
        self.cells.extend(cells);
    }
}

/// The rows of one node, row after row of equal length.
struct Rows<'a> {
    /// First point of the node.
    first: usize,
    length: usize,
    blocks: &'a mut [DMat3],
    /// For the points around the node, the number of their blocks in a row.
    place: &'a [u32],
}

impl Rows<'_> {
    /// Adds what cells have between the node and others: `of` their moments `M_ab`.
    #[inline]
    fn add(
        &mut self,
        cells: &[Tetrahedron],
        visits: &[Corner],
        of: impl Fn(&Tetrahedron, DMat3) -> DMat3,
    ) {
        for visit in visits {
            let cell = &cells[visit.cell as usize];
            let a = visit.local as usize % NODES;
            let row = self.length * (cell.points[a] as usize - self.first);
            let row = &mut self.blocks[row..][..self.length];
            for b in [a ^ 1, a ^ 2, a ^ 3] {
                let moment = kernel::tetrahedron_moment(cell.gradients[a], cell.gradients[b]);
                row[self.place[cell.points[b] as usize] as usize] += of(cell, moment);
            }
        }
    }

    /// Sets the diagonal, which is symmetric: a row adds up to zero, because translations cost
    /// nothing.
    fn close(&mut self) {
        for (row, point) in self.blocks.chunks_mut(self.length).zip(self.first..) {
            let sum: DMat3 = row.iter().copied().sum();
            row[self.place[point] as usize] = -0.5 * (sum + sum.transpose());
        }
    }

    /// Combines the rows to those of the node's unknowns, in these columns.
    fn transform_columns(&mut self, columns: Range<usize>) {
        if self.blocks.len() > self.length {
            for column in columns {
                transform(&mut self.blocks[column..], self.length);
            }
        }
    }

    /// Combines these columns, those of another node, to those of its unknowns.
    fn transform_rows(&mut self, columns: Range<usize>) {
        if columns.len() > 1 {
            for row in self.blocks.chunks_mut(self.length) {
                transform(&mut row[columns.clone()], 1);
            }
        }
    }

    /// Combines the blocks between the points of the node itself, which share no cell: only those
    /// of each with itself are not zero.
    fn transform_diagonal(&mut self, start: usize) {
        let sectors = self.blocks.len() / self.length;
        let own: Vec<DMat3> = (0..sectors)
            .map(|i| self.blocks[i * self.length + start + i])
            .collect();
        for (k, row) in self.blocks.chunks_mut(self.length).enumerate() {
            for (l, block) in row[start..start + sectors].iter_mut().enumerate() {
                let weight = |i, k| coefficient(sectors as u32, i, k as u32);
                let terms = (0..).zip(&own);
                *block = terms
                    .map(|(i, &own)| weight(i, k) * weight(i, l) * own)
                    .sum();
            }
        }
    }
}

/// The transposed table of enrichment, applied in place to blocks of all sectors of a node,
/// `stride` apart: `r_k = sum_i coefficient(s, i, k) f_i`, which is the sum of all for `k = 0` and
/// else `f_k` less their mean.
fn transform(blocks: &mut [DMat3], stride: usize) {
    let sum: DMat3 = blocks.iter().step_by(stride).copied().sum();
    let mean = sum * (1.0 / blocks.len().div_ceil(stride) as f64);
    for block in blocks.iter_mut().step_by(stride).skip(1) {
        *block -= mean;
    }
    blocks[0] = sum;
}
