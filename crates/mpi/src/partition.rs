//! Which rank owns which unknowns.

use std::ops::Range;
use std::sync::Arc;

use glam::{DMat3, DVec3};
use kluft_solver::small::rows_of;
use kluft_solver::{FixedPart, Lists, System};

use crate::answers::machine;
use crate::petsc::{PetscFailure, World};

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
    pub counts: Vec<i32>,
}

impl Partition {
    /// Divides the rows of a system so that the clusters stay whole, all ranks have about as many
    /// rows, and what a rank has lies together. It is the same on all ranks, and in every run.
    pub fn of(world: &Arc<World>, system: &System<'_>, clusters: &Lists) -> Self {
        let nodes = &system.problem().mesh.nodes;
        let points = system.discretisation().points();
        let place = |row: &u32| nodes[points.node[*row as usize] as usize];
        let bodies = (0..clusters.count()).map(|cluster| {
            let rows = clusters.of(cluster);
            let sum: DVec3 = rows.iter().map(place).sum();
            Body {
                cluster,
                place: sum / rows.len() as f64,
                rows: rows.len(),
            }
        });
        let mut bodies: Vec<Body> = bodies.collect();
        let mut owner = vec![0; points.len()];
        divide(&mut bodies, 0..world.ranks(), &mut |cluster, rank| {
            for &row in clusters.of(cluster) {
                owner[row as usize] = rank as u32;
            }
        });
        Self::of_owners(owner, world)
    }

    fn of_owners(owner: Vec<u32>, world: &World) -> Self {
        let by_rank = Lists::group(owner.iter().copied(), world.ranks());
        let mut number = vec![0; owner.len()];
        for (place, &row) in by_rank.entries.iter().enumerate() {
            number[row as usize] = place as i64;
        }
        let counts = by_rank.offset.windows(2);
        Self {
            own: by_rank.of(world.rank()).to_vec(),
            counts: counts.map(|pair| (pair[1] - pair[0]) as i32).collect(),
            all: by_rank.entries,
            owner,
            number,
        }
    }

    /// Blocks by the global numbers of their columns.
    pub fn numbered<'a>(
        &self,
        blocks: impl Iterator<Item = (u32, &'a DMat3)>,
    ) -> impl Iterator<Item = (i64, [[f64; 3]; 3])> {
        blocks.map(|(column, block)| (self.number[column as usize], rows_of(block)))
    }

    /// Sets a vector to the entries of all ranks, each in its place.
    ///
    /// # Errors
    /// Those of MPI.
    pub fn gather(
        &self,
        world: &World,
        own: &[[f64; 3]],
        vector: &mut [DVec3],
    ) -> Result<(), PetscFailure> {
        let gathered = world.gather_records(own, &self.counts)?;
        for (&row, entry) in self.all.iter().zip(gathered) {
            vector[row as usize] = DVec3::from_array(entry);
        }
        Ok(())
    }

    /// Sets the second of two vectors to the product of the tangent with the first one, each rank
    /// its own entries. A rank that cannot be asked any more ends the run.
    pub fn multiply(
        &self,
        world: &World,
        fixed: FixedPart<'_>,
        stiffness: &[DMat3],
        (vector, product): (&[DVec3], &mut [DVec3]),
    ) {
        let own = fixed.products(stiffness, &self.own, vector);
        let own: Vec<[f64; 3]> = own.into_iter().map(|entry| entry.to_array()).collect();
        if let Err(failure) = self.gather(world, &own, product) {
            machine(failure).print();
            World::abort(1);
        }
    }

    /// Replaces the entries of a vector that other ranks own by what they have there.
    ///
    /// # Errors
    /// Those of MPI.
    pub fn complete(&self, world: &World, vector: &mut [[f32; 3]]) -> Result<(), PetscFailure> {
        let own = self.own.iter();
        let own: Vec<[f64; 3]> = own
            .map(|&row| vector[row as usize].map(f64::from))
            .collect();
        let gathered = world.gather_records(&own, &self.counts)?;
        for (&row, entry) in self.all.iter().zip(gathered) {
            vector[row as usize] = entry.map(|x| x as f32);
        }
        Ok(())
    }

    /// Largest number of rows of a rank against the mean.
    pub fn imbalance(&self) -> f64 {
        let largest = self.counts.iter().copied().max().unwrap_or(0);
        let mean = self.owner.len() as f64 / self.counts.len() as f64;
        f64::from(largest) / mean.max(1.0)
    }
}

/// A cluster as what is divided.
struct Body {
    cluster: usize,
    place: DVec3,
    rows: usize,
}

/// Recursive coordinate bisection (Berger and Bokhari 1987): cuts across the longest extent, so
/// that each side has rows in proportion to its ranks. PETSc's partitioners would cut fewer
/// couplings, but PT-Scotch, which works on threads, cuts others in every run.
fn divide(bodies: &mut [Body], ranks: Range<usize>, give: &mut impl FnMut(usize, usize)) {
    if ranks.len() < 2 {
        bodies
            .iter()
            .for_each(|body| give(body.cluster, ranks.start));
        return;
    }
    let bounds = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let (low, high) = bodies.iter().fold(bounds, |(low, high), body| {
        (low.min(body.place), high.max(body.place))
    });
    let extent = high - low;
    let axis = (0..3).max_by(|&a, &b| extent[a].total_cmp(&extent[b]));
    let axis = axis.unwrap_or(0);
    bodies.sort_by(|a, b| {
        let places = a.place[axis].total_cmp(&b.place[axis]);
        places.then(a.cluster.cmp(&b.cluster))
    });
    let half = ranks.len() / 2;
    let rows: usize = bodies.iter().map(|body| body.rows).sum();
    let wanted = rows * half / ranks.len();
    let mut before = 0;
    let cut = bodies.iter().take_while(|body| {
        before += body.rows;
        before <= wanted
    });
    let (left, right) = bodies.split_at_mut(cut.count());
    divide(left, ranks.start..ranks.start + half, give);
    divide(right, ranks.start + half..ranks.end, give);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_rank_gets_its_share_of_what_lies_together() {
        let mut bodies: Vec<Body> = (0..300)
            .map(|cluster| Body {
                cluster,
                // Scattered along a line.
                place: DVec3::new(f64::from((cluster as u32 * 7) % 300), 0.1, 0.0),
                rows: 1 + cluster % 3,
            })
            .collect();
        for ranks in 1..=7 {
            let mut of_rank = vec![(0, f64::INFINITY, f64::NEG_INFINITY); ranks];
            divide(&mut bodies, 0..ranks, &mut |cluster, rank| {
                let place = f64::from((cluster as u32 * 7) % 300);
                let (rows, low, high) = of_rank[rank];
                of_rank[rank] = (rows + 1 + cluster % 3, low.min(place), high.max(place));
            });
            let total: usize = of_rank.iter().map(|(rows, ..)| rows).sum();
            assert_eq!(total, 600);
            for (rows, ..) in &of_rank {
                assert!(
                    (*rows as f64 - 600.0 / ranks as f64).abs() < 10.0,
                    "{rows} of {ranks}"
                );
            }
            assert!(
                of_rank.windows(2).all(|pair| pair[0].2 < pair[1].1),
                "{of_rank:?}"
            );
        }
    }

    #[test]
    fn more_ranks_than_clusters_leave_some_without_rows() {
        let mut bodies = vec![Body {
            cluster: 0,
            place: DVec3::ZERO,
            rows: 5,
        }];
        let mut given = Vec::new();
        divide(&mut bodies, 0..3, &mut |cluster, rank| {
            given.push((cluster, rank))
        });
        assert_eq!(given.len(), 1);
    }
}
