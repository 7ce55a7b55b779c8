//! The outside of a mesh: which surfaces are on it, and the volume within.

use glam::DVec3;
use rayon::prelude::*;

use crate::check::facets_of_sets;
use crate::draft::{Draft, Elements};
use crate::facets::Boundary;
use crate::geometry::{cell_volume, corners, facet_area_vector, facet_centre};
use crate::mesh::Mesh;

/// Nodes off a plane by less than this share of the size of the body are on it.
const ON_PLANE: f64 = 1e-9;

impl Mesh {
    /// Volume of the body (m^3): that of the cells, or without cells that within the parts of the
    /// outer surface, if they close around a convex body. None if they do not.
    pub fn volume(&self) -> Option<f64> {
        if self.cells.is_empty() {
            return enclosed_volume(&self.boundaries, &self.nodes);
        }
        let cells = 0..self.cells.len();
        let volumes = cells.map(|cell| {
            let corners = corners(&self.cells, cell, &self.nodes);
            cell_volume(self.cells.shapes[cell], &corners)
        });
        Some(volumes.sum())
    }
}

/// For each group of a draft whether it is a surface all of which lies on planes that have the
/// whole body on one side: the outer surface of a convex body, as far as it is flat.
pub fn outer_surfaces(draft: &Draft) -> Vec<bool> {
    let nodes: Vec<DVec3> = draft.nodes.iter().copied().map(DVec3::from).collect();
    let facets = &draft.facets.elements;
    let mut of_group: Vec<Option<bool>> = vec![None; draft.groups.len()];
    let hull = Hull::of(facets, &nodes);
    let of_set = facets_of_sets(draft);
    for (set, own) in draft.group_sets.iter().zip(&of_set) {
        if own.is_empty() {
            continue;
        }
        let is_outer = hull.holds(facets, own);
        for &group in set
            .iter()
            .filter(|group| draft.groups[**group].dimension == 2)
        {
            of_group[group] = Some(of_group[group].unwrap_or(true) && is_outer);
        }
    }
    of_group
        .into_iter()
        .map(|outer| outer == Some(true))
        .collect()
}

/// The nodes of a body that its planes are held against.
struct Hull<'a> {
    nodes: &'a [DVec3],
    /// Nodes of facets, each once.
    used: Vec<u32>,
    /// Distances below this are none (m).
    tolerance: f64,
}

impl<'a> Hull<'a> {
    fn of(facets: &Elements, nodes: &'a [DVec3]) -> Self {
        let mut used = facets.nodes.clone();
        used.par_sort_unstable();
        used.dedup();
        let all = used.iter().map(|&node| nodes[node as usize]);
        let (low, high) = all.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), x| {
            (low.min(x), high.max(x))
        });
        Self {
            nodes,
            used,
            tolerance: ON_PLANE * (high - low).length(),
        }
    }

    /// Whether facets lie on planes that have all nodes on one side.
    fn holds(&self, facets: &Elements, own: &[u32]) -> bool {
        let mut planes: Vec<(DVec3, DVec3)> = Vec::new();
        own.iter().all(|&facet| {
            let corners = corners(facets, facet as usize, self.nodes);
            let lies_on = |(at, normal): &(DVec3, DVec3)| {
                let off = |x: &DVec3| (*x - *at).dot(*normal).abs();
                corners.iter().all(|x| off(x) <= self.tolerance)
            };
            if planes.iter().any(lies_on) {
                return true;
            }
            let plane = (corners[0], facet_area_vector(&corners).normalize_or_zero());
            let is_outer = self.supports(plane);
            planes.push(plane);
            is_outer
        })
    }

    /// Whether all nodes are on one side of a plane, given by a point and its normal.
    fn supports(&self, (at, normal): (DVec3, DVec3)) -> bool {
        let (mut below, mut above) = (false, false);
        for &node in &self.used {
            let height = (self.nodes[node as usize] - at).dot(normal);
            below |= height < -self.tolerance;
            above |= height > self.tolerance;
            if below && above {
                return false;
            }
        }
        normal != DVec3::ZERO
    }
}

/// Volume (m^3) inside facets that close around a place from which all of them can be seen, as
/// those of a convex body do; whichever way their normals point. None if they do not close.
fn enclosed_volume(parts: &[Boundary], nodes: &[DVec3]) -> Option<f64> {
    let facets = || {
        let parts = parts.iter().map(|part| &part.elements);
        parts.flat_map(|part| (0..part.len()).map(move |facet| (part, facet)))
    };
    let mut edges: Vec<[u32; 2]> = facets()
        .flat_map(|(part, facet)| {
            let own = part.nodes_of(facet);
            let edges = part.shapes[facet].edges().iter();
            edges.map(|&[a, b]| [own[a as usize], own[b as usize]])
        })
        .map(|[a, b]| [a.min(b), a.max(b)])
        .collect();
    edges.sort_unstable();
    if edges.is_empty() || edges.chunk_by(|a, b| a == b).any(|run| run.len() != 2) {
        return None;
    }
    let places = facets().map(|(part, facet)| corners(part, facet, nodes));
    let parts: Vec<(DVec3, DVec3)> = places
        .map(|own| (facet_centre(&own), facet_area_vector(&own)))
        .collect();
    let whole: f64 = parts.iter().map(|(_, area)| area.length()).sum();
    let centre = parts
        .iter()
        .map(|(at, area)| *at * area.length())
        .sum::<DVec3>()
        / whole;
    let cones = parts
        .iter()
        .map(|(at, area)| (*at - centre).dot(*area).abs());
    Some(cones.sum::<f64>() / 3.0)
}
