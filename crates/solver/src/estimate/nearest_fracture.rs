//! Which fracture each cell is nearest to, counted in cells.

use kluft_algebra::Lists;
use kluft_mesh::Mesh;

use crate::space::pattern::CellOfSlot;

/// No fracture.
const NONE: u32 = u32::MAX;

/// The fracture that the fewest cells lie between it and each cell, the first of several; beyond
/// all numbers where there is none.
pub(super) fn nearest_fracture(
    mesh: &Mesh,
    (slots, cell_of_slot): (&Lists, &CellOfSlot),
) -> Vec<u32> {
    let facets = &mesh.facets;
    let mut of_node = vec![NONE; mesh.nodes.len()];
    for facet in 0..facets.elements.len() {
        for &node in facets.elements.nodes_of(facet) {
            let own = &mut of_node[node as usize];
            *own = (*own).min(facets.fracture[facet]);
        }
    }
    let mut of_cell = vec![NONE; mesh.cells.len()];
    let mut front: Vec<u32> = (0..mesh.nodes.len() as u32)
        .filter(|&node| of_node[node as usize] != NONE)
        .collect();
    while !front.is_empty() {
        let mut reached = Vec::new();
        for &node in &front {
            for &slot in slots.of(node as usize) {
                let (cell, _) = cell_of_slot.locate(slot, &mesh.cells);
                if of_cell[cell] == NONE {
                    of_cell[cell] = of_node[node as usize];
                    reached.push(cell);
                }
            }
        }
        front.clear();
        for cell in reached {
            for &node in mesh.cells.nodes_of(cell) {
                if of_node[node as usize] == NONE {
                    of_node[node as usize] = of_cell[cell];
                    front.push(node);
                }
            }
        }
    }
    of_cell
}
