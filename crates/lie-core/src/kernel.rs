//! Integrals over one rock cell.

use glam::{DMat3, DVec3};
use kluft_mesh::Shape;

use crate::element::{RulePoint, rule};
use crate::outer::outer;
use crate::rock::{Elasticity, Rock};

/// Most nodes a cell can have.
pub const MAX_NODES: usize = 27;

/// Gradients of the shape functions in space (1/m) and the volume of one quadrature point (m^3).
struct Gradients {
    of_node: [DVec3; MAX_NODES],
    volume: f64,
}

/// `grad N_a = J^-T dN_a/dxi` with the Jacobian matrix `J = sum_a x_a (x) dN_a/dxi`.
fn gradients(point: &RulePoint, nodes: &[DVec3]) -> Gradients {
    let jacobian = reference_gradient(point, nodes);
    let to_space = jacobian.inverse().transpose();
    let mut of_node = [DVec3::ZERO; MAX_NODES];
    for (slot, gradient) in of_node.iter_mut().zip(&point.gradient) {
        *slot = to_space * *gradient;
    }
    Gradients {
        of_node,
        volume: point.weight * jacobian.determinant(),
    }
}

/// Stiffness of a cell with the given `nodes` (m), `blocks[a n + b] = K_ab` (N/m) for `n` nodes:
/// `K_ab = int lambda g_a (x) g_b + mu g_b (x) g_a + mu (g_a . g_b) I dV`, `g = grad N`, in
/// isotropic rock.
///
/// All terms follow from `M_ab = int g_a (x) g_b dV`, see [`Elasticity::block`], and
/// `K_ba = K_ab^T`.
pub fn stiffness(shape: Shape, nodes: &[DVec3], rock: &Rock, blocks: &mut [DMat3]) {
    let count = nodes.len();
    blocks.fill(DMat3::ZERO);
    for point in &rule(shape).points {
        let Gradients { of_node: g, volume } = gradients(point, nodes);
        for a in 0..count {
            let scaled = volume * g[a];
            for (b, block) in blocks[a * count..][..count].iter_mut().enumerate().skip(a) {
                *block += outer(scaled, g[b]);
            }
        }
    }
    let elasticity = rock.elasticity();
    for a in 0..count {
        for b in a..count {
            let block = elasticity.block(blocks[a * count + b]);
            blocks[a * count + b] = block;
            blocks[b * count + a] = block.transpose();
        }
    }
}

/// Row `a` of [`stiffness`] of a linear tetrahedron, `row[b] = K_ab` (N/m); a row adds up to zero,
/// because translations cost nothing.
pub fn tetrahedron_row(
    nodes: &[DVec3; 4],
    elasticity: Elasticity<'_>,
    a: usize,
    row: &mut [DMat3; 4],
) {
    let gradients = tetrahedron_gradients(nodes);
    let mut sum = DMat3::ZERO;
    for b in (0..4).filter(|&b| b != a) {
        let block = elasticity.block(tetrahedron_moment(gradients[a], gradients[b]));
        sum += block;
        row[b] = block;
    }
    row[a] = -sum;
}

/// Gradients of the shape functions of a linear tetrahedron of positive volume, times the root of
/// that volume: `sqrt(V) grad N_a` (m^1/2).
///
/// With edges `e` from node 0, the gradients at the other nodes are `e x e / 6V`; all four add up
/// to zero.
#[inline]
pub fn tetrahedron_gradients(nodes: &[DVec3; 4]) -> [DVec3; 4] {
    let [e1, e2, e3] = [1, 2, 3].map(|k| nodes[k] - nodes[0]);
    let faces = [e2.cross(e3), e3.cross(e1), e1.cross(e2)];
    let scale = 1.0 / (6.0 * e1.dot(faces[0])).sqrt();
    let [g1, g2, g3] = faces.map(|face| scale * face);
    [-(g1 + g2 + g3), g1, g2, g3]
}

/// `M_ab = int g_a (x) g_b dV` (m) from [`tetrahedron_gradients`].
#[inline]
pub fn tetrahedron_moment(a: DVec3, b: DVec3) -> DMat3 {
    outer(a, b)
}

/// Adds the nodal forces of a stress field, `f_a = int sigma(x) . grad N_a dV` (N).
pub fn add_stress_forces(
    shape: Shape,
    nodes: &[DVec3],
    stress: impl Fn(DVec3) -> DMat3,
    forces: &mut [DVec3],
) {
    for point in &rule(shape).points {
        let Gradients { of_node: g, volume } = gradients(point, nodes);
        let sigma = stress(position(point, nodes));
        for (force, gradient) in forces.iter_mut().zip(g) {
            *force += volume * (sigma * gradient);
        }
    }
}

/// Adds the nodal forces of a body force, `f_a = int N_a q(x) dV` (N), with `q` in N/m^3.
pub fn add_body_forces(
    shape: Shape,
    nodes: &[DVec3],
    q: impl Fn(DVec3) -> DVec3,
    forces: &mut [DVec3],
) {
    for point in &rule(shape).points {
        let force = volume(point, nodes) * q(position(point, nodes));
        for (sum, value) in forces.iter_mut().zip(&point.shape) {
            *sum += *value * force;
        }
    }
}

/// Whether a cell with curved edges or warped faces folds over itself: its volume is not positive
/// at some quadrature point.
pub fn is_folded(shape: Shape, nodes: &[DVec3]) -> bool {
    let mut points = rule(shape).points.iter();
    points.any(|point| volume(point, nodes) <= 0.0)
}

/// Mean displacement gradient of a cell, `H = 1/V int u_a (x) grad N_a dV`.
pub fn mean_gradient(shape: Shape, nodes: &[DVec3], displacement: &[DVec3]) -> DMat3 {
    let mut sum = DMat3::ZERO;
    let mut whole = 0.0;
    for point in &rule(shape).points {
        let (gradient, volume) = gradient_at(point, nodes, displacement);
        whole += volume;
        sum += volume * gradient;
    }
    sum * (1.0 / whole)
}

/// Adds the forces (N) by which a cell of a rock resists displacements of its nodes (m),
/// `f_a = int sigma(u) . grad N_a dV`.
pub fn add_elastic_forces(
    shape: Shape,
    (nodes, displacement): (&[DVec3], &[DVec3]),
    rock: &Rock,
    forces: &mut [DVec3],
) {
    for point in &rule(shape).points {
        let Gradients { of_node: g, volume } = gradients(point, nodes);
        let (gradient, _) = gradient_at(point, nodes, displacement);
        let sigma = rock.stress(gradient);
        for (force, gradient) in forces.iter_mut().zip(g) {
            *force += volume * (sigma * gradient);
        }
    }
}

/// Mean position of a cell (m), weighted by volume.
pub fn centre(shape: Shape, nodes: &[DVec3]) -> DVec3 {
    let mut sum = DVec3::ZERO;
    let mut whole = 0.0;
    for point in &rule(shape).points {
        let volume = volume(point, nodes);
        whole += volume;
        sum += volume * position(point, nodes);
    }
    sum / whole
}

/// Displacement gradient `H = sum_a u_a (x) grad N_a` at a point of a cell, and the volume (m^3) of
/// that point.
pub fn gradient_at(point: &RulePoint, nodes: &[DVec3], displacement: &[DVec3]) -> (DMat3, f64) {
    let (inverse, volume) = inverse_jacobian(point, nodes);
    (gradient(point, inverse, displacement), volume)
}

/// The inverse of the Jacobian matrix `dx/dxi` (1/m) at a point of a cell, and the volume (m^3) of
/// that point.
pub fn inverse_jacobian(point: &RulePoint, nodes: &[DVec3]) -> (DMat3, f64) {
    let jacobian = reference_gradient(point, nodes);
    (jacobian.inverse(), point.weight * jacobian.determinant())
}

/// Displacement gradient at a point of a cell with this inverse of its Jacobian matrix (1/m).
pub fn gradient(point: &RulePoint, inverse: DMat3, displacement: &[DVec3]) -> DMat3 {
    reference_gradient(point, displacement) * inverse
}

/// `sum_a v_a (x) dN_a/dxi` at a point: of places the Jacobian matrix.
fn reference_gradient(point: &RulePoint, values: &[DVec3]) -> DMat3 {
    let terms = values.iter().zip(&point.gradient);
    terms
        .map(|(value, gradient)| outer(*value, *gradient))
        .sum()
}

/// Volume (m^3) of a point of a cell.
fn volume(point: &RulePoint, nodes: &[DVec3]) -> f64 {
    point.weight * reference_gradient(point, nodes).determinant()
}

/// Place (m) of a point of a cell.
pub fn position(point: &RulePoint, nodes: &[DVec3]) -> DVec3 {
    nodes
        .iter()
        .zip(&point.shape)
        .map(|(x, value)| *x * *value)
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    const NODES: [DVec3; 4] = [
        DVec3::new(0.1, 0.0, 0.2),
        DVec3::new(1.3, 0.1, 0.0),
        DVec3::new(0.2, 0.9, 0.1),
        DVec3::new(0.3, 0.2, 1.1),
    ];
    const ROCK: Rock = Rock {
        young_modulus: 50e9,
        poisson_ratio: 0.25,
        density: 0.0,
        anisotropy: None,
    };

    fn forces(displacement: &[DVec3]) -> Vec<DVec3> {
        let mut blocks = [DMat3::ZERO; 16];
        stiffness(Shape::Tet4, &NODES, &ROCK, &mut blocks);
        blocks
            .chunks(4)
            .map(|row| row.iter().zip(displacement).map(|(k, u)| *k * *u).sum())
            .collect()
    }

    #[test]
    fn rows_of_a_tetrahedron_are_those_of_its_stiffness() {
        let mut blocks = [DMat3::ZERO; 16];
        stiffness(Shape::Tet4, &NODES, &ROCK, &mut blocks);
        for (a, expected) in blocks.chunks(4).enumerate() {
            let mut row = [DMat3::ZERO; 4];
            tetrahedron_row(&NODES, ROCK.elasticity(), a, &mut row);
            for (block, expected) in row.iter().zip(expected) {
                let difference = *block - *expected;
                let largest = difference.to_cols_array().map(f64::abs);
                let largest = largest.into_iter().fold(0.0, f64::max);
                assert!(largest < 1e-14 * ROCK.young_modulus, "{block} {expected}");
            }
        }
    }

    #[test]
    fn rigid_motions_store_no_energy() {
        for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
            let spin: Vec<DVec3> = NODES.iter().map(|x| axis.cross(*x)).collect();
            for motion in [vec![axis; 4], spin] {
                let largest = forces(&motion)
                    .iter()
                    .map(|f| f.length())
                    .fold(0.0, f64::max);
                assert!(largest < 1e-5 * ROCK.young_modulus * 1e-9);
            }
        }
    }

    #[test]
    fn stiffness_agrees_with_the_forces_of_its_stress() {
        let displacement: Vec<DVec3> = NODES
            .iter()
            .map(|x| DVec3::new(x.y, 2.0 * x.x, x.z))
            .collect();
        let stress = ROCK.stress(mean_gradient(Shape::Tet4, &NODES, &displacement));
        let mut expected = [DVec3::ZERO; 4];
        add_stress_forces(Shape::Tet4, &NODES, |_| stress, &mut expected);
        for (force, expected) in forces(&displacement).iter().zip(expected) {
            assert!((*force - expected).length() < 1e-12 * expected.length());
        }
    }
}
