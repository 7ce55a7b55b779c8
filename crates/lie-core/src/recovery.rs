//! Where stresses are sampled for recovery, and where their error is integrated.

use std::sync::OnceLock;

use glam::DVec3;
use kluft_mesh::Shape;

use crate::basis::Basis;
use crate::element::{RulePoint, rule};
use crate::quadrature;

/// A place where the error is integrated.
#[derive(Debug, Clone)]
pub struct FinePoint {
    /// The shape functions of the cell there.
    pub point: RulePoint,
    /// The linear shape functions of its corners there.
    pub corners: Vec<f64>,
}

/// The tables of a cell's shape.
#[derive(Debug, Clone)]
pub struct RecoveryRule {
    /// Where the stress of the cell is most accurate: the centre of linear cells, the points of the
    /// next lower rule of quadratic ones (J. Barlow, Int. J. Numer. Meth. Engng 10, 1976).
    pub samples: Vec<RulePoint>,
    /// Points of a rule fine enough for the square of an error.
    pub fine: Vec<FinePoint>,
}

/// The tables of a shape, computed once a run.
pub fn recovery_rule(shape: Shape) -> &'static RecoveryRule {
    static RULES: [OnceLock<RecoveryRule>; 16] = [const { OnceLock::new() }; 16];
    RULES[shape as usize].get_or_init(|| {
        let basis = Basis::of(shape);
        let at = |(at, weight): (DVec3, f64)| RulePoint {
            at,
            weight,
            shape: basis.values(at),
            gradient: basis.gradients(at),
        };
        let corners = Basis::of(linear(shape));
        let fine = fine_points(shape)
            .into_iter()
            .map(|(place, weight)| FinePoint {
                corners: corners.values(place),
                point: at((place, weight)),
            });
        RecoveryRule {
            samples: sample_points(shape).into_iter().map(at).collect(),
            fine: fine.collect(),
        }
    })
}

/// The shape with the same corners and no other nodes.
fn linear(shape: Shape) -> Shape {
    match shape.corner_count() {
        4 => Shape::Tet4,
        5 => Shape::Pyramid5,
        6 => Shape::Prism6,
        _ => Shape::Hex8,
    }
}

fn sample_points(shape: Shape) -> Vec<(DVec3, f64)> {
    match shape {
        Shape::Tet10 => quadrature::points(shape),
        _ if shape.is_quadratic() => quadrature::points(linear(shape)),
        _ => {
            let points = &rule(shape).points;
            let volume: f64 = points.iter().map(|point| point.weight).sum();
            let moment: DVec3 = points.iter().map(|point| point.weight * point.at).sum();
            vec![(moment / volume, volume)]
        }
    }
}

fn fine_points(shape: Shape) -> Vec<(DVec3, f64)> {
    match shape {
        Shape::Tet4 => quadrature::points(Shape::Tet10),
        Shape::Tet10 => quarters(&quadrature::points(Shape::Tet10)),
        _ => quadrature::points(shape),
    }
}

/// A rule on each of the four tetrahedra between the centre and the faces.
fn quarters(points: &[(DVec3, f64)]) -> Vec<(DVec3, f64)> {
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    let part = |left_out: usize| {
        let mut corners = corners;
        corners[left_out] = DVec3::splat(0.25);
        let [a, b, c, d] = corners;
        points.iter().map(move |&(at, weight)| {
            let place = a + at.x * (b - a) + at.y * (c - a) + at.z * (d - a);
            (place, 0.25 * weight)
        })
    };
    (0..4).flat_map(part).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_rules_fill_the_cell() {
        for shape in Shape::CELLS {
            let volume: f64 = rule(shape).points.iter().map(|point| point.weight).sum();
            let table = recovery_rule(shape);
            let sampled: f64 = table.samples.iter().map(|point| point.weight).sum();
            let fine: f64 = table.fine.iter().map(|fine| fine.point.weight).sum();
            assert!((sampled - volume).abs() < 1e-12, "{shape:?}");
            assert!((fine - volume).abs() < 1e-12, "{shape:?}");
        }
    }

    /// Corner functions interpolate linear fields from corners.
    #[test]
    fn corner_functions_reproduce_places() {
        for shape in Shape::CELLS {
            let nodes = shape.reference_nodes();
            for fine in &recovery_rule(shape).fine {
                let terms = nodes.iter().zip(&fine.corners);
                let place: DVec3 = terms.map(|(x, share)| *x * *share).sum();
                assert!((place - fine.point.at).length() < 1e-12, "{shape:?}");
            }
        }
    }
}
