//! Flow along one facet: what a pressure at its corners drives through them.
//!
//! Pressure is linear on triangles and bilinear on quadrangles, on facets of second order too, of
//! which the corners carry it, and the straight lines between them. With the shape functions `N_i`
//! of the corners and gradients along the facet,
//!
//! ```text
//! k_ij = int grad N_i . grad N_j dA,    Q_i = T sum_j k_ij (phi_j - phi_i)
//! ```
//!
//! is the rate that enters the facet from the other nodes' share of it. Rates are differences of
//! potentials, so that what is at rest stays so to the last bit, and the rates of a facet add up to
//! zero as far as rounding lets them: nothing is lost between facets. On triangles this is a method
//! of control volumes around the nodes (Bank & Rose 1987).

use glam::DVec3;
use kluft_mesh::Shape;

use crate::element::rule;

/// Most corners of a facet.
const CORNERS: usize = 4;

/// The stencil of a facet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FacetFlow {
    corners: usize,
    /// `k_ij`, without a unit.
    coupling: [[f64; CORNERS]; CORNERS],
    /// `int grad N_i dA` (m).
    gradients: [DVec3; CORNERS],
    /// Area (m^2).
    area: f64,
}

impl FacetFlow {
    /// The stencil of a facet of a shape with corners at these places (m).
    pub fn of(shape: Shape, corners: &[DVec3]) -> Self {
        let linear = match shape.corner_count() {
            3 => Shape::Tri3,
            _ => Shape::Quad4,
        };
        let mut flow = Self {
            corners: corners.len(),
            coupling: [[0.0; CORNERS]; CORNERS],
            gradients: [DVec3::ZERO; CORNERS],
            area: 0.0,
        };
        for point in &rule(linear).points {
            flow.add(point.weight, &point.gradient, corners);
        }
        flow
    }

    /// Adds a quadrature point, of which the gradients in reference coordinates are known.
    fn add(&mut self, weight: f64, reference: &[DVec3], corners: &[DVec3]) {
        let along = |axis: usize| -> DVec3 {
            let terms = corners.iter().zip(reference);
            terms.map(|(x, gradient)| *x * gradient[axis]).sum()
        };
        let (a, b) = (along(0), along(1));
        let normal = a.cross(b);
        let square = normal.length_squared();
        // The dual basis of the tangents.
        let dual = [b.cross(normal) / square, normal.cross(a) / square];
        let gradient = |i: usize| reference[i].x * dual[0] + reference[i].y * dual[1];
        let size = weight * square.sqrt();
        self.area += size;
        for i in 0..self.corners {
            self.gradients[i] += size * gradient(i);
            for j in 0..self.corners {
                self.coupling[i][j] += size * gradient(i).dot(gradient(j));
            }
        }
    }

    /// Number of corners.
    pub fn corners(&self) -> usize {
        self.corners
    }

    /// `k_ij`: negative where a higher potential at one corner drives fluid to the other; positive
    /// opposite an obtuse angle.
    pub fn coupling(&self, i: usize, j: usize) -> f64 {
        self.coupling[i][j]
    }

    /// Area (m^2).
    pub fn area(&self) -> f64 {
        self.area
    }

    /// Mean gradient (Pa/m) along the facet of a potential at its corners (Pa).
    pub fn mean_gradient(&self, potential: &[f64]) -> DVec3 {
        let differences = potential.iter().map(|value| value - potential[0]);
        let terms = differences.zip(self.gradients);
        terms
            .map(|(value, gradient)| value * gradient)
            .sum::<DVec3>()
            / self.area
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tilted(x: f64, y: f64) -> DVec3 {
        DVec3::new(0.3, -1.0, 2.0) + x * DVec3::new(0.6, 0.0, 0.8) + y * DVec3::new(0.0, 1.0, 0.0)
    }

    #[test]
    fn a_square_couples_its_corners_as_in_the_textbook() {
        let corners = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]].map(|[x, y]| tilted(x, y));
        let flow = FacetFlow::of(Shape::Quad9, &corners);
        let row = [2.0 / 3.0, -1.0 / 6.0, -1.0 / 3.0, -1.0 / 6.0];
        for (j, expected) in row.into_iter().enumerate() {
            assert!((flow.coupling(0, j) - expected).abs() < 1e-14, "{j}");
        }
        assert!((flow.area() - 4.0).abs() < 1e-14);
    }

    /// `k_ij = -cot(angle at k) / 2`.
    #[test]
    fn a_triangle_couples_two_corners_by_the_angle_at_the_third() {
        let corners = [tilted(0.0, 0.0), tilted(3.0, 0.0), tilted(-1.0, 0.5)];
        let flow = FacetFlow::of(Shape::Tri6, &corners);
        for k in 0..3 {
            let [i, j] = [(k + 1) % 3, (k + 2) % 3];
            let (a, b) = (corners[i] - corners[k], corners[j] - corners[k]);
            let cotangent = a.dot(b) / a.cross(b).length();
            let error = (flow.coupling(i, j) + 0.5 * cotangent).abs();
            assert!(error < 1e-13, "{k} {error}");
        }
        assert!(flow.coupling(1, 2) > 0.0, "opposite the obtuse angle");
    }

    #[test]
    fn a_linear_potential_has_its_gradient() {
        let slope = 5.0 * DVec3::new(0.6, 0.0, 0.8) - 2.0 * DVec3::Y;
        let shapes: [&[[f64; 2]]; 2] = [
            &[[0.0, 0.0], [2.0, 0.1], [0.3, 1.5]],
            &[[0.0, 0.0], [2.0, 0.1], [1.8, 1.9], [-0.3, 1.5]],
        ];
        for places in shapes {
            let corners: Vec<DVec3> = places.iter().map(|[x, y]| tilted(*x, *y)).collect();
            let shape = if corners.len() == 3 {
                Shape::Tri3
            } else {
                Shape::Quad4
            };
            let potential: Vec<f64> = corners.iter().map(|x| 7.0 + slope.dot(*x)).collect();
            let flow = FacetFlow::of(shape, &corners);
            let found = flow.mean_gradient(&potential);
            assert!((found - slope).length() < 1e-12, "{found}");
            for i in 0..corners.len() {
                let sum: f64 = (0..corners.len()).map(|j| flow.coupling(i, j)).sum();
                assert!(sum.abs() < 1e-13, "{sum}");
            }
        }
    }
}
