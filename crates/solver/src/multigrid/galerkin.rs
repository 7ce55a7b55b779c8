//! The matrix of the next level, `P^T A P`, in unknowns that scale its diagonal to the identity.

use rayon::prelude::*;

use super::prolongation::{add_columns, add_product};
use super::scaling::Modes;
use super::small::{inverse_factor, narrow, product, transpose, widen};
use super::sparse::{Accumulator, Sparse, Transpose, row_shares, rows_per_task};

/// A motion of an aggregate with less than this share of the energy of its stiffest one costs
/// nothing within single precision; it is left out of the next level.
const COSTS_NOTHING: f64 = 1e-6;

type Block6 = [[f64; 6]; 6];

/// The next level.
pub(super) struct Coarse {
    pub(super) matrix: Sparse<6, 6>,
    pub(super) modes: Vec<Modes<6>>,
}

/// `P^T A P` before it is scaled.
#[derive(Debug, Clone)]
pub(super) struct Unscaled {
    diagonal: Vec<Block6>,
    /// The blocks right of the diagonal, as rows.
    upper: Sparse<6, 6>,
}

impl Unscaled {
    /// `P^T A P`, `A` having the identity as its diagonal.
    pub(super) fn of<const N: usize>(
        matrix: &Sparse<N, N>,
        prolongator: &Sparse<N, 6>,
        transpose: &Transpose,
    ) -> Self {
        let image = image(matrix, prolongator, transpose.columns());
        Self::of_image(prolongator, transpose, &image)
    }

    /// `P^T A P` from `A P`.
    pub(super) fn of_image<const N: usize>(
        prolongator: &Sparse<N, 6>,
        transpose: &Transpose,
        image: &Sparse<N, 6>,
    ) -> Self {
        Self {
            diagonal: diagonal(prolongator, transpose, image),
            upper: upper(prolongator, transpose, image),
        }
    }

    /// The sum of two such matrices.
    pub(super) fn plus(&self, other: &Self) -> Self {
        let diagonal = self.diagonal.par_iter().zip(&other.diagonal);
        let diagonal = diagonal.map(|(a, b)| std::array::from_fn(|i| sum(&a[i], &b[i])));
        let both = [&self.upper, &other.upper];
        let upper = Sparse::build(
            self.upper.rows(),
            rows_per_task::<6>(),
            || Accumulator::<6, 6>::new(self.upper.rows()),
            |sums, row| {
                let columns = both.map(|part| &part.columns[part.range(row)]);
                columns
                    .concat()
                    .iter()
                    .for_each(|&column| sums.touch(column));
                sums.take_count()
            },
            |sums, row, columns, blocks| {
                for (column, block) in both.iter().flat_map(|part| part.row(row)) {
                    let total = sums.at(column as u32);
                    for (total, line) in total.iter_mut().zip(widen(block)) {
                        *total = sum(total, &line);
                    }
                }
                sums.take(columns, blocks);
            },
        );
        Self {
            diagonal: diagonal.collect(),
            upper,
        }
    }

    /// The next level, whose diagonal is the identity, and the factors `L^-1` that scale it.
    pub(super) fn scaled(&self, modes: &[Modes<6>]) -> (Coarse, Vec<Block6>) {
        let diagonal = self.diagonal.par_iter();
        let factors: Vec<Block6> = diagonal
            .map(|block| inverse_factor(block, COSTS_NOTHING).0)
            .collect();
        let mut upper = self.upper.clone();
        scale_upper(&mut upper, &factors);
        // Energy projection on the columns kept: `L^-1 A_ii`, which is `L^T` if none was left out.
        let scaled = factors.par_iter().zip(&self.diagonal).zip(modes);
        let modes = scaled.map(|((factor, block), modes)| product(&product(factor, block), modes));
        let coarse = Coarse {
            modes: modes.collect(),
            matrix: both_triangles(&upper),
        };
        (coarse, factors)
    }

    /// Bytes of storage.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(&self.diagonal[..]) + self.upper.bytes()
    }
}

fn sum(a: &[f64; 6], b: &[f64; 6]) -> [f64; 6] {
    std::array::from_fn(|i| a[i] + b[i])
}

/// Computes the next level and scales the columns of the prolongator to its unknowns.
pub(super) fn coarse<const N: usize>(
    matrix: &Sparse<N, N>,
    prolongator: &mut Sparse<N, 6>,
    transpose: &Transpose,
    modes: &[Modes<6>],
) -> Coarse {
    let (coarse, factors) = Unscaled::of(matrix, prolongator, transpose).scaled(modes);
    scale_prolongator(prolongator, &factors);
    coarse
}

/// `A P`.
fn image<const N: usize>(
    matrix: &Sparse<N, N>,
    prolongator: &Sparse<N, 6>,
    aggregates: usize,
) -> Sparse<N, 6> {
    Sparse::build(
        matrix.rows(),
        rows_per_task::<N>(),
        || Accumulator::<N, 6>::new(aggregates),
        |sums, row| {
            for at in std::iter::once(row).chain(matrix.row(row).map(|(at, _)| at)) {
                let columns = &prolongator.columns[prolongator.range(at)];
                columns.iter().for_each(|&column| sums.touch(column));
            }
            sums.take_count()
        },
        |sums, row, columns, blocks| {
            for (column, block) in prolongator.row(row) {
                let sum = sums.at(column as u32);
                for (sum, line) in sum.iter_mut().zip(block) {
                    for (sum, &entry) in sum.iter_mut().zip(line) {
                        *sum += f64::from(entry);
                    }
                }
            }
            for (at, block) in matrix.row(row) {
                for (column, line) in prolongator.row(at) {
                    add_product(sums.at(column as u32), 1.0, block, line);
                }
            }
            sums.take(columns, blocks);
        },
    )
}

/// `S += A^T B` of blocks as rows.
#[inline]
fn add_transposed<const N: usize>(sum: &mut Block6, a: &[[f32; 6]; N], b: &[[f32; 6]; N]) {
    add_columns(sum, &widen(a), &widen(b));
}

/// The diagonal blocks of `P^T A P`.
fn diagonal<const N: usize>(
    prolongator: &Sparse<N, 6>,
    transpose: &Transpose,
    image: &Sparse<N, 6>,
) -> Vec<Block6> {
    let aggregates = (0..transpose.columns()).into_par_iter();
    let block = |aggregate: usize| {
        let mut sum = [[0.0; 6]; 6];
        for &(row, position) in transpose.column(aggregate) {
            let range = image.range(row as usize);
            let place = image.columns[range.clone()].binary_search(&(aggregate as u32));
            if let Ok(place) = place {
                let left = &prolongator.blocks[position as usize];
                add_transposed(&mut sum, left, &image.blocks[range.start + place]);
            }
        }
        sum
    };
    aggregates
        .with_min_len(rows_per_task::<6>())
        .map(block)
        .collect()
}

/// The blocks of `P^T A P` right of the diagonal, as rows.
fn upper<const N: usize>(
    prolongator: &Sparse<N, 6>,
    transpose: &Transpose,
    image: &Sparse<N, 6>,
) -> Sparse<6, 6> {
    let right_of = |row: usize, aggregate: usize| {
        let range = image.range(row);
        let columns = &image.columns[range.clone()];
        let skip = columns.partition_point(|&column| column as usize <= aggregate);
        range.start + skip..range.end
    };
    Sparse::build(
        transpose.columns(),
        rows_per_task::<6>(),
        || Accumulator::<6, 6>::new(transpose.columns()),
        |sums, aggregate| {
            for &(row, _) in transpose.column(aggregate) {
                let columns = &image.columns[right_of(row as usize, aggregate)];
                columns.iter().for_each(|&column| sums.touch(column));
            }
            sums.take_count()
        },
        |sums, aggregate, columns, blocks| {
            for &(row, position) in transpose.column(aggregate) {
                let left = &prolongator.blocks[position as usize];
                for right in right_of(row as usize, aggregate) {
                    let sum = sums.at(image.columns[right]);
                    add_transposed(sum, left, &image.blocks[right]);
                }
            }
            sums.take(columns, blocks);
        },
    )
}

/// `P L^-T`.
fn scale_prolongator<const N: usize>(prolongator: &mut Sparse<N, 6>, factors: &[Block6]) {
    let blocks = prolongator.blocks.par_iter_mut().zip(&prolongator.columns);
    blocks.for_each(|(block, &column)| {
        let right = transpose(&factors[column as usize]);
        *block = narrow(&product(&widen(block), &right));
    });
}

/// `L^-1 A L^-T` for the blocks right of the diagonal.
fn scale_upper(upper: &mut Sparse<6, 6>, factors: &[Block6]) {
    let rows = rows_per_task::<6>();
    let shares = row_shares(&upper.offset, rows, &mut upper.columns, &mut upper.blocks);
    shares.into_par_iter().for_each(|share| {
        let mut place = 0;
        for row in share.rows {
            for _ in upper.offset[row]..upper.offset[row + 1] {
                let right = transpose(&factors[share.columns[place] as usize]);
                let left = product(&factors[row], &widen(&share.blocks[place]));
                share.blocks[place] = narrow(&product(&left, &right));
                place += 1;
            }
        }
    });
}

/// The whole matrix but for its diagonal, blocks as columns, from those right of the diagonal,
/// blocks as rows: symmetric to the last bit.
fn both_triangles(upper: &Sparse<6, 6>) -> Sparse<6, 6> {
    let lower = Transpose::of(upper, upper.rows());
    Sparse::build(
        upper.rows(),
        rows_per_task::<6>(),
        || (),
        |(), row| lower.column(row).len() + upper.range(row).len(),
        |(), row, columns, blocks| {
            let left = lower.column(row).iter();
            let left = left.map(|&(at, position)| (at, upper.blocks[position as usize]));
            let right = upper.row(row);
            let right = right.map(|(at, block)| (at as u32, transpose(block)));
            let targets = columns.iter_mut().zip(blocks);
            for ((column, target), (at, block)) in targets.zip(left.chain(right)) {
                (*column, *target) = (at, block);
            }
        },
    )
}
