//! Aggregates: groups of nodes that become one node of the next level.

use rayon::prelude::*;

use crate::lists::Lists;
use crate::small::Modes;

use super::places::Places;
use super::sparse::{Sparse, rows_per_task};

/// Blocks whose norm is not above this share of the diagonal do not tie nodes together.
pub(super) const STRENGTH: f32 = 0.05;
/// Neighbours that a node has in common with the first node of an aggregate, if it lies beside it
/// like the tip of a cell on the face of another.
const FACE: usize = 3;
/// Marks a node without strong neighbours: the smoother alone takes care of it.
pub(super) const ALONE: u32 = u32::MAX;

/// Aggregates of a level.
pub(super) struct Aggregates {
    /// Aggregate of each node, or [`ALONE`].
    pub(super) of_node: Vec<u32>,
    /// Number of aggregates.
    pub(super) count: usize,
}

impl Aggregates {
    /// Nodes of each aggregate, ascending; those without one follow in a list more.
    pub(super) fn members(&self) -> Lists {
        let key = |&at: &u32| at.min(self.count as u32);
        Lists::group(self.of_node.iter().map(key), self.count + 1)
    }
}

/// Square of the Frobenius norm of a block.
#[inline(always)]
pub(super) fn square<const N: usize>(block: &[[f32; N]; N]) -> f32 {
    block.as_flattened().iter().map(|x| x * x).sum()
}

/// The neighbours of each node whose blocks have a norm beyond [`STRENGTH`] (of the unit diagonal)
/// and which are near, with the squares of these norms. The mass-like part of the stiffness ties
/// the ends of slender cells together by norms that are large, although they resist no motion.
pub(super) fn strong_neighbours<const N: usize>(
    matrix: &Sparse<N, N>,
    modes: &[Modes<N>],
) -> Sparse<1, 1> {
    let places = Places::of(modes);
    let tied = |row: usize| {
        let squares = matrix.row(row).map(|(at, block)| (at, square(block)));
        squares.filter(|(_, square)| *square > STRENGTH * STRENGTH)
    };
    let strong = |row: usize| {
        let near = places.near(row, || tied(row).map(|(at, _)| at));
        tied(row).filter(move |(at, _)| near.contains(*at))
    };
    Sparse::build(
        matrix.rows(),
        rows_per_task::<N>(),
        || (),
        |(), row| strong(row).count(),
        #[inline(always)]
        |(), row, columns, blocks| {
            let targets = columns.iter_mut().zip(blocks);
            for ((at, square), (column, block)) in strong(row).zip(targets) {
                (*column, *block) = (at as u32, [[square]]);
            }
        },
    )
}

/// How far an aggregate reaches from its first node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Reach {
    /// To its neighbours.
    Neighbours,
    /// Beyond them, to nodes that share [`FACE`] of them. A node of the finest level has three
    /// unknowns where one of the next level has six, and tetrahedra give it few neighbours: with
    /// these alone the next level would be nearly as dear as the finest one.
    Beyond,
}

/// Greedy aggregation (Vanek, Mandel, Brezina 1996): first whole neighbourhoods in the order of the
/// nodes, then each node left over joins the neighbouring one that it is tied to most, and what is
/// then left forms aggregates of its own. Neighbours are the [`strong_neighbours`].
pub(super) fn aggregate(neighbours: &Sparse<1, 1>, reach: Reach) -> Aggregates {
    let greedy = Greedy { neighbours };
    let mut aggregates = Aggregates {
        of_node: vec![ALONE; neighbours.rows()],
        count: 0,
    };
    let mut is_beside = vec![false; neighbours.rows()];
    for node in 0..neighbours.rows() {
        let is_free = |at: usize| aggregates.of_node[at] == ALONE && !is_beside[at];
        let mut strong = greedy.strong(node).peekable();
        if is_free(node) && strong.peek().is_some() && strong.all(|(at, _)| is_free(at)) {
            greedy.gather(node, &mut aggregates);
            if reach == Reach::Beyond {
                let beyond = greedy.beyond(node);
                beyond.into_iter().for_each(|at| is_beside[at] = true);
            }
        }
    }
    greedy.join(&mut aggregates);
    if reach == Reach::Beyond {
        // Those that only such nodes tie to an aggregate.
        greedy.join(&mut aggregates);
    }
    for node in 0..neighbours.rows() {
        if aggregates.of_node[node] == ALONE && greedy.strong(node).next().is_some() {
            greedy.gather(node, &mut aggregates);
        }
    }
    aggregates
}

struct Greedy<'a> {
    neighbours: &'a Sparse<1, 1>,
}

impl Greedy<'_> {
    /// Strong neighbours of a node and the squared norms of their blocks.
    fn strong(&self, node: usize) -> impl Iterator<Item = (usize, f32)> {
        let all = self.neighbours.row(node);
        all.map(|(at, square)| (at, square[0][0]))
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

    /// Nodes that share at least [`FACE`] neighbours with a node; its neighbours may be among them.
    fn beyond(&self, node: usize) -> Vec<usize> {
        let beside = self.strong(node).flat_map(|(at, _)| self.strong(at));
        let mut beside: Vec<usize> = beside.map(|(at, _)| at).collect();
        beside.sort_unstable();
        let equal = beside.chunk_by(|a, b| a == b);
        let shared = equal.filter(|same| same.len() >= FACE);
        shared.map(|same| same[0]).collect()
    }

    /// Each node without an aggregate joins the one whose nodes beside it have the largest sum of
    /// norms.
    fn join(&self, aggregates: &mut Aggregates) {
        let of_node = &aggregates.of_node;
        let joined = of_node.par_iter().enumerate().map(|(node, &own)| {
            if own != ALONE {
                return own;
            }
            let mut sums: Vec<(u32, f32)> = Vec::new();
            let near = self.strong(node).filter(|(at, _)| of_node[*at] != ALONE);
            for (at, square) in near {
                match sums.iter_mut().find(|(other, _)| *other == of_node[at]) {
                    Some((_, sum)) => *sum += square.sqrt(),
                    None => sums.push((of_node[at], square.sqrt())),
                }
            }
            // `max_by` keeps the last of equals: the order of the columns decides.
            let most = sums.iter().max_by(|a, b| a.1.total_cmp(&b.1));
            most.map_or(own, |(other, _)| *other)
        });
        aggregates.of_node = joined.collect();
    }
}
