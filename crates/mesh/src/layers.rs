//! Meshes of the plane: one cell thick, where the nodes of one layer stand for all.
//!
//! What lies in the plane has one displacement through the thickness, so the copies of a node move
//! with it: cells and facets keep their nodes, and with them their volumes and areas, but unknowns
//! are those of the layer below.

use glam::DVec3;

use crate::draft::Elements;
use crate::shape::Shape;

/// Through a cell of a plane mesh: a shape of the plane, and which of its nodes each node of the
/// cell stands above.
#[derive(Debug, Clone)]
pub struct Flat {
    /// The shape in the plane.
    pub shape: Shape,
    /// For each node of the cell the node of the flat shape.
    pub node: Vec<u8>,
    /// For each node of the cell its height, -1, 0 or 1.
    pub height: Vec<i8>,
}

impl Shape {
    /// The prism or hexahedron over a flat shape, or the quadrangle over a line. Where a mesh has
    /// quadrangles without middles, so have the faces between its cells.
    pub fn extruded(self, without_middles: bool) -> Option<Self> {
        Some(match self {
            Self::Line2 => Self::Quad4,
            Self::Line3 if without_middles => Self::Quad8,
            Self::Line3 => Self::Quad9,
            Self::Tri3 => Self::Prism6,
            Self::Tri6 if without_middles => Self::Prism15,
            Self::Tri6 => Self::Prism18,
            Self::Quad4 => Self::Hex8,
            Self::Quad8 => Self::Hex20,
            Self::Quad9 => Self::Hex27,
            _ => return None,
        })
    }

    /// What it is an extrusion of: a cell along its third, a facet along its second reference axis.
    pub fn flat(self) -> Option<Flat> {
        let shape = match self {
            Self::Quad4 => Self::Line2,
            Self::Quad8 | Self::Quad9 => Self::Line3,
            Self::Prism6 => Self::Tri3,
            Self::Prism15 | Self::Prism18 => Self::Tri6,
            Self::Hex8 => Self::Quad4,
            Self::Hex20 => Self::Quad8,
            Self::Hex27 => Self::Quad9,
            _ => return None,
        };
        let axis = shape.dimension();
        let in_plane = shape.reference_nodes();
        let own = self.reference_nodes();
        let below = |at: &DVec3| {
            let is_below = |flat: &DVec3| (0..axis).all(|i| flat[i] == at[i]);
            in_plane.iter().position(is_below)
        };
        let node: Option<Vec<u8>> = own.iter().map(|at| below(at).map(|n| n as u8)).collect();
        Some(Flat {
            shape,
            node: node?,
            height: own.iter().map(|at| at[axis] as i8).collect(),
        })
    }
}

/// The node that each node of a plane mesh moves with, itself in the layer below.
pub(crate) fn originals(
    cells: &Elements,
    node_count: usize,
    is_below: impl Fn(u32, u32) -> bool,
) -> Vec<u32> {
    let mut original: Vec<u32> = (0..node_count as u32).collect();
    for_each_slot(cells, is_below, |slot, below| {
        original[cells.nodes[slot] as usize] = cells.nodes[below];
    });
    original
}

/// Calls `act` with each slot of the cells, and the slot of the same cell below it.
pub(crate) fn for_each_slot(
    cells: &Elements,
    is_below: impl Fn(u32, u32) -> bool,
    mut act: impl FnMut(usize, usize),
) {
    for cell in 0..cells.len() {
        let Some(Flat { node, height, .. }) = cells.shapes[cell].flat() else {
            continue;
        };
        let own = cells.nodes_of(cell);
        let local = |wanted: u8, at: i8| {
            let mut pairs = node.iter().zip(&height);
            pairs.position(|(&flat, &height)| flat == wanted && height == at)
        };
        let (Some(low), Some(high)) = (local(0, -1), local(0, 1)) else {
            continue;
        };
        let bottom = match is_below(own[low], own[high]) {
            true => -1,
            false => 1,
        };
        let first = cells.range(cell).start;
        for (place, &flat) in node.iter().enumerate() {
            if let Some(below) = local(flat, bottom) {
                act(first + place, first + below);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_extrusion_knows_what_it_stands_on() {
        let flat = [
            Shape::Line2,
            Shape::Line3,
            Shape::Tri3,
            Shape::Tri6,
            Shape::Quad4,
            Shape::Quad9,
        ];
        for shape in flat {
            let extruded = shape.extruded(false).expect("an extrusion");
            let found = extruded.flat().expect("a flat shape");
            assert_eq!(found.shape, shape);
            let layers = extruded.node_count() / shape.node_count();
            for node in 0..shape.node_count() as u8 {
                assert_eq!(found.node.iter().filter(|&&n| n == node).count(), layers);
            }
        }
        for (shape, nodes) in [(Shape::Quad8, 20), (Shape::Tri6, 15), (Shape::Line3, 8)] {
            let extruded = shape.extruded(true).expect("an extrusion");
            assert_eq!(extruded.node_count(), nodes);
            assert_eq!(extruded.flat().expect("flat").shape, shape);
        }
        assert!(Shape::Tet4.flat().is_none() && Shape::Tet4.extruded(false).is_none());
    }
}
