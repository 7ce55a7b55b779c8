//! Rows of a level that one of several processes has: products of its matrix, the way to the next
//! level and back, and the change to scaled unknowns.

use glam::DVec3;
use rayon::prelude::*;

use super::block_jacobi::{Factors, InverseFactors};
use super::clusters::Clusters;
use super::sparse::{Sparse, rows_per_task};
use super::symmetric::{SymmetricMatrix, rows_per_run};
use super::unit;
use crate::lists::Lists;
use crate::small::{transpose, widen};

/// Some rows `A_o` of a level's matrix `A`, in single precision. Of a vector, this process has the
/// entries of these rows, and receives those of its ghosts, the other columns that occur.
#[derive(Debug, Clone)]
pub struct LevelRows<const N: usize> {
    /// Columns are places among the rows, then among the ghosts.
    matrix: SymmetricMatrix<N>,
    ghosts: Vec<u32>,
}

impl<const N: usize> LevelRows<N> {
    /// Of the rows `own`, ascending, of a matrix.
    pub(super) fn of(matrix: Sparse<N, N>, own: &[u32]) -> Self {
        let columns = matrix.rows();
        let mut matrix = matrix.only(own);
        let ghosts = number_by_place(&mut matrix.columns, own, columns);
        Self {
            matrix: SymmetricMatrix::of(matrix),
            ghosts,
        }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.matrix.rows()
    }

    /// The other columns that occur, ascending.
    pub fn ghosts(&self) -> &[u32] {
        &self.ghosts
    }

    /// Columns, as places among the rows and then among the ghosts, and blocks as rows; the
    /// diagonal, which is the identity, comes first.
    pub fn row(&self, row: usize) -> impl Iterator<Item = (usize, [[f64; N]; N])> {
        let identity =
            std::array::from_fn(|i| std::array::from_fn(|j| if i == j { 1.0 } else { 0.0 }));
        let others = self.matrix.row(row);
        let others = others.map(|(place, block)| (place, transpose(&widen(&block))));
        std::iter::once((row, identity)).chain(others)
    }

    /// Sets `product` to `A_o x`, from the entries of `x` in these rows and those of the ghosts.
    /// `room` is room, whatever it holds.
    ///
    /// # Panics
    /// If a vector has not one entry for each.
    pub fn multiply(
        &self,
        [own, ghosts]: [&[[f64; N]]; 2],
        product: &mut [[f64; N]],
        room: &mut Vec<[f32; N]>,
    ) {
        assert_eq!(own.len(), self.rows(), "one entry a row");
        assert_eq!(product.len(), self.rows(), "one entry a row");
        assert_eq!(ghosts.len(), self.ghosts.len(), "one entry a ghost");
        let unit = unit(&[own.as_flattened(), ghosts.as_flattened()]);
        let narrowed = |entry: &[f64; N]| entry.map(|x| (x / unit) as f32);
        room.clear();
        room.extend(own.iter().chain(ghosts).map(narrowed));
        room.resize(room.len() + product.len(), [0.0; N]);
        let (x, narrow) = room.split_at_mut(own.len() + ghosts.len());
        let rows = rows_per_run::<N>();
        let tasks = product
            .par_chunks_mut(rows)
            .zip(narrow.par_chunks_mut(rows));
        tasks.enumerate().for_each(|(run, (targets, narrow))| {
            self.matrix.run_product(run, x, narrow);
            for (target, entry) in targets.iter_mut().zip(narrow) {
                *target = entry.map(|x| unit * f64::from(x));
            }
        });
    }
}

/// Rows of a prolongator `P` to the rows of this process, in single precision. Its columns are
/// nodes of the next level: those of this process, then its ghosts.
#[derive(Debug, Clone)]
pub struct ProlongatorRows<const N: usize> {
    matrix: Sparse<N, 6>,
    /// Number of columns of this process.
    own: usize,
    ghosts: Vec<u32>,
}

impl<const N: usize> ProlongatorRows<N> {
    /// Of some rows of a prolongator from a level with so many nodes, of which `own`, ascending,
    /// belong to this process.
    pub(super) fn of(mut matrix: Sparse<N, 6>, own: &[u32], nodes: usize) -> Self {
        let ghosts = number_by_place(&mut matrix.columns, own, nodes);
        Self {
            matrix,
            own: own.len(),
            ghosts,
        }
    }

    /// Number of rows, and of columns of this process.
    pub fn size(&self) -> [usize; 2] {
        [self.matrix.rows(), self.own]
    }

    /// The other columns, ascending.
    pub fn ghosts(&self) -> &[u32] {
        &self.ghosts
    }

    /// Sets `fine` to the rows of `P z`, from the entries of `z` in the columns of this process and
    /// of the ghosts.
    ///
    /// # Panics
    /// If a vector has not one entry for each.
    pub fn prolong(&self, [own, ghosts]: [&[[f64; 6]]; 2], fine: &mut [[f64; N]]) {
        assert_eq!([fine.len(), own.len()], self.size(), "one entry for each");
        assert_eq!(ghosts.len(), self.ghosts.len(), "one entry a ghost");
        let coarse: Vec<[f64; 6]> = own.iter().chain(ghosts).copied().collect();
        let rows = rows_per_task::<N>();
        let tasks = fine.par_chunks_mut(rows).enumerate();
        tasks.for_each(|(task, chunk)| {
            for (place, target) in chunk.iter_mut().enumerate() {
                *target = [0.0; N];
                for (column, block) in self.matrix.row(task * rows + place) {
                    for (target, line) in target.iter_mut().zip(block) {
                        let both = line.iter().zip(&coarse[column]);
                        *target += both.map(|(&weight, x)| f64::from(weight) * x).sum::<f64>();
                    }
                }
            }
        });
    }

    /// Sets `coarse`, columns of this process and then of the ghosts, to what the rows give to
    /// `P^T r`.
    ///
    /// # Panics
    /// If a vector has not one entry for each.
    pub fn restrict(&self, fine: &[[f64; N]], coarse: &mut [[f64; 6]]) {
        assert_eq!(fine.len(), self.matrix.rows(), "one entry a row");
        let columns = self.own + self.ghosts.len();
        assert_eq!(coarse.len(), columns, "one entry a column");
        coarse.fill([0.0; 6]);
        for (row, entries) in fine.iter().enumerate() {
            for (column, block) in self.matrix.row(row) {
                for (line, &x) in block.iter().zip(entries) {
                    for (target, &weight) in coarse[column].iter_mut().zip(line) {
                        *target += f64::from(weight) * x;
                    }
                }
            }
        }
    }
}

/// Replaces columns, which are below `count`, by their places among `own`, ascending, and the
/// others that occur, behind these; returns the others, ascending.
fn number_by_place(columns: &mut [u32], own: &[u32], count: usize) -> Vec<u32> {
    const UNKNOWN: u32 = u32::MAX;
    let mut place = vec![UNKNOWN; count];
    for (at, &row) in own.iter().enumerate() {
        place[row as usize] = at as u32;
    }
    let is_unknown = |column: &u32| place[*column as usize] == UNKNOWN;
    let mut others: Vec<u32> = columns.iter().copied().filter(is_unknown).collect();
    others.sort_unstable();
    others.dedup();
    for (at, &other) in others.iter().enumerate() {
        place[other as usize] = (own.len() + at) as u32;
    }
    let columns = columns.par_iter_mut();
    columns.for_each(|column| *column = place[*column as usize]);
    others
}

/// Whole clusters `C` of rows, with `A_CC = L L^T`.
#[derive(Debug, Clone)]
pub struct OwnClusters {
    /// Of places among the rows.
    clusters: Clusters,
    factors: InverseFactors,
}

impl OwnClusters {
    /// Those of the rows `own`, ascending.
    pub(super) fn of(all: &Clusters, factors: &Factors, own: &[u32]) -> Self {
        let cluster_of = |row: &u32| all.place[*row as usize].0;
        let mut numbers: Vec<u32> = own.iter().map(cluster_of).collect();
        numbers.sort_unstable();
        numbers.dedup();
        let number = |row: &u32| numbers.partition_point(|&other| other < cluster_of(row)) as u32;
        let members = Lists::group(own.iter().map(number), numbers.len());
        let place = own
            .iter()
            .map(|row| (number(row), all.place[*row as usize].1));
        Self {
            clusters: Clusters {
                place: place.collect(),
                members,
            },
            factors: factors.some_compact(&numbers),
        }
    }

    /// Sets `scaled` to `L^-1 r`.
    ///
    /// # Panics
    /// If a vector has not one entry a row.
    pub fn to_scaled(&self, residual: &[DVec3], scaled: &mut [[f64; 3]]) {
        let (unit, narrow) = self.narrow(residual);
        widen_by(unit, &narrow, scaled);
    }

    /// Sets `correction` to `L^-T z`.
    ///
    /// # Panics
    /// If a vector has not one entry a row.
    pub fn unscaled(&self, scaled: &[[f64; 3]], correction: &mut [DVec3]) {
        let unit = unit(&[scaled.as_flattened()]);
        let narrow = scaled.iter();
        let narrow: Vec<[f32; 3]> = narrow
            .map(|entry| entry.map(|x| (x / unit) as f32))
            .collect();
        self.factors
            .unscaled(&self.clusters, &narrow, unit, correction);
    }

    /// The block Jacobi method: `A_CC^-1 r`.
    ///
    /// # Panics
    /// If the vector has not one entry a row.
    pub fn alone(&self, residual: &[DVec3]) -> Vec<DVec3> {
        let (unit, narrow) = self.narrow(residual);
        let mut correction = vec![DVec3::ZERO; residual.len()];
        self.factors
            .unscaled(&self.clusters, &narrow, unit, &mut correction);
        correction
    }

    /// A unit, and `L^-1 r` in it.
    fn narrow(&self, residual: &[DVec3]) -> (f64, Vec<[f32; 3]>) {
        let rows = self.clusters.place.len();
        assert_eq!(residual.len(), rows, "one entry a row");
        let unit = unit(&[bytemuck::cast_slice(residual)]);
        let mut narrow = vec![[0.0; 3]; rows];
        self.factors
            .to_scaled(&self.clusters, residual, unit, &mut narrow);
        (unit, narrow)
    }
}

fn widen_by(unit: f64, narrow: &[[f32; 3]], wide: &mut [[f64; 3]]) {
    for (wide, narrow) in wide.iter_mut().zip(narrow) {
        *wide = narrow.map(|x| unit * f64::from(x));
    }
}
