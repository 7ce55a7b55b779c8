//! What whole parts of a body feel and do: forces on parts of its surface, motions of its blocks.

use glam::{DMat3, DVec3};
use kluft_algebra::trace;
use kluft_mesh::{Shape, cell_volume};
use lie_core::kernel::{self, MAX_NODES};
use lie_core::load_areas;
use rayon::prelude::*;

use crate::assembly::springs;
use crate::problem::{Condition, Problem, Support, SurfaceLoad, VaryingLoad};
use crate::space::cell::Cell;
use crate::system::{State, System};

/// Cells whose forces are kept at a time.
const CELLS_PER_WAVE: usize = 1 << 12;

/// What happens to one part of the outer surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceResultant {
    /// Area (m^2).
    pub area: f64,
    /// Force of what lies outside on the body (N): loads and reactions of supports.
    pub force: DVec3,
    /// Mean displacement by area (m).
    pub displacement: DVec3,
}

/// How a block moves as a whole.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BlockMotion {
    /// Volume (m^3).
    pub volume: f64,
    /// Mean displacement by volume (m).
    pub displacement: DVec3,
    /// Mean rotation by volume, `curl u / 2` (radians), about its direction by the right hand.
    pub rotation: DVec3,
}

/// What happens to each part of the outer surface in a state, whose displacement of all points is
/// given (m).
///
/// The force at a node is what the stress around it leaves over, over all sectors, so that walls of
/// fractures cancel: `r = sum_cells int sigma grad N dV - int N rho g dV`. Each part has its loads
/// there, and of what exceeds them what its support takes by area: `A_s P_s W^+ r` with
/// `W = sum_s A_s P_s`, where `P_s` projects on the directions that the part holds. Where two parts
/// hold the same direction of an edge, the sum is exact and the shares are not.
pub fn surface_resultants(
    system: &System<'_>,
    state: &State,
    displacements: &[DVec3],
) -> Vec<SurfaceResultant> {
    let problem = system.problem();
    let mut surfaces = surfaces(problem, state);
    add_springs(system, displacements, &mut surfaces);
    let nodes = problem.mesh.nodes.len();
    let mut excess = node_forces(system, state, displacements);
    let mut holds = vec![DMat3::ZERO; nodes];
    for corner in surfaces.iter().flatten() {
        excess[corner.node] -= corner.load;
        holds[corner.node] += corner.held;
    }
    let of_point = &system.discretisation().points().of_cell_node;
    let resultant = |(index, surface): (usize, &Vec<Corner>)| {
        let slots = &problem.mesh.boundaries[index].slots;
        let mut sum = SurfaceResultant {
            area: 0.0,
            force: DVec3::ZERO,
            displacement: DVec3::ZERO,
        };
        for (corner, &slot) in surface.iter().zip(slots) {
            let node = corner.node;
            sum.area += corner.area;
            sum.force += corner.load + corner.held * taken(holds[node], excess[node]);
            sum.displacement += corner.area * displacements[of_point[slot as usize] as usize];
        }
        sum.displacement /= sum.area;
        sum
    };
    surfaces.iter().enumerate().map(resultant).collect()
}

/// Share of the held directions that keeps `W` invertible: far below what a step converges to.
const BARELY_HELD: f64 = 1e-12;

/// `W^+ r`.
fn taken(holds: DMat3, excess: DVec3) -> DVec3 {
    let size = trace(holds);
    if size == 0.0 {
        return DVec3::ZERO;
    }
    (holds + BARELY_HELD * size * DMat3::IDENTITY).inverse() * excess
}

/// A node of a facet of the surface.
struct Corner {
    node: usize,
    /// `int N dA` (m^2).
    area: f64,
    /// What the loads and springs of the surface put on it (N).
    load: DVec3,
    /// `A_s P_s` (m^2), with an equal share of the area of the facet: `int N dA` is zero at the
    /// corners of facets of second order.
    held: DMat3,
}

/// What acts on a part of the surface.
struct Acting<'a> {
    loads: Vec<(f64, SurfaceLoad)>,
    varying: Vec<(f64, &'a VaryingLoad)>,
    supports: Vec<Support>,
}

impl<'a> Acting<'a> {
    fn on(problem: &'a Problem, state: &State, boundary: usize) -> Self {
        let cases = &problem.schedule.cases;
        let all = problem.conditions.iter().enumerate();
        let own = all.filter(|(_, condition)| condition.boundary == boundary);
        let load = |(number, condition): (usize, &Condition)| {
            let factor = state.load.factor(cases.of_condition(number));
            Some((factor, condition.load?))
        };
        let varying = problem.varying.loads.iter();
        let varying = varying.filter(|load| load.boundary == boundary);
        Self {
            loads: own.clone().filter_map(load).collect(),
            varying: varying
                .map(|load| (state.load.factor(load.case), load))
                .collect(),
            supports: own.filter_map(|(_, condition)| condition.support).collect(),
        }
    }

    /// The nodes of a facet with these places (m).
    fn corners(&self, shape: Shape, (nodes, places): (&[u32], &[DVec3])) -> Vec<Corner> {
        let areas = load_areas(shape, places);
        let whole: DVec3 = areas.iter().map(|(_, area)| *area).sum();
        let share = whole.length() / nodes.len() as f64;
        let normal = whole.normalize_or_zero();
        let supports = self.supports.iter().map(|support| held(*support, normal));
        let held = share * supports.fold(DMat3::ZERO, |sum, held| sum + held);
        let corner = |(&node, (size, area)): (&u32, (f64, DVec3))| {
            let loads = self.loads.iter();
            let load = loads.map(|(factor, load)| *factor * load.force((size, area)));
            Corner {
                node: node as usize,
                area: size,
                load: load.sum(),
                held,
            }
        };
        let mut corners: Vec<Corner> = nodes.iter().zip(areas).map(corner).collect();
        for (factor, load) in &self.varying {
            let forces = load.forces(shape, places);
            let pairs = corners.iter_mut().zip(forces);
            pairs.for_each(|(corner, force)| corner.load += *factor * force);
        }
        corners
    }
}

/// The nodes of each part of the surface, one entry for each slot of its facets.
fn surfaces(problem: &Problem, state: &State) -> Vec<Vec<Corner>> {
    let mesh = &problem.mesh;
    let all = mesh.boundaries.iter().enumerate();
    all.map(|(index, boundary)| {
        let acting = Acting::on(problem, state, index);
        let elements = &boundary.elements;
        let corners = |facet: usize| {
            let nodes = elements.nodes_of(facet);
            let places: Vec<DVec3> = nodes
                .iter()
                .map(|&node| mesh.nodes[node as usize])
                .collect();
            acting.corners(elements.shapes[facet], (nodes, &places))
        };
        (0..elements.len()).flat_map(corners).collect()
    })
    .collect()
}

/// Adds the forces of springs to the loads of their surfaces.
fn add_springs(system: &System<'_>, displacements: &[DVec3], surfaces: &mut [Vec<Corner>]) {
    let problem = system.problem();
    let points = system.discretisation().points();
    for spring in &problem.springs {
        let count = problem.mesh.boundaries[spring.boundary].elements.len();
        let facets = (0..count).map(|facet| springs::of_facet(problem, points, spring, facet));
        let forces = facets.flat_map(|facet| facet.forces(|point| displacements[point as usize]));
        for (corner, force) in surfaces[spring.boundary].iter_mut().zip(forces) {
            corner.load += force;
        }
    }
}

/// Projector on what a support holds of a facet with a unit normal.
fn held(support: Support, normal: DVec3) -> DMat3 {
    match support {
        Support::Displacement(components) => {
            let is_held = components.map(|component| f64::from(component.is_some()));
            DMat3::from_diagonal(DVec3::from(is_held))
        }
        Support::Symmetry => {
            DMat3::from_cols(normal.x * normal, normal.y * normal, normal.z * normal)
        }
    }
}

/// What the stress leaves over at each node of the outer surface (N), zero elsewhere.
fn node_forces(system: &System<'_>, state: &State, displacements: &[DVec3]) -> Vec<DVec3> {
    let mesh = &system.problem().mesh;
    let mut is_outer = vec![false; mesh.nodes.len()];
    for boundary in &mesh.boundaries {
        for &node in &boundary.elements.nodes {
            is_outer[node as usize] = true;
        }
    }
    let touches = |cell: &usize| {
        mesh.cells
            .nodes_of(*cell)
            .iter()
            .any(|&node| is_outer[node as usize])
    };
    let cells: Vec<usize> = (0..mesh.cells.len())
        .into_par_iter()
        .filter(touches)
        .collect();
    let mut sums = vec![DVec3::ZERO; mesh.nodes.len()];
    for wave in cells.chunks(CELLS_PER_WAVE) {
        let forces: Vec<[DVec3; MAX_NODES]> = wave
            .par_iter()
            .map_init(
                || [DMat3::ZERO; MAX_NODES * MAX_NODES],
                |matrix, &cell| cell_forces(system, state, displacements, (cell, matrix)),
            )
            .collect();
        for (&cell, forces) in wave.iter().zip(forces) {
            let own = mesh.cells.nodes_of(cell).iter();
            for (&node, force) in own
                .zip(forces)
                .filter(|(node, _)| is_outer[**node as usize])
            {
                sums[node as usize] += force;
            }
        }
    }
    sums
}

/// Forces of one cell on its nodes (N): of its stress, less its weight.
fn cell_forces(
    system: &System<'_>,
    state: &State,
    displacements: &[DVec3],
    (index, matrix): (usize, &mut [DMat3]),
) -> [DVec3; MAX_NODES] {
    let problem = system.problem();
    let cell = Cell::of(
        problem,
        system.discretisation().points(),
        displacements,
        index,
    )
    .strained(system.strain_offsets(), index);
    let count = cell.nodes().len();
    let matrix = &mut matrix[..count * count];
    kernel::stiffness(cell.shape, cell.nodes(), cell.rock, matrix);
    let mut forces = [DVec3::ZERO; MAX_NODES];
    for (force, row) in forces.iter_mut().zip(matrix.chunks(count)) {
        *force = row
            .iter()
            .zip(cell.moved())
            .map(|(block, u)| *block * *u)
            .sum();
    }
    if let Some(stress) = problem.initial_stress_in(index) {
        kernel::add_stress_forces(
            cell.shape,
            cell.nodes(),
            |at| stress.at(at),
            &mut forces[..count],
        );
    }
    let factor = state.load.factor(problem.schedule.cases.gravity);
    let weight = factor * cell.rock.density * problem.gravity;
    if weight != DVec3::ZERO {
        kernel::add_body_forces(cell.shape, cell.nodes(), |_| -weight, &mut forces[..count]);
    }
    forces
}

/// How each block moves as a whole, where the displacement of all points is given (m).
pub fn block_motions(system: &System<'_>, displacements: &[DVec3]) -> Vec<BlockMotion> {
    let problem = system.problem();
    let mesh = &problem.mesh;
    let still = BlockMotion {
        volume: 0.0,
        displacement: DVec3::ZERO,
        rotation: DVec3::ZERO,
    };
    let mut sums = vec![still; mesh.block_count];
    let count = mesh.cells.len();
    for start in (0..count).step_by(CELLS_PER_WAVE) {
        let wave = start..count.min(start + CELLS_PER_WAVE);
        let of_cells: Vec<BlockMotion> = wave
            .clone()
            .into_par_iter()
            .map(|index| cell_motion(system, displacements, index))
            .collect();
        for (index, cell) in wave.zip(&of_cells) {
            let sum = &mut sums[mesh.block[index] as usize];
            sum.volume += cell.volume;
            sum.displacement += cell.volume * cell.displacement;
            sum.rotation += cell.volume * cell.rotation;
        }
    }
    for sum in &mut sums {
        sum.displacement /= sum.volume;
        sum.rotation /= sum.volume;
    }
    sums
}

fn cell_motion(system: &System<'_>, displacements: &[DVec3], index: usize) -> BlockMotion {
    let problem = system.problem();
    let mesh = &problem.mesh;
    let cell = Cell::of(
        problem,
        system.discretisation().points(),
        displacements,
        index,
    );
    let mut shares = [DVec3::ZERO; MAX_NODES];
    let shares = &mut shares[..cell.nodes().len()];
    kernel::add_body_forces(cell.shape, cell.nodes(), |_| DVec3::X, shares);
    let whole: f64 = shares.iter().map(|share| share.x).sum();
    let moved = shares.iter().zip(cell.moved());
    let displacement: DVec3 = moved.map(|(share, u)| share.x * *u).sum();
    let h = kernel::mean_gradient(cell.shape, cell.nodes(), cell.moved());
    // H_ij = du_i / dx_j, columns by j.
    let curl = DVec3::new(
        h.y_axis.z - h.z_axis.y,
        h.z_axis.x - h.x_axis.z,
        h.x_axis.y - h.y_axis.x,
    );
    BlockMotion {
        volume: cell_volume(cell.shape, &mesh.corners(&mesh.cells, index)),
        displacement: displacement / whole,
        rotation: 0.5 * curl,
    }
}
