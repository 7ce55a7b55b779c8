//! The V-cycle.

use std::sync::Arc;

use rayon::prelude::*;

use super::coarsest::Dense;
use super::smoother::{Smoother, Work, residual};
use super::sparse::{Sparse, Transpose, rows_per_task};
use super::symmetric::SymmetricMatrix;

/// Smoothings of a coarsest level that is too large to invert, as after disconnected bodies.
const LAST_SMOOTHINGS: usize = 2;

/// A level and the way to the next. While others are made of it, its matrix has all blocks.
#[derive(Debug, Clone)]
pub(super) struct Level<const N: usize, A = SymmetricMatrix<N>> {
    pub(super) matrix: A,
    pub(super) smoother: Smoother,
    pub(super) below: Below<N>,
}

/// What is below a level.
#[derive(Debug, Clone)]
pub(super) enum Below<const N: usize> {
    /// Another level.
    Level(Transfer<N>),
    /// None: this level is inverted.
    Inverse(Dense),
    /// None: nothing couples any more, or hardly; this level is smoothed.
    Nothing,
}

/// A prolongator `P`, and its blocks aggregate by aggregate.
#[derive(Debug, Clone, Default)]
pub(super) struct Prolongator<const N: usize> {
    pub(super) rows: Sparse<N, 6>,
    pub(super) transpose: Transpose,
}

impl<const N: usize> Prolongator<N> {
    pub(super) fn of(rows: Sparse<N, 6>, aggregates: usize) -> Self {
        Self {
            transpose: Transpose::of(&rows, aggregates),
            rows,
        }
    }

    /// Bytes of storage.
    pub(super) fn bytes(&self) -> usize {
        self.rows.bytes() + self.transpose.bytes()
    }

    /// An entry of `P^T r`.
    fn restricted(&self, aggregate: usize, residual: &[[f32; N]]) -> [f32; 6] {
        let mut sum = [0.0; 6];
        for &(row, position) in self.transpose.column(aggregate) {
            let block = &self.rows.blocks[position as usize];
            let mut part = [0.0; 6];
            for (line, &entry) in block.iter().zip(&residual[row as usize]) {
                for (part, &weight) in part.iter_mut().zip(line) {
                    *part += weight * entry;
                }
            }
            for (sum, part) in sum.iter_mut().zip(part) {
                *sum += part;
            }
        }
        sum
    }
}

/// The way down to the next level, whose unknowns are scaled by `L`, and up again.
#[derive(Debug, Clone, Default)]
pub(super) struct Transfer<const N: usize> {
    pub(super) prolongator: Arc<Prolongator<N>>,
    /// `L^-1` of each aggregate, as rows.
    pub(super) scaling: Vec<[[f32; 6]; 6]>,
}

impl<const N: usize> Transfer<N> {
    /// `r_c = L^-1 P^T r`.
    fn restrict(&self, residual: &[[f32; N]], coarse: &mut [[f32; 6]]) {
        let rows = rows_per_task::<6>();
        let tasks = coarse.par_chunks_mut(rows).enumerate();
        tasks.for_each(|(task, chunk)| {
            for (place, target) in chunk.iter_mut().enumerate() {
                let aggregate = task * rows + place;
                let sum = self.prolongator.restricted(aggregate, residual);
                *target = self.scaling[aggregate].map(|line| {
                    let both = line.iter().zip(&sum);
                    both.map(|(weight, entry)| weight * entry).sum()
                });
            }
        });
    }

    /// `z += P L^-T z_c`, where `z_c` becomes `L^-T z_c`.
    fn prolong(&self, coarse: &mut [[f32; 6]], solution: &mut [[f32; N]]) {
        let pairs = coarse.par_iter_mut().zip(&self.scaling);
        let pairs = pairs.with_min_len(rows_per_task::<6>());
        pairs.for_each(|(entries, scaling)| {
            let mut sum = [0.0; 6];
            for (line, &entry) in scaling.iter().zip(&*entries) {
                for (sum, weight) in sum.iter_mut().zip(line) {
                    *sum += weight * entry;
                }
            }
            *entries = sum;
        });
        let coarse = &*coarse;
        let rows = rows_per_task::<N>();
        let tasks = solution.par_chunks_mut(rows).enumerate();
        tasks.for_each(|(task, chunk)| {
            for (place, sum) in chunk.iter_mut().enumerate() {
                for (column, block) in self.prolongator.rows.row(task * rows + place) {
                    for (sum, line) in sum.iter_mut().zip(block) {
                        let both = line.iter().zip(&coarse[column]);
                        *sum += both.map(|(weight, entry)| weight * entry).sum::<f32>();
                    }
                }
            }
        });
    }

    fn bytes(&self) -> usize {
        self.prolongator.bytes() + size_of_val(&self.scaling[..])
    }
}

impl<const N: usize> Level<N, Sparse<N, N>> {
    /// As the cycle keeps it.
    pub(super) fn compact(self) -> Level<N> {
        Level {
            matrix: SymmetricMatrix::of(self.matrix),
            smoother: self.smoother,
            below: self.below,
        }
    }
}

impl<const N: usize> Level<N> {
    /// A level without unknowns.
    pub(super) fn empty() -> Self {
        Self {
            matrix: SymmetricMatrix::of(Sparse::empty()),
            smoother: Smoother::new(1.0),
            below: Below::Nothing,
        }
    }

    /// Bytes of storage.
    pub(super) fn bytes(&self) -> usize {
        let below = match &self.below {
            Below::Level(transfer) => transfer.bytes(),
            Below::Inverse(dense) => dense.bytes(),
            Below::Nothing => 0,
        };
        self.matrix.bytes() + below
    }

    /// One symmetric V-cycle from zero: `work.solution` from `work.rhs`.
    pub(super) fn cycle(
        &self,
        work: &mut Work<N>,
        coarser: &[Level<6>],
        coarser_work: &mut [Work<6>],
    ) {
        match (&self.below, coarser, coarser_work) {
            (Below::Inverse(dense), _, _) => dense.solve(&work.rhs, &mut work.solution),
            (Below::Level(transfer), [next, coarser @ ..], [next_work, coarser_work @ ..]) => {
                self.smoother.start(&self.matrix, work);
                residual(&self.matrix, work);
                transfer.restrict(&work.step, &mut next_work.rhs);
                next.cycle(next_work, coarser, coarser_work);
                transfer.prolong(&mut next_work.solution, &mut work.solution);
                self.smoother.resume(&self.matrix, work);
            }
            _ => {
                self.smoother.start(&self.matrix, work);
                for _ in 1..LAST_SMOOTHINGS {
                    self.smoother.resume(&self.matrix, work);
                }
            }
        }
    }
}
