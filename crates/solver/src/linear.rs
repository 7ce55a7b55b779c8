//! Sparse Cholesky factorisation under a nested-dissection ordering of the node graph.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{LltError, LltRegularization};
use faer::sparse::SparseColMatRef;
use faer::sparse::linalg::cholesky::{LltRef, SymbolicCholesky};
use faer::{Conj, Mat, Par, Side};
use glam::{DMat3, DVec3};

use crate::analysis::Analysis;
use crate::matrix::BlockMatrix;
use crate::pattern::Pattern;
use crate::points::Points;

/// Why a linear system could not be solved.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum LinearFailure {
    /// The factor does not fit in memory.
    OutOfMemory,
    /// The matrix is not positive definite; the block row where it showed.
    Indefinite(usize),
    /// The ordering or the symbolic analysis failed.
    Analysis(String),
}

/// Direct solver: the analysis is done once, values change from iteration to iteration.
pub struct DirectSolver {
    analysis: Analysis,
    /// Upper triangle of the matrix, column by column.
    values: Vec<f64>,
    factor: Vec<f64>,
    is_current: bool,
}

impl DirectSolver {
    /// Analyses the pattern and takes over the values of `matrix`.
    ///
    /// # Errors
    /// If ordering or analysis fails or the factor would not fit in memory.
    pub fn new(
        matrix: &BlockMatrix,
        pattern: &Pattern,
        points: &Points,
    ) -> Result<Self, LinearFailure> {
        let analysis = Analysis::of(pattern, points)?;
        let mut solver = Self {
            values: vec![0.0; analysis.row_index.len()],
            factor: Vec::new(),
            analysis,
            is_current: false,
        };
        for row in 0..points.len() {
            for (place, address) in pattern.row(row).enumerate() {
                solver.set_block(row, place, matrix.blocks[address]);
            }
        }
        Ok(solver)
    }

    /// Sets one block of the matrix: `place` counts the blocks of its row. Blocks right of the
    /// diagonal follow from symmetry and are ignored.
    pub fn set_block(&mut self, row: usize, place: usize, block: DMat3) {
        self.is_current = false;
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

    /// Whether a factor of the present values exists.
    pub fn is_current(&self) -> bool {
        self.is_current
    }

    /// Factorises the present values.
    ///
    /// # Errors
    /// If the matrix is not positive definite or memory runs out.
    pub fn factorise(&mut self) -> Result<(), LinearFailure> {
        let Analysis { symbolic, .. } = &self.analysis;
        let shape = self.analysis.shape();
        let length = symbolic.len_val();
        self.factor.clear();
        self.factor
            .try_reserve_exact(length)
            .map_err(|_| LinearFailure::OutOfMemory)?;
        self.factor.resize(length, 0.0);
        let par = parallelism();
        let request = symbolic.factorize_numeric_llt_scratch::<f64>(par, faer::Spec::default());
        let mut memory = MemBuffer::try_new(request).map_err(|_| LinearFailure::OutOfMemory)?;
        symbolic
            .factorize_numeric_llt(
                &mut self.factor,
                SparseColMatRef::new(shape, &self.values),
                Side::Upper,
                LltRegularization::default(),
                par,
                MemStack::new(&mut memory),
                faer::Spec::default(),
            )
            .map_err(|error| explain(symbolic, &error))?;
        self.is_current = true;
        Ok(())
    }

    /// Solves for one right-hand side with the present factor.
    ///
    /// # Panics
    /// If there is no factor.
    pub fn solve(&self, right: &[DVec3]) -> Vec<DVec3> {
        assert!(self.is_current, "factorise before solving");
        let mut column = Mat::from_fn(3 * right.len(), 1, |i, _| right[i / 3][i % 3]);
        let symbolic = &self.analysis.symbolic;
        let request = symbolic.solve_in_place_scratch::<f64>(1, Par::Seq);
        let mut memory = MemBuffer::new(request);
        LltRef::new(symbolic, &self.factor).solve_in_place_with_conj(
            Conj::No,
            column.as_mut(),
            Par::Seq,
            MemStack::new(&mut memory),
        );
        (0..right.len())
            .map(|i| {
                DVec3::new(
                    column[(3 * i, 0)],
                    column[(3 * i + 1, 0)],
                    column[(3 * i + 2, 0)],
                )
            })
            .collect()
    }
}

/// Translates the failing pivot to the block row it belongs to.
fn explain(symbolic: &SymbolicCholesky<usize>, error: &LltError) -> LinearFailure {
    let LltError::NonPositivePivot { index } = error;
    let original = symbolic
        .perm()
        .map_or(*index, |perm| perm.arrays().0[*index]);
    LinearFailure::Indefinite(original / 3)
}

pub(crate) fn parallelism() -> Par {
    Par::rayon(0)
}
