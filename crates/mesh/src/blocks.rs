//! Blocks: parts of the body that hang together without crossing a fracture.

use crate::adjacency::{Adjacency, NONE};
use crate::disjoint_sets::DisjointSets;

/// The block of each cell, numbered by the lowest cell in each, and how many there are.
pub(crate) fn find(
    cell_count: usize,
    adjacency: &Adjacency,
    is_fractured: &[bool],
) -> (Vec<u32>, usize) {
    let mut sets = DisjointSets::new(cell_count);
    for (face, &other) in adjacency.neighbour.iter().enumerate() {
        if other != NONE && !is_fractured[face] {
            let cells = &adjacency.cell_of_face;
            sets.join(cells[face], cells[other as usize]);
        }
    }
    let mut block = vec![0; cell_count];
    let mut count = 0;
    for cell in 0..cell_count as u32 {
        let root = sets.root(cell);
        if root == cell {
            block[cell as usize] = count;
            count += 1;
        } else {
            block[cell as usize] = block[root as usize];
        }
    }
    (block, count as usize)
}
