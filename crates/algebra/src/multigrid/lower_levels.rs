//! The levels below a finest one whose rows many processes share. They are much smaller than it, so
//! every process makes all of them, alike; what it works with are the rows that it owns.

use super::block_list::BlockList;
use super::cycle::{Below, Level};
use super::galerkin::{self, CoarseNodes};
use super::setup;
use super::triple_product::{Block6, PartialProduct};
use crate::failure::MultigridFailure;
use crate::small::{transpose, widen};

/// All levels but the finest, the largest of them first; never none.
#[derive(Debug, Clone)]
pub struct LowerLevels {
    factors: Vec<Block6>,
    levels: Vec<Level<6>>,
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
    /// its nodes.
    pub(super) fn of(
        parts: Vec<PartialProduct>,
        nodes: CoarseNodes<'_>,
    ) -> Result<Self, MultigridFailure> {
        let whole = PartialProduct::sum(nodes.modes.len(), &parts);
        drop(parts);
        let factors = galerkin::factors(&whole);
        let mut next = Some(galerkin::scaled(&whole, &factors, nodes));
        drop(whole);
        let mut levels = Vec::new();
        while let Some(coarse) = next {
            let (level, below) = setup::level(coarse)?;
            levels.push(level);
            next = below;
        }
        Ok(Self { factors, levels })
    }

    /// Number of levels.
    pub fn count(&self) -> usize {
        self.levels.len()
    }

    /// `L^-1` of the diagonal blocks of the first level before it was scaled: the prolongator to it
    /// is `P L^-T`.
    pub fn factors(&self) -> &[Block6] {
        &self.factors
    }

    /// Number of nodes of a level.
    pub fn nodes(&self, level: usize) -> usize {
        self.levels[level].matrix.rows()
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
                &transfer.prolongator.columns[transfer.prolongator.range(node)]
            }
            _ => &[],
        }
    }

    /// A row of the matrix of a level: columns and blocks as rows.
    pub fn matrix_row(&self, level: usize, node: u32) -> impl Iterator<Item = (u32, Block6)> {
        let identity =
            std::array::from_fn(|i| std::array::from_fn(|j| if i == j { 1.0 } else { 0.0 }));
        let others = self.levels[level].matrix.row(node as usize);
        let others = others.map(|(column, block)| (column as u32, transpose(&widen(block))));
        std::iter::once((node, identity)).chain(others)
    }

    /// A row of the prolongator from the level below, blocks as rows; an empty one on the coarsest
    /// level.
    pub fn prolongator_row(&self, level: usize, node: u32) -> impl Iterator<Item = (u32, Block6)> {
        let transfer = match &self.levels[level].below {
            Below::Level(transfer) => Some(transfer),
            _ => None,
        };
        let row = transfer.map(|transfer| transfer.prolongator.row(node as usize));
        let row = row.into_iter().flatten();
        row.map(|(column, block)| (column as u32, widen(block)))
    }

    /// Rows of the pseudo-inverse of the coarsest matrix, if it is solved by that.
    pub fn inverse(&self, own: &[u32]) -> BlockList<6, 6> {
        let mut rows = BlockList::new();
        let Some((Below::Inverse(dense), nodes)) = self
            .levels
            .last()
            .map(|level| (&level.below, level.matrix.rows()))
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
