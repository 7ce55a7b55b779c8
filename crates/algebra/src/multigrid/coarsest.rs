//! The coarsest level: a dense inverse.

use faer::linalg::solvers::SelfAdjointEigen;
use faer::{Mat, Side};

use super::sparse::Sparse;
use crate::dense_kernels::apart;

/// Eigenvalues below this share of the largest belong to motions that cost nothing; the inverse
/// leaves them out.
const SINGULAR: f64 = 1e-6;

/// The pseudo-inverse of a small level matrix.
#[derive(Debug, Clone)]
pub(super) struct Dense {
    /// Row by row.
    inverse: Vec<f32>,
}

impl Dense {
    /// Inverts a level matrix; `None` if its eigenvalues cannot be found.
    pub(super) fn new<const N: usize>(matrix: &Sparse<N, N>) -> Option<Self> {
        let size = N * matrix.rows();
        let mut dense = Mat::<f64>::identity(size, size);
        for row in 0..matrix.rows() {
            for (column, block) in matrix.row(row) {
                for (c, line) in block.iter().enumerate() {
                    for (r, &entry) in line.iter().enumerate() {
                        dense[(N * row + r, N * column + c)] = f64::from(entry);
                    }
                }
            }
        }
        let inverse = apart(|| {
            let eigen = dense.self_adjoint_eigen(Side::Lower).ok()?;
            Some(pseudo_inverse(&eigen, size))
        });
        Some(Self { inverse: inverse? })
    }

    /// `z = A^+ r`.
    pub(super) fn solve<const N: usize>(&self, rhs: &[[f32; N]], solution: &mut [[f32; N]]) {
        let rhs = rhs.as_flattened();
        let rows = self.inverse.chunks_exact(rhs.len().max(1));
        for (entry, row) in solution.as_flattened_mut().iter_mut().zip(rows) {
            *entry = row.iter().zip(rhs).map(|(a, b)| a * b).sum();
        }
    }

    /// A row of `A^+`.
    pub(super) fn row(&self, row: usize, size: usize) -> &[f32] {
        &self.inverse[row * size..(row + 1) * size]
    }

    /// Bytes of storage.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(&self.inverse[..])
    }
}

fn pseudo_inverse(eigen: &SelfAdjointEigen<f64>, size: usize) -> Vec<f32> {
    let values = eigen.S().column_vector();
    let largest = (0..size).map(|i| values[i]).fold(0.0, f64::max);
    let scaled = Mat::from_fn(size, size, |i, j| match values[j] > SINGULAR * largest {
        true => eigen.U()[(i, j)] / values[j].sqrt(),
        false => 0.0,
    });
    let inverse = &scaled * scaled.transpose();
    (0..size * size)
        .map(|at| inverse[(at / size, at % size)] as f32)
        .collect()
}
