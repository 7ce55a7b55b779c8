//! Shapes of cells and facets: how many nodes, and which of them span each face.

/// The shape of a cell or a facet. Node order is gmsh's (and, for these shapes, VTK's).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Shape {
    /// Linear triangle, 3 nodes.
    Tri3,
    /// Linear tetrahedron, 4 nodes.
    Tet4,
}

/// One face of a cell: its shape and the cell's local nodes, seen from outside counter-clockwise.
#[derive(Debug, Clone, Copy)]
pub struct Face {
    /// The shape of the face.
    pub shape: Shape,
    /// Local node numbers of the cell; the right-hand normal points out of the cell.
    pub nodes: &'static [u8],
}

impl Face {
    /// Local numbers of the corner nodes alone.
    pub fn corners(&self) -> &'static [u8] {
        &self.nodes[..self.shape.corner_count()]
    }
}

const TET4_FACES: [Face; 4] = [
    Face {
        shape: Shape::Tri3,
        nodes: &[0, 2, 1],
    },
    Face {
        shape: Shape::Tri3,
        nodes: &[0, 1, 3],
    },
    Face {
        shape: Shape::Tri3,
        nodes: &[0, 3, 2],
    },
    Face {
        shape: Shape::Tri3,
        nodes: &[1, 2, 3],
    },
];

impl Shape {
    /// Space dimension of the shape: 3 for cells, 2 for facets.
    pub fn dimension(self) -> usize {
        match self {
            Shape::Tri3 => 2,
            Shape::Tet4 => 3,
        }
    }

    /// Number of nodes.
    pub fn node_count(self) -> usize {
        match self {
            Shape::Tri3 => 3,
            Shape::Tet4 => 4,
        }
    }

    /// Number of corner nodes; corners come first in the node order.
    pub fn corner_count(self) -> usize {
        match self {
            Shape::Tri3 => 3,
            Shape::Tet4 => 4,
        }
    }

    /// The faces of a cell; empty for a facet.
    pub fn faces(self) -> &'static [Face] {
        match self {
            Shape::Tri3 => &[],
            Shape::Tet4 => &TET4_FACES,
        }
    }
}
