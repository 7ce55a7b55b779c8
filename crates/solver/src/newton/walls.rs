//! The facet points of a step: where each is linearised, and how it follows the linear solves.

use glam::{DMat3, DVec3};
use lie_core::{FractureLaw, RockStiffness, Separation, Tangent, TrialState};
use rayon::prelude::*;

use super::Linearisation;
use crate::assembly::facet_point::FacetPoint;
use crate::linear::Tangents;
use crate::problem::Load;
use crate::system::{FacetPointState, State, System};

/// Stiffness that stands for walls in contact, against that of the rock beside them. Their tractions
/// follow by increments, so it decides how fast they settle and not where.
const RIGID: f64 = 1e6;
/// Stiffness against sudden moves of walls that nothing holds, against that of the rock beside them.
/// It enters the matrix only and no balance.
const REINS: f64 = 1e-6;

/// Where the last linear solve of a step put a facet point.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Landed {
    /// Separation of the walls; none before the first solve.
    separation: Option<Separation>,
    /// Normal traction on the tangent plane (Pa).
    traction: f64,
}

impl Landed {
    /// Stiffness of the surrounding rock as two landings tell it, `-dt/dw`; 0 where they tell
    /// nothing.
    fn spring_to(&self, landing: &TrialState) -> f64 {
        let spring = self.separation.map(|before| {
            (self.traction - landing.normal_traction) / landing.separation.beyond(before)
        });
        spring.filter(|spring| spring.is_finite()).unwrap_or(0.0)
    }
}

/// Takes the state to another load: prescribed displacements move walls that are held.
pub(super) fn move_supports(system: &System<'_>, state: &mut State, load: &Load) {
    let interface = &system.discretisation.interface;
    let jumps = interface.prescribed_change(&state.load, load);
    state.load.clone_from(load);
    for (jump, state) in jumps.into_iter().zip(&mut state.facet_points) {
        state.jump_residual += jump;
    }
}

/// Makes a converged state the one that the next step starts from.
pub(super) fn commit(system: &System<'_>, state: &mut State) {
    let points = &system.discretisation.interface.points;
    for (point, state) in points.iter().zip(&mut state.facet_points) {
        let law = system.law(point);
        law.commit(&mut state.joint, &mut state.history);
    }
}

/// Tangents of the laws at the state (Pa/m).
pub(super) fn tangents(system: &System<'_>, state: &State) -> Tangents {
    let points = system.discretisation.interface.points.par_iter();
    let all: Vec<Tangent> = points
        .zip(&state.facet_points)
        .map(|(point, state)| tangent(system.law(point), point, state))
        .collect();
    let exact: Vec<DMat3> = all.iter().map(|tangent| tangent.exact).collect();
    if system.is_smooth() {
        return exact.into();
    }
    let positive: Vec<DMat3> = all.iter().map(|tangent| tangent.positive).collect();
    Tangents {
        positive: (positive != exact).then_some(positive),
        exact,
    }
}

/// The tangents with reins on walls that may come loose.
pub(super) fn reined(system: &System<'_>, tangents: &Tangents) -> Tangents {
    let points = &system.discretisation.interface.points;
    let reined = |tangents: &Vec<DMat3>| {
        let pairs = tangents.iter().zip(points);
        pairs
            .map(|(tangent, point)| *tangent + REINS * point.spring * DMat3::IDENTITY)
            .collect()
    };
    Tangents {
        exact: reined(&tangents.exact),
        positive: tangents.positive.as_ref().map(reined),
    }
}

pub(super) fn tangent(law: &FractureLaw, point: &FacetPoint, state: &FacetPointState) -> Tangent {
    law.tangent(
        &state.joint,
        &state.history,
        point.normal,
        RIGID * point.spring,
    )
}

/// Tractions on the tangent planes of the laws (Pa).
pub(super) fn linearised_tractions(
    system: &System<'_>,
    state: &State,
    tangents: &Tangents,
) -> Vec<DVec3> {
    let points = system.discretisation.interface.points.par_iter();
    points
        .zip(&state.facet_points)
        .zip(&tangents.exact)
        .map(|((point, state), tangent)| {
            state.joint.traction(point.normal) + *tangent * state.jump_residual
        })
        .collect()
}

/// Moves all facet points by the change of their jumps to where they are linearised next; returns
/// their closure errors (Pa).
pub(super) fn follow(
    system: &System<'_>,
    linearisation: Linearisation,
    state: &mut State,
    landed: &mut [Landed],
    changes: &[DVec3],
    tangents: &Tangents,
) -> Vec<f64> {
    let points = system.discretisation.interface.points.par_iter();
    points
        .zip(changes)
        .zip(&tangents.exact)
        .zip(state.facet_points.par_iter_mut().zip(landed))
        .map(|(((point, change), tangent), (state, landed))| {
            let landing = land(point, state, *tangent, *change);
            follow_point(
                system.law(point),
                linearisation,
                point,
                &landing,
                state,
                landed,
            )
        })
        .collect()
}

/// Where a change of the jump (m) takes a facet point on the tangent plane of its law.
fn land(point: &FacetPoint, state: &FacetPointState, tangent: DMat3, change: DVec3) -> TrialState {
    let walls = &state.joint;
    let beyond = state.jump_residual + change;
    let opening = beyond.dot(point.normal);
    let traction = walls.traction(point.normal) + tangent * beyond;
    let across = traction.dot(point.normal);
    TrialState {
        separation: walls.separation.moved(opening),
        slip: walls.slip + beyond - opening * point.normal,
        normal_traction: across,
        shear: traction - across * point.normal,
    }
}

fn follow_point(
    law: &FractureLaw,
    linearisation: Linearisation,
    point: &FacetPoint,
    landing: &TrialState,
    state: &mut FacetPointState,
    landed: &mut Landed,
) -> f64 {
    let secant = landed.spring_to(landing).clamp(0.0, point.spring);
    *landed = Landed {
        separation: Some(landing.separation),
        traction: landing.normal_traction,
    };
    let plain = linearisation == Linearisation::Landed && law.is_smooth();
    state.joint = if law.is_linear() || plain {
        law.state_at(landing)
    } else {
        law.return_map(
            landing,
            springs(law, point, landing, secant),
            &state.history,
        )
    };
    let walls = &state.joint;
    let opening = landing.separation.beyond(walls.separation);
    state.jump_residual = opening * point.normal + landing.slip - walls.slip;
    let traction = landing.normal_traction * point.normal + landing.shear;
    (traction - walls.traction(point.normal))
        .length()
        .max(point.spring * state.jump_residual.length())
}

/// The secant serves where the law is smooth. Two landings on different sides of a kink tell nothing of
/// the rock, so there it is the bound.
fn springs(
    law: &FractureLaw,
    point: &FacetPoint,
    landing: &TrialState,
    secant: f64,
) -> RockStiffness {
    let bound = point.rock_stiffness();
    let touching = law.closure.normal_stiffness.is_infinite();
    let parted = landing.normal_traction + bound.normal * law.closure.gap(landing.separation) > 0.0;
    let kinked = touching || (parted && !law.closure.is_smooth());
    RockStiffness {
        normal: if kinked { bound.normal } else { secant },
        ..bound
    }
}
