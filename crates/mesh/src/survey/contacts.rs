//! Where fractures meet.

use std::collections::BTreeMap;

use glam::DVec3;

use super::fractures::FacetGeometry;
use crate::fracture_edges::{FacetEdge, FractureEdges, FracturesAtNodes};
use crate::mesh::Mesh;

/// Two fractures that share nodes.
#[derive(Debug, Clone, PartialEq)]
pub struct Contact {
    /// Indices into [`crate::MeshData::fractures`], ascending.
    pub fractures: [u32; 2],
    /// Number of nodes that they share.
    pub nodes: usize,
    /// Length along which both go on (m): an X.
    pub crossing_length: f64,
    /// Length along which the first ends on the second, and the second on the first (m): a T.
    pub ending_length: [f64; 2],
    /// Length along which both end (m): an L, or one continues the other.
    pub rim_length: f64,
    /// Smallest angle between facets of both at a common edge (degrees); none if they share nodes
    /// only.
    pub smallest_angle: Option<f64>,
    /// Where that is, or one of the nodes they share (m).
    pub at: DVec3,
}

/// Finds the contacts, by pair.
pub(super) fn find(
    mesh: &Mesh,
    geometry: &FacetGeometry,
    edges: &FractureEdges,
    at_nodes: &FracturesAtNodes,
) -> Vec<Contact> {
    let mut contacts: BTreeMap<[u32; 2], Contact> = BTreeMap::new();
    for node in 0..mesh.nodes.len() {
        let here = at_nodes.of(node);
        for (i, &first) in here.iter().enumerate() {
            for &second in &here[i + 1..] {
                let fractures = [first, second];
                let contact = contacts
                    .entry(fractures)
                    .or_insert_with(|| Contact::at(fractures, mesh.nodes[node]));
                contact.nodes += 1;
            }
        }
    }
    for run in edges.meetings() {
        let groups: Vec<&[FacetEdge]> = run.chunk_by(|a, b| a.fracture == b.fracture).collect();
        for (i, first) in groups.iter().enumerate() {
            for second in &groups[i + 1..] {
                let fractures = [first[0].fracture, second[0].fracture];
                if let Some(contact) = contacts.get_mut(&fractures) {
                    contact.add(mesh, geometry, first, second);
                }
            }
        }
    }
    contacts.into_values().collect()
}

impl Contact {
    fn at(fractures: [u32; 2], at: DVec3) -> Self {
        Self {
            fractures,
            nodes: 0,
            crossing_length: 0.0,
            ending_length: [0.0; 2],
            rim_length: 0.0,
            smallest_angle: None,
            at,
        }
    }

    fn add(
        &mut self,
        mesh: &Mesh,
        geometry: &FacetGeometry,
        first: &[FacetEdge],
        second: &[FacetEdge],
    ) {
        let long = mesh.edge_length(first[0].nodes);
        let kind = match (first.len(), second.len()) {
            (1, 1) => &mut self.rim_length,
            (1, _) => &mut self.ending_length[0],
            (_, 1) => &mut self.ending_length[1],
            _ => &mut self.crossing_length,
        };
        *kind += long;
        let ends = first[0].nodes.map(|node| mesh.nodes[node as usize]);
        for a in first {
            for b in second {
                let [a, b] = [a, b].map(|edge| inward(geometry, edge.facet, ends));
                let angle = a.cross(b).length().atan2(a.dot(b)).to_degrees();
                if self.smallest_angle.is_none_or(|smallest| angle < smallest) {
                    self.smallest_angle = Some(angle);
                    self.at = 0.5 * (ends[0] + ends[1]);
                }
            }
        }
    }
}

/// Direction from an edge into a facet, square to the edge.
fn inward(geometry: &FacetGeometry, facet: u32, [from, to]: [DVec3; 2]) -> DVec3 {
    let arm = geometry.centres[facet as usize] - from;
    arm.reject_from(to - from)
}
