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
    /// `K y`. Each row is summed by one thread in the order of its columns, so the result does not
    /// depend on the number of threads.
    pub fn times(&self, pattern: &Pattern, vector: &[DVec3]) -> Vec<DVec3> {
        (0..vector.len())
            .into_par_iter()
            .map(|row| {
                let range = pattern.row(row);
                let columns = &pattern.columns[range.clone()];
                self.blocks[range]
                    .iter()
                    .zip(columns)
                    .map(|(block, &column)| *block * vector[column as usize])
                    .sum()
            })
            .collect()
    }
}
