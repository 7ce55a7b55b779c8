//! Networks that nothing drives: fractures between which fluid could pass, and through which none
//! does.

use super::steady::FlowSystem;

impl FlowSystem<'_> {
    /// Facets, ascending, of the networks that no condition acts on. Nothing flows in them, and
    /// their pressure is not known.
    pub fn isolated_facets(&self) -> Vec<u32> {
        let topology = &self.topology;
        let is_isolated = |facet: usize| {
            let row = topology.nodes.corners.of(facet)[0] as usize;
            let network = &topology.networks[topology.network_of_row[row] as usize];
            network.conditions.is_empty()
        };
        let facets = topology.nodes.facets.iter().enumerate();
        let isolated = facets.filter(|(index, _)| is_isolated(*index));
        isolated.map(|(_, facet)| *facet).collect()
    }
}
