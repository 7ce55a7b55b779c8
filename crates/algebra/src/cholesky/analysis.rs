//! Symbolic factorisation of the matrix, and what its factor will cost.

use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::cholesky::SymbolicCholesky;
use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;
use glam::DMat3;

use super::factor;
use crate::dense_kernels::parallelism;
use crate::failure::LinearFailure;

/// Symbolic Cholesky factorisation of a pattern, without values.
pub struct Analysis {
    pub(super) symbolic: SymbolicCholesky<usize>,
    pub(super) column_offset: Vec<usize>,
    pub(super) row_index: Vec<usize>,
    /// Number of blocks left of the diagonal in each block row.
    pub(super) lower_blocks: Vec<usize>,
    /// Unknown 3-vectors in the order of their elimination.
    pub(super) order: Vec<usize>,
    /// Number of blocks of the matrix.
    blocks: usize,
}

impl Analysis {
    /// Analyses a symmetric pattern of blocks (start of each row, and columns ascending in each
    /// row) that is eliminated in the given order.
    ///
    /// # Errors
    /// If the analysis fails.
    pub fn of(
        row_offset: &[usize],
        columns: &[u32],
        order: Vec<usize>,
    ) -> Result<Self, LinearFailure> {
        let lower_blocks: Vec<usize> = (0..order.len())
            .map(|row| {
                let columns = &columns[row_offset[row]..row_offset[row + 1]];
                columns.partition_point(|&column| (column as usize) < row)
            })
            .collect();
        let (column_offset, row_index) = upper_triangle(row_offset, columns, &lower_blocks);
        let forward = scalars(&order);
        let size = forward.len();
        let shape =
            SymbolicSparseColMatRef::new_checked(size, size, &column_offset, None, &row_index);
        let symbolic = factor::symbolic(shape, &forward)?;
        Ok(Self {
            blocks: columns.len(),
            symbolic,
            column_offset,
            row_index,
            lower_blocks,
            order,
        })
    }

    pub(super) fn supernodal(&self) -> &SymbolicSupernodalCholesky<usize> {
        factor::supernodal(&self.symbolic)
    }

    /// The scalar pattern of the upper triangle.
    pub(super) fn shape(&self) -> SymbolicSparseColMatRef<'_, usize> {
        let size = self.column_offset.len() - 1;
        SymbolicSparseColMatRef::new_checked(size, size, &self.column_offset, None, &self.row_index)
    }

    /// Frees what is needed to set values only.
    pub(super) fn forget_pattern(&mut self) {
        self.column_offset = Vec::new();
        self.row_index = Vec::new();
        self.lower_blocks = Vec::new();
    }

    /// Number of entries of the factor.
    pub fn factor_entries(&self) -> usize {
        self.symbolic.len_val()
    }

    /// Floating-point operations of one factorisation: the sum over the columns of the factor of
    /// the square of the number of their entries.
    pub fn factor_operations(&self) -> f64 {
        factor::operations(self.supernodal())
    }

    /// Memory of a solve (bytes): the factor, its work space, the matrix of the rock and of the
    /// tangent, and their scalar copy.
    pub fn memory_bytes(&self) -> usize {
        let work = self
            .symbolic
            .factorize_numeric_llt_scratch::<f64>(parallelism(), faer::Spec::default());
        let scalars = self.row_index.len() * (size_of::<f64>() + size_of::<usize>());
        let blocks = 2 * self.blocks * size_of::<DMat3>();
        self.factor_entries() * size_of::<f64>()
            + work.unaligned_bytes_required()
            + scalars
            + blocks
    }
}

/// Column offsets and row indices of the upper triangle. Column `3 i + c` holds the blocks of block
/// row `i` up to the diagonal, which by symmetry are those of block column `i`.
fn upper_triangle(
    row_offset: &[usize],
    columns: &[u32],
    lower_blocks: &[usize],
) -> (Vec<usize>, Vec<usize>) {
    let mut column_offset = vec![0];
    let mut row_index = Vec::new();
    for (row, &lower) in lower_blocks.iter().enumerate() {
        let columns = &columns[row_offset[row]..][..lower];
        for c in 0..3 {
            let left = columns
                .iter()
                .flat_map(|&block| (0..3).map(move |r| 3 * block as usize + r));
            row_index.extend(left);
            row_index.extend((0..=c).map(|r| 3 * row + r));
            column_offset.push(row_index.len());
        }
    }
    (column_offset, row_index)
}

/// The scalars of 3-vectors in an order.
fn scalars(order: &[usize]) -> Vec<usize> {
    let of_block = |&block: &usize| [3 * block, 3 * block + 1, 3 * block + 2];
    order.iter().flat_map(of_block).collect()
}
