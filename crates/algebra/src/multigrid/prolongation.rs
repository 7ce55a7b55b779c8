//! The smoothed prolongator `P = (I - omega A) T` (Vanek, Mandel, Brezina 1996), `A` having the
//! identity as its diagonal.

use super::aggregation::{ALONE, Aggregates};
use super::sparse::{Accumulator, Sparse, rows_per_task};
use super::tentative::Tentative;
use crate::small::{add, add_product, widen};

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
