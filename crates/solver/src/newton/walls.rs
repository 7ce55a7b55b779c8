//! The facet points of a step: where each is linearised, and how it follows the linear solves.

use glam::{DMat3, DVec3};
use lie_core::Separation;
use rayon::prelude::*;

use super::Linearisation;
use crate::interface::FacetPoint;
use crate::schedule::Load;
use crate::system::{FacetPointState, State, System};

/// Where the last linear solve of a step put a facet point.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Landing {
    /// Separation of the walls; none before the first solve.
    separation: Option<Separation>,
    /// Normal traction on the tangent plane (Pa).
    traction: f64,
}

impl Landing {
    /// Stiffness of the surrounding rock as two landings tell it, `-dt/dw`; 0 where they tell
    /// nothing.
    fn spring_to(&self, landed: Separation, traction: f64) -> f64 {
        let spring = self
            .separation
            .map(|before| (self.traction - traction) / landed.beyond(before));
        spring.filter(|spring| spring.is_finite()).unwrap_or(0.0)
    }
}

/// Takes the state to another load: prescribed displacements move walls that are held.
pub(super) fn move_supports(system: &System<'_>, state: &mut State, load: &Load) {
    let interface = &system.discretisation.interface;
    let jumps = interface.prescribed_change(&state.load, load);
    state.load.clone_from(load);
    let points = interface.points.iter().zip(jumps);
    for ((point, jump), state) in points.zip(&mut state.facet_points) {
        let opening = jump.dot(point.normal);
        state.mismatch += opening;
        state.shear += system.law(point).shear_stiffness * (jump - opening * point.normal);
    }
}

/// Slopes of the laws at the apertures of the state (Pa/m).
pub(super) fn tangents(system: &System<'_>, state: &State) -> Vec<DMat3> {
    let points = system.discretisation.interface.points.par_iter();
    points
        .zip(&state.facet_points)
        .map(|(point, state)| {
            let law = system.law(point);
            law.at(state.separation, DVec3::ZERO, point.normal).tangent
        })
        .collect()
}

/// Tractions on the tangent planes of the laws (Pa).
pub(super) fn linearised_tractions(
    system: &System<'_>,
    state: &State,
    tangents: &[DMat3],
) -> Vec<DVec3> {
    let points = system.discretisation.interface.points.par_iter();
    points
        .zip(&state.facet_points)
        .zip(tangents)
        .map(|((point, state), tangent)| {
            let beyond = *tangent * (state.mismatch * point.normal);
            system.law_traction(point, state) + beyond
        })
        .collect()
}

/// Moves all facet points by the change of their jumps to where they are linearised next; returns
/// their closure errors (Pa).
pub(super) fn follow(
    system: &System<'_>,
    linearisation: Linearisation,
    state: &mut State,
    landings: &mut [Landing],
    changes: &[DVec3],
) -> Vec<f64> {
    let points = system.discretisation.interface.points.par_iter();
    points
        .zip(changes)
        .zip(state.facet_points.par_iter_mut().zip(landings))
        .map(|((point, change), (state, landing))| {
            follow_point(system, linearisation, point, *change, state, landing)
        })
        .collect()
}

fn follow_point(
    system: &System<'_>,
    linearisation: Linearisation,
    point: &FacetPoint,
    change: DVec3,
    state: &mut FacetPointState,
    landing: &mut Landing,
) -> f64 {
    let law = system.law(point);
    let closure = &law.closure;
    let opening = change.dot(point.normal);
    state.shear += law.shear_stiffness * (change - opening * point.normal);
    let here = closure.at(state.separation);
    let beyond = state.mismatch + opening;
    let traction = here.traction + here.tangent * beyond;
    let landed = state.separation.moved(beyond);
    let spring = landing.spring_to(landed, traction).clamp(0.0, point.spring);
    *landing = Landing {
        separation: Some(landed),
        traction,
    };
    let balances = linearisation == Linearisation::Balanced;
    state.separation = if closure.is_linear() || !balances {
        landed
    } else {
        closure.balanced(spring, traction + spring * landed.opening)
    };
    state.mismatch = landed.beyond(state.separation);
    let of_law = closure.at(state.separation).traction;
    (traction - of_law)
        .abs()
        .max(point.spring * state.mismatch.abs())
}
