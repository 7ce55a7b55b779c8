//! Sparse matrices of small blocks in single precision.

use std::ops::Range;

use rayon::prelude::*;

use crate::division::Division;
use crate::lists::sum_up;
use crate::ownership::RowOwnership;
use crate::small::narrow;

/// A sparse matrix whose blocks are `M` lines of `L` numbers.
///
/// Matrices of a level keep a block as its columns, because the product with a vector then adds
/// whole columns; prolongators keep it as its rows. The diagonal of a level matrix is the identity
/// and is not stored.
#[derive(Debug, Clone, Default)]
pub(super) struct Sparse<const M: usize, const L: usize> {
    /// Start of each row; one entry more than there are rows.
    pub(super) offset: Vec<usize>,
    /// Column of each block.
    pub(super) columns: Vec<u32>,
    /// The blocks.
    pub(super) blocks: Vec<[[f32; L]; M]>,
}

/// Rows that one task treats. They depend on nothing but the size of a block, so that no result
/// depends on the number of threads.
pub(super) const fn rows_per_task<const N: usize>() -> usize {
    if N == 3 { 1024 } else { 64 }
}

impl<const M: usize, const L: usize> Sparse<M, L> {
    /// A matrix without rows.
    pub(super) fn empty() -> Self {
        Self {
            offset: vec![0],
            columns: Vec::new(),
            blocks: Vec::new(),
        }
    }

    /// Number of rows.
    pub(super) fn rows(&self) -> usize {
        self.offset.len() - 1
    }

    /// Range of the blocks of a row.
    pub(super) fn range(&self, row: usize) -> Range<usize> {
        self.offset[row]..self.offset[row + 1]
    }

    /// Columns and blocks of a row.
    pub(super) fn row(&self, row: usize) -> impl Iterator<Item = (usize, &[[f32; L]; M])> {
        let range = self.range(row);
        let columns = self.columns[range.clone()].iter();
        columns
            .map(|&column| column as usize)
            .zip(&self.blocks[range])
    }

    /// Bytes of storage.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(&self.offset[..])
            + size_of_val(&self.columns[..])
            + size_of_val(&self.blocks[..])
    }

    /// A matrix whose rows, columns and blocks, `row` appends, once each: for rows that take longer
    /// to find than to copy.
    pub(super) fn collect(
        rows: usize,
        rows_per_task: usize,
        row: impl Fn(usize, &mut Vec<u32>, &mut Vec<[[f32; L]; M]>) + Sync,
    ) -> Self {
        let tasks = RowOwnership::even(rows, rows_per_task);
        let found = tasks.ranges().collect::<Vec<_>>().into_par_iter();
        let found = found.map(|own| {
            let (mut columns, mut blocks) = (Vec::new(), Vec::new());
            let ends = own.map(|at| {
                row(at, &mut columns, &mut blocks);
                columns.len()
            });
            let ends: Vec<usize> = ends.collect();
            (ends, columns, blocks)
        });
        let found: Vec<_> = found.collect();
        let mut offset = Vec::with_capacity(rows + 1);
        offset.push(0);
        for (ends, ..) in &found {
            let start = offset[offset.len() - 1];
            offset.extend(ends.iter().map(|end| start + end));
        }
        let mut columns: Vec<u32> = bytemuck::zeroed_vec(offset[rows]);
        let mut blocks: Vec<[[f32; L]; M]> = vec![[[0.0; L]; M]; offset[rows]];
        let shares = tasks.split(&mut columns, &offset).into_par_iter();
        let shares = shares.zip(tasks.split(&mut blocks, &offset)).zip(found);
        shares.for_each(|(((_, columns), (_, blocks)), (_, own, of_own))| {
            columns.copy_from_slice(&own);
            blocks.copy_from_slice(&of_own);
        });
        Self {
            offset,
            columns,
            blocks,
        }
    }

    /// A matrix whose rows `fill` writes, once for their number of blocks and once for the blocks.
    /// `scratch` is what a task keeps from row to row; it must not influence the result. `fill`
    /// runs with the widest vectors of the machine as far as it is inlined.
    pub(super) fn build<S>(
        rows: usize,
        rows_per_task: usize,
        scratch: impl Fn() -> S + Sync + Send,
        count: impl Fn(&mut S, usize) -> usize + Sync + Send,
        fill: impl Fn(&mut S, usize, &mut [u32], &mut [[[f32; L]; M]]) + Sync + Send,
    ) -> Self {
        let mut matrix = Self::default();
        matrix.rebuild(rows, rows_per_task, scratch, count, fill);
        matrix
    }

    /// The same in the storage of a matrix that is needed no more: mapping fresh memory costs more
    /// than filling it.
    pub(super) fn rebuild<S>(
        &mut self,
        rows: usize,
        rows_per_task: usize,
        scratch: impl Fn() -> S + Sync + Send,
        count: impl Fn(&mut S, usize) -> usize + Sync + Send,
        fill: impl Fn(&mut S, usize, &mut [u32], &mut [[[f32; L]; M]]) + Sync + Send,
    ) {
        let Self {
            offset,
            columns,
            blocks,
        } = self;
        offset.clear();
        offset.resize(rows + 1, 0);
        let tasks = offset[1..].par_chunks_mut(rows_per_task).enumerate();
        tasks.for_each_init(&scratch, |scratch, (task, counts)| {
            for (place, number) in counts.iter_mut().enumerate() {
                *number = count(scratch, task * rows_per_task + place);
            }
        });
        sum_up(offset);
        set_length(columns, offset[rows], 0);
        set_length(blocks, offset[rows], [[0.0; L]; M]);
        self.fill(rows_per_task, scratch, fill);
    }

    /// Lets `fill` write rows, as [`Self::build`] does, in a matrix that has their lengths.
    pub(super) fn fill<S>(
        &mut self,
        rows_per_task: usize,
        scratch: impl Fn() -> S + Sync + Send,
        fill: impl Fn(&mut S, usize, &mut [u32], &mut [[[f32; L]; M]]) + Sync + Send,
    ) {
        let tasks = RowOwnership::even(self.rows(), rows_per_task);
        let Self {
            offset,
            columns,
            blocks,
        } = self;
        let shares = tasks.split(columns, offset);
        let shares = shares.into_par_iter().zip(tasks.split(blocks, offset));
        let vectorised = pulp::Arch::new();
        shares.for_each_init(scratch, |scratch, ((own, columns), (_, blocks))| {
            vectorised.dispatch(
                #[inline(always)]
                || {
                    let start = offset[own.start];
                    for row in own {
                        let range = offset[row] - start..offset[row + 1] - start;
                        let blocks = &mut blocks[range.clone()];
                        fill(scratch, row, &mut columns[range], blocks);
                    }
                },
            );
        });
    }
}

impl<const M: usize, const L: usize> Sparse<M, L> {
    /// Some rows, ascending.
    pub(super) fn only(self, rows: &[u32]) -> Self {
        self.packed(rows.iter().map(|&row| (row as usize, true)))
    }

    /// All rows, those that are not kept empty.
    pub(super) fn kept(self, is_kept: impl Fn(usize) -> bool) -> Self {
        let rows = 0..self.rows();
        self.packed(rows.map(|row| (row, is_kept(row))))
    }

    /// Some rows, ascending, those that are not to be kept empty.
    fn packed(mut self, rows: impl Iterator<Item = (usize, bool)>) -> Self {
        let mut offset = vec![0];
        let mut end = 0;
        for (row, is_kept) in rows {
            if is_kept {
                let range = self.range(row);
                self.columns.copy_within(range.clone(), end);
                self.blocks.copy_within(range.clone(), end);
                end += range.len();
            }
            offset.push(end);
        }
        self.columns.truncate(end);
        self.blocks.truncate(end);
        self.columns.shrink_to_fit();
        self.blocks.shrink_to_fit();
        Self { offset, ..self }
    }

    /// The rows of all ranks, of which each one has its own; the others are empty there.
    pub(super) fn completed(mut self, division: &Division) -> Self {
        if division.is_whole() {
            return self;
        }
        let communicator = division.communicator();
        division.complete_offsets(&mut self.offset);
        self.columns = communicator.gathered(&self.columns);
        self.blocks = communicator.gathered(&self.blocks);
        self
    }
}

/// Gives a vector a length; what it holds does not matter.
fn set_length<T: Clone>(vector: &mut Vec<T>, length: usize, any: T) {
    if vector.capacity() < length {
        // Freed first, and zeroed by the system where it is used.
        *vector = Vec::new();
        *vector = vec![any; length];
    } else {
        vector.resize(length, any);
    }
}

impl<const N: usize> Sparse<N, N> {
    /// Entry `row` of `A x`, where the diagonal of `A` is the identity.
    #[inline]
    pub(super) fn times(&self, row: usize, x: &[[f32; N]]) -> [f32; N] {
        let range = self.range(row);
        let mut sum = x[row];
        for (&column, block) in self.columns[range.clone()].iter().zip(&self.blocks[range]) {
            let x = &x[column as usize];
            // Apart from the sum, so that blocks need not wait for each other.
            let mut part = [0.0; N];
            for (line, &x) in block.iter().zip(x) {
                for (part, &entry) in part.iter_mut().zip(line) {
                    *part += entry * x;
                }
            }
            for (sum, part) in sum.iter_mut().zip(part) {
                *sum += part;
            }
        }
        sum
    }
}

/// The pattern of a transposed matrix: for each column the rows where it occurs, and the positions
/// of the blocks.
#[derive(Debug, Clone, Default)]
pub(super) struct Transpose {
    offset: Vec<usize>,
    entries: Vec<(u32, u32)>,
}

impl Transpose {
    /// Transposes a pattern; rows ascend in each column.
    pub(super) fn of<const M: usize, const L: usize>(
        matrix: &Sparse<M, L>,
        columns: usize,
    ) -> Self {
        let mut offset = vec![0; columns + 1];
        for &column in &matrix.columns {
            offset[column as usize + 1] += 1;
        }
        sum_up(&mut offset);
        let mut next = offset.clone();
        let mut entries = vec![(0, 0); matrix.columns.len()];
        for row in 0..matrix.rows() {
            for position in matrix.range(row) {
                let next = &mut next[matrix.columns[position] as usize];
                entries[*next] = (row as u32, position as u32);
                *next += 1;
            }
        }
        Self { offset, entries }
    }

    /// Rows and positions of the blocks of a column.
    pub(super) fn column(&self, column: usize) -> &[(u32, u32)] {
        &self.entries[self.offset[column]..self.offset[column + 1]]
    }

    /// Bytes of storage.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(&self.offset[..]) + size_of_val(&self.entries[..])
    }

    /// Number of columns.
    pub(super) fn columns(&self) -> usize {
        self.offset.len() - 1
    }
}

/// Sums of blocks of one row of a product, by column.
pub(super) struct Accumulator<const M: usize, const L: usize> {
    /// Place of each column in the lists below, [`Self::NOWHERE`] if it has none.
    place: Vec<u32>,
    pub(super) columns: Vec<u32>,
    sums: Vec<[[f64; L]; M]>,
}

impl<const M: usize, const L: usize> Accumulator<M, L> {
    const NOWHERE: u32 = u32::MAX;

    /// For a matrix with `columns` block columns.
    pub(super) fn new(columns: usize) -> Self {
        Self {
            place: vec![Self::NOWHERE; columns],
            columns: Vec::new(),
            sums: Vec::new(),
        }
    }

    /// Notes that a column occurs.
    pub(super) fn touch(&mut self, column: u32) {
        if self.place[column as usize] == Self::NOWHERE {
            self.place[column as usize] = self.columns.len() as u32;
            self.columns.push(column);
        }
    }

    /// Number of columns noted since the last call.
    pub(super) fn take_count(&mut self) -> usize {
        let count = self.columns.len();
        self.clear();
        count
    }

    /// The sum of a column.
    #[inline(always)]
    pub(super) fn at(&mut self, column: u32) -> &mut [[f64; L]; M] {
        let place = self.place[column as usize];
        if place != Self::NOWHERE {
            return &mut self.sums[place as usize];
        }
        self.place[column as usize] = self.columns.len() as u32;
        self.columns.push(column);
        self.sums.push([[0.0; L]; M]);
        let last = self.sums.len() - 1;
        &mut self.sums[last]
    }

    /// Moves the sums to a row of a matrix, columns ascending.
    #[inline(always)]
    pub(super) fn take(&mut self, columns: &mut [u32], blocks: &mut [[[f32; L]; M]]) {
        columns.copy_from_slice(&self.columns);
        columns.sort_unstable();
        for (column, block) in columns.iter().zip(blocks) {
            let place = self.place[*column as usize] as usize;
            *block = narrow(&self.sums[place]);
        }
        self.clear();
    }

    fn clear(&mut self) {
        for &column in &self.columns {
            self.place[column as usize] = Self::NOWHERE;
        }
        self.columns.clear();
        self.sums.clear();
    }
}
