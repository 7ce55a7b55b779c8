//! The smoothed prolongator `P = (I - omega A) T` (Vanek, Mandel, Brezina 1996), `A` having the
//! identity as its diagonal.

use super::aggregation::{ALONE, Aggregates};
use super::small::{add, widen};
use super::sparse::{Accumulator, Sparse, rows_per_task};
use super::tentative::Tentative;

/// Numerator of `omega = 4/3 / (largest eigenvalue)`.
const DAMPING: f64 = 4.0 / 3.0;

/// Smooths the tentative prolongator.
pub(super) fn smoothed<const N: usize>(
    matrix: &Sparse<N, N>,
    largest_eigenvalue: f64,
    aggregates: &Aggregates,
    tentative: &Tentative<N>,
) -> Sparse<N, 6> {
    let omega = DAMPING / largest_eigenvalue;
    let of_node = &aggregates.of_node;
    let neighbours = |row: usize| matrix.row(row).filter(|(at, _)| of_node[*at] != ALONE);
    Sparse::build(
        matrix.rows(),
        rows_per_task::<N>(),
        || Accumulator::<N, 6>::new(aggregates.count),
        |sums, row| {
            if of_node[row] != ALONE {
                sums.touch(of_node[row]);
            }
            neighbours(row).for_each(|(at, _)| sums.touch(of_node[at]));
            sums.take_count()
        },
        #[inline(always)]
        |sums, row, columns, blocks| {
            if of_node[row] != ALONE {
                let own = widen(&tentative.blocks[row]);
                add(sums.at(of_node[row]), 1.0 - omega, &own);
            }
            for (at, block) in neighbours(row) {
                let sum = sums.at(of_node[at]);
                add_product(sum, -omega, block, &tentative.blocks[at]);
            }
            sums.take(columns, blocks);
        },
    )
}

/// `S += A B`, with `A` as columns and `B` as rows: line by line, so that a line stays in registers.
#[inline(always)]
pub(super) fn add_columns<const M: usize, const N: usize>(
    sum: &mut [[f64; 6]; M],
    a: &[[f64; M]; N],
    b: &[[f64; 6]; N],
) {
    for (i, sum) in sum.iter_mut().enumerate() {
        let mut line = *sum;
        for (a, b) in a.iter().zip(b) {
            for (entry, b) in line.iter_mut().zip(b) {
                *entry += a[i] * b;
            }
        }
        *sum = line;
    }
}

/// `S += factor A B`, with `A` as columns and `B` as rows.
#[inline(always)]
pub(super) fn add_product<const N: usize>(
    sum: &mut [[f64; 6]; N],
    factor: f64,
    a: &[[f32; N]; N],
    b: &[[f32; 6]; N],
) {
    let mut a = widen(a);
    a.as_flattened_mut()
        .iter_mut()
        .for_each(|entry| *entry *= factor);
    add_columns(sum, &a, &widen(b));
}
