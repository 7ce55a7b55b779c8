//! Elements by table: shape functions and their gradients at the points of a quadrature rule.

use std::sync::OnceLock;

use glam::DVec3;
use lie_mesh::Shape;

/// One quadrature point of a cell.
#[derive(Debug, Clone)]
pub struct RulePoint {
    /// Weight; the weights of a rule add up to the volume of the reference cell.
    pub weight: f64,
    /// Value of each node's shape function.
    pub shape: Vec<f64>,
    /// Gradient of each node's shape function in reference coordinates.
    pub gradient: Vec<DVec3>,
}

/// Quadrature rule of a cell shape, exact for the stiffness of an affine cell.
#[derive(Debug, Clone)]
pub struct ElementRule {
    /// Its points.
    pub points: Vec<RulePoint>,
}

/// The rule of a cell shape.
///
/// # Panics
/// If `shape` is a facet.
pub fn rule(shape: Shape) -> &'static ElementRule {
    static TET4: OnceLock<ElementRule> = OnceLock::new();
    match shape {
        Shape::Tet4 => TET4.get_or_init(tet4),
        Shape::Tri3 => unreachable!("facets are integrated at their nodes"),
    }
}

/// Reference tetrahedron `0, e_x, e_y, e_z`, one point at the centroid (exact to degree 1).
fn tet4() -> ElementRule {
    let gradient = vec![-DVec3::ONE, DVec3::X, DVec3::Y, DVec3::Z];
    ElementRule {
        points: vec![RulePoint {
            weight: 1.0 / 6.0,
            shape: vec![0.25; 4],
            gradient,
        }],
    }
}

/// Share of a facet's area that each of its nodes stands for: facets are integrated at their
/// nodes, because quadrature inside gives stiff joints the wrong sign of traction behind a front
/// (Schellekens & de Borst 1993).
pub fn facet_node_weights(shape: Shape) -> &'static [f64] {
    match shape {
        Shape::Tri3 => &[1.0 / 3.0; 3],
        Shape::Tet4 => unreachable!("a cell is not a facet"),
    }
}

/// For each node of a facet the barycentre of its shape function, `int N_a x dA / int N_a dA`, as
/// weights of the facet's nodes. A linear field taken there and lumped at the nodes does exactly
/// the work of the field itself.
pub fn facet_node_centroids(shape: Shape) -> &'static [&'static [f64]] {
    match shape {
        Shape::Tri3 => &[&[0.5, 0.25, 0.25], &[0.25, 0.5, 0.25], &[0.25, 0.25, 0.5]],
        Shape::Tet4 => unreachable!("a cell is not a facet"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shape_functions_sum_to_one_and_gradients_to_zero() {
        for point in &rule(Shape::Tet4).points {
            assert!((point.shape.iter().sum::<f64>() - 1.0).abs() < 1e-15);
            assert!(point.gradient.iter().sum::<DVec3>().length() < 1e-15);
        }
        let area: f64 = facet_node_weights(Shape::Tri3).iter().sum();
        assert!((area - 1.0).abs() < 1e-15);
    }
}
