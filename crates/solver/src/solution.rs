//! What a converged state means: displacement, stress, jump, aperture, traction.

use glam::{DMat3, DVec3};
use lie_core::SymmetricStress;
use lie_core::kernel::{self, MAX_NODES};
use rayon::prelude::*;

use crate::interface::FacetPoint;
use crate::system::{FacetPointState, State, System};

/// What a facet point does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FacetState {
    /// Its aperture is at least the initial one.
    Open = 0,
    /// It is closed and does not slide.
    Stuck = 1,
    /// It is closed and slides.
    Slipping = 2,
    /// Its aperture is below the cutoff of its law.
    BelowCutoff = 3,
}

/// Results at one facet point.
#[derive(Debug, Clone, Copy)]
pub struct FacetResult {
    /// `u(plus) - u(minus)` (m), since the state of initial stress.
    pub jump: DVec3,
    /// Normal part of the jump (m).
    pub opening: f64,
    /// Tangential part of the jump (m).
    pub slip: DVec3,
    /// Aperture `b` (m).
    pub aperture: f64,
    /// Traction of the law (Pa), without the fluid pressure.
    pub traction: DVec3,
    /// Its normal part (Pa).
    pub normal_traction: f64,
    /// State.
    pub state: FacetState,
}

/// Fields of one converged state.
#[derive(Debug, Clone)]
pub struct Solution {
    /// Displacement of every point (m).
    pub displacements: Vec<DVec3>,
    /// Mean stress of every cell, initial stress included (Pa).
    pub stresses: Vec<SymmetricStress>,
    /// Results of every facet point.
    pub facet_points: Vec<FacetResult>,
}

/// Derives the fields of a state.
pub fn solution(system: &System<'_>, state: &State) -> Solution {
    let displacements = system.displacements(&state.unknowns, &state.load);
    let cell_count = system.problem.mesh.cells.len();
    let stresses = (0..cell_count)
        .into_par_iter()
        .map(|cell| cell_stress(system, &displacements, cell))
        .collect();
    let interface = &system.discretisation.interface;
    let jumps = interface.jumps(&state.unknowns, &state.load);
    let facet_points = (0..jumps.len())
        .into_par_iter()
        .map(|i| {
            facet_result(
                system,
                &interface.points[i],
                jumps[i],
                &state.facet_points[i],
            )
        })
        .collect();
    Solution {
        displacements,
        stresses,
        facet_points,
    }
}

fn cell_stress(system: &System<'_>, displacements: &[DVec3], cell: usize) -> SymmetricStress {
    let mesh = &system.problem.mesh;
    let mut nodes = [DVec3::ZERO; MAX_NODES];
    let mut moved = [DVec3::ZERO; MAX_NODES];
    let range = mesh.cells.range(cell);
    let count = range.len();
    for (local, slot) in range.enumerate() {
        nodes[local] = mesh.nodes[mesh.cells.nodes[slot] as usize];
        moved[local] = displacements[system.discretisation.points.of_cell_node[slot] as usize];
    }
    let (nodes, moved) = (&nodes[..count], &moved[..count]);
    let shape = mesh.cells.shapes[cell];
    let initial = system.problem.initial_stress.map_or(DMat3::ZERO, |stress| {
        stress.at(kernel::centre(shape, nodes))
    });
    let gradient = kernel::mean_gradient(shape, nodes, moved);
    let s = system.problem.rock(cell).stress(gradient) + initial;
    [
        s.x_axis.x, s.y_axis.y, s.z_axis.z, s.x_axis.y, s.y_axis.z, s.x_axis.z,
    ]
}

fn facet_result(
    system: &System<'_>,
    point: &FacetPoint,
    jump: DVec3,
    state: &FacetPointState,
) -> FacetResult {
    let closure = &system.law(point).closure;
    let aperture = state.walls.separation.aperture;
    let opening = jump.dot(point.normal);
    let traction = state.walls.traction(point.normal);
    let below = closure.cutoff().is_some_and(|cutoff| aperture < cutoff);
    let parted = closure.gap(state.walls.separation) > 0.0;
    let kind = if below && !closure.is_linear() {
        FacetState::BelowCutoff
    } else if state.walls.sliding && state.walls.normal_traction < 0.0 {
        FacetState::Slipping
    } else if parted || closure.normal_stiffness == 0.0 && aperture >= closure.aperture {
        FacetState::Open
    } else {
        FacetState::Stuck
    };
    FacetResult {
        jump,
        opening,
        slip: jump - opening * point.normal,
        aperture,
        traction,
        normal_traction: traction.dot(point.normal),
        state: kind,
    }
}
