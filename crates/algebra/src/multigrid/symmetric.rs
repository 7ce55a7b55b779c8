//! Level matrices as the cycle keeps them: each block and its transpose stored once, where one task
//! has both.

use std::ops::Range;

use rayon::prelude::*;

use super::sparse::Sparse;
use crate::ownership::RowOwnership;
use crate::small::transpose;

/// Rows of a run. It depends on nothing but the size of a block, so that no result depends on the
/// number of threads. In longer runs fewer blocks lead out of them, but tasks are fewer.
pub(super) const fn rows_per_run<const N: usize>() -> usize {
    if N == 3 { 2048 } else { 512 }
}

/// A symmetric matrix with the identity as its diagonal, which is not stored; blocks as columns.
///
/// Rows are divided into runs. Of blocks between two rows of a run those right of the diagonal are
/// stored; blocks that lead out of a run are stored in each of the rows. So a run is the work of
/// one task, which adds to its own rows alone, and nearly half of the bytes are spared.
#[derive(Debug, Clone)]
pub(super) struct SymmetricMatrix<const N: usize> {
    /// Start of the blocks of each row; one entry more than there are rows. Those inside the run
    /// come first.
    offset: Vec<usize>,
    /// End of the blocks of each row inside the run.
    inner_end: Vec<usize>,
    columns: Vec<u32>,
    blocks: Vec<[[f32; N]; N]>,
}

impl<const N: usize> SymmetricMatrix<N> {
    /// From all blocks, in their memory. There may be more columns than rows.
    pub(super) fn of(matrix: Sparse<N, N>) -> Self {
        let Sparse {
            offset,
            mut columns,
            mut blocks,
        } = matrix;
        let runs = RowOwnership::even(offset.len() - 1, rows_per_run::<N>());
        let shares = runs.split(&mut columns, &offset).into_par_iter();
        let shares = shares.zip(runs.split(&mut blocks, &offset));
        let counts: Vec<Vec<[usize; 2]>> = shares
            .map(|((own, columns), (_, blocks))| compact(own, &offset, columns, blocks))
            .collect();
        let mut starts = vec![0];
        let mut inner_end = Vec::with_capacity(offset.len() - 1);
        for (own, counts) in runs.ranges().zip(counts) {
            let start = starts[own.start];
            for [inner, outer] in counts {
                let row = starts[starts.len() - 1];
                inner_end.push(row + inner);
                starts.push(row + inner + outer);
            }
            let from = offset[own.start]..offset[own.start] + starts[own.end] - start;
            columns.copy_within(from.clone(), start);
            blocks.copy_within(from, start);
        }
        let end = starts[starts.len() - 1];
        columns.truncate(end);
        columns.shrink_to_fit();
        blocks.truncate(end);
        blocks.shrink_to_fit();
        Self {
            offset: starts,
            inner_end,
            columns,
            blocks,
        }
    }

    /// Number of rows.
    pub(super) fn rows(&self) -> usize {
        self.inner_end.len()
    }

    /// Number of blocks, those that are not stored included.
    pub(super) fn block_count(&self) -> usize {
        let inner = (0..self.rows()).map(|row| self.inner_end[row] - self.offset[row]);
        self.blocks.len() + inner.sum::<usize>()
    }

    /// Bytes of storage.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(&self.offset[..])
            + size_of_val(&self.inner_end[..])
            + size_of_val(&self.columns[..])
            + size_of_val(&self.blocks[..])
    }

    /// Columns and blocks of a row, those of a small matrix: the whole run is searched.
    pub(super) fn row(&self, row: usize) -> impl Iterator<Item = (usize, [[f32; N]; N])> {
        let first = row - row % rows_per_run::<N>();
        let mirrored = (first..row).flat_map(move |other| {
            let inner = self.stored(self.offset[other]..self.inner_end[other]);
            let of_row = inner.filter(move |(column, _)| *column == row);
            of_row.map(move |(_, block)| (other, transpose(block)))
        });
        let stored = self.stored(self.offset[row]..self.offset[row + 1]);
        mirrored.chain(stored.map(|(column, block)| (column, *block)))
    }

    #[inline(always)]
    fn stored(&self, range: Range<usize>) -> impl Iterator<Item = (usize, &[[f32; N]; N])> {
        let columns = self.columns[range.clone()].iter();
        columns
            .map(|&column| column as usize)
            .zip(&self.blocks[range])
    }

    /// Sets `product` to the entries of `A x` in run number `run`.
    pub(super) fn run_product(&self, run: usize, x: &[[f32; N]], product: &mut [[f32; N]]) {
        // With the widest vectors of the machine.
        pulp::Arch::new().dispatch(RunProduct {
            matrix: self,
            first: run * rows_per_run::<N>(),
            x,
            product,
        });
    }
}

/// The product of a run of rows, from row `first` on.
struct RunProduct<'a, const N: usize> {
    matrix: &'a SymmetricMatrix<N>,
    first: usize,
    x: &'a [[f32; N]],
    product: &'a mut [[f32; N]],
}

impl<const N: usize> pulp::NullaryFnOnce for RunProduct<'_, N> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self {
            matrix,
            first,
            x,
            product,
        } = self;
        let rows = first..first + product.len();
        product.copy_from_slice(&x[rows.clone()]);
        for row in rows {
            let own = &x[row];
            let mut sum = [0.0; N];
            for (column, block) in matrix.stored(matrix.offset[row]..matrix.inner_end[row]) {
                add_product(&mut sum, block, &x[column]);
                for (target, line) in product[column - first].iter_mut().zip(block) {
                    let both = line.iter().zip(own);
                    *target += both.map(|(entry, x)| entry * x).sum::<f32>();
                }
            }
            for (column, block) in matrix.stored(matrix.inner_end[row]..matrix.offset[row + 1]) {
                add_product(&mut sum, block, &x[column]);
            }
            for (target, sum) in product[row - first].iter_mut().zip(sum) {
                *target += sum;
            }
        }
    }
}

/// Moves the blocks of a run that are stored to the front; for each row, how many of them are
/// inside the run and how many lead out of it.
fn compact<const N: usize>(
    own: Range<usize>,
    offset: &[usize],
    columns: &mut [u32],
    blocks: &mut [[[f32; N]; N]],
) -> Vec<[usize; 2]> {
    let start = offset[own.start];
    let (mut row_columns, mut row_blocks) = (Vec::new(), Vec::new());
    let mut end = 0;
    let counts = own.clone().map(|row| {
        let range = offset[row] - start..offset[row + 1] - start;
        row_columns.clear();
        row_columns.extend_from_slice(&columns[range.clone()]);
        row_blocks.clear();
        row_blocks.extend_from_slice(&blocks[range]);
        let is_inner = |column: usize| row < column && column < own.end;
        let is_outer = |column: usize| !own.contains(&column);
        let kinds: [&dyn Fn(usize) -> bool; 2] = [&is_inner, &is_outer];
        kinds.map(|is_kept| {
            let first = end;
            for (&column, block) in row_columns.iter().zip(&row_blocks) {
                if is_kept(column as usize) {
                    (columns[end], blocks[end]) = (column, *block);
                    end += 1;
                }
            }
            end - first
        })
    });
    counts.collect()
}

/// `S += B x`, with `B` as columns.
#[inline(always)]
fn add_product<const N: usize>(sum: &mut [f32; N], block: &[[f32; N]; N], x: &[f32; N]) {
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

#[cfg(test)]
mod tests {
    use super::*;

    const ROWS: usize = 1300;
    /// Columns that belong to no row.
    const GHOSTS: usize = 5;

    /// A block and its transpose on the other side; far from both ends they lead out of runs.
    fn block(row: usize, column: usize) -> [[f32; 6]; 6] {
        let (low, high) = (row.min(column), row.max(column));
        let entry = |i: usize, j: usize| {
            let seed = (31 * low + 17 * high + 7 * i + 3 * j) % 101;
            seed as f32 / 101.0 - 0.4
        };
        std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                if row < column {
                    entry(i, j)
                } else {
                    entry(j, i)
                }
            })
        })
    }

    /// Rows with neighbours near and far, and some with a ghost, columns not in order.
    fn whole() -> Sparse<6, 6> {
        let columns = |row: usize| {
            let near = [
                row + 300,
                row + 1,
                row.wrapping_sub(1),
                row.wrapping_sub(300),
            ];
            let near = near.into_iter().filter(|&column| column < ROWS);
            let ghost = (row % 260 == 7).then_some(ROWS + row / 260);
            ghost.into_iter().chain(near)
        };
        Sparse::collect(ROWS, 64, |row, all, blocks| {
            for column in columns(row) {
                all.push(column as u32);
                blocks.push(block(row, column));
            }
        })
    }

    #[test]
    fn half_of_the_blocks_makes_the_products_and_rows_of_all() {
        let whole = whole();
        let half = SymmetricMatrix::of(whole.clone());
        assert_eq!(half.block_count(), whole.blocks.len());
        assert!(half.blocks.len() < whole.blocks.len() * 3 / 4);
        let entry = |at: usize| ((at * 7919) % 997) as f32 / 997.0 - 0.5;
        let x: Vec<[f32; 6]> = (0..ROWS + GHOSTS)
            .map(|row| std::array::from_fn(|i| entry(6 * row + i)))
            .collect();
        let mut product = vec![[0.0; 6]; ROWS];
        let runs = product.chunks_mut(rows_per_run::<6>()).enumerate();
        runs.for_each(|(run, product)| half.run_product(run, &x, product));
        for (row, product) in product.iter().enumerate() {
            let expected = whole.times(row, &x);
            for (one, other) in product.iter().zip(expected) {
                assert!((one - other).abs() < 1e-5, "{row}: {one} {other}");
            }
            let by_column = |row: Vec<(usize, [[f32; 6]; 6])>| {
                let mut row = row;
                row.sort_by_key(|(column, _)| *column);
                row
            };
            let own: Vec<_> = whole.row(row).map(|(at, block)| (at, *block)).collect();
            assert_eq!(by_column(half.row(row).collect()), by_column(own));
        }
    }
}
