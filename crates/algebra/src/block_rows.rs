//! A view of a symmetric matrix as rows of 3x3 blocks.

use glam::{DMat3, DVec3};
use rayon::prelude::*;

/// Rows that one task treats; fixed, so that no result depends on the number of threads.
const ROWS_PER_TASK: usize = 1024;
/// Marks a row of the larger matrix that is not kept.
pub(crate) const DROPPED: u32 = u32::MAX;

/// A symmetric sparse matrix of 3x3 blocks, row by row, both triangles stored.
#[derive(Debug, Clone, Copy)]
pub struct BlockRows<'a> {
    /// Start of each block row; one entry more than there are rows.
    pub row_offset: &'a [usize],
    /// Column of each block, ascending in each row.
    pub columns: &'a [u32],
    /// The blocks; entry `(r, c)` of a block is `block.col(c)[r]`.
    pub blocks: &'a [DMat3],
}

impl<'a> BlockRows<'a> {
    /// Number of block rows.
    pub fn rows(&self) -> usize {
        self.row_offset.len() - 1
    }

    /// Columns and blocks of a row.
    pub fn row(&self, row: usize) -> impl Iterator<Item = (u32, &'a DMat3)> + use<'a> {
        let range = self.row_offset[row]..self.row_offset[row + 1];
        let columns = self.columns[range.clone()].iter().copied();
        columns.zip(&self.blocks[range])
    }

    /// The diagonal block of a row, zero if there is none.
    pub fn diagonal(&self, row: usize) -> DMat3 {
        let range = self.row_offset[row]..self.row_offset[row + 1];
        let found = self.columns[range.clone()].binary_search(&(row as u32));
        found.map_or(DMat3::ZERO, |at| self.blocks[range.start + at])
    }

    /// Entry `row` of `A vector`. Two sums run side by side, so that one need not wait for the
    /// other.
    pub fn row_product(&self, row: usize, vector: &[DVec3]) -> DVec3 {
        let range = self.row_offset[row]..self.row_offset[row + 1];
        let (columns, blocks) = (&self.columns[range.clone()], &self.blocks[range]);
        let times = |k: usize| blocks[k] * vector[columns[k] as usize];
        let count = blocks.len().min(columns.len());
        let (mut even, mut odd) = (DVec3::ZERO, DVec3::ZERO);
        for pair in 0..count / 2 {
            even += times(2 * pair);
            odd += times(2 * pair + 1);
        }
        if count % 2 == 1 {
            even += times(count - 1);
        }
        even + odd
    }

    /// Entry `row` of `|A| |vector|`, both entry by entry: the unit that rounding of `A vector` is
    /// a small multiple of, once it is multiplied with the machine's epsilon.
    pub fn absolute_product(&self, row: usize, vector: &[DVec3]) -> DVec3 {
        let absolute = |block: &DMat3| DMat3::from_cols_array(&block.to_cols_array().map(f64::abs));
        let terms = self.row(row);
        let terms = terms.map(|(at, block)| absolute(block) * vector[at as usize].abs());
        terms.fold(DVec3::ZERO, |sum, term| sum + term)
    }

    /// `product = A vector`, both of one entry a block row, without allocating. Each row is summed
    /// by one thread in a fixed order, so the result does not depend on the number of threads.
    ///
    /// # Panics
    /// If `vector` or `product` has not one entry for each block row.
    pub fn multiply(&self, vector: &[DVec3], product: &mut [DVec3]) {
        let lengths = [vector.len(), product.len()];
        assert_eq!(lengths, [self.rows(); 2], "one entry a block row");
        let tasks = product.par_chunks_mut(ROWS_PER_TASK).enumerate();
        tasks.for_each(|(task, chunk)| {
            for (place, sum) in chunk.iter_mut().enumerate() {
                *sum = self.row_product(task * ROWS_PER_TASK + place, vector);
            }
        });
    }
}

/// New number of each row, [`DROPPED`] for those not kept.
pub(crate) fn numbers(rows: usize, kept: &[u32]) -> Vec<u32> {
    let mut number = vec![DROPPED; rows];
    for (new, &old) in kept.iter().enumerate() {
        number[old as usize] = new as u32;
    }
    number
}
