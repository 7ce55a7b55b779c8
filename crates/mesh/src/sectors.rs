//! Sectors of a node: groups of cells that reach each other without crossing a fracture.

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

/// Finds the sectors. `is_fractured[face]` tells which cell faces carry a fracture facet.
pub(crate) fn find(
    cells: &Elements,
    node_count: usize,
    adjacency: &Adjacency,
    is_fractured: &[bool],
) -> Sectors {
    let on_fracture = nodes_on_fractures(cells, node_count, adjacency, is_fractured);
    let mut sets = DisjointSets::new(cells.nodes.len());
    for (face, &other) in adjacency.neighbour.iter().enumerate() {
        let joins = other != NONE && (face as u32) < other && !is_fractured[face];
        if joins {
            join_across(
                cells,
                adjacency,
                face as u32,
                other,
                &on_fracture,
                &mut sets,
            );
        }
    }
    number(cells, &on_fracture, &mut sets)
}

fn nodes_on_fractures(
    cells: &Elements,
    node_count: usize,
    adjacency: &Adjacency,
    is_fractured: &[bool],
) -> Vec<bool> {
    let mut on_fracture = vec![false; node_count];
    let fractured = (0..is_fractured.len()).filter(|&face| is_fractured[face]);
    for face in fractured {
        for slot in adjacency.slots(cells, face as u32) {
            on_fracture[cells.nodes[slot] as usize] = true;
        }
    }
    on_fracture
}

fn join_across(
    cells: &Elements,
    adjacency: &Adjacency,
    face: u32,
    other: u32,
    on_fracture: &[bool],
    sets: &mut DisjointSets,
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

fn number(cells: &Elements, on_fracture: &[bool], sets: &mut DisjointSets) -> Sectors {
    let mut count = vec![0_u32; on_fracture.len()];
    let mut of_cell_node = vec![0_u32; cells.nodes.len()];
    for slot in 0..cells.nodes.len() {
        let node = cells.nodes[slot] as usize;
        if !on_fracture[node] {
            count[node] = 1;
            continue;
        }
        let root = sets.root(slot as u32) as usize;
        if root == slot {
            of_cell_node[slot] = count[node];
            count[node] += 1;
        } else {
            of_cell_node[slot] = of_cell_node[root];
        }
    }
    Sectors {
        count,
        of_cell_node,
    }
}
