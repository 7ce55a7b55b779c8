//! How exactly the linear systems of an increment are solved: inexact Newton (Eisenstat and Walker
//! 1996).

use glam::DVec3;
use kluft_algebra::norm;

use super::NewtonSettings;
use super::facet_points::interface;
use super::iterate::Iterate;
use crate::linear::LARGEST_TOLERANCE;
use crate::system::{State, System};

/// Largest error of a linear solve against its right-hand side while the state still changes.
const LARGEST_FORCING_TERM: f64 = 1e-3;
/// Smallest one.
const SMALLEST_FORCING_TERM: f64 = 1e-8;
/// What a linear solve may leave out of balance, as a share of what the test of the forces allows.
const LINEAR_SHARE: f64 = 0.1;
/// Share of what the test of the forces allows that counts as rounding.
const ROUNDING_SHARE: f64 = 1e-3;
/// What nodes of a flow may miss, summed up, against what moves, for `conservation` to mend.
const CONSERVED: f64 = 1e-7;

/// The forcing term of the first linear solve of an increment.
pub(super) fn first(system: &System<'_>, settings: &NewtonSettings) -> f64 {
    if system.is_nonlinear() {
        LARGEST_FORCING_TERM
    } else {
        exact_enough(settings)
    }
}

/// The forcing term after an iteration with this error.
pub(super) fn after(error: f64) -> f64 {
    error.clamp(SMALLEST_FORCING_TERM, LARGEST_FORCING_TERM)
}

/// The force out of balance, against the largest force, that a linear solve may leave.
pub(super) fn exact_enough(settings: &NewtonSettings) -> f64 {
    LINEAR_SHARE * settings.force
}

/// Error allowed in the next linear solve of an iterate, against its right-hand side of norm
/// `residual` (N): enough for what the linearisation is worth, and for the test of the forces. A
/// residual above rounding is always reduced: tractions may still move where forces are in balance.
pub(super) fn tolerance(
    system: &System<'_>,
    settings: &NewtonSettings,
    iterate: &Iterate,
    residual: f64,
) -> f64 {
    let scale = iterate.sizes.force;
    let interface_force = interface_force_norm(system, &iterate.state).unwrap_or(scale);
    let wanted = iterate.forcing_term * residual.min(scale).min(interface_force);
    let enough = exact_enough(settings) * scale;
    let tolerance = wanted.max(enough);
    let rounding = ROUNDING_SHARE * settings.force * scale;
    if residual <= rounding {
        1.0
    } else {
        (tolerance / residual).min(LARGEST_TOLERANCE)
    }
}

/// Norms that a coupled solve may leave of the forces (N) and of what is missing in a flow (m^3/s),
/// whose right-hand sides amount to `sizes` of these: enough for what the linearisation is worth,
/// and for the tests. `missing` is the number of flow balances.
pub(super) fn coupled_goals(
    (system, settings): (&System<'_>, &NewtonSettings),
    iterate: &Iterate,
    [force, rate]: [f64; 2],
    missing: usize,
) -> [f64; 2] {
    let scale = iterate.sizes.force.max(force);
    let interface_force = interface_force_norm(system, &iterate.state).unwrap_or(scale);
    let forces = (iterate.forcing_term * force.min(interface_force))
        .max(exact_enough(settings) * scale)
        .min(LARGEST_TOLERANCE * force);
    let balance = iterate.flow.as_ref().map(|flow| flow.at.balance);
    let mended = if iterate.conserves { CONSERVED } else { 0.0 };
    let enough = balance.map_or(0.0, |balance| {
        settings.mass.max(balance.rounding).max(mended) * balance.moved
    });
    let enough = LINEAR_SHARE * enough / (missing.max(1) as f64).sqrt();
    [forces, (iterate.forcing_term * rate).max(enough)]
}

/// Norm (N) of what fractures with kinks in their laws carry. It may be a small part of the loads;
/// solves that are exact against the loads only would let it stick, slide and open at random.
fn interface_force_norm(system: &System<'_>, state: &State) -> Option<f64> {
    if system.is_smooth() {
        return None;
    }
    let mut forces = vec![DVec3::ZERO; state.unknowns.len()];
    interface(system).add_forces(&system.law_tractions(state), 1.0, &mut forces);
    Some(norm(&forces)).filter(|size| *size > 0.0)
}
