//! What of a converged state the loads do not determine.
//!
//! A block that nothing holds any more, but nothing pushes either, may lie anywhere: jumps beside
//! it are balanced, but another solver would find others. And where slip has stored more energy
//! than the walls are pressed together for, an open fracture would balance the same tractions.

use faer::{Mat, Scale};
use kluft_mesh::facet_area_vector;

use super::facet_points::{interface, tangent};
use super::free_blocks;
use crate::space::rigid_modes::{self, FreeMotions};
use crate::system::{State, System};

/// Jump of a free motion of unit size, in units of the body, above which it is none of rounding.
const MOVES: f64 = 1e-6;
/// Stiffness of walls that slide, against that of the rock beside them, above which their friction
/// holds a motion that leads off their slip.
const HELD_BY_SLIDING: f64 = 1e-6;
/// Most free motions that are compared with what sliding resists.
const MOST_MOTIONS: usize = 60;
/// Share of the largest traction of a fracture below which the thrust of slip does not matter.
const SMALL_THRUST: f64 = 1e-3;

/// What the loads determine at a facet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Determinacy {
    /// All.
    Determined = 0,
    /// Not the slip: its walls slide freely.
    Slip = 1,
    /// Neither aperture nor slip: the rock on one side floats.
    Aperture = 2,
    /// A closed facet that its slip could as well hold open.
    Metastable = 3,
}

/// What the loads determine at each facet in a converged state; nothing is said of systems without
/// kinks, whose state is unique, and of bodies too many to tell.
pub fn determinacy(system: &System<'_>, state: &State) -> Option<Vec<Determinacy>> {
    if system.is_smooth() {
        return None;
    }
    let mut facets = floating(system, state)?;
    for (point, own) in interface(system).points.iter().zip(&state.facet_points) {
        let thrust = system.law(point).largest_thrust(&own.joint);
        let matters = thrust > SMALL_THRUST * state.reached.traction;
        let facet = &mut facets[point.facet as usize];
        if matters && thrust > -own.joint.normal_traction && *facet == Determinacy::Determined {
            *facet = Determinacy::Metastable;
        }
    }
    Some(facets)
}

/// What free motions of blocks leave undetermined at each facet; nothing of too many bodies.
pub(super) fn floating(system: &System<'_>, state: &State) -> Option<Vec<Determinacy>> {
    let mut free = free_motions(system, state)?;
    if free.count() <= MOST_MOTIONS {
        let resistance = resistance_of_sliding(system, state, &free);
        free = free.unresisted(&resistance, HELD_BY_SLIDING)?;
    }
    Some(of_facets(system, &free))
}

fn free_motions(system: &System<'_>, state: &State) -> Option<FreeMotions> {
    let (problem, space) = (system.problem, &system.discretisation);
    let ties = free_blocks::ties(system, state);
    rigid_modes::free_motions(problem, &space.points, &space.supports, &ties)
}

/// The work of each of the motions along each other against the tangents, as a share of that of
/// springs as stiff as the rock beside the walls. Walls that slide resist another direction than
/// that of their slip, into which their friction would turn: a wedge whose walls slide in two
/// directions moves in neither.
fn resistance_of_sliding(system: &System<'_>, state: &State, free: &FreeMotions) -> Mat<f64> {
    let mesh = &system.problem.mesh;
    let count = free.count();
    let (mut sum, mut area) = (Mat::<f64>::zeros(count, count), 0.0);
    for (point, own) in interface(system).points.iter().zip(&state.facet_points) {
        let jumps = free.jumps(mesh, point.facet as usize, point.position);
        let tangent = tangent(system.law(point), point, own).positive;
        let share = point.area / point.spring;
        for (i, a) in jumps.iter().enumerate() {
            for (j, b) in jumps.iter().enumerate() {
                sum[(i, j)] += share * a.dot(tangent * *b);
            }
        }
        area += if jumps.is_empty() { 0.0 } else { point.area };
    }
    sum * Scale(1.0 / f64::max(area, f64::MIN_POSITIVE))
}

/// What motions leave undetermined at each facet.
fn of_facets(system: &System<'_>, free: &FreeMotions) -> Vec<Determinacy> {
    let mesh = &system.problem.mesh;
    let of_facet = |facet: usize| {
        let corners = mesh.corners(&mesh.facets.elements, facet);
        let normal = facet_area_vector(&corners).normalize();
        let jumps = corners.into_iter();
        let jumps = jumps.flat_map(|at| free.jumps(mesh, facet, at));
        jumps.fold(Determinacy::Determined, |found, jump| {
            let across = jump.dot(normal).abs();
            if across > MOVES || found == Determinacy::Aperture {
                Determinacy::Aperture
            } else if jump.length() > MOVES {
                Determinacy::Slip
            } else {
                found
            }
        })
    };
    let facets = 0..mesh.facets.elements.len();
    facets.map(of_facet).collect()
}
