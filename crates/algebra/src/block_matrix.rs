//! Symmetric sparse matrix of 3x3 blocks, its values apart from its pattern.

use glam::{DMat3, DVec3};

use crate::block_pattern::BlockPattern;
use crate::block_rows::BlockRows;

/// Values of a block matrix over a [`BlockPattern`], which its user keeps beside it.
#[derive(Debug, Clone)]
pub struct BlockMatrix {
    /// One block for each that the pattern stores.
    pub blocks: Vec<DMat3>,
}

impl BlockMatrix {
    /// The matrix row by row.
    pub fn rows<'a>(&'a self, pattern: &'a BlockPattern) -> BlockRows<'a> {
        BlockRows {
            pattern,
            blocks: &self.blocks,
        }
    }

    /// `K y`.
    pub fn times(&self, pattern: &BlockPattern, vector: &[DVec3]) -> Vec<DVec3> {
        let mut product = vec![DVec3::ZERO; vector.len()];
        self.rows(pattern).multiply(vector, &mut product);
        product
    }
}
