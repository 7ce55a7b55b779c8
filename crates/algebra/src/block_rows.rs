//! A view of a symmetric matrix as rows of 3x3 blocks.

use glam::{DMat3, DVec3};
use rayon::prelude::*;

use crate::block_pattern::{BlockPattern, ROWS_PER_RUN, Span};

/// Marks a row of the larger matrix that is not kept.
pub(crate) const DROPPED: u32 = u32::MAX;

/// A symmetric sparse matrix of 3x3 blocks, row by row.
#[derive(Debug, Clone, Copy)]
pub struct BlockRows<'a> {
    /// Where it has blocks, and which are stored.
    pub pattern: &'a BlockPattern,
    /// The stored blocks; entry `(r, c)` of a block is `block.col(c)[r]`.
    pub blocks: &'a [DMat3],
}

impl<'a> BlockRows<'a> {
    /// Number of block rows.
    pub fn rows(&self) -> usize {
        self.pattern.rows()
    }

    /// Columns and blocks of a row.
    pub fn row(self, row: usize) -> impl Iterator<Item = (u32, DMat3)> + use<'a> {
        let columns = self.pattern.columns[self.pattern.row(row)].iter();
        let span = self.pattern.span(row);
        let stored = &self.blocks[self.pattern.stored(row)];
        let places = columns.enumerate();
        places.map(move |(place, &column)| {
            let block = match place {
                _ if place < span.mirrored => stored[place],
                _ if place >= span.right => stored[span.mirrored + place - span.right],
                _ => self.mirrored(row, column),
            };
            (column, block)
        })
    }

    /// Block number `place` of a row.
    pub fn block(&self, row: usize, place: usize) -> DMat3 {
        let column = self.pattern.columns[self.pattern.row_offset[row] + place];
        let address = self.pattern.address(row, place);
        address.map_or_else(|| self.mirrored(row, column), |at| self.blocks[at])
    }

    fn mirrored(&self, row: usize, column: u32) -> DMat3 {
        let address = self.pattern.mirror(row, column as usize);
        address.map_or(DMat3::ZERO, |at| self.blocks[at].transpose())
    }

    /// The diagonal block of a row, zero if there is none.
    pub fn diagonal(&self, row: usize) -> DMat3 {
        let place = self.pattern.place(row, row);
        place.map_or(DMat3::ZERO, |place| self.block(row, place))
    }

    /// `product = A vector`, both of one entry a block row, without allocating. Each run of rows is
    /// summed by one thread in a fixed order, so the result does not depend on the number of
    /// threads, nor on which blocks are stored once.
    ///
    /// # Panics
    /// If `vector` or `product` has not one entry for each block row.
    pub fn multiply(&self, vector: &[DVec3], product: &mut [DVec3]) {
        self.multiply_by(|block| *block, vector, product);
    }

    /// `product = |A| |vector|`, both entry by entry: the unit that rounding of `A vector` is a
    /// small multiple of, once it is multiplied with the machine's epsilon.
    ///
    /// # Panics
    /// As [`Self::multiply`].
    pub fn multiply_absolute(&self, vector: &[DVec3], product: &mut [DVec3]) {
        let vector: Vec<DVec3> = vector.par_iter().map(|entry| entry.abs()).collect();
        let absolute = |block: &DMat3| DMat3::from_cols_array(&block.to_cols_array().map(f64::abs));
        self.multiply_by(absolute, &vector, product);
    }

    fn multiply_by(
        &self,
        of: impl Fn(&DMat3) -> DMat3 + Copy + Sync,
        vector: &[DVec3],
        product: &mut [DVec3],
    ) {
        let lengths = [vector.len(), product.len()];
        assert_eq!(lengths, [self.rows(); 2], "one entry a block row");
        let runs = product.par_chunks_mut(ROWS_PER_RUN).enumerate();
        runs.for_each(|(run, product)| self.run_product(of, run, vector, product));
    }

    /// Entries `rows`, ascending, of `A vector`, to the same bits as [`Self::multiply`] has them.
    pub fn products(&self, rows: &[u32], vector: &[DVec3]) -> Vec<DVec3> {
        let run = |row: u32| row as usize / ROWS_PER_RUN;
        let runs: Vec<&[u32]> = rows.chunk_by(|a, b| run(*a) == run(*b)).collect();
        let products = runs.par_iter().flat_map_iter(|rows| {
            let first = run(rows[0]) * ROWS_PER_RUN;
            let length = ROWS_PER_RUN.min(self.rows() - first);
            let mut product = vec![DVec3::ZERO; length];
            self.run_product(|block| *block, run(rows[0]), vector, &mut product);
            rows.iter().map(move |&row| product[row as usize - first])
        });
        products.collect()
    }

    /// Sets `product` to the entries of run number `run`. Each is the sum of what is left of the
    /// diagonal within the run, plus the sum of the others.
    #[inline(always)]
    fn run_product(
        &self,
        of: impl Fn(&DMat3) -> DMat3,
        run: usize,
        vector: &[DVec3],
        product: &mut [DVec3],
    ) {
        let first = run * ROWS_PER_RUN;
        let rows = first..first + product.len();
        product.fill(DVec3::ZERO);
        if !self.pattern.is_halved(&rows) {
            for row in rows.clone() {
                let (columns, stored, span) = self.parts(row);
                let left = span.run..span.mirrored;
                for (&column, block) in columns[left.clone()].iter().zip(&stored[left]) {
                    product[row - first] += of(block) * vector[column as usize];
                }
            }
        }
        for row in rows {
            let (columns, stored, span) = self.parts(row);
            let (before, stored) = (&stored[..span.run], &stored[span.mirrored..]);
            let own = vector[row];
            let mut sum = DVec3::ZERO;
            for (&column, block) in columns.iter().zip(before) {
                sum += of(block) * vector[column as usize];
            }
            let columns = &columns[span.right..];
            let (inside, outside) = stored.split_at(span.end - span.right);
            for (&column, block) in columns.iter().zip(inside) {
                let (column, block) = (column as usize, of(block));
                sum += block * vector[column];
                if column != row {
                    product[column - first] += block.transpose() * own;
                }
            }
            for (&column, block) in columns[inside.len()..].iter().zip(outside) {
                sum += of(block) * vector[column as usize];
            }
            product[row - first] += sum;
        }
    }

    /// Columns of a row, its stored blocks, and how they are divided.
    #[inline(always)]
    fn parts(&self, row: usize) -> (&'a [u32], &'a [DMat3], Span) {
        let BlockRows { pattern, blocks } = *self;
        let columns = &pattern.columns[pattern.row(row)];
        (columns, &blocks[pattern.stored(row)], pattern.span(row))
    }
}

/// New number of each row, [`DROPPED`] for those not kept.
pub(crate) fn numbers(rows: usize, kept: &[u32]) -> Vec<u32> {
    let mut number = vec![DROPPED; rows];
    for (new, &old) in kept.iter().enumerate() {
        number[old as usize] = new as u32;
    }
    number
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROWS: usize = 5000;

    /// Columns near to a row and far from it, within its run and beyond.
    fn columns(row: usize) -> Vec<u32> {
        let shifts = [-2500_isize, -700, -1, 0, 1, 700, 2500];
        let columns = shifts.iter().map(|shift| row as isize + shift);
        let columns = columns.filter(|column| (0..ROWS as isize).contains(column));
        columns.map(|column| column as u32).collect()
    }

    fn block(row: usize, column: usize) -> DMat3 {
        let (low, high) = (row.min(column), row.max(column));
        let entry = |at: usize| ((31 * low + 17 * high + 7 * at) % 101) as f64 / 101.0 - 0.4;
        let block = DMat3::from_cols_array(&std::array::from_fn(entry));
        match row.cmp(&column) {
            std::cmp::Ordering::Less => block,
            std::cmp::Ordering::Equal => block + block.transpose(),
            std::cmp::Ordering::Greater => block.transpose(),
        }
    }

    fn plain() -> BlockPattern {
        let all: Vec<Vec<u32>> = (0..ROWS).map(columns).collect();
        let lengths = all.iter().map(Vec::len);
        let mut offset: Vec<usize> = std::iter::once(0).chain(lengths).collect();
        crate::lists::sum_up(&mut offset);
        BlockPattern::new(offset, all.concat())
    }

    /// The blocks that a pattern stores.
    fn stored(pattern: &BlockPattern) -> Vec<DMat3> {
        let rows = (0..ROWS).flat_map(|row| {
            let columns = &pattern.columns[pattern.row(row)];
            let places = pattern.stored_places(row);
            places.map(move |place| block(row, columns[place] as usize))
        });
        rows.collect()
    }

    #[test]
    fn half_of_the_blocks_makes_the_rows_and_products_of_all_to_the_last_bit() {
        let vector: Vec<DVec3> = (0..ROWS)
            .map(|row| DVec3::new(1.0, -0.3, 0.1) * ((row * 7919) % 997) as f64)
            .collect();
        let wanted = [3, 4, 700, 2050, 4999];
        let results = |pattern: &BlockPattern| {
            let blocks = stored(pattern);
            assert_eq!(blocks.len(), pattern.stored_count());
            let rows = BlockRows {
                pattern,
                blocks: &blocks,
            };
            let mut products = [vec![DVec3::ZERO; ROWS], vec![DVec3::ZERO; ROWS]];
            rows.multiply(&vector, &mut products[0]);
            rows.multiply_absolute(&vector, &mut products[1]);
            let some = wanted.map(|row| products[0][row as usize]);
            assert_eq!(rows.products(&wanted, &vector), some);
            for row in 0..ROWS {
                let own = columns(row).into_iter();
                let expected = own.map(|column| (column, block(row, column as usize)));
                assert!(rows.row(row).eq(expected), "row {row}");
                assert_eq!(rows.diagonal(row), block(row, row));
            }
            products
        };
        let whole = plain();
        let expected = results(&whole);
        for row in [0, 1234, 4999] {
            let own = columns(row).into_iter();
            let terms = own.map(|column| block(row, column as usize) * vector[column as usize]);
            let sum: DVec3 = terms.sum();
            assert!((expected[0][row] - sum).length() < 1e-12 * sum.length());
        }
        for rows in [0..ROWS, 0..0, 1000..4500, 2048..4096] {
            let half = whole.clone().halved(rows.clone());
            assert!(results(&half) == expected, "{rows:?}");
            let few = half.stored_count() < whole.columns.len() * 4 / 5;
            assert_eq!(few, rows.len() > 4000, "{rows:?}");
        }
    }
}
