//! Which nodes of a level continuous material joins, where an interface divides some of it.

use rayon::prelude::*;

use super::aggregation::{ALONE, Aggregates};
use super::sparse::Sparse;
use crate::lists::Lists;

/// Nodes that nothing but the interface joins have walls of it between them. It is known of the
/// nodes beside the interface; of others nothing is told, and they have no walls.
#[derive(Debug, Clone, Default)]
pub struct Continuity {
    /// For a node beside the interface those that continuous material joins to it, itself included,
    /// ascending; for others none.
    joined: Lists,
}

impl Continuity {
    /// With a list for each node: of a node beside the interface those that continuous material
    /// joins to it, itself included, ascending; empty for others.
    pub fn new(joined: &[Vec<u32>]) -> Self {
        Self {
            joined: Lists::collect(joined),
        }
    }

    fn joined(&self, node: usize) -> &[u32] {
        match self.joined.offset.len() {
            0 => &[],
            _ => self.joined.of(node),
        }
    }

    /// Whether one of some nodes is beside the interface.
    pub(super) fn divides_any_of(&self, nodes: &[u32]) -> bool {
        let mut nodes = nodes.iter();
        nodes.any(|&node| !self.joined(node as usize).is_empty())
    }

    /// Whether walls of the interface lie between two nodes.
    pub(super) fn is_broken(&self, a: usize, b: usize) -> bool {
        let [of_a, of_b] = [a, b].map(|node| self.joined(node));
        let holds = |list: &[u32], node: usize| list.binary_search(&(node as u32)).is_ok();
        let is_told = !of_a.is_empty() || !of_b.is_empty();
        is_told && !(holds(of_a, b) || holds(of_b, a))
    }

    /// That of aggregates of the nodes of a matrix: what joins nodes joins their aggregates.
    pub(super) fn of_aggregates(&self, aggregates: &Aggregates, matrix: &Sparse<6, 6>) -> Self {
        if self.joined.entries.is_empty() {
            return Self::default();
        }
        let members = aggregates.members();
        let joined = (0..aggregates.count).into_par_iter().map(|aggregate| {
            let nodes = members.of(aggregate);
            if !self.divides_any_of(nodes) {
                return Vec::new();
            }
            let nodes = nodes.iter().map(|&node| node as usize);
            let beside = nodes.flat_map(|node| {
                let neighbours = matrix.row(node).map(|(at, _)| at);
                neighbours.filter(move |&at| !self.is_broken(node, at))
            });
            let mut joined: Vec<u32> = beside.map(|at| aggregates.of_node[at]).collect();
            joined.push(aggregate as u32);
            joined.retain(|&other| other != ALONE);
            joined.sort_unstable();
            joined.dedup();
            joined
        });
        Self::new(&joined.collect::<Vec<_>>())
    }

    /// Bytes of storage.
    pub(super) fn bytes(&self) -> usize {
        self.joined.bytes()
    }
}
