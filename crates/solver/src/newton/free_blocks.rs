//! Blocks that nothing holds once fractures have opened or slide.

use glam::DVec3;
use rayon::prelude::*;

use super::facet_points::{self, interface, tangent};
use super::fluid;
use super::iterate::Iterate;
use crate::problem::Load;
use crate::space::collapse::{self, Resistance};
use crate::space::mechanism::Push;
use crate::space::rigid_modes::{self, FreeBody, FreeMotions, Tie};
use crate::system::{State, System};

/// Stiffness that counts as none, against that of the rock beside a facet point.
const NO_STIFFNESS: f64 = 1e-9;
/// Most bodies of which it is asked before a load step whether they fall, and after an increment
/// that failed whether the load is too much for them.
const MOST_BODIES: usize = 50;
/// Force that pushes a block, against the largest force, above which it is not in balance.
pub(super) const UNBALANCED: f64 = 1e-4;

/// The blocks that the forces of an iterate push along motions that nothing resists and no wall
/// stops, with the fractures that let them.
pub(super) fn find(system: &System<'_>, iterate: &Iterate) -> Vec<FreeBody> {
    let ties = ties(system, &iterate.state);
    let Some((free, push)) = push(system, &iterate.state, &iterate.rock_forces, &ties) else {
        return Vec::new();
    };
    if push.is_held() || push.size() <= UNBALANCED * iterate.sizes.force {
        return Vec::new();
    }
    pushed(system, &free, &push.along, &ties)
}

fn pushed(system: &System<'_>, free: &FreeMotions, along: &[f64], ties: &[Tie]) -> Vec<FreeBody> {
    let remedy = format!(
        "{} has opened or slides there; hold the block, lower the load, or give the fracture friction, cohesion or stiffness",
        untied_fractures(system, ties).join(", ")
    );
    free.bodies(&system.problem.mesh, along, &remedy)
}

/// What the fractures of a system bear, whatever the path.
pub(super) struct Bearing<'a> {
    system: &'a System<'a>,
    ties: Vec<Tie>,
    free: FreeMotions,
    resistance: Resistance<'a>,
}

impl<'a> Bearing<'a> {
    /// None where there is nothing to exceed, or too much to tell; nor where a fluid follows the
    /// walls, whose pressures are not known before.
    pub(super) fn of(system: &'a System<'a>) -> Option<Self> {
        if system.is_smooth() || system.coupling().is_some() {
            return None;
        }
        let (problem, space) = (system.problem, &system.discretisation);
        let laws = system.laws();
        let facets = problem.mesh.facets.fracture.iter();
        let tie = |fracture: &u32| collapse::tie(&laws[*fracture as usize]);
        let ties: Vec<Tie> = facets.map(tie).collect();
        if rigid_modes::body_count(&problem.mesh, &ties) > MOST_BODIES {
            return None;
        }
        let free = rigid_modes::free_motions(problem, &space.points, &space.supports, &ties)?;
        Some(Self {
            resistance: Resistance::of(&free, problem, laws)?,
            system,
            ties,
            free,
        })
    }

    /// The mechanism for which a load is too much, as coefficients of the free motions; none if
    /// none is found.
    pub(super) fn exceeded_by(&self, load: &Load) -> Option<Vec<f64>> {
        let (system, problem) = (self.system, self.system.problem);
        let forces = system.load_forces(load);
        let points = &system.discretisation.points;
        let work = self.free.work(&problem.mesh, points, &forces);
        let (along, force) = self.resistance.exceeded_by(&work)?;
        let rest = vec![DVec3::ZERO; forces.len()];
        let no_tractions = vec![DVec3::ZERO; interface(system).points.len()];
        let scale = system.force_scale(&rest, &no_tractions, load);
        (force > UNBALANCED * scale).then_some(along)
    }

    /// The blocks that a mechanism moves.
    pub(super) fn blocks(&self, along: &[f64]) -> Vec<FreeBody> {
        pushed(self.system, &self.free, along, &self.ties)
    }
}

/// Whether a load pushes blocks from a state through open gaps to walls with friction.
pub(super) fn fall(system: &System<'_>, from: &State, load: &Load) -> bool {
    let ties = ties(system, from);
    let bodies = rigid_modes::body_count(&system.problem.mesh, &ties);
    if !(2..=MOST_BODIES).contains(&bodies) {
        return false;
    }
    let mut state = from.clone();
    facet_points::move_supports(system, &mut state, load);
    let rock_forces = system.rock_forces(&state.unknowns);
    let scale = system.force_scale(&rock_forces, &system.law_tractions(&state), load);
    push(system, &state, &rock_forces, &ties)
        .is_some_and(|(_, push)| push.is_held() && push.size() > UNBALANCED * scale)
}

/// Motions that `ties` leave free, and what the forces push along them; none if there are too many
/// blocks to tell.
fn push(
    system: &System<'_>,
    state: &State,
    rock_forces: &[DVec3],
    ties: &[Tie],
) -> Option<(FreeMotions, Push)> {
    let (problem, space) = (system.problem, &system.discretisation);
    let free = rigid_modes::free_motions(problem, &space.points, &space.supports, ties)?;
    let tractions = fluid::total_tractions(system, state, system.law_tractions(state));
    let residual = system.residual(rock_forces, &tractions, &state.load);
    let push = Push::of(&free, problem, &space.points, &residual);
    Some((free, push))
}

/// Names of the fractures with facets that let their sides move.
fn untied_fractures(system: &System<'_>, ties: &[Tie]) -> Vec<String> {
    let mesh = &system.problem.mesh;
    let facets = std::iter::zip(ties, &mesh.facets.fracture);
    let untied = facets.filter(|(tie, _)| !(tie.across && tie.along));
    let mut fractures: Vec<u32> = untied.map(|(_, fracture)| *fracture).collect();
    fractures.sort_unstable();
    fractures.dedup();
    let name = |fracture: &u32| format!("`{}`", mesh.fractures[*fracture as usize]);
    fractures.iter().map(name).collect()
}

/// How each facet holds its two sides together.
pub(super) fn ties(system: &System<'_>, state: &State) -> Vec<Tie> {
    let none = Tie {
        across: false,
        along: false,
    };
    let mut ties = vec![none; system.problem.mesh.facets.elements.len()];
    let points = &interface(system).points;
    let of_points: Vec<Tie> = points
        .par_iter()
        .zip(&state.facet_points)
        .map(|(point, state)| {
            let stiffness = tangent(system.law(point), point, state).positive;
            let across = point.normal.dot(stiffness * point.normal);
            let trace = stiffness.x_axis.x + stiffness.y_axis.y + stiffness.z_axis.z;
            let enough = NO_STIFFNESS * point.spring;
            Tie {
                across: across > enough,
                along: !state.joint.sliding && trace - across > enough,
            }
        })
        .collect();
    for (point, own) in points.iter().zip(of_points) {
        let tie = &mut ties[point.facet as usize];
        tie.across |= own.across;
        tie.along |= own.along;
    }
    ties
}
