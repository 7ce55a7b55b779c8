//! Where fractures meet, end in the rock and come out of it: the facets at every edge, the
//! fractures at every node.

use crate::adjacency::NONE;
use crate::mesh::Mesh;

/// An edge between two nodes as one facet has it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct FacetEdge {
    /// Its nodes, the lower one first.
    pub nodes: [u32; 2],
    /// The fracture of the facet: index into [`crate::MeshData::fractures`].
    pub fracture: u32,
    /// The facet: index into the elements of [`crate::MeshData::facets`].
    pub facet: u32,
}

/// The edges between the corners of all fracture facets, and what meets there.
///
/// | facets at an edge, by fracture | the edge is |
/// |---|---|
/// | 1 | where the fracture ends: in the rock, or on the outer surface ([`Self::is_outer`]) |
/// | 2 | inside the fracture |
/// | 1 and 1 | the common rim of two fractures: an L |
/// | 1 and 2 | where one fracture ends on another: a T |
/// | 2 and 2 | where two fractures cross: an X |
#[derive(Debug, Clone)]
pub struct FractureEdges {
    /// Sorted, so that those of the same nodes stand together.
    edges: Vec<FacetEdge>,
    /// Edges of the outer surface between nodes on fractures, sorted.
    outer: Vec<[u32; 2]>,
}

impl FractureEdges {
    /// Finds the edges of a mesh, of which `at_nodes` tells the fractures at nodes.
    pub fn of(mesh: &Mesh, at_nodes: &FracturesAtNodes) -> Self {
        let facets = &mesh.facets;
        let mut edges = Vec::with_capacity(4 * facets.fracture.len());
        for (facet, &fracture) in facets.fracture.iter().enumerate() {
            let corners = facets.elements.shapes[facet].corner_count();
            let ring = &facets.elements.nodes_of(facet)[..corners];
            edges.extend(ring_edges(ring).map(|nodes| FacetEdge {
                nodes,
                fracture,
                facet: facet as u32,
            }));
        }
        edges.sort_unstable();
        Self {
            edges,
            outer: outer_edges(mesh, at_nodes),
        }
    }

    /// The facets at one edge after the other, in ascending order of nodes; those of one edge by
    /// fracture.
    pub fn meetings(&self) -> impl Iterator<Item = &[FacetEdge]> {
        self.edges.chunk_by(|a, b| a.nodes == b.nodes)
    }

    /// Whether the outer surface runs along an edge between nodes on fractures, the lower node
    /// first.
    pub fn is_outer(&self, nodes: [u32; 2]) -> bool {
        self.outer.binary_search(&nodes).is_ok()
    }
}

/// The fractures at each node, ascending.
#[derive(Debug, Clone)]
pub struct FracturesAtNodes {
    offset: Vec<u32>,
    fractures: Vec<u32>,
}

impl FracturesAtNodes {
    /// Finds the fractures at the nodes of a mesh.
    pub fn of_mesh(mesh: &Mesh) -> Self {
        let mut pairs = Vec::with_capacity(mesh.facets.elements.nodes.len());
        for (facet, &fracture) in mesh.facets.fracture.iter().enumerate() {
            let own = mesh.facets.elements.nodes_of(facet);
            pairs.extend(own.iter().map(|&node| (node, fracture)));
        }
        pairs.sort_unstable();
        pairs.dedup();
        let mut offset = vec![0_u32; mesh.nodes.len() + 1];
        for &(node, _) in &pairs {
            offset[node as usize + 1] += 1;
        }
        for node in 0..mesh.nodes.len() {
            offset[node + 1] += offset[node];
        }
        Self {
            offset,
            fractures: pairs.into_iter().map(|(_, fracture)| fracture).collect(),
        }
    }

    /// Fractures at a node: indices into [`crate::MeshData::fractures`], ascending.
    pub fn of(&self, node: usize) -> &[u32] {
        &self.fractures[self.offset[node] as usize..self.offset[node + 1] as usize]
    }

    /// Whether a fracture goes through a node or ends there.
    pub fn any(&self, node: u32) -> bool {
        self.offset[node as usize] < self.offset[node as usize + 1]
    }
}

fn ring_edges(ring: &[u32]) -> impl Iterator<Item = [u32; 2]> {
    let next = ring.iter().cycle().skip(1);
    ring.iter().zip(next).map(|(&a, &b)| [a.min(b), a.max(b)])
}

/// A face of a cell by its corner nodes, ascending; triangles end in [`NONE`].
type Key = [u32; 4];

fn key(nodes: &[u32]) -> Key {
    let mut key = [NONE; 4];
    key[..nodes.len()].copy_from_slice(nodes);
    key.sort_unstable();
    key
}

/// Edges of faces with a cell on one side only, as far as both ends are on fractures.
fn outer_edges(mesh: &Mesh, at_nodes: &FracturesAtNodes) -> Vec<[u32; 2]> {
    if mesh.cells.is_empty() {
        return boundary_edges(mesh, at_nodes);
    }
    let mut faces: Vec<(Key, [u32; 4], u8)> = Vec::new();
    for (cell, shape) in mesh.cells.shapes.iter().enumerate() {
        let nodes = mesh.cells.nodes_of(cell);
        let corners = &nodes[..shape.corner_count()];
        if corners.iter().filter(|&&node| at_nodes.any(node)).count() < 2 {
            continue;
        }
        for face in shape.faces() {
            let mut ring = [0; 4];
            let count = face.corners().len();
            for (slot, &local) in ring.iter_mut().zip(face.corners()) {
                *slot = nodes[local as usize];
            }
            let own = &ring[..count];
            if own.iter().filter(|&&node| at_nodes.any(node)).count() > 1 {
                faces.push((key(own), ring, count as u8));
            }
        }
    }
    faces.sort_unstable();
    let mut edges = Vec::new();
    for run in faces.chunk_by(|a, b| a.0 == b.0) {
        if let [(_, ring, count)] = run {
            let own = ring_edges(&ring[..*count as usize]);
            edges.extend(own.filter(|nodes| nodes.iter().all(|&node| at_nodes.any(node))));
        }
    }
    edges.sort_unstable();
    edges.dedup();
    edges
}

/// Edges of the parts of the outer surface, as far as both ends are on fractures.
fn boundary_edges(mesh: &Mesh, at_nodes: &FracturesAtNodes) -> Vec<[u32; 2]> {
    let mut edges = Vec::new();
    for part in mesh.boundaries.iter().map(|boundary| &boundary.elements) {
        for facet in 0..part.len() {
            let corners = part.shapes[facet].corner_count();
            let own = ring_edges(&part.nodes_of(facet)[..corners]);
            edges.extend(own.filter(|nodes| nodes.iter().all(|&node| at_nodes.any(node))));
        }
    }
    edges.sort_unstable();
    edges.dedup();
    edges
}
