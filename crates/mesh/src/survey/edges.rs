//! Edges of facets: which facets meet there, and whether the outer surface runs along.

use super::{FractureSurvey, FracturesAtNodes};
use crate::adjacency::NONE;
use crate::mesh::Mesh;

/// An edge between two nodes as one facet has it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct FacetEdge {
    /// Its nodes, the lower one first.
    pub(super) nodes: [u32; 2],
    pub(super) fracture: u32,
    pub(super) facet: u32,
}

/// All edges of all facets, sorted, so that those of the same nodes stand together.
pub(super) struct FacetEdges {
    edges: Vec<FacetEdge>,
    /// Edges of the outer surface between nodes on fractures, sorted.
    outer: Vec<[u32; 2]>,
}

impl FacetEdges {
    pub(super) fn of(mesh: &Mesh, at_nodes: &FracturesAtNodes) -> Self {
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

    /// The facets at one edge after the other, by fracture.
    pub(super) fn runs(&self) -> impl Iterator<Item = &[FacetEdge]> {
        self.edges.chunk_by(|a, b| a.nodes == b.nodes)
    }

    fn is_outer(&self, nodes: [u32; 2]) -> bool {
        self.outer.binary_search(&nodes).is_ok()
    }

    /// Adds tips, traces and branchings to the fractures; returns the number of tip edges of each
    /// facet.
    pub(super) fn add_to(&self, mesh: &Mesh, fractures: &mut [FractureSurvey]) -> Vec<u8> {
        let mut tips = vec![0; mesh.facets.fracture.len()];
        for run in self.runs() {
            let (is_outer, long) = (self.is_outer(run[0].nodes), length(mesh, run[0].nodes));
            for own in run.chunk_by(|a, b| a.fracture == b.fracture) {
                let entry = &mut fractures[own[0].fracture as usize];
                entry.closed &= own.len() > 1;
                if is_outer {
                    entry.trace_edges += 1;
                    entry.trace_length += long;
                } else if run.len() == 1 {
                    entry.tip_edges += 1;
                    entry.tip_length += long;
                    tips[own[0].facet as usize] += 1;
                }
                if own.len() > 2 {
                    entry.branching_length += long;
                }
            }
        }
        tips
    }
}

/// Length of the straight edge between two nodes (m).
pub(super) fn length(mesh: &Mesh, [a, b]: [u32; 2]) -> f64 {
    mesh.nodes[a as usize].distance(mesh.nodes[b as usize])
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
