//! Which rank owns which unknowns.

use bytemuck::Pod;
use glam::{DMat3, DVec3};
use kluft_solver::{Communicator, FixedPart, Lists};

/// Rows and their owners. The rows of a rank have consecutive global numbers, rank by rank, in the
/// order of the rows.
#[derive(Debug, Clone)]
pub struct Partition {
    /// Rank of each row.
    pub owner: Vec<u32>,
    /// Global number of each row.
    pub number: Vec<i64>,
    /// Rows of this rank, ascending.
    pub own: Vec<u32>,
    /// Rows of each rank, rank by rank.
    pub all: Vec<u32>,
    /// Number of rows of each rank.
    pub counts: Vec<usize>,
    communicator: Communicator,
}

impl Partition {
    /// With the rank of each row.
    pub fn of(owner: Vec<u32>, communicator: &Communicator) -> Self {
        let by_rank = Lists::group(owner.iter().copied(), communicator.size());
        let mut number = vec![0; owner.len()];
        for (place, &row) in by_rank.entries.iter().enumerate() {
            number[row as usize] = place as i64;
        }
        let counts = by_rank.offset.windows(2);
        Self {
            own: by_rank.of(communicator.rank()).to_vec(),
            counts: counts.map(|pair| pair[1] - pair[0]).collect(),
            all: by_rank.entries,
            owner,
            number,
            communicator: communicator.clone(),
        }
    }

    /// Replaces the entries of a vector by those of all ranks, each in its place; `own` are those
    /// of this rank.
    pub fn gather<T: Pod>(&self, own: &[T], vector: &mut [T]) {
        let gathered = self.communicator.gathered_of(own, &self.counts);
        for (&row, entry) in self.all.iter().zip(gathered) {
            vector[row as usize] = entry;
        }
    }

    /// Replaces the entries of a vector that other ranks own by what they have there.
    pub fn complete<T: Pod>(&self, vector: &mut [T]) {
        let own: Vec<T> = self.own.iter().map(|&row| vector[row as usize]).collect();
        self.gather(&own, vector);
    }

    /// Sets the second of two vectors to the product of the tangent with the first one, each rank
    /// its own entries.
    pub fn multiply(
        &self,
        fixed: FixedPart<'_>,
        stiffness: &[DMat3],
        (vector, product): (&[DVec3], &mut [DVec3]),
    ) {
        self.gather(&fixed.products(stiffness, &self.own, vector), product);
    }

    /// Largest number of rows of a rank against the mean.
    pub fn imbalance(&self) -> f64 {
        let largest = self.counts.iter().copied().max().unwrap_or(0);
        let mean = self.owner.len() as f64 / self.counts.len() as f64;
        largest as f64 / mean.max(1.0)
    }
}
