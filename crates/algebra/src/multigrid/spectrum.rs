//! An upper bound of the largest eigenvalue of a level matrix, known as a whole or by some of its
//! rows.

use faer::{Mat, Side};
use rayon::prelude::*;

use super::sparse::{Sparse, rows_per_task};
use super::symmetric::{SymmetricMatrix, rows_per_run};
use crate::dense_kernels::apart;

/// Lanczos steps; the bound is a few per cent too large after them.
const STEPS: usize = 10;
/// A Lanczos vector shorter than this ends the recurrence: an invariant subspace is found.
const INVARIANT: f64 = 1e-6;

/// Lanczos: largest eigenvalue of the tridiagonal matrix plus the length of the residual of its
/// vector (Zhou and Li 2011), from a fixed start vector. At least 1, which the largest eigenvalue
/// of a matrix with unit diagonal never falls below.
pub(super) fn largest_eigenvalue<const N: usize>(matrix: &Sparse<N, N>) -> f64 {
    largest_eigenvalue_of_rows(matrix, |_| {})
}

/// The same of a matrix as the cycle keeps it.
pub(super) fn largest_eigenvalue_of_halves<const N: usize>(matrix: &SymmetricMatrix<N>) -> f64 {
    largest_eigenvalue_by(matrix.rows(), |vector, before, factor| {
        let mut image = vec![[0.0; N]; vector.len()];
        let rows = rows_per_run::<N>();
        let runs = image.par_chunks_mut(rows).zip(before.par_chunks(rows));
        runs.enumerate().for_each(|(run, (image, before))| {
            matrix.run_product(run, vector, image);
            for (image, before) in image.iter_mut().zip(before) {
                *image = std::array::from_fn(|i| image[i] - factor as f32 * before[i]);
            }
        });
        image
    })
}

/// The same of a matrix of which some rows are known; `complete` replaces the entries of a vector
/// that belong to the others.
pub(super) fn largest_eigenvalue_of_rows<const N: usize>(
    matrix: &Sparse<N, N>,
    mut complete: impl FnMut(&mut [[f32; N]]),
) -> f64 {
    largest_eigenvalue_by(matrix.rows(), |vector, before, factor| {
        let mut image = image(matrix, vector, before, factor);
        complete(&mut image);
        image
    })
}

/// The same of a matrix of so many rows whose products `A v - factor b` are given.
fn largest_eigenvalue_by<const N: usize>(
    rows: usize,
    mut image: impl FnMut(&[[f32; N]], &[[f32; N]], f64) -> Vec<[f32; N]>,
) -> f64 {
    let mut vector = start_vector::<N>(rows);
    let mut before = vec![[0.0; N]; rows];
    let (mut diagonal, mut beside) = (Vec::new(), Vec::new());
    let mut length = dot(&vector, &vector).sqrt();
    scale(&mut vector, length);
    for _ in 0..STEPS.min(N * rows) {
        let factor = if beside.is_empty() { 0.0 } else { length };
        let mut next = image(&vector, &before, factor);
        let share = dot(&next, &vector);
        subtract(&mut next, share, &vector);
        diagonal.push(share);
        length = dot(&next, &next).sqrt();
        beside.push(length);
        if length < INVARIANT || !length.is_finite() {
            break;
        }
        scale(&mut next, length);
        before = std::mem::replace(&mut vector, next);
    }
    bound(&diagonal, &beside).max(1.0)
}

fn bound(diagonal: &[f64], beside: &[f64]) -> f64 {
    let size = diagonal.len();
    if size == 0 {
        return 1.0;
    }
    let tridiagonal = Mat::from_fn(size, size, |i, j| match i.abs_diff(j) {
        0 => diagonal[i],
        1 => beside[i.min(j)],
        _ => 0.0,
    });
    let Ok(eigen) = apart(|| tridiagonal.self_adjoint_eigen(Side::Lower)) else {
        return f64::NAN;
    };
    let last = size - 1;
    eigen.S().column_vector()[last] + beside[last] * eigen.U()[(last, last)].abs()
}

/// Pseudo-random numbers in [-1, 1): the finalizer of splitmix64 over the index.
fn start_vector<const N: usize>(rows: usize) -> Vec<[f32; N]> {
    let number = |index: usize| {
        let mut bits = (index as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((bits ^ (bits >> 31)) >> 40) as f32 / (1 << 23) as f32 - 1.0
    };
    let row = |row: usize| std::array::from_fn(|entry| number(N * row + entry + 1));
    (0..rows).into_par_iter().map(row).collect()
}

/// `A v - factor b`.
fn image<const N: usize>(
    matrix: &Sparse<N, N>,
    vector: &[[f32; N]],
    before: &[[f32; N]],
    factor: f64,
) -> Vec<[f32; N]> {
    let rows = (0..matrix.rows()).into_par_iter();
    let entry = |row: usize| {
        let product = matrix.times(row, vector);
        std::array::from_fn(|i| product[i] - factor as f32 * before[row][i])
    };
    rows.with_min_len(rows_per_task::<N>()).map(entry).collect()
}

fn scale<const N: usize>(vector: &mut [[f32; N]], length: f64) {
    let inverse = if length > 0.0 { 1.0 / length } else { 0.0 };
    let entries = vector.as_flattened_mut().par_iter_mut();
    entries.for_each(|entry| *entry = (f64::from(*entry) * inverse) as f32);
}

fn subtract<const N: usize>(vector: &mut [[f32; N]], share: f64, other: &[[f32; N]]) {
    let entries = vector.as_flattened_mut().par_iter_mut();
    let both = entries.zip(other.as_flattened());
    both.for_each(|(entry, other)| *entry -= share as f32 * other);
}

/// Scalar product; the order of its sums is fixed.
fn dot<const N: usize>(a: &[[f32; N]], b: &[[f32; N]]) -> f64 {
    let rows = rows_per_task::<N>();
    let chunks = a.par_chunks(rows).zip(b.par_chunks(rows));
    let sums: Vec<f64> = chunks
        .map(|(a, b)| {
            let both = a.as_flattened().iter().zip(b.as_flattened());
            both.map(|(&a, &b)| f64::from(a) * f64::from(b)).sum()
        })
        .collect();
    sums.iter().sum()
}
