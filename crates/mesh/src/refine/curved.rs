//! Surfaces that look curved although their facets are flat.

use glam::DVec3;
use rayon::prelude::*;

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
        let mut counts = vec![[0_usize; 2]; self.group_sets.len()];
        for (&set, &is_bent) in self.facets.group_set.iter().zip(&is_bent) {
            counts[set as usize][usize::from(is_bent)] += 1;
        }
        let mut of_groups = vec![[0_usize; 2]; self.groups.len()];
        for (set, counts) in self.group_sets.iter().zip(counts) {
            for &group in set {
                of_groups[group][0] += counts[0];
                of_groups[group][1] += counts[1];
            }
        }
        let mostly_bent = |&group: &usize| of_groups[group][1] > of_groups[group][0];
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
        edges.par_sort_unstable();
        edges
    }
}
