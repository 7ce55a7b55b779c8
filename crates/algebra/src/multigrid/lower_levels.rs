//! The levels below a finest one whose rows many processes share. They are much smaller than it, so
//! every process has all of them, alike; it makes its part of their rows, and works with those that
//! it owns.

use std::sync::Arc;

use super::block_list::BlockList;
use super::cycle::{Below, Prolongator, Transfer};
use super::galerkin::{self, CoarseNodes};
use super::level_rows::{LevelRows, ProlongatorRows};
use super::setup::{self, FullLevel};
use super::sparse::Sparse;
use super::triple_product::PartialProduct;
use crate::division::Communicator;
use crate::failure::MultigridFailure;

/// All levels but the finest, the largest of them first; never none.
#[derive(Debug, Clone)]
pub struct LowerLevels {
    /// `L^-1` of the diagonal blocks of the first level before it was scaled.
    scaling: Vec<[[f32; 6]; 6]>,
    /// Nodes of each level.
    nodes: Vec<usize>,
    /// What is left of them.
    levels: Vec<FullLevel<6>>,
}

/// What stands for the inverse of the coarsest matrix.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CoarsestSolve {
    /// Its pseudo-inverse.
    Inverse,
    /// Smoothing: nothing couples any more, or hardly.
    Smoothing,
}

impl LowerLevels {
    /// From parts of the matrix of the first of them, which are summed in their order; and
    /// its nodes. The ranks divide the work.
    pub(super) fn of(
        parts: Vec<PartialProduct>,
        nodes: CoarseNodes<'_>,
        ranks: &Communicator,
    ) -> Result<Self, MultigridFailure> {
        let whole = PartialProduct::sum(nodes.modes.len(), &parts);
        drop(parts);
        let (first, scaling) = galerkin::coarse(whole, (nodes, ranks));
        let mut next = Some(first);
        let mut levels = Vec::new();
        while let Some(coarse) = next {
            let (level, below) = setup::level(coarse, ranks)?;
            levels.push(level);
            next = below;
        }
        let nodes = levels.iter().map(|level| level.matrix.rows()).collect();
        Ok(Self {
            scaling,
            nodes,
            levels,
        })
    }

    /// Number of levels.
    pub fn count(&self) -> usize {
        self.levels.len()
    }

    /// `L^-1` of the diagonal blocks of the first level before it was scaled, as rows: the
    /// prolongator to the finest level is `P L^-T`. None of it is left here.
    pub(super) fn take_scaling(&mut self) -> Vec<[[f32; 6]; 6]> {
        std::mem::take(&mut self.scaling)
    }

    /// Number of nodes of a level.
    pub fn nodes(&self, level: usize) -> usize {
        self.nodes[level]
    }

    /// Upper bound of the eigenvalues of the matrix of a level, whose diagonal is the identity.
    pub fn largest_eigenvalue(&self, level: usize) -> f64 {
        self.levels[level].smoother.largest_eigenvalue()
    }

    /// What the coarsest level is solved by.
    pub fn coarsest_solve(&self) -> CoarsestSolve {
        match self.levels.last().map(|level| &level.below) {
            Some(Below::Inverse(_)) => CoarsestSolve::Inverse,
            _ => CoarsestSolve::Smoothing,
        }
    }

    /// Nodes of the level below which move a node, ascending; none on the coarsest level.
    pub fn movers(&self, level: usize, node: usize) -> &[u32] {
        match &self.levels[level].below {
            Below::Level(transfer) => {
                let rows = &transfer.prolongator.rows;
                &rows.columns[rows.range(node)]
            }
            _ => &[],
        }
    }

    /// Some rows of the matrix of a level, of which none is left here.
    pub fn take_rows(&mut self, level: usize, own: &[u32]) -> LevelRows<6> {
        let matrix = &mut self.levels[level].matrix;
        LevelRows::of(std::mem::replace(matrix, Sparse::empty()), own)
    }

    /// Rows of the prolongator to a level from the one below it, of which this process has the
    /// nodes `below`; none on the coarsest level. None of it is left here.
    pub fn take_prolongator(
        &mut self,
        level: usize,
        own: &[u32],
        below: &[u32],
    ) -> ProlongatorRows<6> {
        let Below::Level(transfer) = &mut self.levels[level].below else {
            return ProlongatorRows::of(Transfer::default(), Vec::new(), &[]);
        };
        let transfer = std::mem::take(transfer);
        let all = Arc::unwrap_or_clone(transfer.prolongator);
        let nodes = transfer.scaling.len();
        let some = Transfer {
            prolongator: Arc::new(Prolongator::of(all.rows.only(own), nodes)),
            scaling: transfer.scaling,
        };
        ProlongatorRows::of(some, (0..own.len() as u32).collect(), below)
    }

    /// Rows of the pseudo-inverse of the coarsest matrix, if it is solved by that.
    pub fn inverse(&self, own: &[u32]) -> BlockList<6, 6> {
        let mut rows = BlockList::new();
        let Some((Below::Inverse(dense), nodes)) = self
            .levels
            .last()
            .map(|level| &level.below)
            .zip(self.nodes.last().copied())
        else {
            return rows;
        };
        for &node in own {
            let line = |i: usize| dense.row(6 * node as usize + i, 6 * nodes);
            for column in 0..nodes {
                let block = std::array::from_fn(|i| {
                    std::array::from_fn(|j| f64::from(line(i)[6 * column + j]))
                });
                rows.push(column as u32, block);
            }
            rows.end_row();
        }
        rows
    }
}
