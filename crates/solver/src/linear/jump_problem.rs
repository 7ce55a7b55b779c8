//! The condensed problem of the jumps: `(S + C) w = g` with the Schur complement `S` of the rock and
//! the stiffness `C` of the fractures.
//!
//! `S` is dense and never changes; `C` is block-sparse and does. A change of `C` alone rarely needs a
//! new factorisation: conjugate gradients with the last one as preconditioner are cheaper as long
//! as no stiffness changed by much.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{
    LltError, LltRegularization, cholesky_in_place, cholesky_in_place_scratch,
};
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::triangular_solve::{
    solve_lower_triangular_in_place, solve_upper_triangular_in_place,
};
use faer::{Accum, ColMut, Mat, Par};
use glam::DMat3;

use super::{LinearFailure, parallelism};

/// The condensed problem.
pub(super) struct JumpProblem {
    /// `S + C_0`, whole.
    schur: Mat<f64>,
    /// Block row and column of each block of `C`, rows ascending.
    places: Vec<(u32, u32)>,
    /// Blocks of `C_0`.
    reference: Vec<DMat3>,
    /// Blocks of `C - C_0`.
    change: Vec<DMat3>,
    /// Lower Cholesky factor of `S + C` for some former `C`.
    factor: Mat<f64>,
    /// Its `C - C_0`.
    factored: Option<Vec<DMat3>>,
}

impl JumpProblem {
    /// From the Cholesky factor of `S + C_0` and the blocks of `C_0`.
    pub(super) fn new(lower: &Mat<f64>, places: Vec<(u32, u32)>, reference: Vec<DMat3>) -> Self {
        let size = lower.nrows();
        let mut schur = Mat::zeros(size, size);
        triangular::matmul(
            &mut schur,
            BlockStructure::TriangularLower,
            Accum::Replace,
            lower,
            BlockStructure::TriangularLower,
            lower.transpose(),
            BlockStructure::TriangularUpper,
            1.0,
            parallelism(),
        );
        for column in 0..size {
            for row in column + 1..size {
                schur[(column, row)] = schur[(row, column)];
            }
        }
        Self {
            schur,
            places,
            change: vec![DMat3::ZERO; reference.len()],
            reference,
            factor: Mat::new(),
            factored: None,
        }
    }

    /// Takes over the blocks of `C`.
    pub(super) fn set_stiffness(&mut self, stiffness: &[DMat3]) {
        let pairs = stiffness.iter().zip(&self.reference);
        self.change = pairs.map(|(new, old)| *new - *old).collect();
    }

    /// Solves for `right` (N).
    ///
    /// # Errors
    /// [`LinearFailure::Indefinite`] with the number of the block.
    pub(super) fn solve(&mut self, right: &mut [f64]) -> Result<(), LinearFailure> {
        if self.factored.as_ref() != Some(&self.change) {
            self.factorise()?;
        }
        let mut column = ColMut::from_slice_mut(right).as_mat_mut();
        solve_lower_triangular_in_place(self.factor.as_ref(), column.as_mut(), Par::Seq);
        solve_upper_triangular_in_place(self.factor.transpose(), column, Par::Seq);
        Ok(())
    }

    fn factorise(&mut self) -> Result<(), LinearFailure> {
        self.factored = None;
        self.factor.clone_from(&self.schur);
        for (&(row, column), block) in self.places.iter().zip(&self.change) {
            let (row, column) = (3 * row as usize, 3 * column as usize);
            for c in 0..3 {
                for r in 0..3 {
                    self.factor[(row + r, column + c)] += block.col(c)[r];
                }
            }
        }
        let size = self.factor.nrows();
        let request = cholesky_in_place_scratch::<f64>(size, parallelism(), faer::Spec::default());
        let mut memory = MemBuffer::try_new(request).map_err(|_| LinearFailure::OutOfMemory)?;
        cholesky_in_place(
            self.factor.as_mut(),
            LltRegularization::default(),
            parallelism(),
            MemStack::new(&mut memory),
            faer::Spec::default(),
        )
        .map_err(|LltError::NonPositivePivot { index }| LinearFailure::Indefinite(index / 3))?;
        self.factored = Some(self.change.clone());
        Ok(())
    }
}
