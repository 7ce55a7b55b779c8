//! The finest matrix in scaled unknowns.
//!
//! With `A_CC = L_C L_C^T` for each cluster `C` of unknowns, the matrix `L_C^-1 A_CD L_D^-T` has
//! the identity in its diagonal blocks. In these unknowns the block Jacobi method is Richardson's,
//! the diagonal needs no storage, and single precision suffices whatever the units, however
//! strongly stiffness is graded, and however stiff an interface is.

use glam::{DMat3, DVec3};
use rayon::prelude::*;

use super::clusters::Clusters;
use super::sparse::{Accumulator, Sparse, rows_per_task};
use super::sum_rows::SumRows;
use crate::division::Division;
use crate::failure::MultigridFailure;
use crate::lists::sum_up;
use crate::ownership::RowOwnership;
use crate::small::{Modes, Packed, add, narrow, product, rows_of, transpose, widen};

/// Clusters that one task factorises.
const PER_TASK: usize = 1024;

/// The diagonal blocks `R` of the clusters in the fixed matrix, and the inverses `L^-1` of the
/// Cholesky factors of those of the whole one: lower triangles, row by row, one cluster behind the
/// other. Clusters that are not wanted have none.
pub(super) struct Factors {
    offset: Vec<usize>,
    /// `R`.
    fixed: Vec<f64>,
    /// `L^-1`.
    inverse: Vec<f64>,
}

/// Entries of a lower triangle of a cluster with this number of 3x3 blocks.
const fn entries(blocks: usize) -> usize {
    3 * blocks * (3 * blocks + 1) / 2
}

/// Block of a lower triangle; zero above the diagonal.
fn block(triangle: &[f64], row: usize, column: usize) -> [[f64; 3]; 3] {
    std::array::from_fn(|r| {
        let line = 3 * row + r;
        std::array::from_fn(|c| match 3 * column + c <= line {
            true => triangle[line * (line + 1) / 2 + 3 * column + c],
            false => 0.0,
        })
    })
}

/// Block of a symmetric matrix whose lower triangle is given.
#[inline(always)]
fn symmetric_block(triangle: &[f64], row: usize, column: usize) -> [[f64; 3]; 3] {
    let entry = |i: usize, j: usize| triangle[i * (i + 1) / 2 + j];
    let (i, j) = (3 * row, 3 * column);
    std::array::from_fn(|r| std::array::from_fn(|c| entry((i + r).max(j + c), (i + r).min(j + c))))
}

impl Factors {
    /// Factorises all clusters.
    ///
    /// # Errors
    /// If one is not positive definite; the row that shows it.
    pub(super) fn of(rows: &SumRows<'_>, clusters: &Clusters) -> Result<Self, MultigridFailure> {
        Self::of_some(rows, clusters, |_| true)
    }

    /// Factorises the clusters that are wanted.
    ///
    /// # Errors
    /// As [`Self::of`].
    pub(super) fn of_some(
        rows: &SumRows<'_>,
        clusters: &Clusters,
        is_wanted: impl Fn(usize) -> bool,
    ) -> Result<Self, MultigridFailure> {
        let mut offset = vec![0; clusters.count() + 1];
        for cluster in (0..clusters.count()).filter(|&cluster| is_wanted(cluster)) {
            offset[cluster + 1] = entries(clusters.members.of(cluster).len());
        }
        sum_up(&mut offset);
        let mut fixed: Vec<f64> = bytemuck::zeroed_vec(offset[clusters.count()]);
        let mut inverse: Vec<f64> = bytemuck::zeroed_vec(fixed.len());
        let of_fixed = rows.without_interface();
        let tasks = RowOwnership::even(clusters.count(), PER_TASK);
        let shares = tasks.split(&mut fixed, &offset).into_par_iter();
        let shares = shares.zip(tasks.split(&mut inverse, &offset));
        let done: Result<Vec<()>, MultigridFailure> = shares
            .map(|((own, mut fixed_parts), (_, mut inverses))| {
                let mut factor = Vec::new();
                for cluster in own {
                    let length = offset[cluster + 1] - offset[cluster];
                    if length == 0 {
                        continue;
                    }
                    let (fixed, inverse);
                    (fixed, fixed_parts) = fixed_parts.split_at_mut(length);
                    (inverse, inverses) = inverses.split_at_mut(length);
                    gather(&of_fixed, clusters, cluster, fixed);
                    factor.clear();
                    factor.extend_from_slice(fixed);
                    if rows.is_changed(clusters.members.of(cluster)) {
                        gather(rows, clusters, cluster, &mut factor);
                    }
                    Packed(&mut factor)
                        .factorise_and_invert(inverse)
                        .map_err(|at| {
                            let member = clusters.members.of(cluster)[at / 3];
                            MultigridFailure::NotPositive(member as usize)
                        })?;
                }
                Ok(())
            })
            .collect();
        done?;
        Ok(Self {
            offset,
            fixed,
            inverse,
        })
    }

    /// Those of all clusters, each of them a single row, of which each rank has those of its own
    /// rows.
    pub(super) fn completed(self, division: &Division) -> Self {
        if division.is_whole() {
            return self;
        }
        const LENGTH: usize = entries(1);
        let all = |own: Vec<f64>| {
            let records: Vec<[f64; LENGTH]> = bytemuck::cast_slice(&own).to_vec();
            division.gathered(records).into_flattened()
        };
        Self {
            offset: (0..self.offset.len()).map(|at| LENGTH * at).collect(),
            fixed: all(self.fixed),
            inverse: all(self.inverse),
        }
    }

    /// Whether a cluster was factorised.
    pub(super) fn has(&self, cluster: u32) -> bool {
        !self.inverse_of(cluster).is_empty()
    }

    fn inverse_of(&self, cluster: u32) -> &[f64] {
        let cluster = cluster as usize;
        &self.inverse[self.offset[cluster]..self.offset[cluster + 1]]
    }

    /// Block of `L^-1 R` of a cluster, as columns.
    #[inline(always)]
    pub(super) fn smoothing_block(&self, cluster: u32, row: usize, column: usize) -> [[f64; 3]; 3] {
        let inverse = self.inverse_of(cluster);
        let cluster = cluster as usize;
        let fixed = &self.fixed[self.offset[cluster]..self.offset[cluster + 1]];
        let mut sum = [[0.0; 3]; 3];
        for at in 0..=row {
            // `(L R)^T = R^T L^T`, with blocks as rows.
            let left = transpose(&block(inverse, row, at));
            add(
                &mut sum,
                1.0,
                &product(&symmetric_block(fixed, column, at), &left),
            );
        }
        sum
    }

    /// Sets columns and blocks of a row of the scaled matrix among clusters of single rows.
    #[inline(always)]
    fn scale_single(
        &self,
        rows: &SumRows<'_>,
        clusters: &Clusters,
        row: usize,
        (columns, blocks): (&mut [u32], &mut [[[f32; 3]; 3]]),
    ) {
        let (own, _) = clusters.place[row];
        let left = block(self.inverse_of(own), 0, 0);
        let mut targets = columns.iter_mut().zip(blocks);
        rows.for_each(row, |column, value| {
            let (other, _) = clusters.place[column as usize];
            if other != own
                && let Some((target, scaled)) = targets.next()
            {
                *target = column;
                let right = block(self.inverse_of(other), 0, 0);
                *scaled = narrow(&product_transposed(&times(&left, value), &right));
            }
        });
    }

    /// The inverses as they are kept for the cycle.
    pub(super) fn compact(self) -> InverseFactors {
        InverseFactors {
            offset: self.offset,
            inverse: self.inverse.into_par_iter().map(|x| x as f32).collect(),
        }
    }

    /// Those of some clusters as they are kept for the cycle.
    pub(super) fn some_compact(&self, clusters: &[u32]) -> InverseFactors {
        let lengths = clusters.iter().map(|&at| self.inverse_of(at).len());
        let mut offset: Vec<usize> = std::iter::once(0).chain(lengths).collect();
        sum_up(&mut offset);
        let inverse = clusters.iter().flat_map(|&at| self.inverse_of(at));
        InverseFactors {
            offset,
            inverse: inverse.map(|&x| x as f32).collect(),
        }
    }
}

/// The lower triangle of a cluster's block.
fn gather(rows: &SumRows<'_>, clusters: &Clusters, cluster: usize, triangle: &mut [f64]) {
    let members = clusters.members.of(cluster);
    for (at, &row) in members.iter().enumerate() {
        for (place, &column) in members[..=at].iter().enumerate() {
            let value = rows.block(row as usize, column);
            for (r, c) in (0..3).flat_map(|r| (0..3).map(move |c| (r, c))) {
                let line = 3 * at + r;
                if 3 * place + c <= line {
                    triangle[line * (line + 1) / 2 + 3 * place + c] = value.col(c)[r];
                }
            }
        }
    }
}

/// Sets `matrix` to the scaled matrix without its diagonal blocks; blocks as columns. Rows that are
/// not `is_wanted` are empty.
pub(super) fn set_matrix(
    matrix: &mut Sparse<3, 3>,
    rows: &SumRows<'_>,
    clusters: &Clusters,
    factors: &Factors,
    is_wanted: impl Fn(usize) -> bool + Sync + Send,
) {
    matrix.rebuild(
        rows.count(),
        rows_per_task::<3>(),
        || Accumulator::<3, 3>::new(rows.count()),
        |sums, row| {
            if !is_wanted(row) {
                return 0;
            }
            if is_among_single(rows, clusters, row) {
                return others(rows, row);
            }
            coupled(rows, clusters, row, |_, _, other, place| {
                let members = clusters.members.of(other as usize);
                members[place..].iter().for_each(|&at| sums.touch(at));
            });
            sums.take_count()
        },
        #[inline(always)]
        |sums, row, columns, blocks| {
            if columns.is_empty() {
                return;
            }
            let (own, at) = clusters.place[row];
            let left = factors.inverse_of(own);
            if is_among_single(rows, clusters, row) {
                return factors.scale_single(rows, clusters, row, (columns, blocks));
            }
            coupled(rows, clusters, row, |member, value, other, place| {
                let scaled = times(&block(left, at as usize, member), value);
                let right = factors.inverse_of(other);
                let members = &clusters.members.of(other as usize)[place..];
                for (next, &column) in members.iter().enumerate() {
                    let right = block(right, place + next, place);
                    let part = product_transposed(&scaled, &right);
                    add(sums.at(column), 1.0, &part);
                }
            });
            sums.take(columns, blocks);
        },
    );
}

/// Blocks that the scaled row depends on and that lie outside the diagonal block: the place of the
/// row they stand in, the block, and cluster and place of its column.
#[inline(always)]
fn coupled(
    rows: &SumRows<'_>,
    clusters: &Clusters,
    row: usize,
    mut treat: impl FnMut(usize, &DMat3, u32, usize),
) {
    let (own, at) = clusters.place[row];
    let members = &clusters.members.of(own as usize)[..=at as usize];
    for (member, &at) in members.iter().enumerate() {
        rows.for_each(at as usize, |column, value| {
            let (other, place) = clusters.place[column as usize];
            if other != own {
                treat(member, value, other, place as usize);
            }
        });
    }
}

/// `L A`, with `A` as columns.
#[inline(always)]
fn times(left: &[[f64; 3]; 3], value: &DMat3) -> [[f64; 3]; 3] {
    product(left, &rows_of(value))
}

/// `B L^T`, as columns.
#[inline(always)]
fn product_transposed(b: &[[f64; 3]; 3], l: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    product(l, &transpose(b))
}

/// Number of blocks of a row that are not zero, without its diagonal.
fn others(rows: &SumRows<'_>, row: usize) -> usize {
    let mut count = 0;
    rows.for_each(row, |column, _| {
        count += usize::from(column as usize != row)
    });
    count
}

/// Whether a row's cluster and those beside it are single rows.
fn is_among_single(rows: &SumRows<'_>, clusters: &Clusters, row: usize) -> bool {
    rows.columns(row).all(|column| {
        let (cluster, _) = clusters.place[column as usize];
        clusters.members.of(cluster as usize).len() == 1
    })
}

/// Modes in scaled unknowns, `L^T B = L^-1 R B`, where every cluster is a single row of the fixed
/// matrix.
pub(super) fn modes(factors: &Factors, modes: &[[DVec3; 6]]) -> Vec<Modes<3>> {
    let scaled = |(cluster, modes): (usize, &[DVec3; 6])| {
        let left = transpose(&factors.smoothing_block(cluster as u32, 0, 0));
        let modes = transpose(&modes.map(|mode| mode.to_array()));
        product(&left, &modes)
    };
    modes.par_iter().enumerate().map(scaled).collect()
}

/// A prolongator of single rows in unknowns that are not scaled, `L^-T P`.
pub(super) fn unscale(factors: &Factors, prolongator: &mut Sparse<3, 6>) {
    let tasks = RowOwnership::even(prolongator.rows(), rows_per_task::<3>());
    let offset = &prolongator.offset;
    let shares = tasks.split(&mut prolongator.blocks, offset);
    shares.into_par_iter().for_each(|(own, blocks)| {
        let start = offset[own.start];
        for row in own {
            let left = transpose(&block(factors.inverse_of(row as u32), 0, 0));
            for value in &mut blocks[offset[row] - start..offset[row + 1] - start] {
                let wide = widen(value);
                *value = narrow(&product(&left, &wide));
            }
        }
    });
}

/// `L^-1` of the clusters in single precision, as [`Factors`] has them.
#[derive(Debug, Clone, Default)]
pub(super) struct InverseFactors {
    offset: Vec<usize>,
    inverse: Vec<f32>,
}

impl InverseFactors {
    fn of(&self, cluster: u32) -> &[f32] {
        let cluster = cluster as usize;
        &self.inverse[self.offset[cluster]..self.offset[cluster + 1]]
    }

    /// `L^-1 r`, divided by `unit`.
    pub(super) fn to_scaled(
        &self,
        clusters: &Clusters,
        residual: &[DVec3],
        unit: f64,
        scaled: &mut [[f32; 3]],
    ) {
        each_row(scaled, |row| {
            let (own, at) = clusters.place[row];
            let members = &clusters.members.of(own as usize)[..=at as usize];
            let inverse = self.of(own);
            let mut sum = [0.0; 3];
            for (member, &other) in members.iter().enumerate() {
                let force = (residual[other as usize] / unit).as_vec3().to_array();
                for (r, sum) in sum.iter_mut().enumerate() {
                    let line = 3 * at as usize + r;
                    let weights = &inverse[line * (line + 1) / 2..][..=line];
                    let own = weights[3 * member..].iter().zip(&force);
                    *sum += own.map(|(weight, force)| weight * force).sum::<f32>();
                }
            }
            sum
        });
    }

    /// `unit L^-T z`.
    pub(super) fn unscaled(
        &self,
        clusters: &Clusters,
        scaled: &[[f32; 3]],
        unit: f64,
        correction: &mut [DVec3],
    ) {
        each_row(correction, |row| {
            let (own, at) = clusters.place[row];
            let at = at as usize;
            let members = &clusters.members.of(own as usize)[at..];
            let inverse = self.of(own);
            let mut sum = [0.0; 3];
            for (next, &other) in members.iter().enumerate() {
                for (r, &entry) in scaled[other as usize].iter().enumerate() {
                    let line = 3 * (at + next) + r;
                    let weights = &inverse[line * (line + 1) / 2..][..=line];
                    for (sum, weight) in sum.iter_mut().zip(&weights[3 * at..]) {
                        *sum += weight * entry;
                    }
                }
            }
            unit * DVec3::from_array(sum.map(f64::from))
        });
    }

    /// Bytes of storage.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(&self.offset[..]) + size_of_val(&self.inverse[..])
    }
}

fn each_row<T: Send>(targets: &mut [T], entry: impl Fn(usize) -> T + Sync) {
    let rows = rows_per_task::<3>();
    let tasks = targets.par_chunks_mut(rows).enumerate();
    tasks.for_each(|(task, chunk)| {
        for (place, target) in chunk.iter_mut().enumerate() {
            *target = entry(task * rows + place);
        }
    });
}
