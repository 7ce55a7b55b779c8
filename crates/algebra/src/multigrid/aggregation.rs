//! Aggregates: groups of nodes that become one node of the next level.

use crate::lists::Lists;
use crate::small::Modes;

use super::places::Places;
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

/// Greedy aggregation (Vanek, Mandel, Brezina 1996): first whole neighbourhoods in the order of the
/// nodes, then each node left over joins the strongest neighbouring one, and what is then left
/// forms aggregates of its own. Neighbours are the [`strong_neighbours`].
pub(super) fn aggregate(neighbours: &Sparse<1, 1>) -> Aggregates {
    let greedy = Greedy { neighbours };
    let mut aggregates = Aggregates {
        of_node: vec![ALONE; neighbours.rows()],
        count: 0,
    };
    for node in 0..neighbours.rows() {
        let is_free = |other: usize| aggregates.of_node[other] == ALONE;
        let mut strong = greedy.strong(node).peekable();
        if is_free(node) && strong.peek().is_some() && strong.all(|(at, _)| is_free(at)) {
            greedy.gather(node, &mut aggregates);
        }
    }
    let seeds = aggregates.of_node.clone();
    for node in (0..neighbours.rows()).filter(|&node| seeds[node] == ALONE) {
        let near = greedy.strong(node).filter(|(at, _)| seeds[*at] != ALONE);
        // `max_by` keeps the last of equals: the order of the columns decides.
        if let Some((at, _)) = near.max_by(|a, b| a.1.total_cmp(&b.1)) {
            aggregates.of_node[node] = seeds[at];
        }
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
}
