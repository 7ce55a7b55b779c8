//! Nodes that stand at one place.

use std::collections::BTreeMap;

use glam::DVec3;
use rayon::prelude::*;
use rstar::primitives::GeomWithData;
use rstar::{PointDistance, RTree};

use crate::disjoint_sets::DisjointSets;
use crate::draft::Elements;

/// Nodes are at one place when they are no further apart than this share of the shortest edge of
/// the faces that they are on.
pub(crate) const SAME_PLACE: f64 = 1e-6;

/// The nodes of some faces that share their place with others.
#[derive(Default)]
pub(crate) struct Places {
    /// For each of them the lowest node at its place.
    lowest: BTreeMap<u32, u32>,
}

/// A node, and how far from it others are at the same place.
struct Reach {
    node: u32,
    at: [f64; 3],
    within: f64,
}

impl Places {
    /// Compares the nodes of all faces with each other.
    pub(crate) fn of(faces: &Elements, nodes: &[DVec3]) -> Self {
        let reaches = reaches(faces, nodes);
        let points = reaches.iter().enumerate();
        let points = points.map(|(index, reach)| GeomWithData::new(reach.at, index));
        let tree = RTree::bulk_load(points.collect());
        let all = &reaches;
        let twins = reaches.par_iter().enumerate().flat_map_iter(|(a, reach)| {
            let near = tree.locate_within_distance(reach.at, reach.within.powi(2));
            let others = near.map(|point| (point.data, point.distance_2(&reach.at)));
            // The other's reach counts as well, so that both see the same.
            let twins = others.filter(move |&(b, d)| a < b && d <= all[b].within.powi(2));
            twins.map(move |(b, _)| (a as u32, b as u32))
        });
        let twins: Vec<(u32, u32)> = twins.collect();
        if twins.is_empty() {
            return Self::default();
        }
        let mut sets = DisjointSets::new(reaches.len());
        for &(a, b) in &twins {
            sets.join(a, b);
        }
        let members = twins.iter().flat_map(|&(a, b)| [a, b]);
        let node = |member: u32| reaches[member as usize].node;
        let lowest = members.map(|member| (node(member), node(sets.root(member))));
        Self {
            lowest: lowest.collect(),
        }
    }

    /// Whether all nodes are alone.
    pub(crate) fn is_empty(&self) -> bool {
        self.lowest.is_empty()
    }

    /// Whether a node shares its place.
    pub(crate) fn has(&self, node: u32) -> bool {
        self.lowest.contains_key(&node)
    }

    /// The lowest node at the place of one.
    pub(crate) fn lowest(&self, node: u32) -> u32 {
        self.lowest.get(&node).copied().unwrap_or(node)
    }

    /// Nodes with the lowest of their place.
    pub(crate) fn pairs(&self) -> impl Iterator<Item = (u32, u32)> {
        self.lowest.iter().map(|(&node, &lowest)| (node, lowest))
    }
}

/// The nodes of the faces, ascending, each with the least that its faces ask for; nodes without a
/// place are left out.
fn reaches(faces: &Elements, nodes: &[DVec3]) -> Vec<Reach> {
    let mut of_faces: Vec<(u32, f64)> = Vec::with_capacity(faces.nodes.len());
    for face in 0..faces.len() {
        let own = faces.nodes_of(face);
        let corners = &own[..faces.shapes[face].corner_count()];
        let ends = corners.iter().cycle().skip(1);
        let edges = corners
            .iter()
            .zip(ends)
            .map(|(&a, &b)| nodes[a as usize].distance(nodes[b as usize]));
        let within = SAME_PLACE * edges.fold(f64::INFINITY, f64::min);
        of_faces.extend(own.iter().map(|&node| (node, within)));
    }
    of_faces.par_sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    of_faces.dedup_by_key(|(node, _)| *node);
    let sound = of_faces.into_iter().filter_map(|(node, within)| {
        let at = nodes[node as usize];
        (at.is_finite() && within.is_finite()).then(|| Reach {
            node,
            at: at.to_array(),
            within,
        })
    });
    sound.collect()
}
