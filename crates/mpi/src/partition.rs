//! Which rank owns which unknowns.

use std::sync::Arc;

use kluft_solver::{BlockRows, Lists};

use crate::petsc::{PetscFailure, World};

/// Clusters for each rank below which their graph is not worth a partition.
const FEW: usize = 8;

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
    /// Divides rows so that the clusters stay whole, all ranks have about as many rows, and few
    /// couplings are cut. It is the same on all ranks.
    ///
    /// # Errors
    /// Those of PETSc.
    pub fn of(
        world: &Arc<World>,
        matrix: BlockRows<'_>,
        clusters: &Lists,
    ) -> Result<Self, PetscFailure> {
        let of_cluster = if world.ranks() == 1 {
            vec![0; clusters.count()]
        } else if clusters.count() < FEW * world.ranks() {
            in_turn(clusters, world.ranks())
        } else {
            by_graph(world, matrix, clusters)?
        };
        let mut owner = vec![0; matrix.rows()];
        for (cluster, rank) in of_cluster.iter().enumerate() {
            for &row in clusters.of(cluster) {
                owner[row as usize] = *rank as u32;
            }
        }
        Ok(Self::of_owners(owner, world))
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

    /// Largest number of rows of a rank against the mean.
    pub fn imbalance(&self) -> f64 {
        let largest = self.counts.iter().copied().max().unwrap_or(0);
        let mean = self.owner.len() as f64 / self.counts.len() as f64;
        f64::from(largest) / mean.max(1.0)
    }
}

/// Clusters in their order, cut into parts of about as many rows.
fn in_turn(clusters: &Lists, ranks: usize) -> Vec<i32> {
    let rows = clusters.entries.len().max(1);
    let mut before = 0;
    let part = |cluster: usize| {
        let part = before * ranks / rows;
        before += clusters.of(cluster).len();
        part as i32
    };
    (0..clusters.count()).map(part).collect()
}

/// The graph of clusters, cut by PETSc.
fn by_graph(
    world: &World,
    matrix: BlockRows<'_>,
    clusters: &Lists,
) -> Result<Vec<i32>, PetscFailure> {
    let mut cluster_of = vec![0_u32; matrix.rows()];
    for cluster in 0..clusters.count() {
        for &row in clusters.of(cluster) {
            cluster_of[row as usize] = cluster as u32;
        }
    }
    let (mut offset, mut neighbours, mut weight) = (vec![0], Vec::new(), Vec::new());
    let mut beside: Vec<u32> = Vec::new();
    for cluster in 0..clusters.count() {
        beside.clear();
        for &row in clusters.of(cluster) {
            let own = matrix.row_offset[row as usize]..matrix.row_offset[row as usize + 1];
            let columns = matrix.columns[own].iter();
            beside.extend(columns.map(|&column| cluster_of[column as usize]));
        }
        beside.sort_unstable();
        beside.dedup();
        let others = beside.iter().filter(|&&other| other as usize != cluster);
        neighbours.extend(others.map(|&other| i64::from(other)));
        offset.push(neighbours.len() as i64);
        weight.push(clusters.of(cluster).len() as i64);
    }
    world.partition(&offset, &neighbours, &weight)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clusters_in_turn_give_each_rank_about_as_many_rows() {
        let clusters = Lists::collect(&[vec![0, 4], vec![1], vec![2], vec![3, 5]]);
        assert_eq!(in_turn(&clusters, 2), [0, 0, 1, 1]);
        assert_eq!(in_turn(&clusters, 3), [0, 1, 1, 2]);
        assert!(in_turn(&Lists::collect(&[]), 3).is_empty());
    }
}
