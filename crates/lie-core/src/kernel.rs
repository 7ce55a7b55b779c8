//! Integrals over one rock cell.

use glam::{DMat3, DVec3};
use lie_mesh::Shape;

use crate::element::{RulePoint, rule};
use crate::fracture_law::outer;
use crate::rock::Rock;

/// Most nodes a cell can have.
pub const MAX_NODES: usize = 27;

/// Gradients of the shape functions in space (1/m) and the volume of one quadrature point (m^3).
struct Gradients {
    of_node: [DVec3; MAX_NODES],
    volume: f64,
}

/// `J = sum_a x_a (x) dN_a/dxi`, `grad N_a = J^-T dN_a/dxi`.
fn gradients(point: &RulePoint, nodes: &[DVec3]) -> Gradients {
    let jacobian: DMat3 = nodes
        .iter()
        .zip(&point.gradient)
        .map(|(x, gradient)| outer(*x, *gradient))
        .sum();
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

/// Adds row `a` of the stiffness of a cell with the given `nodes` (m) to `blocks[b]` (N/m):
/// `K_ab = int lambda g_a (x) g_b + mu g_b (x) g_a + mu (g_a . g_b) I dV`, `g = grad N`.
pub fn add_stiffness_row(
    shape: Shape,
    nodes: &[DVec3],
    rock: &Rock,
    a: usize,
    blocks: &mut [DMat3],
) {
    let (lambda, mu) = rock.lame();
    for point in &rule(shape).points {
        let Gradients { of_node: g, volume } = gradients(point, nodes);
        for b in 0..nodes.len() {
            blocks[b] += volume
                * (lambda * outer(g[a], g[b])
                    + mu * outer(g[b], g[a])
                    + mu * g[a].dot(g[b]) * DMat3::IDENTITY);
        }
    }
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
        let force = gradients(point, nodes).volume * q(position(point, nodes));
        for (sum, value) in forces.iter_mut().zip(&point.shape) {
            *sum += *value * force;
        }
    }
}

/// Whether a cell with curved edges or warped faces folds over itself: its volume is not positive
/// at some quadrature point.
pub fn is_folded(shape: Shape, nodes: &[DVec3]) -> bool {
    let mut points = rule(shape).points.iter();
    points.any(|point| gradients(point, nodes).volume <= 0.0)
}

/// Mean displacement gradient of a cell, `H = 1/V int u_a (x) grad N_a dV`.
pub fn mean_gradient(shape: Shape, nodes: &[DVec3], displacement: &[DVec3]) -> DMat3 {
    let mut sum = DMat3::ZERO;
    let mut whole = 0.0;
    for point in &rule(shape).points {
        let Gradients { of_node: g, volume } = gradients(point, nodes);
        whole += volume;
        for (u, gradient) in displacement.iter().zip(g) {
            sum += outer(*u, volume * gradient);
        }
    }
    sum * (1.0 / whole)
}

/// Mean position of a cell (m), weighted by volume.
pub fn centre(shape: Shape, nodes: &[DVec3]) -> DVec3 {
    let mut sum = DVec3::ZERO;
    let mut whole = 0.0;
    for point in &rule(shape).points {
        let volume = gradients(point, nodes).volume;
        whole += volume;
        sum += volume * position(point, nodes);
    }
    sum / whole
}

fn position(point: &RulePoint, nodes: &[DVec3]) -> DVec3 {
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
    };

    fn forces(displacement: &[DVec3]) -> Vec<DVec3> {
        (0..4)
            .map(|a| {
                let mut row = [DMat3::ZERO; 4];
                add_stiffness_row(Shape::Tet4, &NODES, &ROCK, a, &mut row);
                row.iter().zip(displacement).map(|(k, u)| *k * *u).sum()
            })
            .collect()
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
