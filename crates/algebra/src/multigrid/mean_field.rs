//! The mean motions of nodes, the aggregates that they form, and the basis that is made of these.

use glam::DVec3;

use super::aggregation::{self, Reach};
use super::block_jacobi::{self, Factors};
use super::clusters::Clusters;
use super::continuity::Continuity;
use super::galerkin::CoarseNodes;
use super::prolongation::Unsmoothed;
use super::sparse::{Sparse, Transpose, rows_per_task};
use super::sum_rows::SumRows;
use super::{spectrum, tentative};
use crate::block_rows::numbers;
use crate::division::Division;
use crate::failure::MultigridFailure;
use crate::small::{Modes, narrow};

/// The mean motions of nodes with unknowns, and the motions of their aggregates.
pub struct MeanField {
    prolongator: Sparse<3, 6>,
    transpose: Transpose,
    modes: Vec<Modes<6>>,
    /// Node of each row.
    nodes: Vec<u32>,
    /// Row of each node.
    row_of_node: Vec<u32>,
}

impl MeanField {
    /// Aggregates rows that are all clusters of their own, the first ones of `nodes` among
    /// `node_count`; and their scaled matrix, of which each rank has its own rows.
    pub(super) fn of(
        (rows, division): (&SumRows<'_>, &Division),
        modes: &[[DVec3; 6]],
        nodes: Vec<u32>,
        node_count: usize,
    ) -> Result<(Self, Sparse<3, 3>), MultigridFailure> {
        let single = Clusters::single(rows.count());
        let own = division.own();
        let is_own = |row: usize| own.contains(&row);
        let factors = Factors::of_some(rows, &single, is_own);
        let factors = division.communicator().agreed(factors)?;
        let factors = factors.completed(division);
        let mut matrix = Sparse::default();
        block_jacobi::set_matrix(&mut matrix, rows, &single, &factors, is_own);
        let modes = block_jacobi::modes(&factors, modes);
        let complete = |vector: &mut [[f32; 3]]| division.complete(vector);
        let bound = spectrum::largest_eigenvalue_of_rows(&matrix, complete);
        if !bound.is_finite() {
            return Err(MultigridFailure::NotFinite);
        }
        let strong = aggregation::strong_neighbours(&matrix, &modes);
        let aggregates = aggregation::aggregate(&strong.completed(division), Reach::Beyond);
        let tentative = tentative::tentative(&aggregates, &modes);
        let unsmoothed = Unsmoothed {
            aggregates: &aggregates,
            tentative: &tentative,
            modes: &modes,
        };
        let mut prolongator = unsmoothed.smoothed(&matrix, bound, is_own);
        block_jacobi::unscale(&factors, &mut prolongator);
        let prolongator = prolongator.completed(division);
        let means = Self {
            transpose: Transpose::of(&prolongator, aggregates.count),
            modes: tentative.modes,
            prolongator,
            row_of_node: numbers(node_count, &nodes),
            nodes,
        };
        Ok((means, matrix))
    }

    /// Nodes with unknowns, ascending.
    pub(super) fn nodes(&self) -> &[u32] {
        &self.nodes
    }

    /// Number of aggregates.
    pub fn aggregates(&self) -> usize {
        self.transpose.columns()
    }

    /// The modes of each aggregate in its own six unknowns: upper triangular, with a zero on the
    /// diagonal where a mode depends on those before it.
    pub fn modes(&self) -> &[Modes<6>] {
        &self.modes
    }

    /// Aggregates that move a node, ascending, and how: blocks as rows.
    pub fn motions_of(&self, node: usize) -> impl Iterator<Item = (usize, &[[f32; 6]; 3])> {
        self.prolongator.row(self.row_of_node[node] as usize)
    }

    /// Nodes that an aggregate moves, ascending, and how.
    pub fn moved_by(&self, aggregate: usize) -> impl Iterator<Item = (usize, &[[f32; 6]; 3])> {
        let column = self.transpose.column(aggregate).iter();
        column.map(|&(row, position)| {
            let node = self.nodes[row as usize] as usize;
            (node, &self.prolongator.blocks[position as usize])
        })
    }

    /// The motions as they are, where every node has one row.
    pub(super) fn into_basis(self) -> CoarseBasis {
        CoarseBasis {
            prolongator: self.prolongator,
            modes: self.modes,
            continuity: Continuity::default(),
        }
    }
}

/// Motions of the nodes of the next level, as if the interface had no stiffness.
#[derive(Debug, Clone, Default)]
pub struct CoarseBasis {
    /// One row an unknown, in unknowns that are not scaled.
    pub(super) prolongator: Sparse<3, 6>,
    /// Modes of the next level's nodes.
    pub(super) modes: Vec<Modes<6>>,
    /// Which of them continuous material joins.
    continuity: Continuity,
}

impl CoarseBasis {
    /// A basis of `rows` unknowns and one node for each of `modes`. `motions` tells the nodes that
    /// move an unknown, ascending, and how: blocks as rows.
    pub fn new(
        rows: usize,
        modes: Vec<Modes<6>>,
        motions: impl Fn(usize) -> Vec<(u32, [[f64; 6]; 3])> + Sync + Send,
    ) -> Self {
        let append = |row: usize, columns: &mut Vec<u32>, blocks: &mut Vec<[[f32; 6]; 3]>| {
            for (column, block) in motions(row) {
                columns.push(column);
                blocks.push(narrow(&block));
            }
        };
        let prolongator = Sparse::collect(rows, rows_per_task::<3>(), append);
        Self {
            prolongator,
            modes,
            continuity: Continuity::default(),
        }
    }

    /// The same where an interface divides the material between nodes of the next level.
    pub fn divided(self, continuity: Continuity) -> Self {
        Self { continuity, ..self }
    }

    /// The nodes of the next level.
    pub(super) fn nodes(&self) -> CoarseNodes<'_> {
        CoarseNodes {
            modes: &self.modes,
            continuity: &self.continuity,
        }
    }

    /// Nodes of the next level that move an unknown, and how: blocks as rows.
    pub fn row(&self, row: usize) -> impl Iterator<Item = (usize, &[[f32; 6]; 3])> {
        self.prolongator.row(row)
    }

    /// Modes of the nodes of the next level.
    pub fn modes(&self) -> &[Modes<6>] {
        &self.modes
    }

    /// Bytes of storage.
    pub(super) fn bytes(&self) -> usize {
        self.prolongator.bytes() + size_of_val(&self.modes[..]) + self.continuity.bytes()
    }
}
