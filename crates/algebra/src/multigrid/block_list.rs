//! Rows of blocks in double precision, as they are handed over.

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

impl<const M: usize, const L: usize> BlockList<M, L> {
    /// No rows.
    pub(super) fn new() -> Self {
        Self {
            offset: vec![0],
            ..Self::default()
        }
    }

    pub(super) fn push(&mut self, column: u32, block: [[f64; L]; M]) {
        self.columns.push(column);
        self.blocks.push(block);
    }

    pub(super) fn end_row(&mut self) {
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
