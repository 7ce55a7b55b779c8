//! The finest matrix in scaled unknowns.
//!
//! With `A_ii = L_i L_i^T`, the matrix `L_i^-1 A_ij L_j^-T` has the identity on its diagonal. In
//! these unknowns the block Jacobi method is Richardson's, the diagonal needs no storage, and
//! single precision suffices whatever the units and however strongly stiffness and mesh are graded.

use glam::{DMat3, DVec3};
use rayon::prelude::*;

use super::MultigridFailure;
use super::block_rows::BlockRows;
use super::small::{inverse_factor, narrow, product, transpose};
use super::sparse::{Sparse, rows_per_task};

/// A pivot below this share of the largest diagonal entry shows a singular block.
const SINGULAR: f64 = 1e-14;

/// Inverse factors `L^-1` of the diagonal blocks, as rows `[a], [b, c], [d, e, f]` one behind the
/// other.
pub(super) type Factors = Vec<[f32; 6]>;

/// Modes of a node of a level, one row for each of its unknowns.
pub(super) type Modes<const N: usize> = [[f64; 6]; N];

/// The rows and columns of a larger matrix that a level is made of.
#[derive(Clone, Copy)]
pub(super) struct Selection<'a> {
    pub(super) matrix: BlockRows<'a>,
    /// Rows that belong to it, ascending.
    pub(super) kept: &'a [u32],
    /// New number of each row of the larger matrix.
    pub(super) number: &'a [u32],
}

impl Selection<'_> {
    fn diagonal(&self, new: usize) -> Option<[[f64; 3]; 3]> {
        let row = self.kept[new] as usize;
        let found = self
            .matrix
            .row(row)
            .find(|(column, _)| *column as usize == row);
        found.map(|(_, block)| rows_of(block))
    }
}

fn rows_of(block: &DMat3) -> [[f64; 3]; 3] {
    block.transpose().to_cols_array_2d()
}

/// `L^-1` of every diagonal block.
pub(super) fn factors(selection: Selection<'_>) -> Result<Vec<[[f64; 3]; 3]>, MultigridFailure> {
    let factor = |row: usize| {
        let block = selection.diagonal(row).unwrap_or_default();
        let (inverse, kept) = inverse_factor(&block, SINGULAR);
        let finite = inverse.as_flattened().iter().all(|entry| entry.is_finite());
        match finite && kept == [true; 3] {
            true => Ok(inverse),
            false => Err(MultigridFailure::NotPositive(row)),
        }
    };
    (0..selection.kept.len())
        .into_par_iter()
        .map(factor)
        .collect()
}

/// The scaled matrix without its diagonal; blocks that are zero, as beside held nodes, are dropped.
pub(super) fn matrix(selection: Selection<'_>, factors: &[[[f64; 3]; 3]]) -> Sparse<3, 3> {
    let coupled = |row: usize| {
        let blocks = selection.matrix.row(selection.kept[row] as usize);
        blocks.filter_map(move |(column, block)| {
            let column = *selection.number.get(column as usize)?;
            let coupled = column as usize != row && *block != DMat3::ZERO;
            (coupled && (column as usize) < factors.len()).then_some((column, block))
        })
    };
    Sparse::build(
        selection.kept.len(),
        rows_per_task::<3>(),
        || (),
        |(), row| coupled(row).count(),
        |(), row, columns, blocks| {
            for (place, (column, block)) in coupled(row).enumerate() {
                let right = transpose(&factors[column as usize]);
                let scaled = product(&product(&factors[row], &rows_of(block)), &right);
                columns[place] = column;
                blocks[place] = narrow(&transpose(&scaled));
            }
        },
    )
}

/// Modes in scaled unknowns: `L^T B`, with `L^T = L^-1 A_ii`.
pub(super) fn modes(
    selection: Selection<'_>,
    factors: &[[[f64; 3]; 3]],
    modes: &[[DVec3; 6]],
) -> Vec<Modes<3>> {
    let scaled = |row: usize| {
        let block = selection.diagonal(row).unwrap_or_default();
        let modes = modes[row].map(|mode| mode.to_array());
        product(&product(&factors[row], &block), &transpose(&modes))
    };
    (0..selection.kept.len())
        .into_par_iter()
        .map(scaled)
        .collect()
}

/// Factors as they are kept for the cycle.
pub(super) fn compact(factors: &[[[f64; 3]; 3]]) -> Factors {
    let compact = |[[a, ..], [b, c, _], [d, e, f]]: &[[f64; 3]; 3]| {
        [*a, *b, *c, *d, *e, *f].map(|entry| entry as f32)
    };
    factors.par_iter().map(compact).collect()
}

/// `L^-1 r`, divided by `unit`.
pub(super) fn to_scaled(factors: &Factors, residual: &[DVec3], unit: f64, scaled: &mut [[f32; 3]]) {
    let tasks = scaled.par_chunks_mut(rows_per_task::<3>()).enumerate();
    tasks.for_each(|(task, chunk)| {
        let start = task * rows_per_task::<3>();
        let source = factors[start..].iter().zip(&residual[start..]);
        for (scaled, (&[a, b, c, d, e, f], &force)) in chunk.iter_mut().zip(source) {
            let [x, y, z] = (force / unit).as_vec3().to_array();
            *scaled = [a * x, b * x + c * y, d * x + e * y + f * z];
        }
    });
}

/// `unit L^-T z`.
pub(super) fn from_scaled(
    factors: &Factors,
    scaled: &[[f32; 3]],
    unit: f64,
    correction: &mut [DVec3],
) {
    let tasks = correction.par_chunks_mut(rows_per_task::<3>()).enumerate();
    tasks.for_each(|(task, chunk)| {
        let start = task * rows_per_task::<3>();
        let source = factors[start..].iter().zip(&scaled[start..]);
        for (correction, (&[a, b, c, d, e, f], &[x, y, z])) in chunk.iter_mut().zip(source) {
            let back = [a * x + b * y + d * z, c * y + e * z, f * z];
            *correction = unit * DVec3::from_array(back.map(f64::from));
        }
    });
}
