//! Sectors of a node: groups of cells that reach each other without crossing a fracture.

use std::ops::Range;

use rayon::prelude::*;

use crate::adjacency::Adjacency;
use crate::disjoint_sets::Stretch;
use crate::draft::{Elements, split};

/// Cells that one task joins.
const CELLS_PER_TASK: usize = 32_768;

/// How many sectors each node has, and which of them each cell sees at each of its nodes.
///
/// | sectors | the node is |
/// |---|---|
/// | 0 | in no cell |
/// | 1 | in intact rock, or on a fracture tip |
/// | 2 | inside a fracture |
/// | 3, 4, 8 | on a T, on an X, where three planes meet |
#[derive(Debug, Clone)]
pub struct Sectors {
    /// Number of sectors of each node.
    pub count: Vec<u32>,
    /// Sector at each cell node, in the order of the cells' flat node list. A node's sectors are
    /// numbered by the lowest cell in each.
    pub of_cell_node: Vec<u32>,
}

/// Finds the sectors. `fractured` are the cell faces that carry a fracture facet; they have no
/// neighbour any more in `adjacency`.
pub(crate) fn find(
    cells: &Elements,
    node_count: usize,
    adjacency: &Adjacency,
    fractured: impl Iterator<Item = u32>,
) -> Sectors {
    let around = Around {
        cells,
        adjacency,
        on_fracture: nodes_on_fractures(cells, node_count, adjacency, fractured),
    };
    let mut of_cell_node = vec![0; cells.nodes.len()];
    let tasks = split(&cells.offsets, CELLS_PER_TASK, &mut of_cell_node);
    let crossing: Vec<Vec<(u32, u32)>> = tasks
        .into_par_iter()
        .map(|(stretch, parent)| around.join_stretch(stretch, parent))
        .collect();
    let mut whole = Stretch::of(0, &mut of_cell_node);
    for (slot, other) in crossing.into_iter().flatten() {
        whole.join(slot, other);
    }
    let count = around.number(&mut of_cell_node);
    Sectors {
        count,
        of_cell_node,
    }
}

fn nodes_on_fractures(
    cells: &Elements,
    node_count: usize,
    adjacency: &Adjacency,
    fractured: impl Iterator<Item = u32>,
) -> Vec<bool> {
    let mut on_fracture = vec![false; node_count];
    for face in fractured {
        for slot in adjacency.slots(cells, face) {
            on_fracture[cells.nodes[slot] as usize] = true;
        }
    }
    on_fracture
}

/// The cells around the nodes on fractures. Slots of one node in cells that share a face, beyond
/// which no fracture lies, are in one sector.
struct Around<'a> {
    cells: &'a Elements,
    adjacency: &'a Adjacency,
    on_fracture: Vec<bool>,
}

impl Around<'_> {
    /// Joins the slots of successive cells and returns those pairs of which one lies before.
    fn join_stretch(&self, stretch: Range<usize>, parent: &mut [u32]) -> Vec<(u32, u32)> {
        let first = self.cells.offsets[stretch.start];
        let mut sets = Stretch::of(first, parent);
        let mut crossing = Vec::new();
        for cell in stretch {
            if !self.single_out(cell, &mut sets) {
                continue;
            }
            for face in self.adjacency.lower_neighbours(self.cells, cell) {
                for slot in self.adjacency.slots(self.cells, face) {
                    let Some(twin) = self.twin(slot, cell, face) else {
                        continue;
                    };
                    if slot as u32 >= first {
                        sets.join(slot as u32, twin);
                    } else {
                        crossing.push((slot as u32, twin));
                    }
                }
            }
        }
        crossing
    }

    /// Makes each slot of the cell a sector of its own, if its node is on a fracture; false if none
    /// is.
    fn single_out(&self, cell: usize, sets: &mut Stretch) -> bool {
        let mut any = false;
        for slot in self.cells.range(cell) {
            if self.on_fracture[self.cells.nodes[slot] as usize] {
                sets.single(slot as u32);
                any = true;
            }
        }
        any
    }

    /// Where the cell has the node of a slot of `face`, its neighbour's face, if it is on a
    /// fracture.
    fn twin(&self, slot: usize, cell: usize, face: u32) -> Option<u32> {
        let node = self.cells.nodes[slot];
        if !self.on_fracture[node as usize] {
            return None;
        }
        let is_node = |slot: &usize| self.cells.nodes[*slot] == node;
        let mut own = self.cells.range(cell).filter(is_node);
        match (own.next(), own.next()) {
            (Some(twin), None) => Some(twin),
            (None, _) => None,
            // A collapsed cell has the node more than once, maybe not on this face.
            _ => {
                let face = self.adjacency.neighbour[face as usize];
                self.adjacency.slots(self.cells, face).find(is_node)
            }
        }
        .map(|twin| twin as u32)
    }

    /// Turns slots of nodes on fractures, each with one of its sector that is not higher, into
    /// numbers of sectors, and counts these.
    fn number(&self, slots: &mut [u32]) -> Vec<u32> {
        let mut count = vec![0; self.on_fracture.len()];
        for (slot, &node) in self.cells.nodes.iter().enumerate() {
            let count = &mut count[node as usize];
            if !self.on_fracture[node as usize] {
                *count = 1;
                continue;
            }
            let above = slots[slot] as usize;
            if above == slot {
                slots[slot] = *count;
                *count += 1;
            } else {
                // What is lower has its number already.
                slots[slot] = slots[above];
            }
        }
        count
    }
}
