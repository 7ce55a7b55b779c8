//! The facet points of an increment: where each is linearised, and how it follows the linear
//! solves.

use glam::{DMat3, DVec3};
use lie_core::{FractureLaw, JointState, RockStiffness, Tangent, TrialState};
use rayon::prelude::*;

use super::last_trial::LastTrial;
use crate::assembly::facet_point::FacetPoint;
use crate::assembly::interface::Interface;
use crate::linear::Tangents;
use crate::problem::Load;
use crate::system::{FacetPointState, State, System};

/// Stiffness that stands for walls in contact, against that of the rock beside them. Their
/// tractions follow by increments, so it decides how fast they converge and not where.
const RIGID: f64 = 1e6;

/// Share of its aperture that the walls beside a fluid keep in one iteration.
const LEAST_SHARE: f64 = 0.1;

pub(super) fn interface<'a>(system: &'a System<'_>) -> &'a Interface {
    &system.discretisation.interface
}

/// Takes the state to another load: prescribed displacements move walls that are held.
pub(super) fn move_supports(system: &System<'_>, state: &mut State, load: &Load) {
    let jumps = interface(system).prescribed_change(&state.load, load);
    state.load.clone_from(load);
    let pairs = jumps.par_iter().zip(&mut state.facet_points);
    pairs.for_each(|(jump, state)| state.jump_residual += *jump);
}

/// Makes a converged state the one that the next increment starts from.
pub(super) fn commit(system: &System<'_>, state: &mut State) {
    let points = interface(system).points.par_iter();
    let pairs = points.zip(&mut state.facet_points);
    pairs.for_each(|(point, state)| {
        let law = system.law(point);
        law.commit(&mut state.joint, &mut state.history);
    });
}

/// What stands for the laws in a linear solve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Linearisation {
    /// Their tangents, as Newton's method has it.
    Tangents,
    /// Springs as stiff as the rock beside them, see `splitting`.
    Springs,
}

/// The planes on which a linear solve takes the laws to be.
pub(super) struct Linearised {
    /// Stiffnesses (Pa/m).
    pub(super) tangents: Tangents,
    /// Where they come from.
    pub(super) by: Linearisation,
    /// Stiffness of dashpots beside the laws, against that of the rock beside them.
    pub(super) dashpots: f64,
}

/// The planes of the laws at the state, without dashpots.
pub(super) fn linearised(system: &System<'_>, state: &State, by: Linearisation) -> Linearised {
    let tangents = match by {
        Linearisation::Tangents => tangents(system, state),
        Linearisation::Springs => springs(system, state),
    };
    Linearised {
        tangents,
        by,
        dashpots: 0.0,
    }
}

/// Tangents of the laws at the state (Pa/m).
pub(super) fn tangents(system: &System<'_>, state: &State) -> Tangents {
    let points = interface(system).points.par_iter().zip(&state.facet_points);
    if system.is_smooth() {
        let exact = points.map(|(point, state)| {
            let law = system.law(point);
            let tangent = law.tangent(&state.joint, &state.history, point.normal, f64::INFINITY);
            tangent.exact
        });
        let exact: Vec<DMat3> = exact.collect();
        return exact.into();
    }
    let tangents = points.map(|(point, state)| tangent(system.law(point), point, state));
    let (exact, positive): (Vec<DMat3>, Vec<DMat3>) = tangents
        .map(|tangent| (tangent.exact, tangent.positive))
        .unzip();
    Tangents {
        positive: (positive != exact).then_some(positive),
        exact,
    }
}

/// Stiffness of the rock beside each point in place of the tangents, except those of linear laws.
fn springs(system: &System<'_>, state: &State) -> Tangents {
    let points = interface(system).points.par_iter();
    let all: Vec<DMat3> = points
        .zip(&state.facet_points)
        .map(|(point, state)| match system.law(point) {
            law if law.is_linear() => tangent(law, point, state).exact,
            _ => point.spring * DMat3::IDENTITY,
        })
        .collect();
    all.into()
}

/// The tangents with stiffness against sudden motions of walls: `damping` times that of the rock
/// beside them.
pub(super) fn damped(system: &System<'_>, tangents: &Tangents, damping: f64) -> Tangents {
    let points = &interface(system).points;
    let damped = |tangents: &Vec<DMat3>| {
        let pairs = tangents.iter().zip(points);
        pairs
            .map(|(tangent, point)| *tangent + damping * point.spring * DMat3::IDENTITY)
            .collect()
    };
    Tangents {
        exact: damped(&tangents.exact),
        positive: tangents.positive.as_ref().map(damped),
    }
}

/// The tangent of a law (Pa/m) that a return mapping corrects: walls that are all but closed are no
/// stiffer than those in contact, which matrices would not bear.
pub(super) fn tangent(law: &FractureLaw, point: &FacetPoint, state: &FacetPointState) -> Tangent {
    let rigid = match law.is_linear() {
        true => f64::INFINITY,
        false => RIGID * point.spring,
    };
    law.tangent(&state.joint, &state.history, point.normal, rigid)
}

/// Tractions on the tangent planes of the laws (Pa).
pub(super) fn linearised_tractions(
    system: &System<'_>,
    state: &State,
    tangents: &Tangents,
) -> Vec<DVec3> {
    let points = interface(system).points.par_iter();
    points
        .zip(&state.facet_points)
        .zip(&tangents.exact)
        .map(|((point, state), tangent)| {
            state.joint.traction(point.normal) + *tangent * state.jump_residual
        })
        .collect()
}

/// Adds to the tractions (Pa) of all facet points.
pub(super) fn pull(system: &System<'_>, state: &mut State, tractions: &[DVec3]) {
    let points = interface(system).points.iter().zip(tractions);
    for ((point, traction), state) in points.zip(&mut state.facet_points) {
        let across = traction.dot(point.normal);
        state.joint.normal_traction += across;
        state.joint.shear += *traction - across * point.normal;
    }
}

/// Moves all facet points by the change of their jumps (m) to where they are linearised next;
/// returns their closure errors (Pa).
pub(super) fn follow(
    system: &System<'_>,
    state: &mut State,
    last: &mut [LastTrial],
    changes: &[DVec3],
    planes: &Linearised,
) -> Vec<f64> {
    let flow = system.coupling().filter(|_| system.is_smooth());
    let follows = |law: &FractureLaw, trial: &TrialState, state: &FacetPointState| {
        flow.is_some_and(|flow| opens(trial, state) || (law.lets_walls_pass() && flow.traps()))
    };
    let points = interface(system).points.par_iter();
    points
        .zip(changes)
        .zip(&planes.tangents.exact)
        .zip(state.facet_points.par_iter_mut().zip(last))
        .map(|(((point, change), tangent), (state, last))| {
            let law = system.law(point);
            let before = *last;
            let trial = last.moved(point, state, *tangent, *change);
            match planes.by {
                Linearisation::Springs if !law.is_linear() => split(law, point, trial, state),
                Linearisation::Tangents if follows(law, &trial, state) => {
                    at_jump(law, point, &trial, state)
                }
                _ => {
                    let beside = beside_dashpots(point, planes.dashpots);
                    follow_point(law, &beside, &trial, state, &before)
                }
            }
        })
        .collect()
}

/// A facet point beside which dashpots stiffen the rock by a share.
fn beside_dashpots(point: &FacetPoint, share: f64) -> FacetPoint {
    FacetPoint {
        spring: (1.0 + share) * point.spring,
        ..*point
    }
}

pub(super) fn follow_point(
    law: &FractureLaw,
    point: &FacetPoint,
    trial: &TrialState,
    state: &mut FacetPointState,
    before: &LastTrial,
) -> f64 {
    let secant = before.secant_to(trial).clamp(0.0, point.spring);
    let rock = rock_stiffness(law, point, trial, secant);
    update_state(law, point, trial, rock, state)
}

/// Whether a linear solve opens a facet point.
fn opens(trial: &TrialState, state: &FacetPointState) -> bool {
    trial.separation.beyond(state.joint.separation) > 0.0
}

/// Moves a facet point, whose law is smooth, to where a linear solve has put its walls, but no
/// closer than to a share of its aperture if the law keeps them apart; returns its closure error
/// (Pa).
fn at_jump(
    law: &FractureLaw,
    point: &FacetPoint,
    trial: &TrialState,
    state: &mut FacetPointState,
) -> f64 {
    let before = state.joint.separation;
    let least = LEAST_SHARE * before.aperture;
    let is_too_close = trial.separation.aperture < least && !law.closure.kind.may_overlap();
    let separation = match is_too_close {
        true => before.moved(least - before.aperture),
        false => trial.separation,
    };
    state.jump_residual = trial.separation.beyond(separation) * point.normal;
    state.joint = law.state_at(&TrialState {
        separation,
        ..*trial
    });
    let traction = trial.normal_traction * point.normal + trial.shear;
    (traction - state.joint.traction(point.normal)).length()
}

/// The half step of the laws in the splitting: from the traction that the law had, not from what
/// the spring made of it.
fn split(
    law: &FractureLaw,
    point: &FacetPoint,
    trial: TrialState,
    state: &mut FacetPointState,
) -> f64 {
    let trial = TrialState {
        normal_traction: state.joint.normal_traction,
        shear: state.joint.shear,
        ..trial
    };
    let spring = RockStiffness {
        normal: point.spring,
        shear: point.spring,
    };
    update_state(law, point, &trial, spring, state)
}

/// Moves a facet point to where its law balances the rock; returns its closure error (Pa).
fn update_state(
    law: &FractureLaw,
    point: &FacetPoint,
    trial: &TrialState,
    rock: RockStiffness,
    state: &mut FacetPointState,
) -> f64 {
    let joint = if law.is_linear() {
        law.state_at(trial)
    } else {
        law.return_map(trial, rock, &state.history)
    };
    state.joint = joint;
    state.jump_residual = jump_beyond(point, trial, &joint);
    let traction = trial.normal_traction * point.normal + trial.shear;
    (traction - joint.traction(point.normal))
        .length()
        .max(point.spring * state.jump_residual.length())
}

/// How much further apart the walls are at a trial state than a law has them (m).
pub(super) fn jump_beyond(point: &FacetPoint, trial: &TrialState, joint: &JointState) -> DVec3 {
    let opening = trial.separation.beyond(joint.separation);
    opening * point.normal + trial.slip - joint.slip
}

/// The secant serves where the law is smooth. Two linear solves on different sides of a kink tell
/// nothing of the rock, so there it is the bound.
fn rock_stiffness(
    law: &FractureLaw,
    point: &FacetPoint,
    trial: &TrialState,
    secant: f64,
) -> RockStiffness {
    let bound = point.rock_stiffness();
    let touching = law.closure.normal_stiffness.is_infinite();
    let parted = trial.normal_traction + bound.normal * law.closure.gap(trial.separation) > 0.0;
    let kinked = touching || (parted && !law.closure.is_smooth());
    RockStiffness {
        normal: if kinked { bound.normal } else { secant },
        ..bound
    }
}
