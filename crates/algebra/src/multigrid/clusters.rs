//! Clusters: unknowns whose mutual stiffness the smoother inverts exactly.
//!
//! The unknowns of one node form a cluster, and so do nodes much nearer to each other than to
//! others, as across a sliver. Such nodes move together at almost no cost, which a smoother that
//! looks at one node after the other cannot see, and which is too local for the next level.

use rayon::prelude::*;

use super::aggregation::square;
use super::sparse::Sparse;
use crate::division::Communicator;
use crate::lists::Lists;

/// Nodes tied by a block of this norm belong together; the blocks of both are scaled to the
/// identity.
const TIED: f32 = 0.8;
/// Most nodes of a cluster.
const MOST_NODES: usize = 6;

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

    /// Clusters of a matrix whose nodes have the rows `node_offset[node]..node_offset[node + 1]`;
    /// the first of them is the mean motion. `means` is the scaled matrix of those, with one row
    /// for each of `nodes`, which ranks may share.
    pub(super) fn of(
        (means, communicator): (&Sparse<3, 3>, &Communicator),
        nodes: &[u32],
        node_offset: &[u32],
    ) -> Self {
        let own: Vec<[u32; 3]> = ties(means, nodes)
            .into_iter()
            .map(|(square, a, b)| [square.to_bits(), a, b])
            .collect();
        let ties = communicator.gathered(&own).into_iter();
        let ties = ties.map(|[square, a, b]| (f32::from_bits(square), a, b));
        let mut ties: Vec<(f32, u32, u32)> = ties.collect();
        ties.sort_by(|a, b| b.0.total_cmp(&a.0).then((a.1, a.2).cmp(&(b.1, b.2))));
        let mut groups = ClusterGroups::single(node_offset.len() - 1);
        for (_, a, b) in ties {
            groups.join(a, b);
        }
        Self::collect(&groups, node_offset)
    }

    fn collect(groups: &ClusterGroups, node_offset: &[u32]) -> Self {
        let nodes = node_offset.len() - 1;
        let owns = |node: usize| node_offset[node + 1] > node_offset[node];
        let mut number = vec![u32::MAX; nodes];
        let mut clusters = 0;
        let mut keys = Vec::with_capacity(node_offset[nodes] as usize);
        for node in (0..nodes).filter(|&node| owns(node)) {
            let lowest = groups.lowest[node] as usize;
            if number[lowest] == u32::MAX {
                number[lowest] = clusters;
                clusters += 1;
            }
            let own = node_offset[node]..node_offset[node + 1];
            keys.extend(own.map(|_| number[lowest]));
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
        self.members.count()
    }

    /// Bytes of storage.
    pub(super) fn bytes(&self) -> usize {
        self.members.bytes() + size_of_val(&self.place[..])
    }
}

/// ClusterGroups of few nodes.
struct ClusterGroups {
    /// Lowest node of the group of each node.
    lowest: Vec<u32>,
    /// The next node of its group, in a ring.
    next: Vec<u32>,
}

impl ClusterGroups {
    /// ClusterGroups of one node each.
    fn single(nodes: usize) -> Self {
        let own: Vec<u32> = (0..nodes as u32).collect();
        Self {
            lowest: own.clone(),
            next: own,
        }
    }

    fn members(&self, node: u32) -> impl Iterator<Item = u32> {
        let next = move |at: &u32| Some(self.next[*at as usize]).filter(|&next| next != node);
        std::iter::successors(Some(node), next)
    }

    /// Makes one group of those of two nodes, unless it would be too large.
    fn join(&mut self, a: u32, b: u32) {
        let of = |node: u32| self.lowest[node as usize];
        let (low, high) = (of(a).min(of(b)), of(a).max(of(b)));
        let joining: Vec<u32> = self.members(high).collect();
        if low == high || self.members(low).count() + joining.len() > MOST_NODES {
            return;
        }
        for node in joining {
            self.lowest[node as usize] = low;
        }
        self.next.swap(low as usize, high as usize);
    }
}

/// Norms of the blocks between mean motions, and their nodes, where they are large. `means` is
/// their scaled matrix, with one row for each of `nodes`.
fn ties(means: &Sparse<3, 3>, nodes: &[u32]) -> Vec<(f32, u32, u32)> {
    let tied = |row: usize| {
        let blocks = means.row(row).filter(move |(column, _)| *column > row);
        blocks.filter_map(move |(column, block)| {
            let square = square(block);
            (square > TIED * TIED).then_some((square, nodes[row], nodes[column]))
        })
    };
    let rows = (0..means.rows()).into_par_iter();
    rows.flat_map_iter(tied).collect()
}
