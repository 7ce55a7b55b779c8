//! The smoothed prolongator `P = (I - omega A) T` (Vanek, Mandel, Brezina 1996), `A` having the
//! identity as its diagonal.

use super::aggregation::{ALONE, Aggregates, STRENGTH, square};
use super::sparse::{Accumulator, Sparse, rows_per_task};
use super::tentative::Tentative;
use crate::small::{Modes, add, add_product, widen};

/// Numerator of `omega = 4/3 / (largest eigenvalue)`.
const DAMPING: f64 = 4.0 / 3.0;
/// Largest force of a node in an extended motion of an aggregate, whose columns of `T` are of
/// length 1. Motions of nodes that lie nearly on a line say nothing about one beside them.
const MOST_FORCE: f32 = 3.0;

/// The tentative prolongator of nodes with these modes, to be smoothed.
pub(super) struct Unsmoothed<'a, const N: usize> {
    pub(super) aggregates: &'a Aggregates,
    pub(super) tentative: &'a Tentative<N>,
    pub(super) modes: &'a [Modes<N>],
}

impl<const N: usize> Unsmoothed<'_, N> {
    /// Smooths it by a matrix with this bound of its eigenvalues.
    ///
    /// A neighbour in another aggregate that hardly resists the aggregate of the row moves as if it
    /// belonged to that one: `T` is extended to it by the modes, `B R^-1`. Rigid motions stay, and
    /// aggregates that hardly resist each other do not become neighbours on the next level
    /// (filtered matrices in Vanek, Mandel, Brezina 1996). Rows that are not `is_wanted` are empty.
    pub(super) fn smoothed(
        &self,
        matrix: &Sparse<N, N>,
        largest_eigenvalue: f64,
        is_wanted: impl Fn(usize) -> bool + Sync + Send,
    ) -> Sparse<N, 6> {
        let omega = DAMPING / largest_eigenvalue;
        let moves = |row: usize| {
            let neighbours = matrix.row(row);
            neighbours.filter_map(move |(at, block)| {
                let (aggregate, motion) = self.moved(row, at, block)?;
                Some((block, aggregate, motion))
            })
        };
        let own = |row: usize| Some(self.aggregates.of_node[row]).filter(|own| *own != ALONE);
        Sparse::build(
            matrix.rows(),
            rows_per_task::<N>(),
            || Accumulator::<N, 6>::new(self.aggregates.count),
            |sums, row| {
                if !is_wanted(row) {
                    return 0;
                }
                own(row).into_iter().for_each(|own| sums.touch(own));
                moves(row).for_each(|(_, aggregate, _)| sums.touch(aggregate));
                sums.take_count()
            },
            #[inline(always)]
            |sums, row, columns, blocks| {
                if columns.is_empty() {
                    return;
                }
                if let Some(own) = own(row) {
                    let motion = widen(&self.tentative.blocks[row]);
                    add(sums.at(own), 1.0 - omega, &motion);
                }
                for (block, aggregate, motion) in moves(row) {
                    add_product(sums.at(aggregate), -omega, block, &motion);
                }
                sums.take(columns, blocks);
            },
        )
    }

    /// The aggregate that moves the neighbour `at` of a row, and how; none where nothing does.
    #[inline(always)]
    fn moved(&self, row: usize, at: usize, block: &[[f32; N]; N]) -> Option<Motion<N>> {
        let (own, other) = (self.aggregates.of_node[row], self.aggregates.of_node[at]);
        if own != ALONE && own != other {
            let size = square(block);
            if other == ALONE || size <= STRENGTH * STRENGTH {
                let motion = self.tentative.extended(&self.modes[at], own);
                let entries = motion.as_flattened().iter();
                let largest = entries.fold(0.0_f32, |largest, entry| largest.max(entry.abs()));
                if size * largest * largest <= MOST_FORCE * MOST_FORCE {
                    return Some((own, motion));
                }
            }
        }
        (other != ALONE).then(|| (other, self.tentative.blocks[at]))
    }
}

/// An aggregate, and the block of `T` by which it moves a node.
type Motion<const N: usize> = (u32, [[f32; 6]; N]);
