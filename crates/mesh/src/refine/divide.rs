//! Divides every element of a draft once.

use std::ops::Range;

use glam::DVec3;
use rayon::prelude::*;

use super::division::{Between, Child, DIAGONALS, NewNode, division};
use super::numbering::{Asked, Numbers, Wishes};
use crate::draft::{Draft, Elements, TaggedElements};
use crate::shape::Shape;

/// Elements that one task divides.
const ELEMENTS_PER_TASK: usize = 4096;
/// Numbers of children are one digit.
pub(super) const CHILDREN: u64 = 10;
/// A child has fewer middles.
const MIDDLES: u32 = 32;

/// Divides every cell and every facet; nodes keep their numbers, and new ones follow. The tag of a
/// child is that of its parent with a digit behind, tags of new nodes follow the highest. If there
/// are more nodes than numbers, the error is how many.
pub(super) fn divide(draft: &mut Draft) -> Result<(), u64> {
    let count = draft.cells.elements.len() + draft.facets.elements.len();
    let parents = Parents {
        cells: &draft.cells.elements,
        facets: &draft.facets.elements,
    };
    let ask = |element: u32, wishes: &mut Wishes| parents.ask(element, wishes);
    let (missing, asked) = Numbers::of(count, draft.nodes.len(), ask)?;
    let new = at_shares(&asked, &draft.nodes, |asked| parents.missing(asked));
    draft.nodes.extend(new);
    let completed = Completed {
        parents,
        missing,
        places: &draft.nodes,
        tags: &draft.node_tags,
    };
    let ask = |element: u32, wishes: &mut Wishes| completed.ask(element, wishes);
    let (middles, asked) = Numbers::of(count, draft.nodes.len(), ask)?;
    let new = at_shares(&asked, &draft.nodes, |asked| completed.middle(asked));
    let children = |parents: &TaggedElements, first: usize| {
        let cut = Cut {
            completed: &completed,
            middles: &middles,
            parents,
            first: first as u32,
        };
        cut.children()
    };
    let cells = children(&draft.cells, 0);
    let facets = children(&draft.facets, draft.cells.elements.len());
    draft.cells = cells;
    draft.facets = facets;
    draft.nodes.extend(new);
    let next = draft.node_tags.iter().max().map_or(1, |tag| tag + 1);
    let missing = draft.nodes.len() - draft.node_tags.len();
    draft.node_tags.extend(next..next + missing as u64);
    Ok(())
}

/// Where new nodes lie.
fn at_shares<'a>(
    asked: &[Asked],
    places: &[[f64; 3]],
    node: impl Fn(Asked) -> (&'a NewNode, [u32; 27]) + Sync,
) -> Vec<[f64; 3]> {
    let at = |&asked: &Asked| {
        let (node, of_element) = node(asked);
        let shares = node.shares.iter();
        let parts = shares.map(|&(local, share)| {
            let parent = of_element[local as usize];
            share * DVec3::from(places[parent as usize])
        });
        parts.sum::<DVec3>().to_array()
    };
    asked.par_iter().map(at).collect()
}

/// The elements that are divided: cells, and facets behind them.
#[derive(Clone, Copy)]
struct Parents<'a> {
    cells: &'a Elements,
    facets: &'a Elements,
}

impl<'a> Parents<'a> {
    fn shape_and_nodes(self, element: u32) -> (Shape, &'a [u32]) {
        let element = element as usize;
        let (elements, own) = match element.checked_sub(self.cells.len()) {
            None => (self.cells, element),
            Some(facet) => (self.facets, facet),
        };
        (elements.shapes[own], elements.nodes_of(own))
    }

    /// Asks for the nodes that an element needs to be complete.
    fn ask(self, element: u32, wishes: &mut Wishes) {
        let (shape, nodes) = self.shape_and_nodes(element);
        for (place, node) in (0..).zip(&division(shape).missing) {
            ask_for(node, nodes, Asked { element, place }, wishes);
        }
    }

    fn missing(self, asked: Asked) -> (&'static NewNode, [u32; 27]) {
        let (shape, nodes) = self.shape_and_nodes(asked.element);
        let node = &division(shape).missing[asked.place as usize];
        (node, padded(nodes))
    }
}

fn padded(nodes: &[u32]) -> [u32; 27] {
    let mut all = [0; 27];
    all[..nodes.len()].copy_from_slice(nodes);
    all
}

fn ask_for(node: &NewNode, nodes: &[u32], asked: Asked, wishes: &mut Wishes) {
    match node.between {
        Between::Edge(ends) => wishes.edge(ends.map(|local| nodes[local as usize]), asked),
        Between::Face(corners) => wishes.face(corners.map(|local| nodes[local as usize]), asked),
    }
}

fn number_of(node: &NewNode, nodes: &[u32], numbers: &Numbers) -> u32 {
    match node.between {
        Between::Edge(ends) => numbers.edge(ends.map(|local| nodes[local as usize])),
        Between::Face(corners) => numbers.face(corners.map(|local| nodes[local as usize])),
    }
}

/// The elements with all middles, which are the corners of the children.
struct Completed<'a> {
    parents: Parents<'a>,
    missing: Numbers,
    places: &'a [[f64; 3]],
    tags: &'a [u64],
}

impl Completed<'_> {
    fn nodes(&self, element: u32) -> (Shape, [u32; 27]) {
        let (shape, own) = self.parents.shape_and_nodes(element);
        let mut nodes = padded(own);
        for (place, node) in division(shape).missing.iter().enumerate() {
            nodes[own.len() + place] = number_of(node, own, &self.missing);
        }
        (shape, nodes)
    }

    /// The children of an element of these nodes.
    fn cut(&self, shape: Shape, nodes: &[u32; 27]) -> &'static [Child] {
        let children = &division(shape).children;
        match children.as_slice() {
            [only] => only,
            _ => &children[self.diagonal(nodes)],
        }
    }

    /// The shortest diagonal of the octahedron in a tetrahedron; of several that of the corner with
    /// the lowest tag and of its partner with the lowest.
    fn diagonal(&self, nodes: &[u32; 27]) -> usize {
        let place = |local: u8| DVec3::from(self.places[nodes[local as usize] as usize]);
        let lengths = DIAGONALS.map(|([from, to], _)| place(from).distance_squared(place(to)));
        let shortest = lengths.into_iter().fold(f64::INFINITY, f64::min);
        let tied = (0..DIAGONALS.len()).filter(|&diagonal| lengths[diagonal] <= shortest);
        tied.min_by_key(|&diagonal| self.partner(nodes, DIAGONALS[diagonal].1))
            .unwrap_or(0)
    }

    /// Tag of the corner that shares an edge with that of the lowest tag, where corner 0 shares
    /// one with `of_first`, and the other two the opposite one.
    fn partner(&self, nodes: &[u32; 27], of_first: u8) -> u64 {
        let tag = |local: u8| self.tags[nodes[local as usize] as usize];
        let others = (1..4).filter(|&local| local != of_first);
        let opposite: Vec<u64> = others.map(tag).collect();
        let mut edges = [[tag(0), tag(of_first)], [opposite[0], opposite[1]]];
        edges.iter_mut().for_each(|edge| edge.sort_unstable());
        edges[0].min(edges[1])[1]
    }

    /// Asks for the nodes between the corners of all children.
    fn ask(&self, element: u32, wishes: &mut Wishes) {
        if !self.parents.shape_and_nodes(element).0.is_quadratic() {
            return;
        }
        let (shape, nodes) = self.nodes(element);
        for (number, child) in (0..).zip(self.cut(shape, &nodes)) {
            for (middle, node) in (0..).zip(&child.middles) {
                let place = number * MIDDLES + middle;
                ask_for(node, &nodes, Asked { element, place }, wishes);
            }
        }
    }

    fn middle(&self, asked: Asked) -> (&'static NewNode, [u32; 27]) {
        let (shape, nodes) = self.nodes(asked.element);
        let child = &self.cut(shape, &nodes)[(asked.place / MIDDLES) as usize];
        (&child.middles[(asked.place % MIDDLES) as usize], nodes)
    }
}

/// Cells or facets on the way to their children.
struct Cut<'a> {
    completed: &'a Completed<'a>,
    middles: &'a Numbers,
    parents: &'a TaggedElements,
    /// Number of the first of them among all elements.
    first: u32,
}

/// Where the children of some elements go.
struct Room<'a> {
    parents: Range<usize>,
    first_node: usize,
    shapes: &'a mut [Shape],
    ends: &'a mut [u32],
    nodes: &'a mut [u32],
    tags: &'a mut [u64],
    group_set: &'a mut [u32],
}

impl Cut<'_> {
    fn children(&self) -> TaggedElements {
        let sizes: Vec<(usize, usize)> = self
            .parents
            .elements
            .shapes
            .par_chunks(ELEMENTS_PER_TASK)
            .map(size)
            .collect();
        let count: usize = sizes.iter().map(|size| size.0).sum();
        let end: usize = sizes.iter().map(|size| size.1).sum();
        let mut all = TaggedElements {
            elements: Elements {
                shapes: vec![Shape::Tet4; count],
                offsets: vec![0; count + 1],
                nodes: vec![0; end],
            },
            tags: vec![0; count],
            group_set: vec![0; count],
        };
        let rooms = rooms(&mut all, &sizes, self.parents.elements.len());
        rooms.into_par_iter().for_each(|room| self.fill(room));
        all
    }

    fn fill(&self, room: Room<'_>) {
        let (mut child_number, mut node_number) = (0, 0);
        for parent in room.parents {
            let (shape, nodes) = self.completed.nodes(self.first + parent as u32);
            let children = self.completed.cut(shape, &nodes);
            let tag = self.parents.tags[parent];
            for (digit, child) in (0..).zip(children) {
                let corners = child.corners.iter().map(|&local| nodes[local as usize]);
                let middles = child.middles.iter();
                let middles = middles.map(|node| number_of(node, &nodes, self.middles));
                let width = child.shape.node_count();
                let own = &mut room.nodes[node_number..node_number + width];
                for (place, node) in own.iter_mut().zip(corners.chain(middles)) {
                    *place = node;
                }
                node_number += width;
                room.shapes[child_number] = child.shape;
                room.ends[child_number] = (room.first_node + node_number) as u32;
                room.tags[child_number] = CHILDREN * tag + digit;
                room.group_set[child_number] = self.parents.group_set[parent];
                child_number += 1;
            }
        }
    }
}

/// Number of children of some elements, and of nodes of these.
fn size(parents: &[Shape]) -> (usize, usize) {
    let mut size = (0, 0);
    for alike in parents.chunk_by(|a, b| a == b) {
        let children = &division(alike[0]).children[0];
        let widths = children.iter().map(|child| child.shape.node_count());
        size.0 += alike.len() * children.len();
        size.1 += alike.len() * widths.sum::<usize>();
    }
    size
}

/// Cuts the lists of all children into those of tasks.
fn rooms<'a>(
    all: &'a mut TaggedElements,
    sizes: &[(usize, usize)],
    parent_count: usize,
) -> Vec<Room<'a>> {
    let mut shapes = all.elements.shapes.as_mut_slice();
    let mut ends = &mut all.elements.offsets[1..];
    let mut nodes = all.elements.nodes.as_mut_slice();
    let mut tags = all.tags.as_mut_slice();
    let mut group_set = all.group_set.as_mut_slice();
    let mut first_node = 0;
    let mut first = 0;
    let mut cut = |&(count, width): &(usize, usize)| {
        let parents = first..parent_count.min(first + ELEMENTS_PER_TASK);
        first = parents.end;
        let room = Room {
            parents,
            first_node,
            shapes: shapes.split_off_mut(..count).unwrap_or_default(),
            ends: ends.split_off_mut(..count).unwrap_or_default(),
            nodes: nodes.split_off_mut(..width).unwrap_or_default(),
            tags: tags.split_off_mut(..count).unwrap_or_default(),
            group_set: group_set.split_off_mut(..count).unwrap_or_default(),
        };
        first_node += width;
        room
    };
    sizes.iter().map(&mut cut).collect()
}
