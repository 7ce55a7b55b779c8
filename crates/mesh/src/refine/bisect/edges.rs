//! The edges of all cells, and their order.

use glam::DVec3;
use rayon::prelude::*;

use crate::draft::{Draft, Elements};
use crate::shape::Shape;

/// Marks an edge that no cell has.
pub(super) const NONE: u32 = u32::MAX;

/// Edges of the cells of a draft, each once.
pub(super) struct Edges {
    /// Ends of each, the lower node first; ascending.
    pub(super) ends: Vec<[u32; 2]>,
    /// Place of each in the order of lengths; of edges as long as each other the nodes decide.
    pub(super) rank: Vec<u32>,
    /// Edges of each cell, as its shape counts them.
    pub(super) of_cell: Vec<[u32; 6]>,
    /// Edges of each facet, as its shape counts them; [`NONE`] where no cell has them.
    pub(super) of_facet: Vec<[u32; 3]>,
    /// The edge of each line, in a mesh of the plane; [`NONE`] where no facet has it.
    pub(super) of_line: Vec<[u32; 1]>,
}

impl Edges {
    pub(super) fn of(draft: &Draft) -> Self {
        let (cells, facets) = (&draft.cells.elements, &draft.facets.elements);
        let mut ends: Vec<[u32; 2]> = match draft.is_plane() {
            true => all_pairs::<3>(facets),
            false => all_pairs::<6>(cells),
        };
        ends.par_sort_unstable();
        ends.dedup();
        let find = |pair: [u32; 2]| ends.binary_search(&pair).map_or(NONE, |at| at as u32);
        let numbers = 0..cells.len();
        let of_cell = numbers
            .into_par_iter()
            .map(|cell| pairs(cells, cell).map(find));
        let lines = &draft.lines.elements;
        let is_triangle = |facet: usize| facets.shapes[facet].corner_count() == 3;
        let of_facet = (0..facets.len()).map(|facet| match is_triangle(facet) {
            true => pairs(facets, facet).map(find),
            false => [NONE; 3],
        });
        Self {
            rank: ranks(draft, &ends),
            of_cell: of_cell.collect(),
            of_facet: of_facet.collect(),
            of_line: (0..lines.len())
                .map(|line| pairs(lines, line).map(find))
                .collect(),
            ends,
        }
    }
}

/// Ends of the edges of all elements.
fn all_pairs<const COUNT: usize>(elements: &Elements) -> Vec<[u32; 2]> {
    let all = (0..elements.len()).into_par_iter();
    all.flat_map_iter(|element| pairs::<COUNT>(elements, element))
        .collect()
}

/// Ends of the edges of an element, the lower node first.
fn pairs<const COUNT: usize>(elements: &Elements, element: usize) -> [[u32; 2]; COUNT] {
    let (shape, nodes): (Shape, _) = (elements.shapes[element], elements.nodes_of(element));
    let edges = shape.edges();
    std::array::from_fn(|edge| {
        let [a, b] = edges[edge].map(|end| nodes[end as usize]);
        [a.min(b), a.max(b)]
    })
}

fn ranks(draft: &Draft, ends: &[[u32; 2]]) -> Vec<u32> {
    let node = |node: u32| DVec3::from(draft.nodes[node as usize]);
    let length = |[a, b]: &[u32; 2]| node(*a).distance_squared(node(*b));
    let lengths: Vec<f64> = ends.par_iter().map(length).collect();
    let mut order: Vec<u32> = (0..ends.len() as u32).collect();
    order.par_sort_unstable_by(|&a, &b| {
        let by_length = lengths[a as usize].total_cmp(&lengths[b as usize]);
        by_length.then(a.cmp(&b))
    });
    let mut rank = vec![0; order.len()];
    for (place, &edge) in order.iter().enumerate() {
        rank[edge as usize] = place as u32;
    }
    rank
}
