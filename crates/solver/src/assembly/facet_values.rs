//! Values at the nodes of facets as the points of fractures see them.

use glam::DVec3;
use kluft_mesh::Mesh;
use lie_core::facet_points;

use crate::assembly::interface::Interface;

impl Interface {
    /// Values at the points of the fractures from those at the nodes of the facets, in the order of
    /// their flat node list: at control points, control values.
    ///
    /// # Panics
    /// If there is not one value for each node of each facet.
    pub fn point_values(&self, mesh: &Mesh, at_nodes: &[f64]) -> Vec<f64> {
        let elements = &mesh.facets.elements;
        assert_eq!(at_nodes.len(), elements.nodes.len(), "values at nodes");
        let points = self.points().iter().zip(self.node_shares(mesh));
        let values = points.map(|(point, shares)| {
            let own = &at_nodes[elements.range(point.facet as usize)];
            let terms = shares.into_iter();
            terms
                .map(|(local, share)| share * own[local as usize])
                .sum()
        });
        values.collect()
    }

    /// Local nodes of its facet that each point stands for, and their shares.
    pub(crate) fn node_shares(&self, mesh: &Mesh) -> Vec<Vec<(u8, f64)>> {
        let elements = &mesh.facets.elements;
        // The points of a facet keep their order, wherever they stand.
        let mut seen = vec![0_usize; elements.len()];
        let points = self.points().iter();
        let shares = points.map(|point| {
            let facet = point.facet as usize;
            let place = seen[facet];
            seen[facet] += 1;
            let nodes = elements.nodes_of(facet).iter();
            let nodes: Vec<DVec3> = nodes.map(|&node| mesh.nodes[node as usize]).collect();
            let rule = self.rule_of(point.fracture);
            let own = facet_points(elements.shapes[facet], &nodes, rule)
                .into_iter()
                .nth(place);
            own.map_or_else(Vec::new, |own| own.nodes)
        });
        shares.collect()
    }
}
