//! Mechanisms: rigid motions of blocks that nothing resists, no wall stops, and forces push
//! (theorem of the mechanism, Drucker, Prager and Greenberg 1952).
//!
//! Walls may move apart without end but not into each other, so the motions `v` form a cone,
//! `n . [v] >= 0` on every facet. Forces `w` push along the projection of `w` onto it, found with
//! the reactions `r >= 0` of the walls that stop the rest (Hildreth 1957):
//!
//! ```text
//! v = w + sum r n . [.]
//! ```
//!
//! If that is zero, walls will stop whatever moves. If `sum (r tan(phi) + c A) >= |v|` over the
//! walls with reactions, their friction may hold it.

use glam::DVec3;
use kluft_mesh::facet_area_vector;
use lie_core::FractureLaw;

use super::rigid_modes::{FreeMotions, dot};
use super::sector_nodes::SectorNodes;
use crate::problem::Problem;

/// Sweeps over all facets.
const SWEEPS: usize = 200;
/// Change of a sweep, against the forces, that ends them.
const SMALL_CHANGE: f64 = 1e-4;
/// Reaction of a wall, against the forces, that counts as none.
const NO_REACTION: f64 = 1e-3;
/// Most free motions that are compared with the walls; of more, all that is pushed counts.
const MOST_MOTIONS: usize = 60;
/// Normal jump of a motion, lengths in units of the body, that is rounding.
const ROUNDING: f64 = 1e-9;

/// A corner of a facet that free motions open or close.
struct Wall {
    /// How far each motion opens it.
    opening: Vec<f64>,
    /// The square of its length.
    square: f64,
    fracture: usize,
    /// Its share of the facet's area (m^2).
    area: f64,
    /// Force by which it stops motions (N).
    reaction: f64,
}

/// What forces push along free motions.
pub(crate) struct Push {
    /// The part of the forces that no wall stops, as coefficients of the motions (N).
    pub(crate) along: Vec<f64>,
    /// Force that friction of the walls which stop the rest may bear (N).
    friction: f64,
}

impl Push {
    /// What forces (N, on the unknowns) push.
    pub(crate) fn of(
        free: &FreeMotions,
        problem: &Problem,
        points: &SectorNodes,
        forces: &[DVec3],
    ) -> Self {
        let mut along = free.work(&problem.mesh, points, forces);
        if along.len() > MOST_MOTIONS {
            return Self {
                along,
                friction: 0.0,
            };
        }
        let size = length(&along);
        let mut walls = walls(free, problem);
        for _ in 0..SWEEPS {
            let change = walls.iter_mut().map(|wall| wall.stop(&mut along));
            if change.fold(0.0, f64::max) <= SMALL_CHANGE * size {
                break;
            }
        }
        let stopping = walls
            .iter()
            .filter(|wall| wall.reaction > NO_REACTION * size);
        Self {
            friction: stopping.map(|wall| wall.friction(problem)).sum(),
            along,
        }
    }

    /// Its size (N).
    pub(crate) fn size(&self) -> f64 {
        length(&self.along)
    }

    /// Whether friction may hold it.
    pub(crate) fn is_held(&self) -> bool {
        self.friction >= self.size()
    }
}

impl Wall {
    /// Changes its reaction so that `along` does not close it; returns by how much `along` changed.
    fn stop(&mut self, along: &mut [f64]) -> f64 {
        let closing = -dot(&self.opening, along) / self.square;
        let next = f64::max(self.reaction + closing, 0.0);
        let added = next - self.reaction;
        self.reaction = next;
        for (entry, opening) in along.iter_mut().zip(&self.opening) {
            *entry += added * opening;
        }
        added.abs() * self.square.sqrt()
    }

    /// The force along it that it can bear once it is closed (N).
    fn friction(&self, problem: &Problem) -> f64 {
        let FractureLaw {
            shear_stiffness,
            friction,
            ..
        } = problem.fractures[self.fracture].law;
        match friction {
            Some(friction) => friction.coefficient * self.reaction + friction.cohesion * self.area,
            None if shear_stiffness > 0.0 => f64::INFINITY,
            None => 0.0,
        }
    }
}

/// All corners of facets but those that no motion opens or closes.
fn walls(free: &FreeMotions, problem: &Problem) -> Vec<Wall> {
    let mesh = &problem.mesh;
    let of_facet = |facet: usize| {
        let corners = mesh.corners(&mesh.facets.elements, facet);
        let area = facet_area_vector(&corners);
        let share = area.length() / corners.len() as f64;
        let wall = move |at: DVec3| {
            let jumps = free.jumps(mesh, facet, at);
            let opening: Vec<f64> = jumps
                .iter()
                .map(|jump| jump.dot(area.normalize()))
                .collect();
            Wall {
                square: dot(&opening, &opening),
                opening,
                fracture: mesh.facets.fracture[facet] as usize,
                area: share,
                reaction: 0.0,
            }
        };
        corners.into_iter().map(wall)
    };
    let all = (0..mesh.facets.elements.len()).flat_map(of_facet);
    all.filter(|wall| wall.square > ROUNDING * ROUNDING)
        .collect()
}

fn length(vector: &[f64]) -> f64 {
    dot(vector, vector).sqrt()
}
