//! Sparse Cholesky factorisation: ordering, symbolic analysis, factor, substitution.

mod analysis;
mod factor;
mod ordering;
mod scalar;
mod substitution;

use faer::Mat;
use faer::sparse::SparseColMatRef;
use faer::sparse::linalg::cholesky::supernodal::SupernodalLltRef;
use glam::{DMat3, DVec3};

use crate::block_rows::BlockRows;
use crate::failure::LinearFailure;

pub use analysis::Analysis;
pub use ordering::NodeOrder;
pub use scalar::{ScalarCholesky, ScalarMatrix};

/// `A = L L^T`. The analysis is done once; values may change.
pub struct Cholesky {
    analysis: Analysis,
    /// Upper triangle of the matrix, column by column.
    values: Vec<f64>,
    factor: Vec<f64>,
}

impl Cholesky {
    /// Takes over the values of `matrix`; nothing is factorised yet.
    pub fn new(analysis: Analysis, matrix: BlockRows<'_>) -> Self {
        let mut cholesky = Self {
            values: vec![0.0; analysis.row_index.len()],
            factor: Vec::new(),
            analysis,
        };
        for row in 0..cholesky.analysis.order.len() {
            let left = matrix
                .row(row)
                .take(cholesky.analysis.lower_blocks[row] + 1);
            for (place, (_, block)) in left.enumerate() {
                cholesky.set_block(row, place, block);
            }
        }
        cholesky
    }

    /// Sets one block of the matrix: `place` counts the blocks of its row. Blocks right of the
    /// diagonal follow from symmetry and are ignored.
    pub fn set_block(&mut self, row: usize, place: usize, block: DMat3) {
        let diagonal = self.analysis.lower_blocks[row];
        if place > diagonal {
            return;
        }
        for (c, entries) in block.transpose().to_cols_array_2d().iter().enumerate() {
            let start = self.analysis.column_offset[3 * row + c] + 3 * place;
            let count = if place == diagonal { c + 1 } else { 3 };
            self.values[start..start + count].copy_from_slice(&entries[..count]);
        }
    }

    /// Number of entries of the factor.
    pub fn factor_entries(&self) -> usize {
        self.analysis.factor_entries()
    }

    /// Unknown 3-vectors in the order of their elimination.
    pub fn order(&self) -> &[usize] {
        &self.analysis.order
    }

    /// Factorises the present values.
    ///
    /// # Errors
    /// If the matrix is not positive definite or memory runs out.
    pub fn factorise(&mut self) -> Result<(), LinearFailure> {
        let upper = SparseColMatRef::new(self.analysis.shape(), &self.values);
        let done = factor::numeric(&self.analysis.symbolic, upper, &mut self.factor);
        done.map_err(|failure| match failure {
            LinearFailure::Indefinite(place) => {
                LinearFailure::Indefinite(self.analysis.order[place / 3])
            }
            other => other,
        })
    }

    /// Frees the values of the matrix; the factor stays.
    pub fn forget_values(&mut self) {
        self.values = Vec::new();
        self.analysis.forget_pattern();
    }

    /// Solves for one right-hand side.
    ///
    /// # Panics
    /// If nothing was factorised.
    pub fn solve(&self, rhs: &[DVec3]) -> Vec<DVec3> {
        let mut column = self.ordered(rhs);
        let size = column.len();
        self.eliminate(size, &mut column);
        self.substitute(size, &mut column);
        self.restored(&column)
    }

    /// Scalars in the order of elimination.
    pub fn ordered(&self, vector: &[DVec3]) -> Vec<f64> {
        let order = self.analysis.order.iter();
        order.flat_map(|&block| vector[block].to_array()).collect()
    }

    /// 3-vectors in the order of the unknowns.
    pub fn restored(&self, column: &[f64]) -> Vec<DVec3> {
        let order = &self.analysis.order;
        let mut unknowns = vec![DVec3::ZERO; order.len()];
        for (&block, entries) in order.iter().zip(column.chunks_exact(3)) {
            unknowns[block] = DVec3::from_slice(entries);
        }
        unknowns
    }

    /// Eliminates the first `count` scalars, see `substitution::eliminate`.
    pub fn eliminate(&self, count: usize, column: &mut [f64]) {
        substitution::eliminate(self.lower(), count, column);
    }

    /// Substitutes backward the first `count` scalars, see `substitution::substitute`.
    pub fn substitute(&self, count: usize, column: &mut [f64]) {
        substitution::substitute(self.lower(), count, column);
    }

    /// `L_b`, the part of the factor that belongs to the scalars from `first` on.
    pub fn trailing_factor(&self, first: usize) -> Mat<f64> {
        substitution::trailing_factor(self.lower(), first)
    }

    fn lower(&self) -> SupernodalLltRef<'_, usize, f64> {
        SupernodalLltRef::new(self.analysis.supernodal(), &self.factor)
    }
}
