//! Where the point of an element lies: shares of its nodes by the quadratic map of its shape.

use glam::DVec3;

use crate::shape::Shape;

/// Share of each node of an element of a complete second-order shape at a reference point: the
/// values of its shape functions. Simplices are complete, hexahedra and prisms tensor products,
/// pyramids the rational space of M. Bergot, G. Cohen and M. Duruflé, J. Sci. Comput. 42 (2010).
pub(super) fn shares(complete: Shape, at: DVec3) -> Vec<f64> {
    match complete.corner_count() {
        3 => simplex(complete, &[1.0 - at.x - at.y, at.x, at.y]),
        4 if complete.dimension() == 2 => tensor(complete, at, 2),
        4 => simplex(complete, &[1.0 - at.x - at.y - at.z, at.x, at.y, at.z]),
        5 => pyramid(at),
        6 => prism(at),
        _ => tensor(complete, at, 3),
    }
}

/// Shares of the nodes that a shape without middles of quadrangles has, at the middle of such a
/// quadrangle or hexahedron: `-1/4` of corners, the rest of the middles of its edges.
pub(super) fn serendipity(members: &[u8], edges: &[[u8; 2]]) -> Vec<(u8, f64)> {
    let corners = members.iter().map(|&corner| (corner, -0.25));
    let within = |edge: &[u8; 2]| edge.iter().all(|end| members.contains(end));
    let corner_count = edges.iter().flatten().max().map_or(0, |last| last + 1);
    let own = (corner_count..).zip(edges).filter(|(_, edge)| within(edge));
    let own: Vec<u8> = own.map(|(middle, _)| middle).collect();
    let share = (1.0 + 0.25 * members.len() as f64) / own.len() as f64;
    corners
        .chain(own.iter().map(|&middle| (middle, share)))
        .collect()
}

/// `l (2 l - 1)` of corners and `4 l_a l_b` of edges, from barycentric coordinates.
pub(super) fn simplex(complete: Shape, corners: &[f64]) -> Vec<f64> {
    let of_corners = corners.iter().map(|l| l * (2.0 * l - 1.0));
    let edges = complete.edges().iter();
    let of_edges = edges.map(|&[a, b]| 4.0 * corners[a as usize] * corners[b as usize]);
    of_corners.chain(of_edges).collect()
}

/// Products of the quadratic polynomials of `axes` coordinates.
fn tensor(complete: Shape, at: DVec3, axes: usize) -> Vec<f64> {
    let nodes = complete.reference_nodes().into_iter();
    let share = |node: DVec3| {
        let factors = (0..axes).map(|axis| line(node[axis], at[axis]));
        factors.product()
    };
    nodes.map(share).collect()
}

/// The quadratic polynomial that is 1 at `node`, one of -1, 0 and 1, and 0 at the others.
fn line(node: f64, at: f64) -> f64 {
    if node == 0.0 {
        1.0 - at * at
    } else {
        0.5 * at * (at + node)
    }
}

fn prism(at: DVec3) -> Vec<f64> {
    let triangle = Shape::Tri6.reference_nodes();
    let of_triangle = shares(Shape::Tri6, at);
    let nodes = Shape::Prism18.reference_nodes().into_iter();
    let share = |node: DVec3| {
        let below = |corner: &DVec3| corner.x == node.x && corner.y == node.y;
        let place = triangle.iter().position(below);
        place.map_or(0.0, |place| of_triangle[place] * line(node.z, at.z))
    };
    nodes.map(share).collect()
}

/// With `x = a (1 - z)` and `y = b (1 - z)` the map is `(1 - z)^2 B(a, b) + 2 z (1 - z) L(a, b) +
/// z^2 A`: biquadratic in the base, bilinear in between, the apex. `L` is what puts the middles of
/// the rising edges in their places.
fn pyramid(at: DVec3) -> Vec<f64> {
    let below = 1.0 - at.z;
    let foot = DVec3::new(at.x, at.y, 0.0) / below;
    let of_base = shares(Shape::Quad9, foot);
    let base = Shape::Quad9.reference_nodes();
    let mut shares = vec![0.0; Shape::Pyramid14.node_count()];
    let nodes = Shape::Pyramid14.reference_nodes();
    for (share, node) in shares.iter_mut().zip(&nodes) {
        let place = base.iter().position(|corner| corner == node);
        *share = place.map_or(0.0, |place| below * below * of_base[place]);
    }
    let apex = 4;
    shares[apex] = at.z * at.z;
    for (edge, &[corner, end]) in Shape::Pyramid14.edges().iter().enumerate() {
        if end as usize != apex {
            continue;
        }
        let at_corner = nodes[corner as usize];
        let bilinear = 0.25 * (1.0 + at_corner.x * foot.x) * (1.0 + at_corner.y * foot.y);
        let between = 2.0 * at.z * below * bilinear;
        shares[5 + edge] = 2.0 * between;
        shares[corner as usize] -= 0.5 * between;
        shares[apex] -= 0.5 * between;
    }
    shares
}

#[cfg(test)]
mod tests {
    use super::*;

    const COMPLETE: [Shape; 6] = [
        Shape::Tri6,
        Shape::Quad9,
        Shape::Tet10,
        Shape::Hex27,
        Shape::Prism18,
        Shape::Pyramid14,
    ];

    #[test]
    fn shares_are_one_at_their_node_and_zero_at_the_others() {
        for shape in COMPLETE {
            for (node, at) in shape.reference_nodes().into_iter().enumerate() {
                if at == DVec3::Z && shape == Shape::Pyramid14 {
                    continue;
                }
                for (other, share) in shares(shape, at).into_iter().enumerate() {
                    let expected = f64::from(u8::from(node == other));
                    assert!((share - expected).abs() < 1e-15, "{shape:?} {node} {other}");
                }
            }
        }
    }

    #[test]
    fn shares_leave_quadratic_fields_as_they_are() {
        let at = DVec3::new(0.2, 0.3, 0.25);
        let field =
            |x: DVec3| 1.0 + x.x - 2.0 * x.y + 3.0 * x.z + x.x * x.y - x.z * x.z + x.y * x.y;
        for shape in COMPLETE {
            let at = match shape.dimension() {
                2 => DVec3::new(at.x, at.y, 0.0),
                _ => at,
            };
            let nodes = shape.reference_nodes().into_iter();
            let sum: f64 = nodes
                .zip(shares(shape, at))
                .map(|(node, share)| share * field(node))
                .sum();
            assert!((sum - field(at)).abs() < 1e-14, "{shape:?}");
        }
    }

    /// Serendipity shapes hold all fields of second order, so their middles follow them.
    #[test]
    fn middles_of_faces_and_hexahedra_follow_from_edges() {
        let field = |x: DVec3| 1.0 + x.x * x.y + x.x * x.x - 0.5 * x.z * x.z + x.x * x.y * x.z;
        for shape in [Shape::Quad9, Shape::Hex27] {
            let nodes = shape.reference_nodes();
            for local in shape.corner_count() + shape.edges().len()..shape.node_count() {
                let members = shape.members(local);
                let found = serendipity(&members, shape.edges());
                let terms = found
                    .iter()
                    .map(|&(node, share)| share * field(nodes[node as usize]));
                let sum: f64 = terms.sum();
                assert!(
                    (sum - field(nodes[local])).abs() < 1e-15,
                    "{shape:?} {local}"
                );
            }
        }
    }
}
