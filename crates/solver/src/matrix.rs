//! Symmetric sparse matrix of 3x3 blocks.

use glam::{DMat3, DVec3};
use rayon::prelude::*;

use crate::pattern::Pattern;

/// Values of a block matrix over a [`Pattern`], which its user keeps beside it.
#[derive(Debug, Clone)]
pub struct BlockMatrix {
    /// One block for each of [`Pattern::columns`].
    pub blocks: Vec<DMat3>,
}

impl BlockMatrix {
    /// `K y`.
    pub fn times(&self, pattern: &Pattern, vector: &[DVec3]) -> Vec<DVec3> {
        let mut product = vec![DVec3::ZERO; vector.len()];
        self.times_into(pattern, vector, &mut product);
        product
    }

    /// Writes `K y` to `product`. Each row is summed by one thread in the order of its columns, so
    /// the result does not depend on the number of threads.
    ///
    /// # Panics
    /// If `vector` or `product` has not one entry for each block row.
    pub fn times_into(&self, pattern: &Pattern, vector: &[DVec3], product: &mut [DVec3]) {
        let rows = pattern.row_offset.len() - 1;
        assert_eq!(
            [vector.len(), product.len()],
            [rows; 2],
            "entries of a vector"
        );
        product.par_iter_mut().enumerate().for_each(|(row, sum)| {
            let range = pattern.row(row);
            let columns = &pattern.columns[range.clone()];
            *sum = self.blocks[range]
                .iter()
                .zip(columns)
                .map(|(block, &column)| *block * vector[column as usize])
                .sum();
        });
    }
}
