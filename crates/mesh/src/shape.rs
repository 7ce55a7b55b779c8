//! Shapes of cells and facets: how many nodes, where they lie, and which of them span each face.

use glam::DVec3;

/// The shape of a cell or a facet, named after its family and number of nodes. Node order is
/// gmsh's: corners first, then the middles of edges, of faces, of the cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Shape {
    /// Linear triangle.
    Tri3,
    /// Quadratic triangle.
    Tri6,
    /// Bilinear quadrangle.
    Quad4,
    /// Quadratic quadrangle without a middle.
    Quad8,
    /// Quadratic quadrangle.
    Quad9,
    /// Linear tetrahedron.
    Tet4,
    /// Quadratic tetrahedron.
    Tet10,
    /// Trilinear hexahedron.
    Hex8,
    /// Quadratic hexahedron without middles of faces.
    Hex20,
    /// Quadratic hexahedron.
    Hex27,
    /// Linear prism.
    Prism6,
    /// Quadratic prism without middles of faces.
    Prism15,
    /// Quadratic prism.
    Prism18,
    /// Linear pyramid.
    Pyramid5,
    /// Quadratic pyramid without the middle of its base.
    Pyramid13,
    /// Quadratic pyramid.
    Pyramid14,
    /// Linear line, in meshes of the plane.
    Line2,
    /// Quadratic line.
    Line3,
}

use Shape::{
    Hex8, Hex20, Hex27, Line2, Line3, Prism6, Prism15, Prism18, Pyramid5, Pyramid13, Pyramid14,
    Quad4, Quad8, Quad9, Tet4, Tet10, Tri3, Tri6,
};

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

impl Shape {
    /// All shapes of cells.
    pub const CELLS: [Shape; 11] = [
        Tet4, Tet10, Hex8, Hex20, Hex27, Prism6, Prism15, Prism18, Pyramid5, Pyramid13, Pyramid14,
    ];
    /// All shapes of facets.
    pub const FACETS: [Shape; 5] = [Tri3, Tri6, Quad4, Quad8, Quad9];

    /// Space dimension of the shape: 3 for cells, 2 for facets, 1 for lines.
    pub fn dimension(self) -> usize {
        match self {
            Line2 | Line3 => 1,
            _ if Shape::FACETS.contains(&self) => 2,
            _ => 3,
        }
    }

    /// Number of nodes.
    pub fn node_count(self) -> usize {
        match self {
            Line2 => 2,
            Line3 => 3,
            Tri3 => 3,
            Tri6 => 6,
            Quad4 => 4,
            Quad8 => 8,
            Quad9 => 9,
            Tet4 => 4,
            Tet10 => 10,
            Hex8 => 8,
            Hex20 => 20,
            Hex27 => 27,
            Prism6 => 6,
            Prism15 => 15,
            Prism18 => 18,
            Pyramid5 => 5,
            Pyramid13 => 13,
            Pyramid14 => 14,
        }
    }

    /// Number of corner nodes; corners come first in the node order.
    pub fn corner_count(self) -> usize {
        match self {
            Line2 | Line3 => 2,
            Tri3 | Tri6 => 3,
            Quad4 | Quad8 | Quad9 | Tet4 | Tet10 => 4,
            Pyramid5 | Pyramid13 | Pyramid14 => 5,
            Prism6 | Prism15 | Prism18 => 6,
            Hex8 | Hex20 | Hex27 => 8,
        }
    }

    /// Whether the shape has nodes between its corners.
    pub fn is_quadratic(self) -> bool {
        self.node_count() > self.corner_count()
    }

    /// The edges, as pairs of corners, in the order of the nodes between them: those of quadratic
    /// shapes follow the corners.
    pub fn edges(self) -> &'static [[u8; 2]] {
        match self.corner_count() {
            2 => &[[0, 1]],
            3 => &[[0, 1], [1, 2], [2, 0]],
            4 if self.dimension() == 2 => &[[0, 1], [1, 2], [2, 3], [3, 0]],
            4 => &[[0, 1], [1, 2], [0, 2], [0, 3], [2, 3], [1, 3]],
            5 => &PYRAMID_EDGES,
            6 => &PRISM_EDGES,
            _ => &HEXAHEDRON_EDGES,
        }
    }

    /// The corners between which a node lies: itself, the ends of an edge, the corners of a face or
    /// all of them.
    pub(crate) fn members(self, local: usize) -> Vec<u8> {
        let corners = self.corner_count();
        if local < corners {
            return vec![local as u8];
        }
        if let Some(edge) = self.edges().get(local - corners) {
            return edge.to_vec();
        }
        let mut faces = self.faces().iter();
        let face = faces.find(|face| face.nodes.contains(&(local as u8)));
        face.map_or_else(
            || (0..corners as u8).collect(),
            |face| face.corners().to_vec(),
        )
    }

    /// The second-order shape of the same family with all middles of edges, quadrangles and
    /// hexahedra; its node order continues that of the others.
    pub(crate) fn complete(self) -> Self {
        match self {
            Line2 | Line3 => Line3,
            Tri3 | Tri6 => Tri6,
            Quad4 | Quad8 | Quad9 => Quad9,
            Tet4 | Tet10 => Tet10,
            Hex8 | Hex20 | Hex27 => Hex27,
            Prism6 | Prism15 | Prism18 => Prism18,
            Pyramid5 | Pyramid13 | Pyramid14 => Pyramid14,
        }
    }

    /// Reference coordinates of the nodes. Lines: `[-1, 1]`; triangles, tetrahedra: unit corners;
    /// quadrangles and hexahedra: `[-1, 1]`; prisms: unit triangle times `[-1, 1]`; pyramids:
    /// `[-1, 1]^2` below the apex at `z = 1`. All other nodes lie in the middle of corners.
    pub fn reference_nodes(self) -> Vec<DVec3> {
        let corners = self.reference_corners();
        let middle = |local: usize| {
            let members = self.members(local);
            let sum: DVec3 = members.iter().map(|&corner| corners[corner as usize]).sum();
            sum / members.len() as f64
        };
        (0..self.node_count()).map(middle).collect()
    }

    fn reference_corners(self) -> Vec<DVec3> {
        let square = |z: f64| {
            [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| DVec3::new(x, y, z))
        };
        let triangle =
            |z: f64| [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)].map(|(x, y)| DVec3::new(x, y, z));
        match self.corner_count() {
            2 => vec![-DVec3::X, DVec3::X],
            3 => triangle(0.0).to_vec(),
            4 if self.dimension() == 2 => square(0.0).to_vec(),
            4 => vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z],
            5 => [square(0.0).as_slice(), &[DVec3::Z]].concat(),
            6 => [triangle(-1.0), triangle(1.0)].concat(),
            _ => [square(-1.0), square(1.0)].concat(),
        }
    }

    /// The faces of a cell; empty for others.
    pub fn faces(self) -> &'static [Face] {
        match self {
            Line2 | Line3 | Tri3 | Tri6 | Quad4 | Quad8 | Quad9 => &[],
            Tet4 => &TET4_FACES,
            Tet10 => &TET10_FACES,
            Hex8 => &HEX8_FACES,
            Hex20 => &HEX20_FACES,
            Hex27 => &HEX27_FACES,
            Prism6 => &PRISM6_FACES,
            Prism15 => &PRISM15_FACES,
            Prism18 => &PRISM18_FACES,
            Pyramid5 => &PYRAMID5_FACES,
            Pyramid13 => &PYRAMID13_FACES,
            Pyramid14 => &PYRAMID14_FACES,
        }
    }
}

const PYRAMID_EDGES: [[u8; 2]; 8] = [
    [0, 1],
    [0, 3],
    [0, 4],
    [1, 2],
    [1, 4],
    [2, 3],
    [2, 4],
    [3, 4],
];

const PRISM_EDGES: [[u8; 2]; 9] = [
    [0, 1],
    [0, 2],
    [0, 3],
    [1, 2],
    [1, 4],
    [2, 5],
    [3, 4],
    [3, 5],
    [4, 5],
];

const HEXAHEDRON_EDGES: [[u8; 2]; 12] = [
    [0, 1],
    [0, 3],
    [0, 4],
    [1, 2],
    [1, 5],
    [2, 3],
    [2, 6],
    [3, 7],
    [4, 5],
    [4, 7],
    [5, 6],
    [6, 7],
];

const fn face(shape: Shape, nodes: &'static [u8]) -> Face {
    Face { shape, nodes }
}

const TET4_FACES: [Face; 4] = [
    face(Tri3, &[0, 2, 1]),
    face(Tri3, &[0, 1, 3]),
    face(Tri3, &[0, 3, 2]),
    face(Tri3, &[1, 2, 3]),
];

/// Corners of a tetrahedron's faces, for loops over very many of them.
pub(crate) const TETRAHEDRON: [[usize; 3]; 4] = {
    let mut corners = [[0; 3]; 4];
    let mut place = 0;
    while place < 12 {
        corners[place / 3][place % 3] = TET4_FACES[place / 3].nodes[place % 3] as usize;
        place += 1;
    }
    corners
};

const TET10_FACES: [Face; 4] = [
    face(Tri6, &[0, 2, 1, 6, 5, 4]),
    face(Tri6, &[0, 1, 3, 4, 9, 7]),
    face(Tri6, &[0, 3, 2, 7, 8, 6]),
    face(Tri6, &[1, 2, 3, 5, 8, 9]),
];

const HEX8_FACES: [Face; 6] = [
    face(Quad4, &[0, 3, 2, 1]),
    face(Quad4, &[0, 1, 5, 4]),
    face(Quad4, &[0, 4, 7, 3]),
    face(Quad4, &[1, 2, 6, 5]),
    face(Quad4, &[2, 3, 7, 6]),
    face(Quad4, &[4, 5, 6, 7]),
];

const HEX20_FACES: [Face; 6] = [
    face(Quad8, &[0, 3, 2, 1, 9, 13, 11, 8]),
    face(Quad8, &[0, 1, 5, 4, 8, 12, 16, 10]),
    face(Quad8, &[0, 4, 7, 3, 10, 17, 15, 9]),
    face(Quad8, &[1, 2, 6, 5, 11, 14, 18, 12]),
    face(Quad8, &[2, 3, 7, 6, 13, 15, 19, 14]),
    face(Quad8, &[4, 5, 6, 7, 16, 18, 19, 17]),
];

const HEX27_FACES: [Face; 6] = [
    face(Quad9, &[0, 3, 2, 1, 9, 13, 11, 8, 20]),
    face(Quad9, &[0, 1, 5, 4, 8, 12, 16, 10, 21]),
    face(Quad9, &[0, 4, 7, 3, 10, 17, 15, 9, 22]),
    face(Quad9, &[1, 2, 6, 5, 11, 14, 18, 12, 23]),
    face(Quad9, &[2, 3, 7, 6, 13, 15, 19, 14, 24]),
    face(Quad9, &[4, 5, 6, 7, 16, 18, 19, 17, 25]),
];

const PRISM6_FACES: [Face; 5] = [
    face(Tri3, &[0, 2, 1]),
    face(Tri3, &[3, 4, 5]),
    face(Quad4, &[0, 1, 4, 3]),
    face(Quad4, &[0, 3, 5, 2]),
    face(Quad4, &[1, 2, 5, 4]),
];

const PRISM15_FACES: [Face; 5] = [
    face(Tri6, &[0, 2, 1, 7, 9, 6]),
    face(Tri6, &[3, 4, 5, 12, 14, 13]),
    face(Quad8, &[0, 1, 4, 3, 6, 10, 12, 8]),
    face(Quad8, &[0, 3, 5, 2, 8, 13, 11, 7]),
    face(Quad8, &[1, 2, 5, 4, 9, 11, 14, 10]),
];

const PRISM18_FACES: [Face; 5] = [
    face(Tri6, &[0, 2, 1, 7, 9, 6]),
    face(Tri6, &[3, 4, 5, 12, 14, 13]),
    face(Quad9, &[0, 1, 4, 3, 6, 10, 12, 8, 15]),
    face(Quad9, &[0, 3, 5, 2, 8, 13, 11, 7, 16]),
    face(Quad9, &[1, 2, 5, 4, 9, 11, 14, 10, 17]),
];

const PYRAMID5_FACES: [Face; 5] = [
    face(Tri3, &[0, 1, 4]),
    face(Tri3, &[3, 0, 4]),
    face(Tri3, &[1, 2, 4]),
    face(Tri3, &[2, 3, 4]),
    face(Quad4, &[0, 3, 2, 1]),
];

const PYRAMID13_FACES: [Face; 5] = [
    face(Tri6, &[0, 1, 4, 5, 9, 7]),
    face(Tri6, &[3, 0, 4, 6, 7, 12]),
    face(Tri6, &[1, 2, 4, 8, 11, 9]),
    face(Tri6, &[2, 3, 4, 10, 12, 11]),
    face(Quad8, &[0, 3, 2, 1, 6, 10, 8, 5]),
];

const PYRAMID14_FACES: [Face; 5] = [
    face(Tri6, &[0, 1, 4, 5, 9, 7]),
    face(Tri6, &[3, 0, 4, 6, 7, 12]),
    face(Tri6, &[1, 2, 4, 8, 11, 9]),
    face(Tri6, &[2, 3, 4, 10, 12, 11]),
    face(Quad9, &[0, 3, 2, 1, 6, 10, 8, 5, 13]),
];
