//! Symmetric sparse matrix of 3x3 blocks.

use glam::{DMat3, DVec3};

use crate::multigrid::BlockRows;
use crate::pattern::Pattern;

/// Values of a block matrix over a [`Pattern`], which its user keeps beside it.
#[derive(Debug, Clone)]
pub struct BlockMatrix {
    /// One block for each of [`Pattern::columns`].
    pub blocks: Vec<DMat3>,
}

impl BlockMatrix {
    /// The matrix row by row.
    pub fn rows<'a>(&'a self, pattern: &'a Pattern) -> BlockRows<'a> {
        BlockRows {
            row_offset: &pattern.row_offset,
            columns: &pattern.columns,
            blocks: &self.blocks,
        }
    }

    /// `K y`.
    pub fn times(&self, pattern: &Pattern, vector: &[DVec3]) -> Vec<DVec3> {
        let mut product = vec![DVec3::ZERO; vector.len()];
        self.rows(pattern).multiply(vector, &mut product);
        product
    }
}
