//! The block Jacobi step on the prolongator to the finest level.

use super::block_jacobi::Factors;
use super::clusters::Clusters;
use super::sparse::{Accumulator, Sparse, rows_per_task};
use crate::small::{add_columns, widen};

/// The prolongator to scaled unknowns, `L^T P'`, after a block Jacobi step on the interface.
///
/// What `P` moves, it moves as if the interface had no stiffness `S`. The step is that of the
/// unknowns of each cluster, those of all others being held: `P' = P - A^-1 S P = A^-1 R P`, with
/// `A = R + S = L L^T` and `R` of the fixed matrix, hence `L^T P' = L^-1 R P`. Motions that would
/// strain a stiff interface strain what lies beside it instead, so that the next level is as stiff
/// as the fixed matrix, however stiff the interface is. Rigid motions, where `S P = 0`, stay.
///
/// Rows of clusters that were not factorised are empty.
pub(super) fn smoothed_by_blocks(
    basis: &Sparse<3, 6>,
    columns: usize,
    clusters: &Clusters,
    factors: &Factors,
) -> Sparse<3, 6> {
    let step = BlockStep {
        basis,
        clusters,
        factors,
    };
    Sparse::build(
        basis.rows(),
        rows_per_task::<3>(),
        || Accumulator::<3, 6>::new(columns),
        |sums, row| {
            let (own, _) = clusters.place[row];
            if !factors.has(own) {
                return 0;
            }
            for &member in clusters.members.of(own as usize) {
                let columns = &basis.columns[basis.range(member as usize)];
                columns.iter().for_each(|&column| sums.touch(column));
            }
            sums.take_count()
        },
        #[inline(always)]
        |sums, row, columns, blocks| step.set_row(sums, row, (columns, blocks)),
    )
}

/// Sets the rows of `clusters` that are `is_wanted` in a prolongator that
/// [`smoothed_by_blocks`] made of the same basis, of which only these rows are needed.
pub(super) fn smooth_again(
    prolongator: &mut Sparse<3, 6>,
    basis: &Sparse<3, 6>,
    columns: usize,
    (clusters, factors): (&Clusters, &Factors),
    is_wanted: impl Fn(usize) -> bool + Sync + Send,
) {
    let step = BlockStep {
        basis,
        clusters,
        factors,
    };
    prolongator.fill(
        rows_per_task::<3>(),
        || Accumulator::<3, 6>::new(columns),
        #[inline(always)]
        |sums, row, columns, blocks| {
            if is_wanted(row) {
                step.set_row(sums, row, (columns, blocks));
            }
        },
    );
}

/// The block Jacobi step of [`smoothed_by_blocks`].
struct BlockStep<'a> {
    basis: &'a Sparse<3, 6>,
    clusters: &'a Clusters,
    factors: &'a Factors,
}

impl BlockStep<'_> {
    /// Sets columns and blocks of a row.
    #[inline(always)]
    fn set_row(
        &self,
        sums: &mut Accumulator<3, 6>,
        row: usize,
        (columns, blocks): (&mut [u32], &mut [[[f32; 6]; 3]]),
    ) {
        if columns.is_empty() {
            return;
        }
        let (own, at) = self.clusters.place[row];
        let members = self.clusters.members.of(own as usize).iter();
        for (place, &member) in members.enumerate() {
            let left = self.factors.smoothing_block(own, at as usize, place);
            for (column, value) in self.basis.row(member as usize) {
                add_columns(sums.at(column as u32), &left, &widen(value));
            }
        }
        sums.take(columns, blocks);
    }
}
