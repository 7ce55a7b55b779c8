//! Who owns which rows.

use std::ops::Range;

/// The parts that rows are divided into: part `p` owns the rows `starts[p]..starts[p + 1]`.
///
/// The ranges ascend and cover all rows, so every row has one owner. A part is the work of one
/// task; of one process, where rows are divided over many.
///
/// What assembly and set-up promise with it: a part writes the rows that it owns and no others, and
/// adds what contributes to a row in ascending order of the contributors. So there are no locks,
/// and no value depends on how many threads there are, nor on how the rows are divided.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RowOwnership {
    starts: Vec<usize>,
}

impl RowOwnership {
    /// Parts of `length` rows each; the last one may have fewer.
    ///
    /// # Panics
    /// If `length` is zero.
    pub fn even(rows: usize, length: usize) -> Self {
        let starts = (0..rows).step_by(length).chain([rows]);
        Self {
            starts: starts.collect(),
        }
    }

    /// Parts that begin at `starts`; the last entry is the number of rows.
    ///
    /// # Panics
    /// If the first entry is not zero, or the entries descend.
    pub fn of_starts(starts: Vec<usize>) -> Self {
        assert_eq!(
            starts.first(),
            Some(&0),
            "the first part owns the first row"
        );
        assert!(starts.is_sorted(), "the ranges of the parts ascend");
        Self { starts }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.starts[self.parts()]
    }

    /// Number of parts.
    pub fn parts(&self) -> usize {
        self.starts.len() - 1
    }

    /// Rows of a part.
    pub fn range(&self, part: usize) -> Range<usize> {
        self.starts[part]..self.starts[part + 1]
    }

    /// The part that owns a row.
    ///
    /// # Panics
    /// If there is no such row.
    pub fn owner(&self, row: usize) -> usize {
        assert!(row < self.rows(), "no row {row}");
        self.starts.partition_point(|&start| start <= row) - 1
    }

    /// Rows of all parts.
    pub fn ranges(&self) -> impl Iterator<Item = Range<usize>> {
        self.starts.windows(2).map(|pair| pair[0]..pair[1])
    }

    /// Cuts the entries of all rows, row `r` having `offset[r]..offset[r + 1]`, into what each part
    /// owns.
    ///
    /// # Panics
    /// If `offset` has not one entry more than there are rows.
    pub fn split<'a, T>(
        &self,
        entries: &'a mut [T],
        offset: &[usize],
    ) -> Vec<(Range<usize>, &'a mut [T])> {
        assert_eq!(
            offset.len(),
            self.rows() + 1,
            "one offset a row, and the end"
        );
        let mut rest = entries;
        let mut shares = Vec::with_capacity(self.parts());
        for rows in self.ranges() {
            let (share, tail) = rest.split_at_mut(offset[rows.end] - offset[rows.start]);
            shares.push((rows, share));
            rest = tail;
        }
        shares
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_has_one_owner() {
        for ownership in [
            RowOwnership::even(10, 4),
            RowOwnership::even(8, 4),
            RowOwnership::of_starts(vec![0, 3, 3, 10]),
        ] {
            let mut next = 0;
            for part in 0..ownership.parts() {
                for row in ownership.range(part) {
                    assert_eq!((row, ownership.owner(row)), (next, part));
                    next += 1;
                }
            }
            assert_eq!(next, ownership.rows());
        }
    }

    #[test]
    fn no_rows_have_no_parts() {
        assert_eq!(RowOwnership::even(0, 4).parts(), 0);
        assert!(RowOwnership::even(0, 4).split(&mut [0; 0], &[0]).is_empty());
    }

    #[test]
    fn entries_go_to_the_owners_of_their_rows() {
        let mut entries = [1, 2, 3, 4, 5];
        let shares = RowOwnership::even(3, 2).split(&mut entries, &[0, 1, 4, 5]);
        let shares: Vec<_> = shares
            .iter()
            .map(|(rows, own)| (rows.clone(), own.len()))
            .collect();
        assert_eq!(shares, [(0..2, 4), (2..3, 1)]);
    }
}
