//! Which edges are bisected.

use rayon::prelude::*;

use super::edges::{Edges, NONE};
use crate::draft::Draft;

/// Edges of the four faces of a tetrahedron, as its shape counts them.
const FACES: [[usize; 3]; 4] = [[0, 1, 2], [0, 3, 5], [1, 4, 5], [2, 3, 4]];

/// The longest edges of the cells that are too `large` (of the facets, in a mesh of the plane), and
/// those that must be bisected with them: the longest of every face and cell that has one of them.
pub(super) fn closed(draft: &Draft, edges: &Edges, large: &[usize]) -> Vec<bool> {
    let mut marked = vec![false; edges.ends.len()];
    for &cell in large {
        let own = match draft.is_plane() {
            true => &edges.of_facet[cell][..],
            false => &edges.of_cell[cell],
        };
        marked[longest(edges, own) as usize] = true;
    }
    loop {
        let cells = edges.of_cell.par_iter();
        let asked: Vec<u32> = cells
            .flat_map_iter(|own| of_cell(edges, own, &marked))
            .chain(
                (0..draft.facets.elements.len())
                    .into_par_iter()
                    .flat_map_iter(|facet| of_face(edges, &edges.of_facet[facet], &marked)),
            )
            .collect();
        if asked.is_empty() {
            return marked;
        }
        for edge in asked {
            marked[edge as usize] = true;
        }
    }
}

/// What a cell with marked edges still asks for.
fn of_cell(edges: &Edges, own: &[u32; 6], marked: &[bool]) -> impl Iterator<Item = u32> {
    let faces = FACES.map(|face| of_face(edges, &face.map(|edge| own[edge]), marked));
    faces
        .into_iter()
        .flatten()
        .chain(of_face(edges, own, marked))
}

/// The longest of these edges if another of them is marked, and it is not.
fn of_face(edges: &Edges, own: &[u32], marked: &[bool]) -> Option<u32> {
    let is_marked = |edge: u32| edge != NONE && marked[edge as usize];
    if !own.iter().any(|&edge| is_marked(edge)) {
        return None;
    }
    Some(longest(edges, own)).filter(|&edge| !is_marked(edge))
}

fn longest(edges: &Edges, own: &[u32]) -> u32 {
    let known = own.iter().copied().filter(|&edge| edge != NONE);
    known
        .max_by_key(|&edge| edges.rank[edge as usize])
        .unwrap_or(NONE)
}
