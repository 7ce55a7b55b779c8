//! Products `P^T A P` with little room besides the result: rows of `A` are taken in batches.

use std::ops::Range;

use rayon::prelude::*;

use super::cycle::Prolongator;
use super::sparse::{Accumulator, Sparse, Transpose, rows_per_task};
use crate::division::Communicator;
use crate::lists::sum_up;
use crate::small::{add, add_columns, add_product, widen};

/// Rows of a batch, fixed so that no result depends on the number of threads. `A P` of one is kept.
const fn batch<const N: usize>() -> usize {
    if N == 3 { 1 << 15 } else { 1 << 13 }
}

/// A 6x6 block as rows.
pub(super) type Block6 = [[f64; 6]; 6];

/// What some rows of `A` give to `P^T A P`.
#[derive(Debug, Clone)]
pub(super) struct PartialProduct {
    /// Aggregates that they give something to, ascending.
    aggregates: Vec<u32>,
    /// Their diagonal blocks.
    pub(super) diagonal: Vec<Block6>,
    /// The blocks of their rows right of the diagonal, as rows; columns are numbers of aggregates.
    pub(super) upper: Sparse<6, 6>,
}

impl PartialProduct {
    /// What rows of `A`, which has the identity as its diagonal, give to `P^T A P`: those that
    /// `is_wanted`, in batches.
    pub(super) fn of_rows<const N: usize>(
        matrix: &Sparse<N, N>,
        prolongator: &Prolongator<N>,
        is_wanted: impl Fn(usize) -> bool + Sync,
    ) -> Vec<Self> {
        let Prolongator {
            rows: prolongator,
            transpose,
        } = prolongator;
        let rows = matrix.rows();
        let mut image = Sparse::empty();
        let starts = (0..rows).step_by(batch::<N>());
        let parts = starts.map(|start| {
            let rows = start..rows.min(start + batch::<N>());
            let image_rows = ImageRows {
                matrix,
                prolongator,
                aggregates: transpose.columns(),
                rows: &rows,
            };
            image_rows.set(&mut image, &is_wanted);
            Self::of_image(prolongator, transpose, &rows, &image)
        });
        parts.collect()
    }

    /// What some rows give, from their rows of `A P`.
    fn of_image<const N: usize>(
        prolongator: &Sparse<N, 6>,
        transpose: &Transpose,
        rows: &Range<usize>,
        image: &Sparse<N, 6>,
    ) -> Self {
        let mut is_met = vec![false; transpose.columns()];
        let met = prolongator.offset[rows.start]..prolongator.offset[rows.end];
        for &column in &prolongator.columns[met] {
            is_met[column as usize] = true;
        }
        let aggregates = (0..transpose.columns() as u32).filter(|&at| is_met[at as usize]);
        let aggregates: Vec<u32> = aggregates.collect();
        let batch = Batch {
            prolongator,
            transpose,
            image,
            rows,
        };
        let diagonal = aggregates.par_iter().with_min_len(rows_per_task::<6>());
        Self {
            diagonal: diagonal.map(|&at| batch.diagonal(at)).collect(),
            upper: batch.upper(&aggregates),
            aggregates,
        }
    }

    /// The sum of parts, with all aggregates.
    pub(super) fn sum<'a>(aggregates: usize, parts: impl IntoIterator<Item = &'a Self>) -> Self {
        let parts: Vec<&Self> = parts.into_iter().collect();
        let (offset, places) = places(aggregates, &parts);
        let of = |aggregate: usize| {
            let places = &places[offset[aggregate]..offset[aggregate + 1]];
            places
                .iter()
                .map(|&(part, row)| (parts[part as usize], row as usize))
        };
        let diagonal = (0..aggregates).into_par_iter().map(|aggregate| {
            let mut sum = [[0.0; 6]; 6];
            of(aggregate).for_each(|(part, row)| add(&mut sum, 1.0, &part.diagonal[row]));
            sum
        });
        let upper = Sparse::build(
            aggregates,
            rows_per_task::<6>(),
            || Accumulator::<6, 6>::new(aggregates),
            |sums, aggregate| {
                for (part, row) in of(aggregate) {
                    let columns = &part.upper.columns[part.upper.range(row)];
                    columns.iter().for_each(|&column| sums.touch(column));
                }
                sums.take_count()
            },
            #[inline(always)]
            |sums, aggregate, columns, blocks| {
                for (part, row) in of(aggregate) {
                    for (column, block) in part.upper.row(row) {
                        add(sums.at(column as u32), 1.0, &widen(block));
                    }
                }
                sums.take(columns, blocks);
            },
        );
        Self {
            aggregates: (0..aggregates as u32).collect(),
            diagonal: diagonal.collect(),
            upper,
        }
    }

    /// The same without aggregates that nothing is given to, if it has all.
    pub(super) fn without_empty(mut self) -> Self {
        let (diagonal, upper) = (&self.diagonal, &self.upper);
        let has_any = |row: usize| diagonal[row] != [[0.0; 6]; 6] || !upper.range(row).is_empty();
        let is_kept: Vec<bool> = (0..diagonal.len()).map(has_any).collect();
        let is_kept = |row: usize| is_kept[row];
        let ends = (0..self.diagonal.len()).filter(|&row| is_kept(row));
        let ends = ends.map(|row| self.upper.offset[row + 1]);
        // Rows that go have no blocks.
        self.upper.offset = std::iter::once(0).chain(ends).collect();
        let kept = |row: &u32| is_kept(*row as usize);
        self.diagonal = (0..self.diagonal.len())
            .filter(|&row| is_kept(row))
            .map(|row| self.diagonal[row])
            .collect();
        self.aggregates.retain(kept);
        self
    }

    /// The sum of those of all ranks, which have all aggregates.
    pub(super) fn completed(self, ranks: &Communicator) -> Self {
        match ranks.size() {
            1 => self,
            _ => {
                let aggregates = self.diagonal.len();
                Self::sum(aggregates, &self.without_empty().gathered(ranks))
            }
        }
    }

    /// Those of all ranks, in their order.
    pub(super) fn gathered(self, communicator: &Communicator) -> Vec<Self> {
        let Self {
            aggregates,
            diagonal,
            upper,
        } = self;
        let counts = communicator.gathered(&[aggregates.len() as u64]);
        let lengths = upper
            .offset
            .windows(2)
            .map(|pair| (pair[1] - pair[0]) as u32);
        let lengths = communicator.gathered(&lengths.collect::<Vec<_>>());
        let mut aggregates = communicator.gathered(&aggregates).into_iter();
        let mut diagonal = communicator.gathered(&diagonal).into_iter();
        let mut columns = communicator.gathered(&upper.columns).into_iter();
        let mut blocks = communicator.gathered(&upper.blocks).into_iter();
        drop(upper);
        let mut lengths = lengths.into_iter().map(|length| length as usize);
        let parts = counts.into_iter().map(|count| {
            let count = count as usize;
            let mut offset: Vec<usize> = std::iter::once(0)
                .chain(lengths.by_ref().take(count))
                .collect();
            sum_up(&mut offset);
            let length = offset[count];
            Self {
                aggregates: aggregates.by_ref().take(count).collect(),
                diagonal: diagonal.by_ref().take(count).collect(),
                upper: Sparse {
                    columns: columns.by_ref().take(length).collect(),
                    blocks: blocks.by_ref().take(length).collect(),
                    offset,
                },
            }
        });
        parts.collect()
    }

    /// Bytes of storage.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(&self.aggregates[..]) + size_of_val(&self.diagonal[..]) + self.upper.bytes()
    }
}

/// For each aggregate the parts that have it, and its row there.
fn places(aggregates: usize, parts: &[&PartialProduct]) -> (Vec<usize>, Vec<(u32, u32)>) {
    let mut offset = vec![0; aggregates + 1];
    for &aggregate in parts.iter().flat_map(|part| &part.aggregates) {
        offset[aggregate as usize + 1] += 1;
    }
    sum_up(&mut offset);
    let mut next = offset.clone();
    let mut places = vec![(0, 0); offset[aggregates]];
    for (number, part) in parts.iter().enumerate() {
        for (row, &aggregate) in part.aggregates.iter().enumerate() {
            let next = &mut next[aggregate as usize];
            places[*next] = (number as u32, row as u32);
            *next += 1;
        }
    }
    (offset, places)
}

/// Some rows of `A P`.
struct ImageRows<'a, const N: usize> {
    matrix: &'a Sparse<N, N>,
    prolongator: &'a Sparse<N, 6>,
    /// Number of columns.
    aggregates: usize,
    rows: &'a Range<usize>,
}

impl<const N: usize> ImageRows<'_, N> {
    /// Sets `image` to them, empty if not wanted.
    fn set(&self, image: &mut Sparse<N, 6>, is_wanted: impl Fn(usize) -> bool + Sync) {
        image.rebuild(
            self.rows.len(),
            rows_per_task::<N>(),
            || Accumulator::<N, 6>::new(self.aggregates),
            |sums, row| {
                let row = self.rows.start + row;
                if !is_wanted(row) {
                    return 0;
                }
                for at in std::iter::once(row).chain(self.matrix.row(row).map(|(at, _)| at)) {
                    let columns = &self.prolongator.columns[self.prolongator.range(at)];
                    columns.iter().for_each(|&column| sums.touch(column));
                }
                sums.take_count()
            },
            #[inline(always)]
            |sums, row, columns, blocks| {
                let row = self.rows.start + row;
                if !is_wanted(row) {
                    return;
                }
                for (column, block) in self.prolongator.row(row) {
                    add(sums.at(column as u32), 1.0, &widen(block));
                }
                for (at, block) in self.matrix.row(row) {
                    for (column, line) in self.prolongator.row(at) {
                        add_product(sums.at(column as u32), 1.0, block, line);
                    }
                }
                sums.take(columns, blocks);
            },
        );
    }
}

/// Some rows of `P` and of `A P`.
struct Batch<'a, const N: usize> {
    prolongator: &'a Sparse<N, 6>,
    transpose: &'a Transpose,
    image: &'a Sparse<N, 6>,
    rows: &'a Range<usize>,
}

impl<const N: usize> Batch<'_, N> {
    /// Blocks of a column of `P`, and the rows of the image.
    #[inline(always)]
    fn column(&self, aggregate: u32) -> impl Iterator<Item = (&[[f32; 6]; N], usize)> {
        let entries = self.transpose.column(aggregate as usize);
        let before = |end: usize| entries.partition_point(|&(row, _)| (row as usize) < end);
        let entries = &entries[before(self.rows.start)..before(self.rows.end)];
        entries.iter().map(|&(row, position)| {
            let block = &self.prolongator.blocks[position as usize];
            (block, row as usize - self.rows.start)
        })
    }

    fn diagonal(&self, aggregate: u32) -> Block6 {
        let mut sum = [[0.0; 6]; 6];
        for (left, row) in self.column(aggregate) {
            let range = self.image.range(row);
            let place = self.image.columns[range.clone()].binary_search(&aggregate);
            if let Ok(place) = place {
                add_transposed(&mut sum, left, &self.image.blocks[range.start + place]);
            }
        }
        sum
    }

    /// Entries of a row of the image right of the diagonal.
    #[inline(always)]
    fn right_of(&self, row: usize, aggregate: u32) -> Range<usize> {
        let range = self.image.range(row);
        let columns = &self.image.columns[range.clone()];
        range.start + columns.partition_point(|&column| column <= aggregate)..range.end
    }

    fn upper(&self, aggregates: &[u32]) -> Sparse<6, 6> {
        let image = self.image;
        Sparse::build(
            aggregates.len(),
            rows_per_task::<6>(),
            || Accumulator::<6, 6>::new(self.transpose.columns()),
            |sums, row| {
                let aggregate = aggregates[row];
                for (_, row) in self.column(aggregate) {
                    let columns = &image.columns[self.right_of(row, aggregate)];
                    columns.iter().for_each(|&column| sums.touch(column));
                }
                sums.take_count()
            },
            #[inline(always)]
            |sums, row, columns, blocks| {
                let aggregate = aggregates[row];
                for (left, row) in self.column(aggregate) {
                    for right in self.right_of(row, aggregate) {
                        let sum = sums.at(image.columns[right]);
                        add_transposed(sum, left, &image.blocks[right]);
                    }
                }
                sums.take(columns, blocks);
            },
        )
    }
}

/// `S += A^T B` of blocks as rows.
#[inline(always)]
fn add_transposed<const N: usize>(sum: &mut Block6, a: &[[f32; 6]; N], b: &[[f32; 6]; N]) {
    add_columns(sum, &widen(a), &widen(b));
}
