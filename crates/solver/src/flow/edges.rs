//! Where conducting fractures meet parts of the outer surface.

use kluft_mesh::{Boundary, Elements, Mesh};

use super::numbering::FlowNodes;

/// An edge of a conducting facet on the outer surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct OuterEdge {
    /// The conducting facet: index into those of the numbering.
    pub(super) facet: usize,
    /// Pressures at its ends.
    pub(super) ends: [usize; 2],
    /// Its length (m).
    pub(super) length: f64,
}

/// The edges of conducting facets that run along a boundary, facets ascending.
pub(super) fn on(mesh: &Mesh, nodes: &FlowNodes, boundary: &Boundary) -> Vec<OuterEdge> {
    let count = boundary.elements.len();
    let all = (0..count).flat_map(|facet| ring(&boundary.elements, facet));
    let mut outer: Vec<[u32; 2]> = all.collect();
    outer.sort_unstable();
    let mut found = Vec::new();
    for (index, &facet) in nodes.facets.iter().enumerate() {
        for edge in ring(&mesh.facets.elements, facet as usize) {
            let ends = edge.map(|node| nodes.of_node(node));
            if let ([Some(a), Some(b)], Ok(_)) = (ends, outer.binary_search(&edge)) {
                found.push(OuterEdge {
                    facet: index,
                    ends: [a, b],
                    length: mesh.edge_length(edge),
                });
            }
        }
    }
    found
}

/// Edges between the corners of a facet, the lower node first.
fn ring(elements: &Elements, facet: usize) -> impl Iterator<Item = [u32; 2]> + '_ {
    let nodes = elements.nodes_of(facet);
    let edges = elements.shapes[facet].edges().iter();
    edges.map(|&[a, b]| {
        let [a, b] = [nodes[a as usize], nodes[b as usize]];
        [a.min(b), a.max(b)]
    })
}
