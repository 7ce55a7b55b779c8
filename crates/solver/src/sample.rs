//! Values at positions in the rock.

use glam::{DMat3, DVec3};
use kluft_mesh::{Mesh, Shape};
use lie_core::kernel::{self, MAX_NODES};
use lie_core::{SymmetricStress, load_areas, rule};
use rayon::prelude::*;

use crate::solution::Solution;
use crate::space::cell::{self, Cell, components};
use crate::system::System;

/// How far outside a cell a position still belongs to it, in reference coordinates: rounding.
const SLACK: f64 = 1e-9;
/// How far the faces of curved cells bulge over the box around their nodes, as a share of it.
const BULGE: f64 = 0.2;
/// Iterations within which the reference coordinates of a position are found, or it is not in the
/// cell.
const ITERATIONS: usize = 30;

/// A position in a cell.
#[derive(Debug, Clone, PartialEq)]
pub struct InCell {
    /// The cell.
    pub cell: usize,
    /// Its shape functions at the position.
    pub shares: Vec<f64>,
}

/// What the rock does at a position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RockSample {
    /// Displacement, by the shape functions of the cell (m).
    pub displacement: DVec3,
    /// Mean stress of the cell, initial stress included (Pa).
    pub stress: SymmetricStress,
    /// Mean strain of the cell, tensor components, since the state of initial stress.
    pub strain: SymmetricStress,
}

/// The cells in which positions (m) lie, the first ones where they lie in several: on a fracture
/// they are on one of its sides. None for a position outside the rock.
pub fn locate(mesh: &Mesh, positions: &[DVec3]) -> Vec<Option<InCell>> {
    let in_cell = |index: usize| {
        let mut nodes = [DVec3::ZERO; MAX_NODES];
        let nodes = cell::positions(mesh, index, &mut nodes);
        let (mut low, mut high) = (nodes[0], nodes[0]);
        for node in nodes {
            (low, high) = (low.min(*node), high.max(*node));
        }
        let shape = mesh.cells.shapes[index];
        let slack = if shape.is_quadratic() { BULGE } else { SLACK };
        let slack = slack * (high - low).max_element();
        let near = positions
            .iter()
            .enumerate()
            .filter(move |(_, at)| at.cmpge(low - slack).all() && at.cmple(high + slack).all());
        let found = near.filter_map(|(number, at)| {
            let shares = shares(shape, nodes, *at)?;
            Some((
                number,
                InCell {
                    cell: index,
                    shares,
                },
            ))
        });
        found.collect::<Vec<_>>()
    };
    let found: Vec<Vec<(usize, InCell)>> = (0..mesh.cells.len())
        .into_par_iter()
        .map(in_cell)
        .filter(|found| !found.is_empty())
        .collect();
    let mut located = vec![None; positions.len()];
    for (number, place) in found.into_iter().flatten() {
        located[number].get_or_insert(place);
    }
    located
}

/// The shape functions of a cell at a position (m), if it lies in the cell: Newton's method for
/// `sum_a N_a(xi) x_a = x`.
fn shares(shape: Shape, nodes: &[DVec3], at: DVec3) -> Option<Vec<f64>> {
    let basis = &rule(shape).basis;
    let reference = shape.reference_nodes();
    let mut xi = reference.iter().sum::<DVec3>() / reference.len() as f64;
    for _ in 0..ITERATIONS {
        let values = basis.values(xi);
        let found: DVec3 = nodes.iter().zip(&values).map(|(x, n)| *x * *n).sum();
        let mut jacobian = DMat3::ZERO;
        for (x, gradient) in nodes.iter().zip(basis.gradients(xi)) {
            jacobian += DMat3::from_cols(*x * gradient.x, *x * gradient.y, *x * gradient.z);
        }
        let step = jacobian.inverse() * (at - found);
        if !step.is_finite() {
            return None;
        }
        xi += step;
        if step.abs().max_element() < 1e-13 {
            break;
        }
    }
    is_inside(shape, xi).then(|| basis.values(xi))
}

/// Whether reference coordinates are those of a point of the cell.
fn is_inside(shape: Shape, xi: DVec3) -> bool {
    let within = |x: f64, most: f64| x.abs() <= most + SLACK;
    let in_triangle = xi.x >= -SLACK && xi.y >= -SLACK;
    match shape.corner_count() {
        4 => in_triangle && xi.z >= -SLACK && xi.x + xi.y + xi.z <= 1.0 + SLACK,
        5 => {
            let half = 1.0 - xi.z;
            xi.z >= -SLACK && half >= -SLACK && within(xi.x, half) && within(xi.y, half)
        }
        6 => in_triangle && xi.x + xi.y <= 1.0 + SLACK && within(xi.z, 1.0),
        _ => within(xi.x, 1.0) && within(xi.y, 1.0) && within(xi.z, 1.0),
    }
}

/// What the rock does at a position.
pub fn sample(system: &System<'_>, solution: &Solution, place: &InCell) -> RockSample {
    let points = system.discretisation().points();
    let cell = Cell::of(
        system.problem(),
        points,
        &solution.displacements,
        place.cell,
    );
    let moved = cell.moved().iter().zip(&place.shares);
    let displacement = moved.map(|(u, share)| *u * *share).sum();
    in_cell(system, solution, (place.cell, cell), displacement)
}

/// Stress and strain of a cell, with a displacement.
fn in_cell(
    system: &System<'_>,
    solution: &Solution,
    (index, cell): (usize, Cell<'_>),
    displacement: DVec3,
) -> RockSample {
    let cell = cell.strained(system.strain_offsets(), index);
    let gradient = kernel::mean_gradient(cell.shape, cell.nodes(), cell.moved());
    RockSample {
        displacement,
        stress: solution.stresses[index],
        strain: components(0.5 * (gradient + gradient.transpose())),
    }
}

/// What the rock does on each facet of a part of the outer surface, with its area (m^2): the mean
/// displacement over it, stress and strain of the cell behind it.
pub fn surface_samples(
    system: &System<'_>,
    solution: &Solution,
    boundary: usize,
) -> Vec<(f64, RockSample)> {
    let mesh = &system.problem().mesh;
    let points = system.discretisation().points();
    let surface = &mesh.boundaries[boundary];
    let of_facet = |facet: usize| {
        let elements = &surface.elements;
        let nodes = elements.nodes_of(facet).iter();
        let places: Vec<DVec3> = nodes.map(|&node| mesh.nodes[node as usize]).collect();
        let sizes = load_areas(elements.shapes[facet], &places);
        let slots = &surface.slots[elements.range(facet)];
        let (mut area, mut moved) = (0.0, DVec3::ZERO);
        for (&slot, (size, _)) in slots.iter().zip(sizes) {
            let point = points.of_cell_node[slot as usize] as usize;
            area += size;
            moved += size * solution.displacements[point];
        }
        let index = surface.cell[facet] as usize;
        let cell = Cell::of(system.problem(), points, &solution.displacements, index);
        (area, in_cell(system, solution, (index, cell), moved / area))
    };
    (0..surface.elements.len()).map(of_facet).collect()
}

/// Eigenvalues of a symmetric tensor `xx, yy, zz, xy, yz, xz`, ascending (O. K. Smith,
/// Communications of the ACM 4 (1961)).
pub fn principal(tensor: &SymmetricStress) -> [f64; 3] {
    let [xx, yy, zz, xy, yz, xz] = *tensor;
    let mean = (xx + yy + zz) / 3.0;
    let [a, b, c] = [xx - mean, yy - mean, zz - mean];
    let squares = a * a + b * b + c * c + 2.0 * (xy * xy + yz * yz + xz * xz);
    let size = (squares / 6.0).sqrt();
    if size == 0.0 {
        return [mean; 3];
    }
    let deviator = DMat3::from_cols(
        DVec3::new(a, xy, xz),
        DVec3::new(xy, b, yz),
        DVec3::new(xz, yz, c),
    );
    let half = (deviator * (1.0 / size)).determinant() / 2.0;
    let angle = half.clamp(-1.0, 1.0).acos() / 3.0;
    let third = 2.0 * std::f64::consts::PI / 3.0;
    let value = |turned: f64| mean + 2.0 * size * (angle + turned).cos();
    let (high, low) = (value(0.0), value(third));
    [low, 3.0 * mean - high - low, high]
}

#[cfg(test)]
mod tests {
    use kluft_mesh::Mesh;
    use kluft_mesh::structured::cells_of;

    use super::*;

    /// A quadratic map of each shape, in which a position is found with the shape functions that
    /// give it back.
    #[test]
    fn positions_are_found_in_cells_of_every_shape() {
        for shape in Shape::CELLS {
            let mut draft = cells_of(shape, [2; 3], [1.0; 3], &[]);
            for x in &mut draft.nodes {
                let [a, b, c] = *x;
                *x = [a + 0.05 * b * c, b - 0.04 * a * a, c + 0.03 * a * b];
            }
            let roles = vec![kluft_mesh::SurfaceRole::Unused; draft.groups.len()];
            let mesh = Mesh::build(draft, &roles).expect("a mesh");
            let all = [
                DVec3::new(0.3, 0.4, 0.45),
                DVec3::new(0.71, 0.2, 0.88),
                DVec3::splat(1.2),
            ];
            let found = locate(&mesh, &all);
            assert!(found[2].is_none());
            for (at, place) in all.iter().zip(&found).take(2) {
                let place = place.as_ref().unwrap_or_else(|| panic!("{shape:?} {at}"));
                let nodes = mesh.cells.nodes_of(place.cell).iter().zip(&place.shares);
                let back: DVec3 = nodes
                    .map(|(&n, share)| *share * mesh.nodes[n as usize])
                    .sum();
                assert!(back.distance(*at) < 1e-12, "{shape:?}: {back} for {at}");
            }
        }
    }

    #[test]
    fn principal_values_are_eigenvalues() {
        let turned = DMat3::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 0.7);
        for values in [[-5.0, 1.0, 2.0], [3.0, 3.0, 3.0], [-1.0, -1.0, 0.0]] {
            let tensor = turned * DMat3::from_diagonal(values.into()) * turned.transpose();
            for (found, exact) in principal(&components(tensor)).into_iter().zip(values) {
                assert!((found - exact).abs() < 1e-7, "{values:?}: {found}");
            }
        }
    }
}
