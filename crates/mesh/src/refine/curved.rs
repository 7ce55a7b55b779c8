//! Surfaces that look curved although their facets are flat.

use glam::DVec3;

use crate::draft::Draft;
use crate::facet_area_vector;
use crate::geometry::corners;

/// Facets that meet at smaller angles lie in one plane (radians).
const FLAT: f64 = 1e-3;
/// Facets that meet at larger angles are at an edge of the body (radians).
const SHARP: f64 = 0.8;

impl Draft {
    /// Physical surfaces of flat facets of which most are bent against their neighbours: dividing
    /// them follows the facets, not the surface that they were made from. Indices into
    /// [`Draft::groups`], ascending.
    pub fn faceted_surfaces(&self) -> Vec<usize> {
        let facets = &self.facets.elements;
        let nodes: Vec<DVec3> = self.nodes.iter().copied().map(DVec3::from).collect();
        let normal =
            |facet: usize| facet_area_vector(&corners(facets, facet, &nodes)).normalize_or_zero();
        let normals: Vec<DVec3> = (0..facets.len()).map(normal).collect();
        let mut is_bent = vec![false; facets.len()];
        let edges = self.facet_edges();
        for alike in edges.chunk_by(|a, b| a.0 == b.0) {
            let [(_, one), (_, other)] = *alike else {
                continue;
            };
            let sine = normals[one].cross(normals[other]).length();
            let cosine = normals[one].dot(normals[other]).abs();
            if (FLAT..SHARP).contains(&sine.atan2(cosine)) {
                is_bent[one] = true;
                is_bent[other] = true;
            }
        }
        let holds = |group: usize, facet: usize| {
            let set = &self.group_sets[self.facets.group_set[facet] as usize];
            set.contains(&group)
        };
        let mostly_bent = |group: &usize| {
            let own = (0..facets.len()).filter(|&facet| holds(*group, facet));
            let (count, bent) = own.fold((0, 0), |(count, bent), facet| {
                (count + 1, bent + usize::from(is_bent[facet]))
            });
            2 * bent > count
        };
        (0..self.groups.len()).filter(mostly_bent).collect()
    }

    /// Edges of the linear facets with the set of their groups, in order, each with its facet.
    fn facet_edges(&self) -> Vec<((u32, [u32; 2]), usize)> {
        let facets = &self.facets.elements;
        let linear = (0..facets.len()).filter(|&facet| !facets.shapes[facet].is_quadratic());
        let edges = linear.flat_map(|facet| {
            let own = facets.nodes_of(facet);
            let set = self.facets.group_set[facet];
            facets.shapes[facet].edges().iter().map(move |edge| {
                let mut ends = edge.map(|local| own[local as usize]);
                ends.sort_unstable();
                ((set, ends), facet)
            })
        });
        let mut edges: Vec<_> = edges.collect();
        edges.sort_unstable();
        edges
    }
}
