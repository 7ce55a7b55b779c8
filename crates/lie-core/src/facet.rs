//! Facets: where a fracture is evaluated, and how a surface load reaches the nodes.
//!
//! Facets are integrated at their nodes. Quadrature inside gives stiff joints the wrong sign of
//! traction behind a crack front (Schellekens & de Borst 1993), and nodes keep the response of a
//! fracture block-diagonal. Each node `a` gets the area vector `A_a = int N_a n dA`, so that a
//! uniform traction reaches the nodes exactly as from the rock: patch tests hold on any facet.
//!
//! On the six-node triangle and the eight-node quadrangle `int N_a n dA` of a corner is zero or
//! negative. These get one more point in their middle, and the nodes keep the rest,
//! `A_a = int N_a n dA - N_a(c) A_c`, which is positive: every node is controlled. The quadrangle's
//! middle takes 4/9, which makes Simpson's rule (corners 1/36, edges 1/9). The triangle's takes 1/3
//! (corners 1/27, edges 5/27). Any share passes patch tests; with shares from 0.2 to 0.4 a stiff
//! joint ahead of a crack has no traction of the wrong sign, while the closed rule of degree 3
//! (9/20) has some and the rule on edges alone (0) has many (`tests/physics/oscillation.rs`).
//!
//! That is more points than nodes, which a law that may be rigid cannot have: walls in contact at
//! all of them share their tractions in more than one way, and friction depends on how. Such laws
//! are evaluated at the control points of the facet's Bezier form, as many as nodes, with the
//! control values of the jump and the area vectors `A_q = int B_q n dA`, all positive (Tri6: 1/6
//! each; Quad8: corners 1/12, edges 1/6; Quad9: 1/9 each). A uniform traction still reaches the
//! nodes exactly, and walls that do not overlap at the control points do so nowhere on a facet, see
//! [`crate::bezier_function`]. Where a compliant law is integrated in this way it is of second
//! order, the rule above of third.

use glam::DVec3;
use kluft_mesh::Shape;

use crate::bezier::{bezier_function, control_value};
use crate::element::rule;

/// How a fracture is integrated over a facet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FacetQuadrature {
    /// At the nodes (and the middle of a six-node triangle or eight-node quadrangle).
    #[default]
    Nodal,
    /// At the control points of the Bezier form; on facets of first order these are the nodes.
    Control,
    /// At Gauss points, for comparison.
    Gauss,
}

/// A point where a fracture is evaluated.
#[derive(Debug, Clone, PartialEq)]
pub struct FacetRulePoint {
    /// Area vector it stands for (m^2).
    pub area: DVec3,
    /// Where a linear field is to be taken so that it does its exact work (m).
    pub position: DVec3,
    /// Local nodes and their factors in the jump of the point: shape functions, or those of a
    /// control value; zeros left out.
    pub nodes: Vec<(u8, f64)>,
}

/// Points of a facet with the given `nodes` (m); with all but Gauss's rule the first ones are those
/// of the nodes, in order.
pub fn facet_points(
    shape: Shape,
    nodes: &[DVec3],
    quadrature: FacetQuadrature,
) -> Vec<FacetRulePoint> {
    let gauss = gauss_points(shape, nodes);
    match quadrature {
        FacetQuadrature::Gauss => gauss,
        FacetQuadrature::Control => (0..nodes.len())
            .map(|node| control_point(shape, node, nodes[node], &gauss))
            .collect(),
        FacetQuadrature::Nodal => {
            let middle = middle_point(shape, nodes);
            (0..nodes.len())
                .map(|node| node_point(node, nodes[node], &gauss, middle.as_ref()))
                .chain(middle.clone())
                .collect()
        }
    }
}

/// `int N_a dA` (m^2) for all nodes of a facet, along the mean normal of the point: what a uniform
/// load puts on each node, as `(area, area vector)`.
pub fn load_areas(shape: Shape, nodes: &[DVec3]) -> Vec<(f64, DVec3)> {
    let mut areas = vec![(0.0, DVec3::ZERO); nodes.len()];
    for point in gauss_points(shape, nodes) {
        let size = point.area.length();
        for (local, value) in point.nodes {
            let sum = &mut areas[local as usize];
            sum.0 += value * size;
            sum.1 += value * point.area;
        }
    }
    areas
}

fn gauss_points(shape: Shape, nodes: &[DVec3]) -> Vec<FacetRulePoint> {
    let points = rule(shape).points.iter();
    points
        .map(|point| at(point.weight, &point.shape, &point.gradient, nodes))
        .collect()
}

/// `A = w (dx/dxi x dx/deta)`.
fn at(weight: f64, values: &[f64], gradients: &[DVec3], nodes: &[DVec3]) -> FacetRulePoint {
    let along = |axis: usize| -> DVec3 {
        nodes
            .iter()
            .zip(gradients)
            .map(|(x, gradient)| *x * gradient[axis])
            .sum()
    };
    let shares = values
        .iter()
        .enumerate()
        .filter(|(_, value)| **value != 0.0);
    FacetRulePoint {
        area: weight * along(0).cross(along(1)),
        position: nodes.iter().zip(values).map(|(x, value)| *x * *value).sum(),
        nodes: shares.map(|(local, value)| (local as u8, *value)).collect(),
    }
}

fn middle_point(shape: Shape, nodes: &[DVec3]) -> Option<FacetRulePoint> {
    let (middle, weight) = match shape {
        Shape::Tri6 => (DVec3::new(1.0 / 3.0, 1.0 / 3.0, 0.0), 0.5 / 3.0),
        Shape::Quad8 => (DVec3::ZERO, 4.0 * 4.0 / 9.0),
        _ => return None,
    };
    let basis = &rule(shape).basis;
    Some(at(
        weight,
        &basis.values(middle),
        &basis.gradients(middle),
        nodes,
    ))
}

/// The point of a node: its share of the facet less what the middle point takes over.
fn node_point(
    node: usize,
    fallback: DVec3,
    gauss: &[FacetRulePoint],
    middle: Option<&FacetRulePoint>,
) -> FacetRulePoint {
    let own = [(node as u8, 1.0)];
    let parts = gauss.iter().map(|point| (value(&own, point), point));
    let parts = parts.chain(middle.map(|point| (-value(&own, point), point)));
    gathered(parts, fallback, own.to_vec())
}

/// The control point of a node: the integral of its Bezier function.
fn control_point(
    shape: Shape,
    node: usize,
    fallback: DVec3,
    gauss: &[FacetRulePoint],
) -> FacetRulePoint {
    let function = bezier_function(shape, node);
    let parts = gauss.iter().map(|point| (value(&function, point), point));
    gathered(parts, fallback, control_value(shape, node))
}

/// `sum_a S_a N_a` at a point.
fn value(shares: &[(u8, f64)], point: &FacetRulePoint) -> f64 {
    let of_node = |node: u8| {
        let own = point.nodes.iter().find(|(local, _)| *local == node);
        own.map_or(0.0, |(_, value)| *value)
    };
    shares
        .iter()
        .map(|(node, share)| share * of_node(*node))
        .sum()
}

/// A point that takes shares of others; `position` is the barycentre of what it takes.
fn gathered<'a>(
    parts: impl Iterator<Item = (f64, &'a FacetRulePoint)>,
    fallback: DVec3,
    nodes: Vec<(u8, f64)>,
) -> FacetRulePoint {
    let (mut area, mut size, mut moment) = (DVec3::ZERO, 0.0, DVec3::ZERO);
    for (share, point) in parts {
        area += share * point.area;
        size += share * point.area.length();
        moment += share * point.area.length() * point.position;
    }
    FacetRulePoint {
        area,
        position: if size > 0.0 { moment / size } else { fallback },
        nodes,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const AT_NODES: [FacetQuadrature; 2] = [FacetQuadrature::Nodal, FacetQuadrature::Control];

    fn weights_are(shape: Shape, quadrature: FacetQuadrature, expected: &[f64]) {
        let points = facet_points(shape, &shape.reference_nodes(), quadrature);
        let whole: f64 = points.iter().map(|point| point.area.z).sum();
        assert_eq!(points.len(), expected.len());
        for (point, expected) in points.iter().zip(expected) {
            let found = point.area.z / whole;
            assert!(
                (found - expected).abs() < 1e-12,
                "{shape:?}: {found} {expected}"
            );
        }
    }

    #[test]
    fn control_weights_are_as_stated() {
        let same = |shape, expected: &[f64]| weights_are(shape, FacetQuadrature::Control, expected);
        same(Shape::Tri3, &[1.0 / 3.0; 3]);
        same(Shape::Quad4, &[0.25; 4]);
        same(Shape::Tri6, &[1.0 / 6.0; 6]);
        same(Shape::Quad8, &[[1.0 / 12.0; 4], [1.0 / 6.0; 4]].concat());
        same(Shape::Quad9, &[1.0 / 9.0; 9]);
    }

    #[test]
    fn nodal_weights_are_as_stated() {
        let same = |shape, expected: &[f64]| weights_are(shape, FacetQuadrature::Nodal, expected);
        same(Shape::Tri3, &[1.0 / 3.0; 3]);
        same(Shape::Quad4, &[0.25; 4]);
        let (corner, edge) = (1.0 / 27.0, 5.0 / 27.0);
        same(
            Shape::Tri6,
            &[corner, corner, corner, edge, edge, edge, 1.0 / 3.0],
        );
        let (corner, edge) = (1.0 / 36.0, 1.0 / 9.0);
        let simpson = [
            corner,
            corner,
            corner,
            corner,
            edge,
            edge,
            edge,
            edge,
            4.0 / 9.0,
        ];
        same(Shape::Quad8, &simpson);
        same(Shape::Quad9, &simpson);
    }

    /// `sum_q N_a(q) A_q = int N_a n dA`, on a warped facet too.
    #[test]
    fn a_uniform_traction_reaches_the_nodes_exactly() {
        for shape in Shape::FACETS {
            let bend = |x: DVec3| x + 0.2 * DVec3::new(x.x * x.y, 0.5 * x.y * x.y, x.x * x.x - x.y);
            let nodes: Vec<DVec3> = shape.reference_nodes().into_iter().map(bend).collect();
            let exact = load_areas(shape, &nodes);
            for quadrature in AT_NODES {
                let mut sums = vec![DVec3::ZERO; nodes.len()];
                for point in facet_points(shape, &nodes, quadrature) {
                    for (local, value) in point.nodes {
                        sums[local as usize] += value * point.area;
                    }
                }
                for (sum, (_, expected)) in sums.iter().zip(&exact) {
                    assert!((*sum - *expected).length() < 1e-14, "{shape:?}");
                }
            }
        }
    }

    /// `sum_q N_a(q) |A_q| x_q = int N_a x dA` on flat facets.
    #[test]
    fn a_linear_traction_reaches_the_nodes_exactly() {
        for shape in Shape::FACETS {
            let nodes = shape.reference_nodes();
            let moments = |quadrature: FacetQuadrature| {
                let mut sums = vec![DVec3::ZERO; nodes.len()];
                for point in facet_points(shape, &nodes, quadrature) {
                    for (local, value) in point.nodes {
                        sums[local as usize] += value * point.area.length() * point.position;
                    }
                }
                sums
            };
            let exact = moments(FacetQuadrature::Gauss);
            for quadrature in AT_NODES {
                for (sum, expected) in moments(quadrature).iter().zip(&exact) {
                    assert!((*sum - *expected).length() < 1e-14, "{shape:?}");
                }
            }
        }
    }
}
