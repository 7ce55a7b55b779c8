//! What hangs together hydraulically.

use kluft_mesh::{DisjointSets, Mesh};

use super::numbering::FlowNodes;
use super::places::Place;
use crate::problem::Flow;

/// Conducting fractures between which fluid can pass.
#[derive(Debug, Clone, PartialEq)]
pub struct FlowNetwork {
    /// Indices into [`kluft_mesh::MeshData::fractures`], ascending.
    pub fractures: Vec<u32>,
    /// Number of its pressures.
    pub nodes: usize,
    /// What acts on it: indices into [`Flow::conditions`].
    pub conditions: Vec<usize>,
    /// Whether a pressure is given somewhere.
    pub has_pressure: bool,
}

/// All networks, in the order of their lowest nodes, and the network of each pressure.
pub(super) fn find(
    mesh: &Mesh,
    nodes: &FlowNodes,
    flow: &Flow,
    places: &[Place],
) -> (Vec<FlowNetwork>, Vec<u32>) {
    let mut sets = DisjointSets::new(nodes.len());
    for facet in 0..nodes.facets.len() {
        let corners = nodes.corners.of(facet);
        for &corner in &corners[1..] {
            sets.join(corners[0], corner);
        }
    }
    let mut networks: Vec<FlowNetwork> = Vec::new();
    let mut of_row: Vec<u32> = vec![0; nodes.len()];
    for row in 0..nodes.len() {
        let root = sets.root(row as u32) as usize;
        if root == row {
            of_row[row] = networks.len() as u32;
            networks.push(FlowNetwork {
                fractures: Vec::new(),
                nodes: 0,
                conditions: Vec::new(),
                has_pressure: false,
            });
        }
        // The root is the lowest row, so it has its network already.
        of_row[row] = of_row[root];
        networks[of_row[row] as usize].nodes += 1;
    }
    for (index, &facet) in nodes.facets.iter().enumerate() {
        let network = of_row[nodes.corners.of(index)[0] as usize] as usize;
        let fracture = mesh.facets.fracture[facet as usize];
        networks[network].fractures.push(fracture);
    }
    for network in &mut networks {
        network.fractures.sort_unstable();
        network.fractures.dedup();
    }
    for (condition, place) in places.iter().enumerate() {
        for row in place.rows() {
            let network = &mut networks[of_row[row] as usize];
            network.has_pressure |= flow.conditions[condition].drive.is_pressure();
            if !network.conditions.contains(&condition) {
                network.conditions.push(condition);
            }
        }
    }
    (networks, of_row)
}
