//! Corners of facets between blocks, and how rigid motions part their walls.

use glam::DVec3;
use kluft_mesh::facet_area_vector;

use super::rigid_modes::{FreeMotions, dot};
use crate::problem::Problem;

/// Length of a motion of walls, in units of the body, that is rounding.
const ROUNDING: f64 = 1e-9;

/// A corner of a facet between blocks that free motions move.
pub(super) struct Corner {
    pub(super) fracture: usize,
    /// Jump of each motion.
    pub(super) jumps: Vec<DVec3>,
    pub(super) normal: DVec3,
    /// Its share of the facet's area (m^2).
    pub(super) area: f64,
}

impl Corner {
    /// How far each motion moves the walls in a direction.
    pub(super) fn along(&self, direction: DVec3) -> Vec<f64> {
        self.jumps.iter().map(|jump| jump.dot(direction)).collect()
    }
}

/// All corners of facets between blocks.
pub(super) fn corners(free: &FreeMotions, problem: &Problem) -> Vec<Corner> {
    let mesh = &problem.mesh;
    let of_facet = |facet: usize| {
        let corners = mesh.corners(&mesh.facets.elements, facet);
        let area = facet_area_vector(&corners);
        let share = area.length() / corners.len() as f64;
        corners.into_iter().map(move |at| Corner {
            fracture: mesh.facets.fracture[facet] as usize,
            jumps: free.jumps(mesh, facet, at),
            normal: area.normalize(),
            area: share,
        })
    };
    let all = (0..mesh.facets.elements.len()).flat_map(of_facet);
    all.filter(|corner| !corner.jumps.is_empty()).collect()
}

/// A vector in units of its length; none if that is rounding.
pub(super) fn unit(vector: &[f64]) -> Option<Vec<f64>> {
    let size = length(vector);
    let unit = || vector.iter().map(|entry| entry / size).collect();
    (size > ROUNDING).then(unit)
}

pub(super) fn length(vector: &[f64]) -> f64 {
    dot(vector, vector).sqrt()
}
