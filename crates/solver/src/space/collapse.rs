//! Loads beyond what fractures can bear, whatever the path (upper bound theorem of limit analysis,
//! Drucker, Prager and Greenberg 1952).
//!
//! Rigid motions `v` of blocks on which loads `F` do more work than the walls can spend,
//!
//! ```text
//! F . v > sum A (c |[v]_t| + f_t n . [v]),   n . [v] >= tan(phi) |[v]_t|  on every wall,
//! ```
//!
//! leave no equilibrium, with cohesion `c` and tensile strength `f_t`. Walls that dilate less than
//! they rub bear no more than these (Radenkovic 1961). Walls that nothing lets slide but opening
//! have `[v]_t = 0`. Of all such motions the projection of `F` onto their cone is tried, found with
//! planes that cut off what lies outside (Kelley 1960), and that along which walls with cohesion do
//! not slide.

use glam::DVec3;
use lie_core::{FractureLaw, Tension};

use super::corner::{Corner, corners, length, unit};
use super::mechanism::MOST_MOTIONS;
use super::reactions::Reactions;
use super::rigid_modes::{FreeMotions, Tie};
use crate::problem::Problem;

/// Rounds of planes.
const MOST_ROUNDS: usize = 50;
/// Opening that a motion lacks at a corner, against the motion, that counts as none.
const SMALL: f64 = 1e-6;
/// Most components of motions at corners that are looked at.
const MOST_COMPONENTS: usize = 1_000_000;

/// What a law binds whatever the loads.
pub(crate) fn tie(law: &FractureLaw) -> Tie {
    let is_bound = matches!(law.closure.tension, Tension::Elastic);
    Tie {
        across: is_bound && law.closure.normal_stiffness > 0.0,
        along: is_bound && law.shear_stiffness > 0.0,
    }
}

/// Walls at a corner of a facet.
struct Wall<'a> {
    corner: Corner,
    law: &'a FractureLaw,
}

impl Wall<'_> {
    /// Directions in which walls may move only one way; `glue` keeps walls with cohesion from
    /// sliding.
    fn one_way(&self, glue: bool) -> Vec<Vec<f64>> {
        let normal = self.corner.normal;
        let (first, second) = normal.any_orthonormal_pair();
        let is_glued = match self.law.friction {
            Some(friction) => glue && friction.cohesion > 0.0,
            None => self.law.shear_stiffness > 0.0,
        };
        let glued = [first, -first, second, -second].into_iter();
        let glued = glued.filter(|_| is_glued);
        let all = std::iter::once(normal).chain(glued);
        all.map(|direction| self.corner.along(direction)).collect()
    }

    /// The plane that cuts off a motion along which walls slide without opening enough.
    fn cut(&self, motion: &[f64]) -> Option<Vec<f64>> {
        let (opening, slip) = self.parts(motion);
        let slope = self.law.friction?.coefficient;
        let is_outside = opening < slope * slip.length() - SMALL * length(motion);
        is_outside.then(|| {
            let normal = self.corner.normal;
            self.corner.along(normal - slope * slip.normalize())
        })
    }

    /// How far a motion opens the walls, and how far it lets them slide.
    fn parts(&self, motion: &[f64]) -> (f64, DVec3) {
        let moved = self.corner.jumps.iter().zip(motion);
        let jump: DVec3 = moved.map(|(jump, share)| *jump * *share).sum();
        let normal = self.corner.normal;
        let opening = jump.dot(normal);
        (opening, jump - opening * normal)
    }

    /// What walls that move spend (N times the motion).
    fn spends(&self, motion: &[f64]) -> f64 {
        let (opening, slip) = self.parts(motion);
        let cohesion = self.law.friction.map_or(0.0, |friction| friction.cohesion);
        let strength = match self.law.closure.tension {
            Tension::Cohesive { strength, .. } => strength,
            Tension::CutOff | Tension::Elastic => 0.0,
        };
        self.corner.area * (cohesion * slip.length() + strength * opening.max(0.0))
    }
}

/// What walls bear of loads on blocks that may move freely.
pub(crate) struct Resistance<'a> {
    walls: Vec<Wall<'a>>,
}

impl<'a> Resistance<'a> {
    /// Of all walls between blocks; none if there are too many motions to tell.
    pub(crate) fn of(
        free: &FreeMotions,
        problem: &Problem,
        laws: &'a [FractureLaw],
    ) -> Option<Self> {
        let count = free.count();
        if !(1..=MOST_MOTIONS).contains(&count) {
            return None;
        }
        let wall = |corner: Corner| Wall {
            law: &laws[corner.fracture],
            corner,
        };
        let walls: Vec<Wall> = corners(free, problem).into_iter().map(wall).collect();
        (walls.len() * count <= MOST_COMPONENTS).then_some(Self { walls })
    }

    /// The motion of a mechanism that loads (N, as work along each free motion) drive and no wall
    /// can stop, and the force that is left to drive it (N); none if this finds none.
    pub(crate) fn exceeded_by(&self, loads: &[f64]) -> Option<(Vec<f64>, f64)> {
        let found = [false, true].map(|glue| self.tried(loads, glue));
        let found = found.into_iter().flatten();
        let most = found.max_by(|a, b| a.1.total_cmp(&b.1));
        most.filter(|(_, left)| *left > 0.0)
    }

    /// The projection of loads onto the cone of motions, and the force that walls leave to drive it
    /// (N).
    fn tried(&self, loads: &[f64], glue: bool) -> Option<(Vec<f64>, f64)> {
        let one_way = self.walls.iter().flat_map(|wall| wall.one_way(glue));
        let mut openings: Vec<Vec<f64>> = one_way.filter_map(|own| unit(&own)).collect();
        for _ in 0..MOST_ROUNDS {
            let all = Reactions {
                openings: &openings,
                forces: loads,
            };
            let (_, along) = all.find()?;
            let cuts = self.walls.iter().filter_map(|wall| wall.cut(&along));
            let cuts: Vec<Vec<f64>> = cuts.filter_map(|own| unit(&own)).collect();
            if !cuts.is_empty() {
                openings.extend(cuts);
                continue;
            }
            let spent: f64 = self.walls.iter().map(|wall| wall.spends(&along)).sum();
            // A projection onto a cone does as much work as the square of its length.
            let size = length(&along);
            return (size > 0.0).then(|| (along, size - spent / size));
        }
        None
    }
}
