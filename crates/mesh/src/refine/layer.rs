//! A mesh of the plane whose cells have been divided through their thickness as well.

use crate::draft::{Draft, Elements, TaggedElements};

/// Heights of the nodes, as parts of the thickness: cells of second order that have been halved
/// have nodes at quarters.
const PARTS: f64 = 4.0;

impl Draft {
    /// Leaves out the upper of two layers of cells, and makes the lower one as thick as both were.
    pub(super) fn keep_lower_layer(&mut self) {
        let heights = self.nodes.iter().map(|node| node[2]);
        let bounds = (f64::INFINITY, f64::NEG_INFINITY);
        let (low, high) = heights.fold(bounds, |(low, high), z| (low.min(z), high.max(z)));
        let part = |z: f64| (PARTS * (z - low) / (high - low)).round();
        let is_low: Vec<bool> = self
            .nodes
            .iter()
            .map(|node| part(node[2]) <= 0.5 * PARTS)
            .collect();
        self.cells = kept(&self.cells, &is_low);
        self.facets = kept(&self.facets, &is_low);
        let mut number = vec![0; is_low.len()];
        let mut count = 0;
        for (own, &is_low) in number.iter_mut().zip(&is_low) {
            *own = count;
            count += u32::from(is_low);
        }
        let mut is_kept = is_low.iter();
        self.node_tags
            .retain(|_| is_kept.next().is_some_and(|&is| is));
        let mut is_kept = is_low.iter();
        self.nodes.retain(|_| is_kept.next().is_some_and(|&is| is));
        for node in &mut self.nodes {
            node[2] = low + (high - low) * 2.0 * part(node[2]) / PARTS;
        }
        for elements in [&mut self.cells, &mut self.facets] {
            let nodes = elements.elements.nodes.iter_mut();
            nodes.for_each(|node| *node = number[*node as usize]);
        }
    }
}

/// The elements all of whose nodes are low.
fn kept(all: &TaggedElements, is_low: &[bool]) -> TaggedElements {
    let mut kept = TaggedElements {
        elements: Elements::new(),
        ..TaggedElements::default()
    };
    for element in 0..all.elements.len() {
        let nodes = all.elements.nodes_of(element);
        if nodes.iter().all(|&node| is_low[node as usize]) {
            kept.elements.push(all.elements.shapes[element], nodes);
            kept.tags.push(all.tags[element]);
            kept.group_set.push(all.group_set[element]);
        }
    }
    kept
}
