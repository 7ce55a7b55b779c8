//! Work divided among processes, the ranks.

use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use bytemuck::Pod;
use rayon::prelude::*;

use crate::failure::MultigridFailure;
use crate::lists::sum_up;
use crate::ownership::RowOwnership;

/// Puts the records of all ranks one behind the other: the bytes of a record, those of the records
/// of this rank, how many records each rank has, and room for the bytes of all.
pub type AllGather = Arc<dyn Fn(usize, &[u8], &[usize], &mut [u8]) + Send + Sync>;

/// This process among those that share a run. What it asks of the others, all of them must ask
/// alike.
#[derive(Clone)]
pub struct Communicator {
    rank: usize,
    size: usize,
    all_gather: AllGather,
}

impl fmt::Debug for Communicator {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "rank {} of {}", self.rank, self.size)
    }
}

impl Communicator {
    /// The only process.
    pub fn alone() -> Self {
        let copy = |_: usize, own: &[u8], _: &[usize], all: &mut [u8]| all.copy_from_slice(own);
        Self::new(0, 1, Arc::new(copy))
    }

    /// Process `rank` of `size`.
    pub fn new(rank: usize, size: usize, all_gather: AllGather) -> Self {
        Self {
            rank,
            size,
            all_gather,
        }
    }

    /// Number of this process, from 0.
    pub fn rank(&self) -> usize {
        self.rank
    }

    /// Number of processes.
    pub fn size(&self) -> usize {
        self.size
    }

    /// The records of all ranks, rank by rank, each giving as many as it has.
    pub fn gathered<T: Pod>(&self, own: &[T]) -> Vec<T> {
        self.gathered_of(own, &self.counts(own.len()))
    }

    /// The same where it is known how many each of them gives.
    pub fn gathered_of<T: Pod>(&self, own: &[T], counts: &[usize]) -> Vec<T> {
        let mut all: Vec<T> = bytemuck::zeroed_vec(counts.iter().sum());
        let bytes = bytemuck::cast_slice_mut(&mut all);
        (self.all_gather)(size_of::<T>(), bytemuck::cast_slice(own), counts, bytes);
        all
    }

    /// This number of each rank.
    fn counts(&self, own: usize) -> Vec<usize> {
        let mut counts = vec![0_u64; self.size];
        let bytes = bytemuck::cast_slice_mut(&mut counts);
        let each = vec![1; self.size];
        (self.all_gather)(8, &(own as u64).to_ne_bytes(), &each, bytes);
        counts.into_iter().map(|count| count as usize).collect()
    }

    /// What this rank has if all of them could do their part, and else the failure of one of them,
    /// the same on all.
    ///
    /// # Errors
    /// If one of them failed.
    pub fn agreed<T>(&self, result: Result<T, MultigridFailure>) -> Result<T, MultigridFailure> {
        let code = match &result {
            Ok(_) => 0,
            Err(MultigridFailure::NotFinite) => 1,
            Err(MultigridFailure::NotPositive(row)) => 2 + row,
        };
        match self.counts(code).into_iter().max() {
            Some(1) => Err(MultigridFailure::NotFinite),
            Some(row @ 2..) => Err(MultigridFailure::NotPositive(row - 2)),
            _ => result,
        }
    }

    /// Gives each rank about as many of some rows.
    pub fn divide_evenly(&self, rows: usize) -> Division {
        let starts = (0..=self.size).map(|rank| rank * rows / self.size);
        self.divide(RowOwnership::of_starts(starts.collect()))
    }

    /// Gives each rank its part of some rows.
    ///
    /// # Panics
    /// If there is not one part for each rank.
    pub fn divide(&self, rows: RowOwnership) -> Division {
        assert_eq!(rows.parts(), self.size, "one part for each rank");
        Division {
            communicator: self.clone(),
            rows,
        }
    }
}

/// Consecutive rows for each rank.
#[derive(Debug, Clone)]
pub struct Division {
    communicator: Communicator,
    rows: RowOwnership,
}

impl Division {
    /// All rows for the only process.
    pub fn whole(rows: usize) -> Self {
        Communicator::alone().divide(RowOwnership::of_starts(vec![0, rows]))
    }

    /// The ranks.
    pub fn communicator(&self) -> &Communicator {
        &self.communicator
    }

    /// Whether one rank has all rows.
    pub fn is_whole(&self) -> bool {
        self.communicator.size == 1
    }

    /// Rows of this rank.
    pub fn own(&self) -> Range<usize> {
        self.rows.range(self.communicator.rank)
    }

    /// Rank of a row.
    ///
    /// # Panics
    /// If there is no such row.
    pub fn owner(&self, row: usize) -> usize {
        self.rows.owner(row)
    }

    /// The division of `kept` rows, ascending, among those that are left when the others are
    /// dropped.
    pub fn of_kept(&self, kept: &[u32]) -> Self {
        let before = |end: usize| kept.partition_point(|&row| (row as usize) < end);
        let starts = self.rows.ranges().map(|range| before(range.start));
        let rows = RowOwnership::of_starts(starts.chain([kept.len()]).collect());
        self.communicator.divide(rows)
    }

    /// The records of all rows, of which each rank gives those of its own.
    pub fn gathered<T: Pod>(&self, own: Vec<T>) -> Vec<T> {
        match self.is_whole() {
            true => own,
            false => self.communicator.gathered_of(&own, &self.counts()),
        }
    }

    /// What `of` has for each row, where each rank asks for its own rows.
    pub fn map<T: Pod + Send>(&self, of: impl Fn(usize) -> T + Sync + Send) -> Vec<T> {
        self.gathered(self.own().into_par_iter().map(of).collect())
    }

    /// Replaces the entries of a vector that other ranks own by what they have there.
    ///
    /// # Panics
    /// If there is not one entry a row.
    pub fn complete<T: Pod>(&self, vector: &mut [T]) {
        assert_eq!(vector.len(), self.rows.rows(), "one entry a row");
        if self.is_whole() {
            return;
        }
        let own = vector[self.own()].to_vec();
        let all = bytemuck::cast_slice_mut(vector);
        let own = bytemuck::cast_slice(&own);
        (self.communicator.all_gather)(size_of::<T>(), own, &self.counts(), all);
    }

    /// Replaces the starts of lists, one a row and the end, of which a rank knows the lengths of
    /// its own, by those of the lists of all ranks.
    pub fn complete_offsets(&self, offset: &mut [usize]) {
        if self.is_whole() {
            return;
        }
        let length = |row: usize| (offset[row + 1] - offset[row]) as u32;
        let own: Vec<u32> = self.own().map(length).collect();
        let lengths = self.gathered(own);
        for (offset, length) in offset[1..].iter_mut().zip(lengths) {
            *offset = length as usize;
        }
        sum_up(offset);
    }

    fn counts(&self) -> Vec<usize> {
        self.rows.ranges().map(|range| range.len()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::thread_ranks::on_threads;

    /// Rows with uneven parts, one of which is empty.
    fn uneven() -> RowOwnership {
        RowOwnership::of_starts(vec![0, 3, 3, 10])
    }

    #[test]
    fn records_of_all_ranks_come_in_their_order() {
        let gathered = on_threads(3, |communicator| {
            let rank = communicator.rank() as u32;
            communicator.gathered(&vec![[rank, 7]; communicator.rank()])
        });
        assert!(gathered.iter().all(|all| *all == [[1, 7], [2, 7], [2, 7]]));
    }

    #[test]
    fn all_ranks_have_what_each_makes_of_its_own_rows() {
        let squares: Vec<u64> = (0..10).map(|row| row * row).collect();
        let mapped = on_threads(3, |communicator| {
            let division = communicator.divide(uneven());
            let mut vector = vec![0; 10];
            for row in division.own() {
                vector[row] = (row * row) as u64;
            }
            division.complete(&mut vector);
            (division.map(|row| (row * row) as u64), vector)
        });
        for (mapped, completed) in mapped {
            assert_eq!((&mapped, &completed), (&squares, &squares));
        }
        assert_eq!(Division::whole(10).map(|row| (row * row) as u64), squares);
    }

    #[test]
    fn starts_of_lists_follow_from_the_lengths_on_all_ranks() {
        let starts = on_threads(3, |communicator| {
            let division = communicator.divide(uneven());
            // Row `r` has `r % 3` entries.
            let length = |row: usize| match division.own().contains(&row) {
                true => row % 3,
                false => 0,
            };
            let mut offset: Vec<usize> = [0].into_iter().chain((0..10).map(length)).collect();
            sum_up(&mut offset);
            division.complete_offsets(&mut offset);
            offset
        });
        for offset in starts {
            assert_eq!(offset, [0, 0, 1, 3, 3, 4, 6, 6, 7, 9, 9]);
        }
    }

    #[test]
    fn rows_that_are_kept_stay_with_their_ranks() {
        let communicator = Communicator::new(0, 3, Arc::new(|_, _, _, _| {}));
        let kept = communicator.divide(uneven()).of_kept(&[1, 2, 5, 9]);
        let owners: Vec<usize> = (0..4).map(|row| kept.owner(row)).collect();
        assert_eq!(owners, [0, 0, 2, 2]);
        assert_eq!(kept.own(), 0..2);
    }

    #[test]
    fn a_failure_of_one_rank_is_one_of_all() {
        let agreed = |failing: Option<(usize, MultigridFailure)>| {
            on_threads(3, |communicator| {
                let own = failing.filter(|(rank, _)| *rank == communicator.rank());
                communicator
                    .agreed(own.map_or(Ok(communicator.rank()), |(_, failure)| Err(failure)))
            })
        };
        assert_eq!(agreed(None), [Ok(0), Ok(1), Ok(2)]);
        for failure in [
            MultigridFailure::NotFinite,
            MultigridFailure::NotPositive(0),
        ] {
            let all = agreed(Some((1, failure)));
            assert!(all.iter().all(|one| *one == Err(failure)), "{all:?}");
        }
    }
}
