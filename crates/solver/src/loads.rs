//! Forces on the unknowns: applied loads, initial stress, prescribed displacements.

use glam::DVec3;
use lie_core::facet_node_weights;
use lie_mesh::facet_area_vector;
use rayon::prelude::*;

use crate::assembly::{self, Frame};
use crate::interface::Interface;
use crate::points::Points;
use crate::problem::SurfaceLoad;
use crate::supports::Supports;

/// Forces on all unknowns [N].
#[derive(Debug, Clone)]
pub struct Loads {
    /// Surface loads, gravity and fluid pressure at load factor 1.
    pub applied: Vec<DVec3>,
    /// What the prescribed displacements ask of the rock at load factor 1.
    pub prescribed: Vec<DVec3>,
    /// What the initial stress of the rock does; never scaled.
    pub initial: Vec<DVec3>,
}

impl Loads {
    pub(crate) fn of(frame: Frame<'_>, interface: &Interface) -> Self {
        let mut applied = assembly::gravity_forces(frame);
        add_surface_loads(frame, &mut applied);
        add_fluid_pressure(frame, interface, &mut applied);
        let negative = |forces: Vec<DVec3>| -> Vec<DVec3> {
            let forces: Vec<DVec3> = forces.into_iter().map(|force| -force).collect();
            on_unknowns(frame.points, frame.supports, &forces)
        };
        Self {
            applied: on_unknowns(frame.points, frame.supports, &applied),
            prescribed: negative(assembly::prescribed_forces(frame)),
            initial: negative(assembly::initial_stress_forces(frame)),
        }
    }
}

/// Forces on the unknowns from forces on the points: `T^T P f`.
pub(crate) fn on_unknowns(points: &Points, supports: &Supports, forces: &[DVec3]) -> Vec<DVec3> {
    let projected: Vec<DVec3> = (0..points.len())
        .into_par_iter()
        .map(|point| supports.project(point, forces[point]))
        .collect();
    (0..points.len())
        .into_par_iter()
        .map(|unknown| points.gather(&projected, unknown))
        .collect()
}

fn add_surface_loads(frame: Frame<'_>, forces: &mut [DVec3]) {
    let mesh = &frame.problem.mesh;
    for condition in &frame.problem.conditions {
        let Some(load) = condition.load else {
            continue;
        };
        let boundary = &mesh.boundaries[condition.boundary];
        for facet in 0..boundary.elements.len() {
            let area = facet_area_vector(&mesh.corners(&boundary.elements, facet));
            let force = match load {
                SurfaceLoad::Traction(traction) => area.length() * traction,
                SurfaceLoad::Pressure(pressure) => -pressure * area,
            };
            let weights = facet_node_weights(boundary.elements.shapes[facet]);
            let slots = &boundary.slots[boundary.elements.range(facet)];
            for (&slot, weight) in slots.iter().zip(weights) {
                forces[frame.points.of_cell_node[slot as usize] as usize] += *weight * force;
            }
        }
    }
}

/// The fluid pushes the walls apart: a traction `p n` on the jump.
fn add_fluid_pressure(frame: Frame<'_>, interface: &Interface, forces: &mut [DVec3]) {
    let push = interface.points.iter().map(|point| {
        frame.problem.fractures[point.fracture as usize].fluid_pressure * point.normal
    });
    let push: Vec<DVec3> = push.collect();
    let on_points = interface.forces(&push, frame.points.len());
    for (force, push) in forces.iter_mut().zip(on_points) {
        *force += push;
    }
}
