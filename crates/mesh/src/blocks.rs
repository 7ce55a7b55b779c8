//! Blocks: parts of the body that hang together without crossing a fracture.

use crate::adjacency::{Adjacency, NONE};
use crate::draft::Elements;

/// The block of each cell, numbered by the lowest cell in each, and how many there are. Faces on
/// fractures have no neighbour any more in `adjacency`.
pub(crate) fn find(cells: &Elements, adjacency: &Adjacency) -> (Vec<u32>, usize) {
    let mut block = vec![0; cells.len()];
    let mut count = 0;
    // One bit a cell stays in the cache where the numbers would not.
    let mut reached = Bits::new(cells.len());
    let mut queue: Vec<u32> = Vec::with_capacity(cells.len());
    for seed in 0..cells.len() as u32 {
        if !reached.insert(seed) {
            continue;
        }
        let mut next = queue.len();
        queue.push(seed);
        while next < queue.len() {
            let cell = queue[next] as usize;
            next += 1;
            block[cell] = count;
            let faces = adjacency.faces_of(cells, cell);
            for &other in &adjacency.neighbour[faces.start as usize..faces.end as usize] {
                if other != NONE && reached.insert(adjacency.cell_of(other)) {
                    queue.push(adjacency.cell_of(other));
                }
            }
        }
        count += 1;
    }
    (block, count as usize)
}

/// A set of small numbers.
struct Bits {
    words: Vec<u64>,
}

impl Bits {
    fn new(count: usize) -> Self {
        Self {
            words: vec![0; count.div_ceil(64)],
        }
    }

    /// Adds a number; false if it is there already.
    fn insert(&mut self, number: u32) -> bool {
        let word = &mut self.words[number as usize / 64];
        let bit = 1 << (number % 64);
        let is_new = *word & bit == 0;
        *word |= bit;
        is_new
    }
}
