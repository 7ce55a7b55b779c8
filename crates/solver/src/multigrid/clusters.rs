//! Clusters: unknowns whose mutual stiffness the smoother inverts exactly.
//!
//! The unknowns of one node, mean displacement and jumps, form a cluster, and so do nodes much
//! nearer to each other than to others, as across the sliver of rock between a fracture and the
//! surface beside it. Such nodes move together at almost no cost, which a smoother that looks at
//! one node after the other cannot see, and which is too local for the next level.

use rayon::prelude::*;

use super::MultigridFailure;
use super::small::{inverse_factor, product, transpose};
use super::tangent::{TangentRows, rows_of};
use crate::pattern::Lists;

/// Nodes tied by a block of this norm belong together; the blocks of both are scaled to the identity.
const TIED: f64 = 0.8;
/// Most nodes of a cluster.
const MOST_NODES: u32 = 6;
/// A pivot below this share of the largest diagonal entry shows a singular block.
const SINGULAR: f64 = 1e-14;

/// The clusters of a matrix.
#[derive(Debug, Clone, Default)]
pub(super) struct Clusters {
    /// Rows of each cluster, ascending.
    pub(super) members: Lists,
    /// Cluster of each row, and place in it.
    pub(super) place: Vec<(u32, u32)>,
}

impl Clusters {
    /// Every row a cluster.
    pub(super) fn single(rows: usize) -> Self {
        Self {
            members: Lists {
                offset: (0..=rows).collect(),
                entries: (0..rows as u32).collect(),
            },
            place: (0..rows as u32).map(|row| (row, 0)).collect(),
        }
    }

    /// Clusters of a matrix whose nodes own the rows `node_offset[node]..node_offset[node + 1]`; the
    /// first of them is the mean displacement.
    ///
    /// # Errors
    /// If the diagonal block of a mean displacement is not positive definite.
    pub(super) fn of(
        rows: &TangentRows<'_>,
        node_offset: &[u32],
    ) -> Result<Self, MultigridFailure> {
        let mut ties = ties(rows, node_offset)?;
        ties.sort_by(|a, b| b.0.total_cmp(&a.0).then((a.1, a.2).cmp(&(b.1, b.2))));
        let nodes = node_offset.len() - 1;
        // The lowest node of each cluster, by paths, and how many nodes it has.
        let mut lowest: Vec<u32> = (0..nodes as u32).collect();
        let mut count = vec![1; nodes];
        for (_, a, b) in ties {
            let (a, b) = (root(&lowest, a), root(&lowest, b));
            let (low, high) = (a.min(b), a.max(b));
            let both = count[low as usize] + count[high as usize];
            if low != high && both <= MOST_NODES {
                lowest[high as usize] = low;
                count[low as usize] = both;
            }
        }
        Ok(Self::collect(&lowest, node_offset))
    }

    fn collect(lowest: &[u32], node_offset: &[u32]) -> Self {
        let owns = |node: usize| node_offset[node + 1] > node_offset[node];
        let mut number = vec![u32::MAX; lowest.len()];
        let mut clusters = 0;
        let mut keys = Vec::with_capacity(node_offset[lowest.len()] as usize);
        for node in (0..lowest.len()).filter(|&node| owns(node)) {
            let first = root(lowest, node as u32) as usize;
            if number[first] == u32::MAX {
                number[first] = clusters;
                clusters += 1;
            }
            let own = node_offset[node]..node_offset[node + 1];
            keys.extend(own.map(|_| number[first]));
        }
        let members = Lists::group(keys.iter().copied(), clusters as usize);
        let mut place = vec![(0, 0); keys.len()];
        for cluster in 0..clusters as usize {
            for (at, &row) in members.of(cluster).iter().enumerate() {
                place[row as usize] = (cluster as u32, at as u32);
            }
        }
        Self { members, place }
    }

    /// Number of clusters.
    pub(super) fn count(&self) -> usize {
        self.members.offset.len() - 1
    }

    /// Bytes of storage.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(&self.members.offset[..])
            + size_of_val(&self.members.entries[..])
            + size_of_val(&self.place[..])
    }
}

fn root(lowest: &[u32], mut node: u32) -> u32 {
    while lowest[node as usize] != node {
        node = lowest[node as usize];
    }
    node
}

/// Norms of the scaled blocks between mean displacements, and the two nodes, where they are large.
fn ties(
    rows: &TangentRows<'_>,
    node_offset: &[u32],
) -> Result<Vec<(f64, u32, u32)>, MultigridFailure> {
    let nodes = node_offset.len() - 1;
    let mut node_of_mean = vec![u32::MAX; rows.count()];
    for node in 0..nodes {
        if node_offset[node + 1] > node_offset[node] {
            node_of_mean[node_offset[node] as usize] = node as u32;
        }
    }
    let means: Vec<usize> = (0..rows.count())
        .filter(|&row| node_of_mean[row] != u32::MAX)
        .collect();
    let inverse = |row: usize| {
        let block = rows_of(&rows.diagonal(row));
        let (inverse, kept) = inverse_factor(&block, SINGULAR);
        let finite = inverse.as_flattened().iter().all(|entry| entry.is_finite());
        (finite && kept == [true; 3])
            .then_some(inverse)
            .ok_or(MultigridFailure::NotPositive(row))
    };
    let mut inverses = vec![[[0.0; 3]; 3]; rows.count()];
    let found: Result<Vec<()>, MultigridFailure> = inverses
        .par_iter_mut()
        .enumerate()
        .filter(|(row, _)| node_of_mean[*row] != u32::MAX)
        .map(|(row, target)| inverse(row).map(|found| *target = found))
        .collect();
    found?;
    let tied = |row: usize| {
        let mut found = Vec::new();
        rows.for_each(row, |column, block| {
            let column = column as usize;
            if column > row && node_of_mean[column] != u32::MAX {
                let left = product(&inverses[row], &rows_of(block));
                let scaled = product(&left, &transpose(&inverses[column]));
                let square: f64 = scaled.as_flattened().iter().map(|x| x * x).sum();
                if square > TIED * TIED {
                    found.push((square, node_of_mean[row], node_of_mean[column]));
                }
            }
        });
        found
    };
    Ok(means.into_par_iter().flat_map_iter(tied).collect())
}
