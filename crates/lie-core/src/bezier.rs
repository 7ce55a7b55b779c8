//! Facets of second order in Bezier form: `w = sum_a N_a w_a = sum_q B_q c_q`.
//!
//! Along every edge the functions are Bernstein's: `B_c = N_c + sum_e N_e / 4` at a corner with its
//! two edges `e`, `B_e = N_e / 2` in the middle of an edge (Quad9: the product of both directions).
//! So the control values are those of the nodes at corners and `c_e = 2 w_e - (w_1 + w_2) / 2` on
//! an edge between corners 1 and 2. No function is negative anywhere on Tri6 and Quad9 (nor below
//! -1/27 on Quad8), and no integral of one is: a field whose control values are not negative is not
//! negative. Facets of first order are their own Bezier form.

use kluft_mesh::Shape;

/// The middle of a nine-node quadrangle.
const CENTRE: u8 = 8;

/// What a node of a facet is.
enum Place {
    /// A corner, with the middles of its two edges.
    Corner([u8; 2]),
    /// The middle of an edge, with its two corners.
    Edge([u8; 2]),
    Centre,
}

fn place(shape: Shape, node: usize) -> Place {
    let corners = shape.corner_count();
    let next = |corner: usize| (corner + 1) % corners;
    match node {
        _ if node < corners => {
            let before = (node + corners - 1) % corners;
            Place::Corner([corners + node, corners + before].map(|edge| edge as u8))
        }
        _ if node < 2 * corners => {
            let first = node - corners;
            Place::Edge([first, next(first)].map(|corner| corner as u8))
        }
        _ => Place::Centre,
    }
}

/// `B_q` of a node as `(a, S_qa)`, `B_q = sum_a S_qa N_a`; so also `w_a = sum_q S_qa c_q`.
pub fn bezier_function(shape: Shape, node: usize) -> Vec<(u8, f64)> {
    let own = node as u8;
    if !shape.is_quadratic() {
        return vec![(own, 1.0)];
    }
    let (mut shares, centre) = match place(shape, node) {
        Place::Corner(edges) => (vec![(own, 1.0), (edges[0], 0.25), (edges[1], 0.25)], 0.0625),
        Place::Edge(_) => (vec![(own, 0.5)], 0.125),
        Place::Centre => return vec![(own, 0.25)],
    };
    if shape == Shape::Quad9 {
        shares.push((CENTRE, centre));
    }
    shares
}

/// Control value of a node as `(a, C_qa)`, `c_q = sum_a C_qa w_a`.
pub fn control_value(shape: Shape, node: usize) -> Vec<(u8, f64)> {
    let own = node as u8;
    if !shape.is_quadratic() {
        return vec![(own, 1.0)];
    }
    match place(shape, node) {
        Place::Corner(_) => vec![(own, 1.0)],
        Place::Edge(corners) => vec![(own, 2.0), (corners[0], -0.5), (corners[1], -0.5)],
        Place::Centre => (0..4)
            .flat_map(|corner| [(corner, 0.25), (corner + 4, -1.0)])
            .chain([(own, 4.0)])
            .collect(),
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::element::rule;

    #[test]
    fn control_values_and_functions_are_inverse() {
        for shape in Shape::FACETS {
            let count = shape.node_count();
            let nodal: Vec<f64> = (0..count).map(|a| (a as f64 * 1.7).sin()).collect();
            let mut back = vec![0.0; count];
            for q in 0..count {
                let terms = control_value(shape, q).into_iter();
                let control: f64 = terms.map(|(a, c)| c * nodal[a as usize]).sum();
                for (a, share) in bezier_function(shape, q) {
                    back[a as usize] += share * control;
                }
            }
            for (back, nodal) in back.iter().zip(&nodal) {
                assert!((back - nodal).abs() < 1e-14, "{shape:?}");
            }
        }
    }

    #[test]
    fn functions_are_nowhere_more_negative_than_stated() {
        for shape in Shape::FACETS {
            let triangle = shape.corner_count() == 3;
            let lowest = if shape == Shape::Quad8 {
                -1.0 / 27.0
            } else {
                0.0
            };
            let basis = &rule(shape).basis;
            for (i, j) in (0..=30).flat_map(|i| (0..=30).map(move |j| (i, j))) {
                let (x, y) = (f64::from(i) / 30.0, f64::from(j) / 30.0);
                let at = match triangle {
                    true if x + y > 1.0 => continue,
                    true => DVec3::new(x, y, 0.0),
                    false => DVec3::new(2.0 * x - 1.0, 2.0 * y - 1.0, 0.0),
                };
                let values = basis.values(at);
                for q in 0..shape.node_count() {
                    let terms = bezier_function(shape, q).into_iter();
                    let value: f64 = terms.map(|(a, share)| share * values[a as usize]).sum();
                    assert!(value > lowest - 1e-14, "{shape:?} {q} at {at}: {value}");
                }
            }
        }
    }
}
