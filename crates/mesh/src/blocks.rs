//! Blocks: parts of the body that hang together without crossing a fracture.

use rayon::prelude::*;

use crate::adjacency::{Adjacency, NONE};
use crate::disjoint_sets::DisjointSets;
use crate::draft::Elements;

/// The block of each cell, numbered by the lowest cell in each, and how many there are. Faces on
/// fractures have no neighbour any more in `adjacency`.
pub(crate) fn find(cells: &Elements, adjacency: &Adjacency) -> (Vec<u32>, usize) {
    let sets = DisjointSets::new(cells.len());
    (0..cells.len()).into_par_iter().for_each(|cell| {
        for face in adjacency.faces_of(cells, cell) {
            let other = adjacency.neighbour[face as usize];
            if other != NONE && face < other {
                sets.join(cell as u32, adjacency.cell_of(other));
            }
        }
    });
    let mut block = sets.into_roots();
    let mut count = 0;
    for cell in 0..block.len() {
        // The lowest cell comes first and has its number already when the others ask for it.
        let root = block[cell] as usize;
        if root == cell {
            block[cell] = count;
            count += 1;
        } else {
            block[cell] = block[root];
        }
    }
    (block, count as usize)
}
