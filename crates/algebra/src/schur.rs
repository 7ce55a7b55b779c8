//! The problem that is left when all other unknowns are eliminated: `(S + C) w = g` with the Schur
//! complement `S` and a matrix `C` that changes.
//!
//! `S` is dense and never changes; `C` is block-sparse and does. A change of `C` alone rarely needs
//! a new factorisation: conjugate gradients with the last one as preconditioner are cheaper as long
//! as no stiffness changed by much.

use faer::dyn_stack::MemStack;
use faer::linalg::cholesky::llt::factor::{
    LltError, LltRegularization, cholesky_in_place, cholesky_in_place_scratch,
};
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::triangular_solve::{
    solve_lower_triangular_in_place, solve_upper_triangular_in_place,
};
use faer::{Accum, ColMut, Mat, Par};
use glam::{DMat3, DVec3};
use rayon::prelude::*;

use crate::conjugate_gradients::{
    ConjugateGradientOutcome, ConjugateGradientSettings, conjugate_gradients,
};
use crate::dense_kernels::{parallelism, reserve_panels, scratch};
use crate::failure::LinearFailure;

/// Cost of one iteration of conjugate gradients, which reads matrix and factor, in operations of a
/// factorisation per entry of the matrix.
const ITERATION_COST: f64 = 32.0;

/// The condensed problem `(S + C) w = g`.
pub struct SchurComplement {
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

impl SchurComplement {
    /// From the Cholesky factor of `S + C_0` and the blocks of `C_0`.
    pub fn new(lower: &Mat<f64>, places: Vec<(u32, u32)>, reference: Vec<DMat3>) -> Self {
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
    pub fn set_stiffness(&mut self, stiffness: &[DMat3]) {
        let pairs = stiffness.iter().zip(&self.reference);
        self.change = pairs.map(|(new, old)| *new - *old).collect();
    }

    /// Change of the stiffness that the present factor has, `C - C_0`.
    pub fn factored(&self) -> Option<&[DMat3]> {
        self.factored.as_deref()
    }

    /// Factorises for a change that [`Self::factored`] told.
    ///
    /// # Errors
    /// [`LinearFailure::Indefinite`] with the number of the block.
    pub fn factorise_again(&mut self, change: Option<Vec<DMat3>>) -> Result<(), LinearFailure> {
        if let Some(change) = change {
            self.change = change;
            self.factorise()?;
        }
        Ok(())
    }

    /// Solves for `rhs` (N), to `tolerance` times its norm if that needs no new factor. Returns the
    /// iterations it took.
    ///
    /// # Errors
    /// [`LinearFailure::Indefinite`] with the number of the block.
    pub fn solve(&mut self, rhs: &mut [f64], tolerance: f64) -> Result<usize, LinearFailure> {
        let mut iterations = 0;
        if self.factored.as_ref() != Some(&self.change) {
            if let Some(solved) = self.iterate(rhs, tolerance, &mut iterations) {
                rhs.copy_from_slice(&solved);
                return Ok(iterations);
            }
            self.factorise()?;
        }
        self.apply_factor(rhs);
        Ok(iterations)
    }

    /// The solution by conjugate gradients, if the present factor serves.
    fn iterate(&self, rhs: &[f64], tolerance: f64, iterations: &mut usize) -> Option<Vec<f64>> {
        let affordable = self.schur.nrows() as f64 / 3.0 / ITERATION_COST;
        if self.expected_iterations(tolerance)? > affordable {
            return None;
        }
        let rhs = blocks(rhs);
        let mut solution = vec![DVec3::ZERO; rhs.len()];
        let mut scratch = vec![0.0; 3 * rhs.len()];
        let report = conjugate_gradients(
            |vector, product| self.multiply(vector, product),
            |residual, correction| {
                scratch.copy_from_slice(&scalars(residual));
                self.apply_factor(&mut scratch);
                correction.copy_from_slice(&blocks(&scratch));
            },
            &rhs,
            &mut solution,
            ConjugateGradientSettings {
                tolerance,
                max_iterations: affordable as usize,
            },
        );
        *iterations = report.iterations;
        (report.outcome == ConjugateGradientOutcome::Converged).then(|| scalars(&solution))
    }

    /// Iterations that conjugate gradients need with the present factor, by the spread of
    /// `(S + C) / (S + C_factored)` on the diagonal: `sqrt(kappa) / 2 ln(2 / tolerance)`.
    fn expected_iterations(&self, tolerance: f64) -> Option<f64> {
        let factored = self.factored.as_ref()?;
        let (mut least, mut most) = (1.0_f64, 1.0_f64);
        for (index, &(row, column)) in self.places.iter().enumerate() {
            if row != column {
                continue;
            }
            for c in 0..3 {
                let place = 3 * row as usize + c;
                let rock = self.schur[(place, place)];
                let ratio =
                    (rock + self.change[index].col(c)[c]) / (rock + factored[index].col(c)[c]);
                (least, most) = (least.min(ratio), most.max(ratio));
            }
        }
        let expected = (most / least).sqrt() / 2.0 * (2.0 / tolerance).ln();
        (least > 0.0 && expected.is_finite()).then_some(expected)
    }

    /// `(S + C) v`; each row is summed in a fixed order.
    fn multiply(&self, vector: &[DVec3], product: &mut [DVec3]) {
        let flat = scalars(vector);
        product.par_iter_mut().enumerate().for_each(|(row, sum)| {
            let dot = |c: usize| dot_in_lanes(self.schur_column(3 * row + c), &flat);
            *sum = DVec3::new(dot(0), dot(1), dot(2));
        });
        for (&(row, column), block) in self.places.iter().zip(&self.change) {
            product[row as usize] += *block * vector[column as usize];
        }
    }

    /// A column of the symmetric `S + C_0`, which is its row.
    fn schur_column(&self, index: usize) -> &[f64] {
        let column = self.schur.col(index).try_as_col_major();
        column.map_or(&[], |column| column.as_slice())
    }

    fn apply_factor(&self, vector: &mut [f64]) {
        let mut column = ColMut::from_slice_mut(vector).as_mat_mut();
        solve_lower_triangular_in_place(self.factor.as_ref(), column.as_mut(), Par::Seq);
        solve_upper_triangular_in_place(self.factor.transpose(), column, Par::Seq);
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
        let mut memory = scratch(request)?;
        reserve_panels()?;
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

/// Scalar product in lanes that the processor adds side by side.
fn dot_in_lanes(a: &[f64], b: &[f64]) -> f64 {
    const LANES: usize = 8;
    let mut sums = [0.0; LANES];
    let (a_parts, b_parts) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let rest: f64 = std::iter::zip(a_parts.remainder(), b_parts.remainder())
        .map(|(a, b)| a * b)
        .sum();
    for (a, b) in a_parts.zip(b_parts) {
        for lane in 0..LANES {
            sums[lane] += a[lane] * b[lane];
        }
    }
    sums.iter().sum::<f64>() + rest
}

fn scalars(vectors: &[DVec3]) -> Vec<f64> {
    vectors.iter().flat_map(|v| v.to_array()).collect()
}

fn blocks(scalars: &[f64]) -> Vec<DVec3> {
    scalars.chunks_exact(3).map(DVec3::from_slice).collect()
}
