//! Sectors of a node: groups of cells that reach each other without crossing a fracture.

use rayon::prelude::*;

use crate::adjacency::{Adjacency, NONE};
use crate::disjoint_sets::DisjointSets;
use crate::draft::Elements;

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
    fractured: &[(u32, u32)],
) -> Sectors {
    let on_fracture = nodes_on_fractures(cells, node_count, adjacency, fractured);
    let sets = DisjointSets::new(cells.nodes.len());
    (0..cells.len()).into_par_iter().for_each(|cell| {
        let nodes = cells.nodes_of(cell);
        if !nodes.iter().any(|&node| on_fracture[node as usize]) {
            return;
        }
        for face in adjacency.faces_of(cells, cell) {
            let other = adjacency.neighbour[face as usize];
            if other != NONE && face < other {
                join_across(cells, adjacency, (face, other), &on_fracture, &sets);
            }
        }
    });
    number(cells, &on_fracture, sets.into_roots())
}

fn nodes_on_fractures(
    cells: &Elements,
    node_count: usize,
    adjacency: &Adjacency,
    fractured: &[(u32, u32)],
) -> Vec<bool> {
    let mut on_fracture = vec![false; node_count];
    for face in fractured.iter().flat_map(|&(minus, plus)| [minus, plus]) {
        for slot in adjacency.slots(cells, face) {
            on_fracture[cells.nodes[slot] as usize] = true;
        }
    }
    on_fracture
}

fn join_across(
    cells: &Elements,
    adjacency: &Adjacency,
    (face, other): (u32, u32),
    on_fracture: &[bool],
    sets: &DisjointSets,
) {
    for slot in adjacency.slots(cells, face) {
        let node = cells.nodes[slot];
        if on_fracture[node as usize] {
            let twin = adjacency
                .slots(cells, other)
                .find(|&slot| cells.nodes[slot] == node);
            if let Some(twin) = twin {
                sets.join(slot as u32, twin as u32);
            }
        }
    }
}

/// Numbers the sectors of each node. `roots` has the lowest slot of each sector at every slot, and
/// becomes the sectors in place: the lowest slot comes first and has its number already.
fn number(cells: &Elements, on_fracture: &[bool], mut roots: Vec<u32>) -> Sectors {
    let mut count = vec![0_u32; on_fracture.len()];
    for (slot, &node) in cells.nodes.iter().enumerate() {
        let node = node as usize;
        let root = roots[slot] as usize;
        if !on_fracture[node] {
            count[node] = 1;
            roots[slot] = 0;
        } else if root == slot {
            roots[slot] = count[node];
            count[node] += 1;
        } else {
            roots[slot] = roots[root];
        }
    }
    Sectors {
        count,
        of_cell_node: roots,
    }
}
