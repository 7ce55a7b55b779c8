//! The first coarsening of a matrix whose rows many processes share: what a multigrid framework
//! needs of the rows of one of them, in unknowns that are not scaled.
//!
//! With the clusters `C` of unknowns, `A = R + S` of a fixed matrix and an interface, and the basis
//! `P` of the fixed one, that is the inverse `A_CC^-1` for a smoother, the prolongator
//! `A_CC^-1 R_CC P`, and what the rows give to the matrix of the next level.

use glam::DVec3;

use super::block_jacobi::{self, Factors};
use super::mean_field::{CoarseBasis, MeanField};
use super::setup::{FixedHierarchy, NodeMatrix};
use super::sparse::{Sparse, Transpose};
use super::sum_rows::SumRows;
use super::triple_product::PartialProduct;
use crate::block_rows::BlockRows;
use crate::failure::MultigridFailure;
use crate::interface::InterfaceBlocks;
use crate::lists::Lists;
use crate::small::{Modes, add, product, transpose, widen};

/// Clusters and basis, made once for a fixed matrix.
#[derive(Debug, Clone)]
pub struct FirstCoarsening {
    fixed: FixedHierarchy,
    /// The scaled rows and prolongator of the last part, whose storage serves the next one.
    matrix: Sparse<3, 3>,
    prolongator: Sparse<3, 6>,
}

/// Blocks of `M` lines of `L` numbers, row by row.
#[derive(Debug, Clone, Default)]
pub struct BlockList<const M: usize, const L: usize> {
    /// Start of each row; one entry more than there are rows.
    pub offset: Vec<usize>,
    /// Column of each block.
    pub columns: Vec<u32>,
    /// The blocks, as rows.
    pub blocks: Vec<[[f64; L]; M]>,
}

/// What some rows give to a hierarchy. All lists but the last have one row for each of them.
#[derive(Debug, Clone)]
pub struct LevelPart {
    /// `A_CC^-1`; columns are rows of the matrix.
    pub inverse: BlockList<3, 3>,
    /// `A_CC^-1 R_CC P`; columns are nodes of the next level.
    pub prolongator: BlockList<3, 6>,
    /// What they add to the matrix of the next level, one row for each of its nodes: the diagonal
    /// block and those right of it.
    pub next: BlockList<6, 6>,
}

impl<const M: usize, const L: usize> BlockList<M, L> {
    fn new() -> Self {
        Self {
            offset: vec![0],
            ..Self::default()
        }
    }

    fn push(&mut self, column: u32, block: [[f64; L]; M]) {
        self.columns.push(column);
        self.blocks.push(block);
    }

    fn end_row(&mut self) {
        self.offset.push(self.columns.len());
    }

    /// Columns and blocks of a row.
    pub fn row(&self, row: usize) -> impl Iterator<Item = (u32, &[[f64; L]; M])> {
        let range = self.offset[row]..self.offset[row + 1];
        let columns = self.columns[range.clone()].iter().copied();
        columns.zip(&self.blocks[range])
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.offset.len() - 1
    }
}

impl FirstCoarsening {
    /// Prepares the coarsening of a fixed matrix; arguments are those of
    /// [`super::Multigrid::with_basis`].
    ///
    /// # Errors
    /// If a diagonal block is not positive definite, or an entry not finite.
    pub fn of(
        matrix: BlockRows<'_>,
        first_row: &[u32],
        modes: &[[DVec3; 6]],
        basis: impl FnOnce(&MeanField) -> CoarseBasis,
    ) -> Result<Self, MultigridFailure> {
        let nodes = NodeMatrix {
            matrix,
            offset: first_row,
            modes,
        };
        let (fixed, _) = FixedHierarchy::of(nodes, |means| basis(&means))?;
        Ok(Self {
            fixed,
            matrix: Sparse::default(),
            prolongator: Sparse::default(),
        })
    }

    /// Rows of each cluster. The rows of a part are those of whole clusters.
    pub fn clusters(&self) -> &Lists {
        &self.fixed.clusters.members
    }

    /// The motions of the next level as if the interface had no stiffness.
    pub fn basis(&self) -> &CoarseBasis {
        &self.fixed.basis
    }

    /// Whether the next level of a matrix with so many rows is worth having.
    pub fn has_next(&self, rows: usize) -> bool {
        self.fixed.has_next(rows)
    }

    /// What the rows `own`, ascending, give to the hierarchy. The matrix needs the blocks of these
    /// rows, and the diagonal blocks of the clusters that they couple to.
    ///
    /// # Errors
    /// If a diagonal block is not positive definite.
    pub fn part(
        &mut self,
        matrix: BlockRows<'_>,
        interface: InterfaceBlocks<'_>,
        own: &[u32],
    ) -> Result<LevelPart, MultigridFailure> {
        let rows = SumRows {
            interface: Some(interface),
            ..SumRows::of_fixed(matrix)
        };
        let factors = Factors::of(&rows, &self.fixed.clusters)?;
        let columns = self.fixed.basis.modes.len();
        let mut prolongator = std::mem::take(&mut self.prolongator);
        block_jacobi::smooth_by_blocks(
            &mut prolongator,
            &self.fixed.basis.prolongator,
            columns,
            &self.fixed.clusters,
            &factors,
        );
        let next = self.next(&rows, &factors, &prolongator, own);
        let part = LevelPart {
            inverse: self.inverse(&factors, own),
            prolongator: self.unscaled(&factors, &prolongator, own),
            next: blocks_of(&next),
        };
        self.prolongator = prolongator;
        Ok(part)
    }

    fn next(
        &mut self,
        rows: &SumRows<'_>,
        factors: &Factors,
        prolongator: &Sparse<3, 6>,
        own: &[u32],
    ) -> PartialProduct {
        let mut is_own = vec![false; rows.count()];
        for &row in own {
            is_own[row as usize] = true;
        }
        let mut matrix = std::mem::take(&mut self.matrix);
        let clusters = &self.fixed.clusters;
        block_jacobi::set_matrix(&mut matrix, rows, clusters, factors, |row| is_own[row]);
        let transpose = Transpose::of(prolongator, self.fixed.basis.modes.len());
        let is_own = |row: usize| is_own[row];
        let next = self
            .fixed
            .product(rows, &matrix, prolongator, &transpose, is_own);
        self.matrix = matrix;
        next
    }

    /// `A_CC^-1 = L^-T L^-1`.
    fn inverse(&self, factors: &Factors, own: &[u32]) -> BlockList<3, 3> {
        let clusters = &self.fixed.clusters;
        let mut inverse = BlockList::new();
        for &row in own {
            let (cluster, at) = clusters.place[row as usize];
            let members = clusters.members.of(cluster as usize);
            let left = |row, column| factors.transposed_inverse_block(cluster, row, column);
            for (place, &member) in members.iter().enumerate() {
                let mut sum = [[0.0; 3]; 3];
                for k in place.max(at as usize)..members.len() {
                    let term = product(&left(at as usize, k), &transpose(&left(place, k)));
                    add(&mut sum, 1.0, &term);
                }
                inverse.push(member, sum);
            }
            inverse.end_row();
        }
        inverse
    }

    /// Rows of a prolongator of scaled unknowns in those that are not, `L^-T P`.
    fn unscaled(&self, factors: &Factors, scaled: &Sparse<3, 6>, own: &[u32]) -> BlockList<3, 6> {
        let clusters = &self.fixed.clusters;
        let mut prolongator = BlockList::new();
        for &row in own {
            let (cluster, at) = clusters.place[row as usize];
            let members = clusters.members.of(cluster as usize);
            let mut sums = std::collections::BTreeMap::new();
            for (place, &member) in members.iter().enumerate().skip(at as usize) {
                let left = factors.transposed_inverse_block(cluster, at as usize, place);
                for (column, block) in scaled.row(member as usize) {
                    let sum = sums.entry(column as u32).or_insert([[0.0; 6]; 3]);
                    add(sum, 1.0, &product(&left, &widen(block)));
                }
            }
            for (column, block) in sums {
                prolongator.push(column, block);
            }
            prolongator.end_row();
        }
        prolongator
    }

    /// Modes of the nodes of the next level.
    pub fn modes(&self) -> &[Modes<6>] {
        &self.fixed.basis.modes
    }
}

fn blocks_of(product: &PartialProduct) -> BlockList<6, 6> {
    let mut blocks = BlockList::new();
    for (row, diagonal) in product.diagonal.iter().enumerate() {
        let right = product.upper.row(row);
        if *diagonal != [[0.0; 6]; 6] {
            blocks.push(row as u32, *diagonal);
        }
        for (column, block) in right {
            blocks.push(column as u32, widen(block));
        }
        blocks.end_row();
    }
    blocks
}
