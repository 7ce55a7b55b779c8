//! Symmetric sparse matrix of 3x3 blocks, its values apart from its pattern.

use std::ops::Range;

use glam::{DMat3, DVec3};

use crate::block_rows::BlockRows;

/// Where a square matrix of 3x3 blocks has blocks. Both triangles are stored.
#[derive(Debug, Clone)]
pub struct BlockPattern {
    /// Start of each block row; one entry more than there are rows.
    pub row_offset: Vec<usize>,
    /// Column of each block, ascending in each row.
    pub columns: Vec<u32>,
}

impl BlockPattern {
    /// Number of block rows.
    pub fn rows(&self) -> usize {
        self.row_offset.len() - 1
    }

    /// Range of the blocks of a row.
    pub fn row(&self, row: usize) -> Range<usize> {
        self.row_offset[row]..self.row_offset[row + 1]
    }

    /// Address of the block at `row`, `column`, if there is one.
    pub fn address(&self, row: usize, column: usize) -> Option<usize> {
        let range = self.row(row);
        let found = self.columns[range.clone()].binary_search(&(column as u32));
        found.ok().map(|place| range.start + place)
    }
}

/// Values of a block matrix over a [`BlockPattern`], which its user keeps beside it.
#[derive(Debug, Clone)]
pub struct BlockMatrix {
    /// One block for each of [`BlockPattern::columns`].
    pub blocks: Vec<DMat3>,
}

impl BlockMatrix {
    /// The matrix row by row.
    pub fn rows<'a>(&'a self, pattern: &'a BlockPattern) -> BlockRows<'a> {
        BlockRows {
            row_offset: &pattern.row_offset,
            columns: &pattern.columns,
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
