//! Mechanisms: rigid motions of blocks that nothing resists, no wall stops, and forces push
//! (theorem of the mechanism, Drucker, Prager and Greenberg 1952).
//!
//! Walls may move apart without end but not into each other, so the motions `v` form a cone,
//! `n . [v] >= 0` on every facet. Forces `w` push along the projection of `w` onto it, found with
//! the reactions `r >= 0` of the walls that stop the rest:
//!
//! ```text
//! v = w + sum r n . [.]
//! ```
//!
//! If that is zero, walls will stop whatever moves. If `sum (r tan(phi) + c A) >= |v|` over the
//! walls with reactions, and those that the forces close, their friction may hold it.

use glam::DVec3;
use lie_core::FractureLaw;

use super::corner::{Corner, corners, length, unit};
use super::reactions::Reactions;
use super::rigid_modes::{FreeMotions, dot};
use super::sector_nodes::SectorNodes;
use crate::problem::Problem;

/// Reaction of a wall, against the forces, that counts as none.
const NO_REACTION: f64 = 1e-3;
/// Most free motions that are compared with the walls; of more, all that is pushed counts.
pub(super) const MOST_MOTIONS: usize = 60;

/// A corner of a facet that free motions open or close.
struct Wall {
    /// How far each motion opens it.
    opening: Vec<f64>,
    /// The same in units of its length.
    unit: Vec<f64>,
    fracture: usize,
    /// Its share of the facet's area (m^2).
    area: f64,
}

/// What forces push along free motions.
pub(crate) struct Push {
    /// The part of the forces that no wall stops, as coefficients of the motions (N).
    pub(crate) along: Vec<f64>,
    /// Force that friction of the walls which stop the rest may bear (N).
    friction: f64,
}

impl Push {
    /// What forces (N, on the unknowns) push, if walls resist only to be closed.
    pub(crate) fn of(
        free: &FreeMotions,
        problem: &Problem,
        points: &SectorNodes,
        forces: &[DVec3],
    ) -> Self {
        let forces = free.work(&problem.mesh, points, forces);
        let walls = match forces.len() {
            0..=MOST_MOTIONS => walls(free, problem),
            _ => Vec::new(),
        };
        let size = length(&forces);
        let openings: Vec<Vec<f64>> = walls.iter().map(|wall| wall.unit.clone()).collect();
        let all = Reactions {
            openings: &openings,
            forces: &forces,
        };
        let unstopped = || (vec![0.0; walls.len()], forces.clone());
        let (reactions, along) = all.find().unwrap_or_else(unstopped);
        let friction = |(wall, unit): (&Wall, f64)| {
            let reaction = unit / length(&wall.opening);
            let closing = -dot(&wall.opening, &forces);
            let is_met = reaction.max(closing) > NO_REACTION * size;
            is_met.then(|| wall.friction(problem, reaction))
        };
        let friction = walls.iter().zip(reactions).filter_map(friction).sum();
        Self { along, friction }
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
    /// The force along it that it can bear with a reaction (N) once it is closed (N).
    fn friction(&self, problem: &Problem, reaction: f64) -> f64 {
        let FractureLaw {
            shear_stiffness,
            friction,
            ..
        } = problem.fractures[self.fracture].law;
        match friction {
            Some(friction) => friction.coefficient * reaction + friction.cohesion * self.area,
            None if shear_stiffness > 0.0 => f64::INFINITY,
            None => 0.0,
        }
    }
}

/// All corners of facets but those that no motion opens or closes.
fn walls(free: &FreeMotions, problem: &Problem) -> Vec<Wall> {
    let wall = |corner: Corner| {
        let opening = corner.along(corner.normal);
        Some(Wall {
            unit: unit(&opening)?,
            opening,
            fracture: corner.fracture,
            area: corner.area,
        })
    };
    corners(free, problem)
        .into_iter()
        .filter_map(wall)
        .collect()
}
