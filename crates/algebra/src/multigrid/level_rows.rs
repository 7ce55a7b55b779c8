//! Rows of a level that one of several processes has: products of its matrix, the way to the next
//! level and back, and the change to scaled unknowns.

use std::sync::Arc;

use glam::DVec3;
use rayon::prelude::*;

use super::block_jacobi::{Factors, InverseFactors};
use super::clusters::Clusters;
use super::cycle::{Prolongator, Transfer};
use super::sparse::{Sparse, rows_per_task};
use super::symmetric::{SymmetricMatrix, rows_per_run};
use super::unit;
use crate::block_rows::{DROPPED, numbers};
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
        let (place, ghosts) = places(matrix.columns.iter().copied(), own, columns);
        let columns = matrix.columns.par_iter_mut();
        columns.for_each(|column| *column = place[*column as usize]);
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

/// The way to the rows of this process from the unknowns of the next level, and back: some rows of
/// a prolongator `P L^-T`, with `L^-1` of each node of that level. The nodes are those of this
/// process, then its ghosts, the others that occur.
#[derive(Debug, Clone)]
pub struct ProlongatorRows<const N: usize> {
    /// `P`, at least these rows of it.
    prolongator: Arc<Prolongator<N>>,
    /// Which rows of `P` they are, ascending.
    rows: Vec<u32>,
    /// Place of each row of `P` among these.
    place_of_row: Vec<u32>,
    /// The nodes, and their `L^-1`, as rows.
    nodes: Vec<(u32, [[f32; 6]; 6])>,
    /// Place of each node of the next level among these.
    place_of_node: Vec<u32>,
    /// Number of nodes of this process.
    own: usize,
    ghosts: Vec<u32>,
}

impl<const N: usize> ProlongatorRows<N> {
    /// The rows `rows`, ascending, of the way to a level from the next one, of whose nodes `own`,
    /// ascending, belong to this process.
    pub(super) fn of(transfer: Transfer<N>, rows: Vec<u32>, own: &[u32]) -> Self {
        let Transfer {
            prolongator,
            scaling,
        } = transfer;
        let all = &prolongator.rows;
        let columns = rows.iter().flat_map(|&row| {
            let columns = &all.columns[all.range(row as usize)];
            columns.iter().copied()
        });
        let (place_of_node, ghosts) = places(columns, own, scaling.len());
        let nodes = own.iter().chain(&ghosts);
        Self {
            nodes: nodes.map(|&node| (node, scaling[node as usize])).collect(),
            place_of_row: numbers(all.rows(), &rows),
            prolongator,
            rows,
            place_of_node,
            own: own.len(),
            ghosts,
        }
    }

    /// Number of rows, and of nodes of this process.
    pub fn size(&self) -> [usize; 2] {
        [self.rows.len(), self.own]
    }

    /// The other nodes, ascending.
    pub fn ghosts(&self) -> &[u32] {
        &self.ghosts
    }

    /// Sets `fine` to the rows of `P L^-T z`, from the entries of `z` at the nodes of this process
    /// and at the ghosts.
    ///
    /// # Panics
    /// If a vector has not one entry for each.
    pub fn prolong(&self, [own, ghosts]: [&[[f64; 6]]; 2], fine: &mut [[f64; N]]) {
        assert_eq!([fine.len(), own.len()], self.size(), "one entry for each");
        assert_eq!(ghosts.len(), self.ghosts.len(), "one entry a ghost");
        let entries = own.iter().chain(ghosts).zip(&self.nodes);
        let coarse: Vec<[f64; 6]> = entries
            .map(|(entries, (_, scaling))| times_transpose(scaling, entries))
            .collect();
        let pairs = fine.par_iter_mut().zip(&self.rows);
        let pairs = pairs.with_min_len(rows_per_task::<N>());
        pairs.for_each(|(target, &row)| {
            *target = [0.0; N];
            for (node, block) in self.prolongator.rows.row(row as usize) {
                let entries = &coarse[self.place_of_node[node] as usize];
                for (target, line) in target.iter_mut().zip(block) {
                    *target += dot(line, entries);
                }
            }
        });
    }

    /// Sets `coarse`, at the nodes of this process and then at the ghosts, to what the rows give to
    /// `L^-1 P^T r`.
    ///
    /// # Panics
    /// If a vector has not one entry for each.
    pub fn restrict(&self, fine: &[[f64; N]], coarse: &mut [[f64; 6]]) {
        assert_eq!(fine.len(), self.rows.len(), "one entry a row");
        assert_eq!(coarse.len(), self.nodes.len(), "one entry a node");
        let pairs = coarse.par_iter_mut().zip(&self.nodes);
        let pairs = pairs.with_min_len(rows_per_task::<6>());
        pairs.for_each(|(target, (node, scaling))| {
            let mut sum = [0.0; 6];
            for &(row, position) in self.prolongator.transpose.column(*node as usize) {
                let block = &self.prolongator.rows.blocks[position as usize];
                // Rows of other processes have no place.
                if let Some(entries) = fine.get(self.place_of_row[row as usize] as usize) {
                    let part = times_transpose(block, entries);
                    sum.iter_mut()
                        .zip(part)
                        .for_each(|(sum, part)| *sum += part);
                }
            }
            *target = scaling.map(|line| dot(&line, &sum));
        });
    }
}

fn dot(line: &[f32; 6], entries: &[f64; 6]) -> f64 {
    let both = line.iter().zip(entries);
    both.map(|(&weight, x)| f64::from(weight) * x).sum()
}

/// `B^T r`, with the rows of `B`.
fn times_transpose<const N: usize>(block: &[[f32; 6]; N], entries: &[f64; N]) -> [f64; 6] {
    let mut product = [0.0; 6];
    for (line, entry) in block.iter().zip(entries) {
        for (product, &weight) in product.iter_mut().zip(line) {
            *product += f64::from(weight) * entry;
        }
    }
    product
}

/// Places of columns, which are below `count`, among `own`, ascending, and behind these among the
/// others that occur; and the others, ascending.
fn places(columns: impl Iterator<Item = u32>, own: &[u32], count: usize) -> (Vec<u32>, Vec<u32>) {
    let mut place = numbers(count, own);
    let mut is_other = vec![false; count];
    for column in columns {
        is_other[column as usize] = place[column as usize] == DROPPED;
    }
    let others = 0..count as u32;
    let others: Vec<u32> = others.filter(|&other| is_other[other as usize]).collect();
    for (at, &other) in others.iter().enumerate() {
        place[other as usize] = (own.len() + at) as u32;
    }
    (place, others)
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
