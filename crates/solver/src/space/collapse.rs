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
use kluft_mesh::facet_area_vector;
use lie_core::{FractureLaw, Tension};

use super::mechanism::{MOST_MOTIONS, ROUNDING, length};
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

/// How walls part at a corner of a facet.
struct Corner {
    law: FractureLaw,
    /// Jump of each motion.
    jumps: Vec<DVec3>,
    normal: DVec3,
    /// Its share of the facet's area (m^2).
    area: f64,
}

impl Corner {
    /// How far each motion moves the walls in a direction.
    fn along(&self, direction: DVec3) -> Vec<f64> {
        self.jumps.iter().map(|jump| jump.dot(direction)).collect()
    }

    /// Directions in which walls may move only one way; `glue` keeps walls with cohesion from
    /// sliding.
    fn one_way(&self, glue: bool) -> Vec<Vec<f64>> {
        let (first, second) = self.normal.any_orthonormal_pair();
        let is_glued = match self.law.friction {
            Some(friction) => glue && friction.cohesion > 0.0,
            None => self.law.shear_stiffness > 0.0,
        };
        let glued = [first, -first, second, -second].into_iter();
        let glued = glued.filter(|_| is_glued);
        let all = std::iter::once(self.normal).chain(glued);
        all.map(|direction| self.along(direction)).collect()
    }

    /// The plane that cuts off a motion along which walls slide without opening enough.
    fn cut(&self, motion: &[f64]) -> Option<Vec<f64>> {
        let (opening, slip) = self.parts(motion);
        let slope = self.law.friction?.coefficient;
        let is_outside = opening < slope * slip.length() - SMALL * length(motion);
        is_outside.then(|| self.along(self.normal - slope * slip.normalize()))
    }

    /// How far a motion opens the walls, and how far it lets them slide.
    fn parts(&self, motion: &[f64]) -> (f64, DVec3) {
        let moved = self.jumps.iter().zip(motion);
        let jump: DVec3 = moved.map(|(jump, share)| *jump * *share).sum();
        let opening = jump.dot(self.normal);
        (opening, jump - opening * self.normal)
    }

    /// What walls that move spend (N times the motion).
    fn spends(&self, motion: &[f64]) -> f64 {
        let (opening, slip) = self.parts(motion);
        let cohesion = self.law.friction.map_or(0.0, |friction| friction.cohesion);
        let strength = match self.law.closure.tension {
            Tension::Cohesive { strength, .. } => strength,
            Tension::CutOff | Tension::Elastic => 0.0,
        };
        self.area * (cohesion * slip.length() + strength * opening.max(0.0))
    }
}

/// The motion of a mechanism that loads (N, as work along each free motion) drive and no wall can
/// stop, and the force that is left to drive it (N); none if this finds none.
pub(crate) fn find(
    free: &FreeMotions,
    problem: &Problem,
    laws: &[FractureLaw],
    loads: &[f64],
) -> Option<(Vec<f64>, f64)> {
    if loads.is_empty() || loads.len() > MOST_MOTIONS {
        return None;
    }
    let corners = corners(free, problem, laws);
    if corners.len() * loads.len() > MOST_COMPONENTS {
        return None;
    }
    let found = [false, true].map(|glue| tried(&corners, loads, glue));
    let most = found
        .into_iter()
        .flatten()
        .max_by(|a, b| a.1.total_cmp(&b.1));
    most.filter(|(_, left)| *left > 0.0)
}

/// The projection of loads onto the cone of motions, and the force that walls leave to drive it
/// (N).
fn tried(corners: &[Corner], loads: &[f64], glue: bool) -> Option<(Vec<f64>, f64)> {
    let unit = |opening: Vec<f64>| -> Option<Vec<f64>> {
        let size = length(&opening);
        let unit = || opening.iter().map(|entry| entry / size).collect();
        (size > ROUNDING).then(unit)
    };
    let one_way = corners.iter().flat_map(|corner| corner.one_way(glue));
    let mut openings: Vec<Vec<f64>> = one_way.filter_map(unit).collect();
    for _ in 0..MOST_ROUNDS {
        let all = Reactions {
            openings: &openings,
            forces: loads,
        };
        let (_, along) = all.find()?;
        let cuts = corners.iter().filter_map(|corner| corner.cut(&along));
        let cuts: Vec<Vec<f64>> = cuts.filter_map(unit).collect();
        if !cuts.is_empty() {
            openings.extend(cuts);
            continue;
        }
        let spent: f64 = corners.iter().map(|corner| corner.spends(&along)).sum();
        // A projection onto a cone does as much work as the square of its length.
        let size = length(&along);
        return (size > 0.0).then(|| (along, size - spent / size));
    }
    None
}

/// Corners of facets between blocks.
fn corners(free: &FreeMotions, problem: &Problem, laws: &[FractureLaw]) -> Vec<Corner> {
    let mesh = &problem.mesh;
    let of_facet = |facet: usize| {
        let corners = mesh.corners(&mesh.facets.elements, facet);
        let area = facet_area_vector(&corners);
        let share = area.length() / corners.len() as f64;
        corners.into_iter().map(move |at| Corner {
            law: laws[mesh.facets.fracture[facet] as usize],
            jumps: free.jumps(mesh, facet, at),
            normal: area.normalize(),
            area: share,
        })
    };
    let all = (0..mesh.facets.elements.len()).flat_map(of_facet);
    all.filter(|corner| !corner.jumps.is_empty()).collect()
}
