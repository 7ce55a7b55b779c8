//! How each shape is divided: its children and the nodes that they need, by table.

use std::sync::OnceLock;

use glam::DVec3;

use super::map::{serendipity, shares};
use crate::shape::Shape;

/// What a new node is known by: all elements that meet there name the same nodes.
#[derive(Debug, Clone, Copy)]
pub(super) enum Between {
    /// The ends of an edge.
    Edge([u8; 2]),
    /// The corners of a quadrangle; for the middle of a hexahedron four of its corners no two of
    /// which share an edge, for no face has those.
    Face([u8; 4]),
}

/// A node that dividing makes; node numbers are local ones of the completed parent.
#[derive(Debug, Clone)]
pub(super) struct NewNode {
    /// What it is known by.
    pub(super) between: Between,
    /// Where it lies: shares of nodes of the parent.
    pub(super) shares: Vec<(u8, f64)>,
}

/// A part of an element.
#[derive(Debug, Clone)]
pub(super) struct Child {
    /// Its shape, of the order of the parent.
    pub(super) shape: Shape,
    /// Its corners: local numbers of the completed parent.
    pub(super) corners: Vec<u8>,
    /// Its other nodes, in order.
    pub(super) middles: Vec<NewNode>,
}

/// How elements of a shape are divided: first completed by middles of edges, quadrangles and
/// hexahedra, which are the corners of the children, then cut.
#[derive(Debug, Clone)]
pub(super) struct Division {
    /// The nodes without which the element is not complete, in order.
    pub(super) missing: Vec<NewNode>,
    /// The children; of a tetrahedron for each of [`DIAGONALS`].
    pub(super) children: Vec<Vec<Child>>,
}

/// Diagonals of the octahedron inside a tetrahedron, each between the middles of two edges, of
/// which the first holds corner 0; and the corner at its other end.
pub(super) const DIAGONALS: [([u8; 2], u8); 3] = [([4, 8], 1), ([6, 9], 2), ([7, 5], 3)];

/// The division of a shape, computed once.
pub(super) fn division(shape: Shape) -> &'static Division {
    static DIVISIONS: [OnceLock<Division>; 16] = [const { OnceLock::new() }; 16];
    DIVISIONS[shape as usize].get_or_init(|| Division::of(shape))
}

impl Division {
    fn of(shape: Shape) -> Self {
        let complete = shape.complete();
        let missing = shape.node_count()..complete.node_count();
        let children = inner(complete).into_iter().map(|inner| {
            let at_corners = at_corners(complete).map(|corners| (shape, corners));
            let inner = inner
                .into_iter()
                .map(|corners| (same_order(shape, corners.len()), corners));
            let all = at_corners.chain(inner);
            all.map(|(own, corners)| child(complete, own, corners))
                .collect()
        });
        Self {
            missing: missing.map(|local| missing_node(shape, local)).collect(),
            children: children.collect(),
        }
    }
}

/// A node of the completed shape that the shape itself has not.
fn missing_node(shape: Shape, local: usize) -> NewNode {
    let members = shape.complete().members(local);
    let equal = 1.0 / members.len() as f64;
    NewNode {
        between: between(&members),
        shares: match shape.is_quadratic() {
            true => serendipity(&members, shape.edges()),
            false => members.iter().map(|&corner| (corner, equal)).collect(),
        },
    }
}

fn between(members: &[u8]) -> Between {
    match *members {
        [a, b] => Between::Edge([a, b]),
        [a, b, c, d] => Between::Face([a, b, c, d]),
        [a, _, c, _, _, f, _, h] => Between::Face([a, c, f, h]),
        _ => unreachable!("edges, quadrangles and hexahedra have middles"),
    }
}

/// The children at the corners: the parent, half as large.
fn at_corners(complete: Shape) -> impl Iterator<Item = Vec<u8>> {
    let corners = 0..complete.corner_count() as u8;
    let ends = corners.clone();
    corners.map(move |corner| {
        let halfway = |end| middle(complete, [corner, end]);
        ends.clone().map(halfway).collect()
    })
}

/// The node halfway between two corners.
fn middle(complete: Shape, ends: [u8; 2]) -> u8 {
    let mut nodes = 0..complete.node_count();
    let between = nodes.find(|&local| {
        let members = complete.members(local);
        ends.iter().all(|end| members.contains(end))
    });
    between.map_or(ends[0], |local| local as u8)
}

/// The corners of the children that lie at none of the corners, for each way to cut.
fn inner(complete: Shape) -> Vec<Vec<Vec<u8>>> {
    let lists = |children: &[&[u8]]| children.iter().map(|child| child.to_vec()).collect();
    match complete {
        Shape::Tri6 => vec![lists(&[&[3, 4, 5]])],
        Shape::Tet10 => vec![
            around([4, 8], [5, 6, 7, 9]),
            around([6, 9], [4, 5, 8, 7]),
            around([7, 5], [4, 6, 8, 9]),
        ],
        Shape::Prism18 => vec![lists(&[&[6, 9, 7, 15, 17, 16], &[15, 17, 16, 12, 14, 13]])],
        Shape::Pyramid14 => vec![lists(&[
            &[7, 12, 11, 9, 13],
            &[5, 7, 9, 13],
            &[8, 9, 11, 13],
            &[10, 11, 12, 13],
            &[6, 12, 7, 13],
        ])],
        _ => vec![Vec::new()],
    }
}

/// Four tetrahedra around a diagonal; the ring runs clockwise seen against it.
fn around([from, to]: [u8; 2], ring: [u8; 4]) -> Vec<Vec<u8>> {
    let sides = (0..4).map(|side| vec![from, to, ring[side], ring[(side + 1) % 4]]);
    sides.collect()
}

/// The shape of a child with so many corners.
fn same_order(parent: Shape, corners: usize) -> Shape {
    let is_tetrahedron = corners == 4 && parent.dimension() == 3;
    match (is_tetrahedron, parent.is_quadratic()) {
        (true, false) => Shape::Tet4,
        (true, true) => Shape::Tet10,
        (false, _) => parent,
    }
}

fn child(complete: Shape, shape: Shape, corners: Vec<u8>) -> Child {
    let places = complete.reference_nodes();
    let middle = |local: usize| {
        let members = shape.members(local);
        let members: Vec<u8> = members.iter().map(|&own| corners[own as usize]).collect();
        let sum: DVec3 = members.iter().map(|&local| places[local as usize]).sum();
        let of_nodes = shares(complete, sum / members.len() as f64);
        let named = (0..).zip(of_nodes);
        NewNode {
            between: between(&members),
            shares: named.filter(|(_, share)| *share != 0.0).collect(),
        }
    };
    let middles = shape.corner_count()..shape.node_count();
    Child {
        middles: middles.map(middle).collect(),
        shape,
        corners,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{cell_volume, facet_area_vector};

    #[test]
    fn children_fill_their_parent() {
        for shape in Shape::CELLS.into_iter().chain(Shape::FACETS) {
            let nodes = shape.complete().reference_nodes();
            let size = |shape: Shape, corners: &[DVec3]| match shape.dimension() {
                2 => facet_area_vector(corners).z,
                _ => cell_volume(shape, corners),
            };
            let whole = size(shape, &nodes[..shape.corner_count()]);
            for children in &division(shape).children {
                let sizes = children.iter().map(|child| {
                    let corners: Vec<DVec3> =
                        child.corners.iter().map(|&l| nodes[l as usize]).collect();
                    size(child.shape, &corners)
                });
                let sizes: Vec<f64> = sizes.collect();
                assert!(sizes.iter().all(|size| *size > 0.0), "{shape:?} {sizes:?}");
                let sum: f64 = sizes.iter().sum();
                assert!((sum - whole).abs() < 1e-15, "{shape:?}");
                let count = match (shape.dimension(), shape.corner_count()) {
                    (2, _) => 4,
                    (_, 5) => 10,
                    _ => 8,
                };
                assert_eq!(children.len(), count, "{shape:?}");
            }
        }
    }

    #[test]
    fn diagonals_are_those_of_the_tables() {
        let tables = &division(Shape::Tet4).children;
        for (([from, to], partner), children) in DIAGONALS.into_iter().zip(tables) {
            assert_eq!(Shape::Tet10.members(from as usize), [0, partner]);
            for child in &children[4..] {
                assert_eq!(child.corners[..2], [from, to]);
            }
        }
    }
}
