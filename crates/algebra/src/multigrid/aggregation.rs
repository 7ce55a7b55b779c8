//! Aggregates: groups of nodes that become one node of the next level.

use rayon::prelude::*;

use super::sparse::{Sparse, rows_per_task};

/// Blocks whose norm is not above this share of the diagonal do not tie nodes together.
pub(super) const STRENGTH: f32 = 0.05;
/// Marks a node without strong neighbours: the smoother alone takes care of it.
pub(super) const ALONE: u32 = u32::MAX;

/// Aggregates of a level.
pub(super) struct Aggregates {
    /// Aggregate of each node, or [`ALONE`].
    pub(super) of_node: Vec<u32>,
    /// Number of aggregates.
    pub(super) count: usize,
}

/// Square of the Frobenius norm of a block.
#[inline(always)]
pub(super) fn square<const N: usize>(block: &[[f32; N]; N]) -> f32 {
    block.as_flattened().iter().map(|x| x * x).sum()
}

/// Squared Frobenius norm of each block.
fn norms<const N: usize>(matrix: &Sparse<N, N>) -> Vec<f32> {
    let blocks = matrix.blocks.par_iter().with_min_len(rows_per_task::<N>());
    blocks.map(square).collect()
}

/// Greedy aggregation (Vanek, Mandel, Brezina 1996): first whole neighbourhoods in the order of the
/// nodes, then each node left over joins the strongest neighbouring one, and what is then left
/// forms aggregates of its own. Neighbours count where the norm of their block exceeds [`STRENGTH`]
/// (of the unit diagonal).
pub(super) fn aggregate<const N: usize>(matrix: &Sparse<N, N>) -> Aggregates {
    let greedy = Greedy {
        matrix,
        norms: norms(matrix),
        least: STRENGTH * STRENGTH,
    };
    let mut aggregates = Aggregates {
        of_node: vec![ALONE; matrix.rows()],
        count: 0,
    };
    for node in 0..matrix.rows() {
        let is_free = |other: usize| aggregates.of_node[other] == ALONE;
        let mut neighbours = greedy.strong(node).peekable();
        if is_free(node) && neighbours.peek().is_some() && neighbours.all(|(at, _)| is_free(at)) {
            greedy.gather(node, &mut aggregates);
        }
    }
    let seeds = aggregates.of_node.clone();
    for node in (0..matrix.rows()).filter(|&node| seeds[node] == ALONE) {
        let near = greedy.strong(node).filter(|(at, _)| seeds[*at] != ALONE);
        // `max_by` keeps the last of equals: the order of the columns decides.
        if let Some((at, _)) = near.max_by(|a, b| a.1.total_cmp(&b.1)) {
            aggregates.of_node[node] = seeds[at];
        }
    }
    for node in 0..matrix.rows() {
        if aggregates.of_node[node] == ALONE && greedy.strong(node).next().is_some() {
            greedy.gather(node, &mut aggregates);
        }
    }
    aggregates
}

struct Greedy<'a, const N: usize> {
    matrix: &'a Sparse<N, N>,
    norms: Vec<f32>,
    least: f32,
}

impl<const N: usize> Greedy<'_, N> {
    /// Strong neighbours of a node and the squared norms of their blocks.
    fn strong(&self, node: usize) -> impl Iterator<Item = (usize, f32)> {
        let range = self.matrix.range(node);
        let columns = self.matrix.columns[range.clone()].iter();
        let all = columns
            .map(|&at| at as usize)
            .zip(self.norms[range].iter().copied());
        all.filter(|(_, norm)| *norm > self.least)
    }

    /// Makes an aggregate of a node and its free neighbours.
    fn gather(&self, node: usize, aggregates: &mut Aggregates) {
        let own = aggregates.count as u32;
        aggregates.count += 1;
        aggregates.of_node[node] = own;
        for (other, _) in self.strong(node) {
            if aggregates.of_node[other] == ALONE {
                aggregates.of_node[other] = own;
            }
        }
    }
}
