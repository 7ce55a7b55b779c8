//! Cells, facets and lines cut at their marked edges.

use std::collections::BTreeMap;

use glam::DVec3;
use rayon::prelude::*;

use super::edges::{Edges, NONE};
use crate::draft::{Draft, Elements, TaggedElements};
use crate::refine::map::simplex;
use crate::shape::Shape;

/// A part of an element: for each of its corners a corner of the parent, or, counted on from these,
/// the middle of one of its edges.
type Part<const CORNERS: usize> = [u8; CORNERS];

/// Cuts a draft at its marked edges; returns the targets of the parts.
pub(super) fn divide(
    draft: &mut Draft,
    edges: &Edges,
    marked: &[bool],
    targets: &[f64],
) -> Vec<f64> {
    let mut new = NewNodes {
        next_tag: draft.node_tags.iter().max().map_or(1, |tag| tag + 1),
        middles: BTreeMap::new(),
    };
    let middles = middles(draft, (edges, marked), &mut new);
    let cells: Vec<Vec<Part<4>>> = edges
        .of_cell
        .par_iter()
        .map(|own| parts(Shape::Tet4, own, (edges, marked)))
        .collect();
    let facets: Vec<Vec<Part<3>>> = edges
        .of_facet
        .par_iter()
        .map(|own| parts(Shape::Tri3, own, (edges, marked)))
        .collect();
    let old = std::mem::take(&mut draft.cells);
    draft.cells = cut(draft, &old, (&cells, &edges.of_cell), &middles, &mut new);
    let old = std::mem::take(&mut draft.facets);
    draft.facets = cut(draft, &old, (&facets, &edges.of_facet), &middles, &mut new);
    let lines = edges.of_line.iter();
    let lines: Vec<Vec<Part<2>>> = lines
        .map(|own| parts(Shape::Line2, own, (edges, marked)))
        .collect();
    let old = std::mem::take(&mut draft.lines);
    draft.lines = cut(draft, &old, (&lines, &edges.of_line), &middles, &mut new);
    match cells.is_empty() {
        true => inherited(targets, &facets),
        false => inherited(targets, &cells),
    }
}

/// The target of each part: that of its parent.
fn inherited<const CORNERS: usize>(targets: &[f64], parts: &[Vec<Part<CORNERS>>]) -> Vec<f64> {
    let pairs = targets.iter().zip(parts);
    pairs
        .flat_map(|(target, parts)| std::iter::repeat_n(*target, parts.len()))
        .collect()
}

/// The node in the middle of each marked edge: a new one, or that of an edge of second order.
fn middles(draft: &mut Draft, (edges, marked): (&Edges, &[bool]), new: &mut NewNodes) -> Vec<u32> {
    let mut middles = vec![NONE; marked.len()];
    match draft.is_plane() {
        true => known_middles(&draft.facets.elements, &edges.of_facet, &mut middles),
        false => known_middles(&draft.cells.elements, &edges.of_cell, &mut middles),
    }
    for (edge, ends) in edges.ends.iter().enumerate() {
        if marked[edge] && middles[edge] == NONE {
            let [a, b] = ends.map(|end| DVec3::from(draft.nodes[end as usize]));
            middles[edge] = new.add(draft, 0.5 * (a + b));
        }
    }
    middles
}

/// Takes the nodes between the corners of elements of second order for those of their edges.
fn known_middles<const EDGES: usize>(
    elements: &Elements,
    edges: &[[u32; EDGES]],
    middles: &mut [u32],
) {
    for (element, own) in edges.iter().enumerate() {
        let shape = elements.shapes[element];
        if shape.is_quadratic() {
            let known = &elements.nodes_of(element)[shape.corner_count()..];
            for (edge, &middle) in own.iter().zip(known) {
                middles[*edge as usize] = middle;
            }
        }
    }
}

/// Parts of an element with these edges: at each marked edge, the longest first, the part that has
/// it is cut into two, which turn as the whole does.
fn parts<const CORNERS: usize>(
    shape: Shape,
    own: &[u32],
    (edges, marked): (&Edges, &[bool]),
) -> Vec<Part<CORNERS>> {
    let is_marked = |edge: &usize| own[*edge] != NONE && marked[own[*edge] as usize];
    let mut cuts: Vec<usize> = (0..own.len()).filter(is_marked).collect();
    cuts.sort_by_key(|&edge| std::cmp::Reverse(edges.rank[own[edge] as usize]));
    let mut parts = vec![std::array::from_fn(|corner| corner as u8)];
    for edge in cuts {
        let middle = (CORNERS + edge) as u8;
        let [a, b] = shape.edges()[edge];
        parts = parts
            .into_iter()
            .flat_map(|part: Part<CORNERS>| {
                let has = |corner: u8| part.contains(&corner);
                let with_middle_at =
                    |corner: u8| part.map(|own| if own == corner { middle } else { own });
                match has(a) && has(b) {
                    true => vec![with_middle_at(b), with_middle_at(a)],
                    false => vec![part],
                }
            })
            .collect();
    }
    parts
}

/// Nodes that are added.
struct NewNodes {
    next_tag: u64,
    /// Middles of edges that no element had before, by the ends.
    middles: BTreeMap<[u32; 2], u32>,
}

impl NewNodes {
    fn add(&mut self, draft: &mut Draft, at: DVec3) -> u32 {
        draft.nodes.push(at.to_array());
        draft.node_tags.push(self.next_tag);
        self.next_tag += 1;
        draft.nodes.len() as u32 - 1
    }
}

/// The parts of all elements as elements.
fn cut<const CORNERS: usize, const EDGES: usize>(
    draft: &mut Draft,
    old: &TaggedElements,
    (parts, edges): (&[Vec<Part<CORNERS>>], &[[u32; EDGES]]),
    middles: &[u32],
    new: &mut NewNodes,
) -> TaggedElements {
    let mut made = TaggedElements::new();
    let mut last_tag = old.tags.iter().max().copied().unwrap_or(0);
    for (element, parts) in parts.iter().enumerate() {
        let parent = Parent {
            elements: &old.elements,
            element,
            middles: edges[element].map(|edge| middles.get(edge as usize).copied()),
        };
        for (number, part) in parts.iter().enumerate() {
            let nodes = match parts.len() {
                1 => old.elements.nodes_of(element).to_vec(),
                _ => parent.nodes_of(part, draft, new),
            };
            made.elements.push(old.elements.shapes[element], &nodes);
            made.group_set.push(old.group_set[element]);
            made.tags.push(match number {
                0 => old.tags[element],
                _ => {
                    last_tag += 1;
                    last_tag
                }
            });
        }
    }
    made
}

/// An element that is cut, with the nodes in the middles of its edges.
struct Parent<'a, const EDGES: usize> {
    elements: &'a Elements,
    element: usize,
    middles: [Option<u32>; EDGES],
}

impl<const EDGES: usize> Parent<'_, EDGES> {
    /// The nodes of a part, as the shape of the element counts them.
    fn nodes_of<const CORNERS: usize>(
        &self,
        part: &Part<CORNERS>,
        draft: &mut Draft,
        new: &mut NewNodes,
    ) -> Vec<u32> {
        let own = self.elements.nodes_of(self.element);
        let shape = self.elements.shapes[self.element];
        let node = |at: u8| match (at as usize).checked_sub(CORNERS) {
            None => own[at as usize],
            Some(edge) => self.middles[edge].unwrap_or(NONE),
        };
        let mut nodes: Vec<u32> = part.iter().map(|&at| node(at)).collect();
        if shape.is_quadratic() {
            for &[a, b] in shape.edges() {
                let ends = [part[a as usize], part[b as usize]];
                nodes.push(self.middle(ends, ends.map(node), draft, new));
            }
        }
        nodes
    }

    /// The node between two corners of a part: that of an edge which stays, or a new one where the
    /// map of the parent has it.
    fn middle(
        &self,
        places: [u8; 2],
        ends: [u32; 2],
        draft: &mut Draft,
        new: &mut NewNodes,
    ) -> u32 {
        let shape = self.elements.shapes[self.element];
        let own = self.elements.nodes_of(self.element);
        let corners = shape.corner_count();
        let is_whole = |edge: &[u8; 2]| *edge == places || *edge == [places[1], places[0]];
        if let Some(edge) = shape.edges().iter().position(is_whole) {
            return own[corners + edge];
        }
        let key = [ends[0].min(ends[1]), ends[0].max(ends[1])];
        if let Some(&known) = new.middles.get(&key) {
            return known;
        }
        let shares = simplex(shape, &between(shape, places));
        let terms = shares.iter().zip(own);
        let at = terms.map(|(share, &node)| *share * DVec3::from(draft.nodes[node as usize]));
        let node = new.add(draft, at.sum());
        new.middles.insert(key, node);
        node
    }
}

/// Barycentric coordinates of the middle between two places of a part.
fn between(shape: Shape, places: [u8; 2]) -> Vec<f64> {
    let corners = shape.corner_count();
    let mut coordinates = vec![0.0; corners];
    for place in places {
        match (place as usize).checked_sub(corners) {
            None => coordinates[place as usize] += 0.5,
            Some(edge) => shape.edges()[edge]
                .iter()
                .for_each(|&end| coordinates[end as usize] += 0.25),
        }
    }
    coordinates
}
