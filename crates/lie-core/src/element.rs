//! Cells by table: shape functions and their gradients at the points of a quadrature rule.

use std::sync::OnceLock;

use glam::DVec3;
use kluft_mesh::Shape;

use crate::basis::Basis;
use crate::quadrature;

/// One quadrature point of a cell.
#[derive(Debug, Clone)]
pub struct RulePoint {
    /// Reference coordinates.
    pub at: DVec3,
    /// Weight; the weights of a rule add up to the volume of the reference cell.
    pub weight: f64,
    /// Value of each node's shape function.
    pub shape: Vec<f64>,
    /// Gradient of each node's shape function in reference coordinates.
    pub gradient: Vec<DVec3>,
}

/// Everything the kernels need of a shape.
#[derive(Debug, Clone)]
pub struct ElementRule {
    /// Shape functions anywhere.
    pub basis: Basis,
    /// Shape functions at the quadrature points.
    pub points: Vec<RulePoint>,
}

/// The rule of a shape, computed once a run.
pub fn rule(shape: Shape) -> &'static ElementRule {
    static RULES: [OnceLock<ElementRule>; 16] = [const { OnceLock::new() }; 16];
    RULES[shape as usize].get_or_init(|| {
        let basis = Basis::of(shape);
        let points = quadrature::points(shape)
            .into_iter()
            .map(|(at, weight)| RulePoint {
                at,
                weight,
                shape: basis.values(at),
                gradient: basis.gradients(at),
            })
            .collect();
        ElementRule { basis, points }
    })
}

#[cfg(test)]
mod tests {
    use kluft_mesh::{Draft, Elements};

    use super::*;

    fn all() -> impl Iterator<Item = Shape> {
        Shape::CELLS.into_iter().chain(Shape::FACETS)
    }

    /// Some points inside a shape, never on its boundary.
    fn inside(shape: Shape) -> Vec<DVec3> {
        quadrature::points(shape)
            .into_iter()
            .map(|(at, _)| at)
            .collect()
    }

    #[test]
    fn shape_functions_are_one_at_their_node_and_zero_at_the_others() {
        for shape in all() {
            for (node, at) in shape.reference_nodes().into_iter().enumerate() {
                for (other, value) in rule(shape).basis.values(at).into_iter().enumerate() {
                    let expected = f64::from(u8::from(node == other));
                    assert!((value - expected).abs() < 1e-13, "{shape:?} {node} {other}");
                }
            }
        }
    }

    #[test]
    fn shape_functions_sum_to_one_and_gradients_to_zero() {
        for shape in all() {
            for at in inside(shape) {
                let basis = &rule(shape).basis;
                assert!((basis.values(at).iter().sum::<f64>() - 1.0).abs() < 1e-13);
                assert!(basis.gradients(at).iter().sum::<DVec3>().length() < 1e-12);
            }
        }
    }

    #[test]
    fn shape_functions_reproduce_linear_fields() {
        for shape in all() {
            let nodes = shape.reference_nodes();
            for at in inside(shape) {
                let values = rule(shape).basis.values(at);
                let sum: DVec3 = nodes.iter().zip(values).map(|(x, value)| *x * value).sum();
                assert!((sum - at).length() < 1e-13, "{shape:?}");
            }
        }
    }

    #[test]
    fn gradients_agree_with_differences() {
        for shape in all() {
            let basis = &rule(shape).basis;
            let axes = [DVec3::X, DVec3::Y, DVec3::Z];
            for at in inside(shape) {
                for axis in &axes[..shape.dimension()] {
                    let h = 1e-6 * *axis;
                    let (ahead, behind) = (basis.values(at + h), basis.values(at - h));
                    for (node, gradient) in basis.gradients(at).into_iter().enumerate() {
                        let difference = (ahead[node] - behind[node]) / 2e-6;
                        assert!((difference - gradient.dot(*axis)).abs() < 1e-6, "{shape:?}");
                    }
                }
            }
        }
    }

    /// On each face of a cell the functions of its nodes are those of the face's own shape, and all
    /// others vanish: neighbours of any shape agree along a face.
    #[test]
    fn traces_on_faces_are_the_shape_functions_of_the_facet() {
        for shape in Shape::CELLS {
            let nodes = shape.reference_nodes();
            for face in shape.faces() {
                for at in inside(face.shape) {
                    let of_facet = rule(face.shape).basis.values(at);
                    let corners = face.nodes.iter().map(|&local| nodes[local as usize]);
                    let in_cell: DVec3 = corners.zip(&of_facet).map(|(x, v)| x * *v).sum();
                    let mut of_cell = rule(shape).basis.values(in_cell);
                    for (&local, value) in face.nodes.iter().zip(&of_facet) {
                        let trace = std::mem::take(&mut of_cell[local as usize]);
                        assert!((trace - value).abs() < 1e-12, "{shape:?} {face:?}");
                    }
                    assert!(
                        of_cell.iter().all(|rest| rest.abs() < 1e-12),
                        "{shape:?} {face:?}"
                    );
                }
            }
        }
    }

    /// One cell, refined once: its nodes.
    fn refined(shape: Shape, nodes: &[DVec3]) -> Vec<DVec3> {
        let all: Vec<u32> = (0..nodes.len() as u32).collect();
        let mut draft = Draft {
            nodes: nodes.iter().map(DVec3::to_array).collect(),
            node_tags: (1..=nodes.len() as u64).collect(),
            group_sets: vec![Vec::new()],
            ..Draft::default()
        };
        draft.cells.elements = Elements::new();
        draft.cells.elements.push(shape, &all);
        draft.cells.tags = vec![1];
        draft.cells.group_set = vec![0];
        draft.refine(1).expect("one cell");
        draft.nodes.into_iter().map(DVec3::from).collect()
    }

    /// The nodes of a refined curved cell are where its shape functions have those of the refined
    /// reference cell.
    #[test]
    fn refined_cells_lie_on_the_map_of_their_parent() {
        let wave = |x: DVec3| {
            let phase = x.dot(DVec3::new(7.0, 5.0, 3.0)) + 1.0;
            0.05 * DVec3::new(phase.sin(), (2.0 * phase).cos(), (3.0 * phase).sin())
        };
        for shape in Shape::CELLS {
            let reference = shape.reference_nodes();
            let curved: Vec<DVec3> = reference.iter().map(|&x| x + wave(x)).collect();
            let mapped = refined(shape, &reference).into_iter().map(|at| {
                let values = rule(shape).basis.values(at);
                values.iter().zip(&curved).map(|(v, x)| *v * *x).sum()
            });
            let mapped: Vec<DVec3> = mapped.collect();
            let found = refined(shape, &curved);
            assert_eq!(found.len(), mapped.len(), "{shape:?}");
            for x in found {
                let near = mapped.iter().any(|at| at.distance(x) < 1e-14 * 8.0);
                assert!(near, "{shape:?}: {x}");
            }
        }
    }

    #[test]
    fn faces_point_outwards() {
        for shape in Shape::CELLS {
            let nodes = shape.reference_nodes();
            let middle: DVec3 = nodes.iter().sum::<DVec3>() / nodes.len() as f64;
            for face in shape.faces() {
                let corners: Vec<DVec3> = face
                    .corners()
                    .iter()
                    .map(|&local| nodes[local as usize])
                    .collect();
                let outward = kluft_mesh::facet_centre(&corners) - middle;
                assert!(
                    kluft_mesh::facet_area_vector(&corners).dot(outward) > 0.0,
                    "{shape:?}"
                );
            }
        }
    }
}
