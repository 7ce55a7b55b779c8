//! The fractures as the solver sees them: facet points, each with two walls and a law.
//!
//! Facets are integrated at their nodes, so a facet point couples nothing but the unknowns of its
//! own node: the response of all fractures is block-diagonal.

use glam::{DMat3, DVec3};
use lie_core::enrichment::coefficient;
use lie_core::{facet_node_centroids, facet_node_weights};
use lie_mesh::{Mesh, cell_volume};
use rayon::prelude::*;

use crate::pattern::{Lists, Pattern};
use crate::points::Points;
use crate::problem::{Fracture, Problem};
use crate::supports::Supports;

/// One node of one facet.
#[derive(Debug, Clone, Copy)]
pub struct FacetPoint {
    /// Point on the plus wall.
    pub plus: u32,
    /// Point on the minus wall.
    pub minus: u32,
    /// Area it stands for [m^2].
    pub area: f64,
    /// Unit normal, from minus to plus.
    pub normal: DVec3,
    /// Index of its fracture.
    pub fracture: u32,
    /// Stiffness of the rock next to it, about `E/h` [Pa/m]: constrained modulus over the height of
    /// the cells on both sides, in series.
    pub spring: f64,
    /// Jump [m] at which the law carries the initial stress. The law always sees
    /// `initial_jump + jump`.
    pub initial_jump: DVec3,
    /// Aperture [m] that goes with it.
    pub initial_aperture: f64,
}

/// All facet points and the nodes they sit on.
#[derive(Debug, Clone)]
pub struct Interface {
    /// The facet points, facet by facet in the order of [`lie_mesh::Facets::elements`]' nodes.
    pub points: Vec<FacetPoint>,
    /// Nodes that carry facet points, ascending.
    pub nodes: Vec<u32>,
    /// Facet points of each of `nodes`.
    pub of_node: Lists,
}

impl Interface {
    /// Collects the facet points of a problem.
    pub fn of(problem: &Problem, points: &Points) -> Self {
        let mesh = &problem.mesh;
        let facet_points: Vec<FacetPoint> = (0..mesh.facets.elements.len())
            .flat_map(|facet| facet_points(problem, points, facet))
            .collect();
        let mut nodes: Vec<u32> = mesh.facets.elements.nodes.clone();
        nodes.sort_unstable();
        nodes.dedup();
        let position = |node: &u32| nodes.partition_point(|other| other < node) as u32;
        let keys: Vec<u32> = mesh.facets.elements.nodes.iter().map(position).collect();
        let of_node = Lists::group(keys.into_iter(), nodes.len());
        Self {
            points: facet_points,
            nodes,
            of_node,
        }
    }

    /// Jumps `u(plus) - u(minus)` [m].
    pub fn jumps(&self, displacements: &[DVec3]) -> Vec<DVec3> {
        let jump = |point: &FacetPoint| {
            displacements[point.plus as usize] - displacements[point.minus as usize]
        };
        self.points.par_iter().map(jump).collect()
    }

    /// Forces [N] by which `tractions` [Pa] resist on all points: `+A t` on the plus wall, `-A t`
    /// on the minus wall.
    pub fn forces(&self, tractions: &[DVec3], point_count: usize) -> Vec<DVec3> {
        let mut forces = vec![DVec3::ZERO; point_count];
        for (point, traction) in self.points.iter().zip(tractions) {
            forces[point.plus as usize] += point.area * *traction;
            forces[point.minus as usize] -= point.area * *traction;
        }
        forces
    }

    /// Stiffness of the fractures: for each of `nodes` the blocks between all its unknowns, row by
    /// row: `K_kl = sum A J_k^T D J_l`, `J_k = c(plus, k) P(plus) - c(minus, k) P(minus)`.
    pub fn stiffness(
        &self,
        tangents: &[DMat3],
        points: &Points,
        supports: &Supports,
    ) -> Vec<Vec<DMat3>> {
        (0..self.nodes.len())
            .into_par_iter()
            .map(|index| {
                let own = points.of_node(self.nodes[index] as usize);
                let mut blocks = vec![DMat3::ZERO; own.len() * own.len()];
                for &facet_point in self.of_node.of(index) {
                    let point = &self.points[facet_point as usize];
                    let tangent = point.area * tangents[facet_point as usize];
                    let jump = jump_operator(point, points, supports);
                    for (k, left) in jump.iter().enumerate() {
                        for (l, right) in jump.iter().enumerate() {
                            blocks[k * own.len() + l] += left.transpose() * tangent * *right;
                        }
                    }
                }
                blocks
            })
            .collect()
    }

    /// Addresses in the matrix of the blocks that [`Interface::stiffness`] returns: for each of
    /// `nodes` its rows, each with the address of its first block.
    pub fn addresses(&self, points: &Points, pattern: &Pattern) -> Vec<Vec<(usize, usize)>> {
        let rows = |&node: &u32| {
            let own = points.of_node(node as usize);
            own.clone()
                .map(|row| (row, pattern.address(row, own.start)))
                .collect()
        };
        self.nodes.iter().map(rows).collect()
    }
}

/// `J_k` for all unknowns `k` of the point's node. Without supports `J_0` vanishes: the continuous
/// displacement does not see the fracture.
fn jump_operator(point: &FacetPoint, points: &Points, supports: &Supports) -> Vec<DMat3> {
    let (plus, sectors) = points.sector(point.plus as usize);
    let (minus, _) = points.sector(point.minus as usize);
    let free = |wall: u32| {
        supports
            .hold(wall as usize)
            .map_or(DMat3::IDENTITY, |hold| hold.free)
    };
    let (free_plus, free_minus) = (free(point.plus), free(point.minus));
    (0..sectors)
        .map(|k| {
            coefficient(sectors, plus, k) * free_plus - coefficient(sectors, minus, k) * free_minus
        })
        .collect()
}

fn facet_points(problem: &Problem, points: &Points, facet: usize) -> Vec<FacetPoint> {
    let mesh = &problem.mesh;
    let elements = &mesh.facets.elements;
    let shape = elements.shapes[facet];
    let nodes = elements.nodes_of(facet);
    let area = lie_mesh::facet_area_vector(&mesh.corners(elements, facet));
    let normal = area.normalize();
    let spring = spring(problem, facet, area.length());
    let fracture = mesh.facets.fracture[facet];
    let law = &problem.fractures[fracture as usize];
    let slots = elements.range(facet);
    let sides = std::iter::zip(
        &mesh.facets.plus_slots[slots.clone()],
        &mesh.facets.minus_slots[slots],
    );
    let rule = std::iter::zip(facet_node_weights(shape), facet_node_centroids(shape));
    std::iter::zip(sides, rule)
        .map(|((&plus, &minus), (weight, centroid))| {
            let at = std::iter::zip(nodes, *centroid)
                .map(|(&node, share)| *share * mesh.nodes[node as usize])
                .sum();
            let (initial_jump, initial_aperture) = initial_jump(problem, law, at, normal);
            FacetPoint {
                plus: points.of_cell_node[plus as usize],
                minus: points.of_cell_node[minus as usize],
                area: weight * area.length(),
                normal,
                fracture,
                spring,
                initial_jump,
                initial_aperture,
            }
        })
        .collect()
}

fn spring(problem: &Problem, facet: usize, area: f64) -> f64 {
    let mesh = &problem.mesh;
    let compliance = |cell: u32| {
        let cell = cell as usize;
        let volume = cell_volume(mesh.cells.shapes[cell], &corners(mesh, cell));
        volume / area / problem.rock(cell).constrained_modulus()
    };
    1.0 / (compliance(mesh.facets.minus[facet]) + compliance(mesh.facets.plus[facet]))
}

fn corners(mesh: &Mesh, cell: usize) -> Vec<DVec3> {
    mesh.corners(&mesh.cells, cell)
}

/// Jump and aperture at which the law carries the initial stress. A fracture without stiffness
/// carries none, so it relaxes what the initial stress would need of it.
fn initial_jump(problem: &Problem, fracture: &Fracture, at: DVec3, normal: DVec3) -> (DVec3, f64) {
    let law = &fracture.law;
    let Some(stress) = &problem.initial_stress else {
        return (DVec3::ZERO, law.closure.aperture);
    };
    let traction = stress.at(at) * normal;
    let across = traction.dot(normal);
    let separation = law.closure.balanced(0.0, across);
    let shear = traction - across * normal;
    let slip = if law.shear_stiffness > 0.0 {
        shear / law.shear_stiffness
    } else {
        DVec3::ZERO
    };
    (separation.opening * normal + slip, separation.aperture)
}
