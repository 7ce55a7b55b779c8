//! Chebyshev smoothing: polynomials of the level matrix, the same before and after the coarse
//! levels, so that the cycle is symmetric.

use rayon::prelude::*;

use super::sparse::rows_per_task;
use super::symmetric::{SymmetricMatrix, rows_per_run};

/// Number of products with the matrix in one smoothing.
const DEGREE: usize = 2;
/// `beta_k`, for which the bound of the two-level method is smallest (Lottes 2022, table 1).
const WEIGHTS: [f64; DEGREE] = [1.02387287570313, 1.26408905371085];

/// A Chebyshev polynomial of the fourth kind with optimal weights (Lottes 2022; Adams et al. 2003
/// for Chebyshev smoothing as such), which needs no lower end of the spectrum:
/// `d_k = a_k d_(k-1) + b_k (r - A (z_0 + d_1 + ... + d_(k-1)))`, `z = z_0 + sum_k beta_k d_k`.
#[derive(Debug, Clone)]
pub(super) struct Smoother {
    largest_eigenvalue: f64,
    steps: [ChebyshevStep; DEGREE],
}

/// How a step comes about and what the solution takes of it.
#[derive(Debug, Clone, Copy)]
struct ChebyshevStep {
    /// `a_k`.
    before: f32,
    /// `b_k`.
    residual: f32,
    /// Of the last step, beyond what the solution has of it, and of this one.
    weights: [f32; 2],
}

/// Vectors that a level works with, one entry a node.
#[derive(Debug, Clone)]
pub(super) struct Work<const N: usize> {
    /// Right-hand side `r`.
    pub(super) rhs: Vec<[f32; N]>,
    /// Solution `z`.
    pub(super) solution: Vec<[f32; N]>,
    /// Last step `d`; between smoothings, the residual.
    pub(super) step: Vec<[f32; N]>,
    next: Vec<[f32; N]>,
}

impl<const N: usize> Work<N> {
    pub(super) fn new(rows: usize) -> Self {
        let zeros = vec![[0.0; N]; rows];
        Self {
            rhs: zeros.clone(),
            solution: zeros.clone(),
            step: zeros.clone(),
            next: zeros,
        }
    }
}

impl Smoother {
    /// For a matrix with this bound of its eigenvalues.
    pub(super) fn new(largest_eigenvalue: f64) -> Self {
        let step = |index: usize| {
            let k = (index + 1) as f64;
            let a = (2.0 * k - 3.0).max(0.0) / (2.0 * k + 1.0);
            let b = (8.0 * k - 4.0) / (2.0 * k + 1.0) / largest_eigenvalue;
            let weights = match index + 1 == DEGREE {
                true => [WEIGHTS[index - 1] - 1.0, WEIGHTS[index]],
                false => [0.0, 1.0],
            };
            ChebyshevStep {
                before: a as f32,
                residual: b as f32,
                weights: weights.map(|weight| weight as f32),
            }
        };
        Self {
            largest_eigenvalue,
            steps: std::array::from_fn(step),
        }
    }

    /// The bound.
    pub(super) fn largest_eigenvalue(&self) -> f64 {
        self.largest_eigenvalue
    }

    /// For a spectrum that reaches further by `margin` than the bound says.
    pub(super) fn with_margin(&self, margin: f64) -> Self {
        Self {
            largest_eigenvalue: self.largest_eigenvalue,
            ..Self::new(margin * self.largest_eigenvalue)
        }
    }

    /// Smooths from zero.
    pub(super) fn start<const N: usize>(&self, matrix: &SymmetricMatrix<N>, work: &mut Work<N>) {
        let factor = self.steps[0].residual;
        let rows = rows_per_task::<N>();
        let targets = work.solution.par_chunks_mut(rows);
        let targets = targets.zip(work.step.par_chunks_mut(rows));
        let tasks = targets.zip(work.rhs.par_chunks(rows));
        tasks.for_each(|((solution, step), rhs)| {
            for ((solution, step), rhs) in solution.iter_mut().zip(step).zip(rhs) {
                *step = rhs.map(|entry| factor * entry);
                *solution = *step;
            }
        });
        for &step in &self.steps[1..] {
            advance(matrix, work, step);
        }
    }

    /// Smooths what the solution is so far.
    pub(super) fn resume<const N: usize>(&self, matrix: &SymmetricMatrix<N>, work: &mut Work<N>) {
        for &step in &self.steps {
            advance(matrix, work, step);
        }
    }
}

fn advance<const N: usize>(matrix: &SymmetricMatrix<N>, work: &mut Work<N>, by: ChebyshevStep) {
    let (a, b, [last, own]) = (by.before, by.residual, by.weights);
    let rows = rows_per_run::<N>();
    let (rhs, old) = (&work.rhs, &work.solution);
    let targets = work.next.par_chunks_mut(rows);
    let tasks = targets.zip(work.step.par_chunks_mut(rows)).enumerate();
    tasks.for_each(|(run, (next, step))| {
        matrix.run_product(run, old, next);
        for (place, (next, step)) in next.iter_mut().zip(step).enumerate() {
            let row = run * rows + place;
            for i in 0..N {
                let before = step[i];
                step[i] = a * step[i] + b * (rhs[row][i] - next[i]);
                next[i] = old[row][i] + last * before + own * step[i];
            }
        }
    });
    std::mem::swap(&mut work.solution, &mut work.next);
}

/// Writes the residual where the last step was.
pub(super) fn residual<const N: usize>(matrix: &SymmetricMatrix<N>, work: &mut Work<N>) {
    let rows = rows_per_run::<N>();
    let (rhs, solution) = (&work.rhs, &work.solution);
    let tasks = work.step.par_chunks_mut(rows).enumerate();
    tasks.for_each(|(run, residual)| {
        matrix.run_product(run, solution, residual);
        for (place, residual) in residual.iter_mut().enumerate() {
            let rhs = rhs[run * rows + place];
            *residual = std::array::from_fn(|i| rhs[i] - residual[i]);
        }
    });
}
