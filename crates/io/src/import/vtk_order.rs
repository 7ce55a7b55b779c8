//! Node orders that VTK and Abaqus share.

use kluft_mesh::Shape;

use crate::vtu::vtk_cell;

/// The nodes of an element in our order, from those in the order of VTK.
pub(super) fn from_vtk(shape: Shape, nodes: &[u32]) -> Vec<u32> {
    let (_, order) = vtk_cell(shape);
    let mut own = nodes.to_vec();
    for (place, &node) in order.iter().enumerate() {
        own[node as usize] = nodes[place];
    }
    own
}
