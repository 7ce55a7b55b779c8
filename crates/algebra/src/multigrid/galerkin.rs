//! The matrix of the next level, `P^T A P`, in unknowns that scale its diagonal to the identity.

use rayon::prelude::*;

use super::continuity::Continuity;
use super::sparse::{Sparse, Transpose, rows_per_task};
use super::triple_product::{Block6, PartialProduct};
use crate::division::{Communicator, Division};
use crate::small::{Modes, inverse_factor, narrow, product, transpose, widen};

/// A motion of an aggregate with less than this share of the energy of its stiffest one costs
/// nothing within single precision; it is left out of the next level.
const COSTS_NOTHING: f64 = 1e-6;

/// The next level.
pub(super) struct Coarse {
    pub(super) matrix: Sparse<6, 6>,
    pub(super) modes: Vec<Modes<6>>,
    pub(super) continuity: Continuity,
}

/// What is known of the nodes of the next level.
#[derive(Clone, Copy)]
pub(super) struct CoarseNodes<'a> {
    /// Modes in unknowns that are not scaled.
    pub(super) modes: &'a [Modes<6>],
    pub(super) continuity: &'a Continuity,
}

/// The next level of `P^T A P`, whose nodes are these, and `L^-1` of the diagonal blocks of this,
/// which scales its unknowns. The ranks divide the work.
pub(super) fn coarse(
    whole: PartialProduct,
    nodes: (CoarseNodes<'_>, &Communicator),
) -> (Coarse, Vec<[[f32; 6]; 6]>) {
    let factors = factors(&whole);
    let scaling = factors.par_iter().map(narrow).collect();
    (scaled(whole, &factors, nodes), scaling)
}

/// `L^-1` of the diagonal blocks.
pub(super) fn factors(whole: &PartialProduct) -> Vec<Block6> {
    let diagonal = whole.diagonal.par_iter();
    diagonal
        .map(|block| inverse_factor(block, COSTS_NOTHING).0)
        .collect()
}

/// The next level in unknowns that scale its diagonal, whose factors are given. The ranks divide
/// the work.
pub(super) fn scaled(
    whole: PartialProduct,
    factors: &[Block6],
    (nodes, ranks): (CoarseNodes<'_>, &Communicator),
) -> Coarse {
    // Energy projection on the columns kept: `L^-1 A_ii`, which is `L^T` if none was left out.
    let scaled = factors.par_iter().zip(&whole.diagonal).zip(nodes.modes);
    let modes = scaled.map(|((factor, block), modes)| product(&product(factor, block), modes));
    let modes = modes.collect();
    let division = ranks.divide_evenly(factors.len());
    let own = scaled_matrix(&whole.upper, factors, &division);
    drop(whole);
    Coarse {
        modes,
        matrix: own.completed(&division),
        continuity: nodes.continuity.clone(),
    }
}

/// `L^-1 A L^-T` without its diagonal, blocks as columns, from the blocks of `A` right of the
/// diagonal, blocks as rows: symmetric to the last bit. Rows of other ranks are empty.
fn scaled_matrix(upper: &Sparse<6, 6>, factors: &[Block6], division: &Division) -> Sparse<6, 6> {
    let lower = Transpose::of(upper, upper.rows());
    let scaled = |row: usize, column: usize, block: &[[f32; 6]; 6]| {
        let right = transpose(&factors[column]);
        narrow(&product(&product(&factors[row], &widen(block)), &right))
    };
    let own = division.own();
    Sparse::build(
        upper.rows(),
        rows_per_task::<6>(),
        || (),
        |(), row| match own.contains(&row) {
            true => lower.column(row).len() + upper.range(row).len(),
            false => 0,
        },
        #[inline(always)]
        |(), row, columns, blocks| {
            if columns.is_empty() {
                return;
            }
            let mut targets = columns.iter_mut().zip(blocks);
            for (&(at, position), (column, target)) in lower.column(row).iter().zip(&mut targets) {
                let block = &upper.blocks[position as usize];
                (*column, *target) = (at, scaled(at as usize, row, block));
            }
            for ((at, block), (column, target)) in upper.row(row).zip(targets) {
                (*column, *target) = (at as u32, transpose(&scaled(row, at, block)));
            }
        },
    )
}
