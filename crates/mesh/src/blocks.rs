//! Blocks: parts of the body that hang together without crossing a fracture.

use rayon::prelude::*;

use crate::adjacency::Adjacency;
use crate::disjoint_sets::Stretch;
use crate::draft::Elements;

/// Cells that one task joins.
const CELLS_PER_TASK: usize = 32_768;

/// The block of each cell, numbered by the lowest cell in each, and how many there are. Faces on
/// fractures have no neighbour any more in `adjacency`.
pub(crate) fn find(cells: &Elements, adjacency: &Adjacency) -> (Vec<u32>, usize) {
    let mut block = vec![0; cells.len()];
    let tasks = block.par_chunks_mut(CELLS_PER_TASK).enumerate();
    let crossing: Vec<Vec<(u32, u32)>> = tasks
        .map(|(task, parent)| join_stretch(cells, adjacency, task * CELLS_PER_TASK, parent))
        .collect();
    let mut whole = Stretch::of(0, &mut block);
    for (cell, other) in crossing.into_iter().flatten() {
        whole.join(cell, other);
    }
    let count = number(&mut block);
    (block, count)
}

/// Joins neighbours from cell `first` on and returns those of which one lies before.
fn join_stretch(
    cells: &Elements,
    adjacency: &Adjacency,
    first: usize,
    parent: &mut [u32],
) -> Vec<(u32, u32)> {
    let end = first + parent.len();
    let mut stretch = Stretch::of(first as u32, parent);
    let mut crossing = Vec::new();
    for cell in first..end {
        stretch.single(cell as u32);
        for other in adjacency.lower_neighbours(cells, cell) {
            let pair = (adjacency.cell_of(other), cell as u32);
            if pair.0 as usize >= first {
                stretch.join(pair.0, pair.1);
            } else {
                crossing.push(pair);
            }
        }
    }
    crossing
}

/// Turns members of sets, each with one of its set that is not higher, into numbers of sets.
fn number(sets: &mut [u32]) -> usize {
    let mut count = 0;
    for member in 0..sets.len() {
        let above = sets[member] as usize;
        if above == member {
            sets[member] = count;
            count += 1;
        } else {
            // What is lower has its number already.
            sets[member] = sets[above];
        }
    }
    count as usize
}
