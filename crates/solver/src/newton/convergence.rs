//! The test of convergence: how far an iterate is from a solution, against how large its quantities
//! are.

use glam::DVec3;
use kluft_algebra::largest;
use kluft_algebra::norm;

use super::facet_points::interface;
use super::fluid;
use super::iterate::Iterate;
use super::{Iteration, NewtonSettings, Step, StepOutcome};
use crate::system::{State, StateScales, System};

/// Share of the largest sizes of a path that still counts once the loads are gone: what is left
/// then is rounding, and would be compared with nothing but itself.
pub(super) const SHARE_OF_FORMER_SIZES: f64 = 1e-3;
/// Share of the largest increment allowed where laws have kinks: the error of a stabilised
/// iteration falls by a factor, not as a square.
const INCREMENT_AT_KINKS: f64 = 1e-2;
/// Share of the traction that would close an open fracture, below which the errors of its own count
/// as small.
const RECLOSING_SHARE: f64 = 1e-3;

/// Multiples of the unit of rounding that forces out of balance may be made of.
const ROUNDINGS: f64 = 4.0;
/// Largest force out of balance, against the largest force, that counts as rounding.
const MOST_ROUNDING: f64 = 1e-6;

impl NewtonSettings {
    /// Whether all tests hold.
    pub(super) fn accept(
        &self,
        system: &System<'_>,
        iterate: &Iterate,
        iteration: &Iteration,
    ) -> bool {
        self.unmet(system, iterate, iteration) == Unmet::Nothing
    }

    /// Which tests do not hold.
    pub(super) fn unmet(
        &self,
        system: &System<'_>,
        iterate: &Iterate,
        iteration: &Iteration,
    ) -> Unmet {
        let increment = if system.is_smooth() {
            self.increment
        } else {
            INCREMENT_AT_KINKS * self.increment
        };
        let change = iteration.increment.max(iteration.pressure_increment);
        if system.is_nonlinear() && change > increment {
            return Unmet::Others;
        }
        let is_below = |share: f64| {
            iteration.force_residual <= self.force.max(share)
                && iteration.closure_error <= self.closure.max(share)
        };
        let is_balanced =
            is_below(0.0) || (is_below(MOST_ROUNDING) && is_below(rounding(system, iterate)));
        let balance = iterate.flow.as_ref().map(|flow| flow.at.balance);
        let rounding_of_flow = balance.map_or(0.0, |balance| balance.rounding);
        match iteration.mass_error > self.mass.max(rounding_of_flow) {
            _ if !is_balanced => Unmet::Others,
            true => Unmet::Mass,
            false => Unmet::Nothing,
        }
    }
}

/// Tests of convergence that do not hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Unmet {
    /// None.
    Nothing,
    /// That of the mass of a flow only.
    Mass,
    /// Others.
    Others,
}

/// What rounding alone leaves out of balance, against the largest force. Stiff rock that rides on
/// soft rock, or rock that hardly changes its volume, multiplies the rounding of the displacements
/// by a stiffness that has little to do with its forces.
fn rounding(system: &System<'_>, iterate: &Iterate) -> f64 {
    let unit = f64::EPSILON * norm(&system.absolute_rock_forces(&iterate.state.unknowns));
    (ROUNDINGS * ratio(unit, iterate.sizes.force)).min(MOST_ROUNDING)
}

/// Measures how far an iterate is from a solution, given the closure errors of its facet points
/// (Pa) and the largest displacement of its last correction (m).
///
/// # Errors
/// If a traction or an error is not finite.
pub(super) fn measure(
    step: &mut Step<'_>,
    iterate: &mut Iterate,
    errors: &[f64],
    change: f64,
) -> Result<Iteration, StepOutcome> {
    let (system, state) = (step.system, &iterate.state);
    let tractions = system.law_tractions(state);
    if let Some(broken) = tractions.iter().position(|traction| !traction.is_finite()) {
        return Err(StepOutcome::NotFinite(Some(broken)));
    }
    let mut total = fluid::total_tractions(system, state, tractions.clone());
    iterate.dashpots.add_to(system, &mut total);
    let residual = norm(&system.residual(&iterate.rock_forces, &total, &state.load));
    let worst = (0..errors.len()).max_by(|&a, &b| errors[a].total_cmp(&errors[b]));
    step.record.worst_facet_point = worst;
    let points = state.facet_points.iter();
    let apertures = points.map(|point| point.joint.separation.aperture);
    let smallest_aperture = apertures.fold(f64::INFINITY, f64::min);
    let own_sizes = sizes(system, iterate, &tractions);
    let sizes = own_sizes.or_share(SHARE_OF_FORMER_SIZES, state.reached);
    iterate.sizes = sizes;
    let force_residual = ratio(residual, sizes.force);
    let closure_error = ratio(worst.map_or(0.0, |worst| errors[worst]), sizes.traction);
    if force_residual.is_nan() || closure_error.is_nan() {
        return Err(StepOutcome::NotFinite(worst));
    }
    Ok(Iteration {
        force_residual,
        increment: ratio(change, sizes.displacement),
        closure_error,
        smallest_aperture,
        pressure_increment: iterate
            .flow
            .as_ref()
            .map_or(0.0, |flow| ratio(flow.change, sizes.pressure)),
        mass_error: iterate
            .flow
            .as_ref()
            .map_or(0.0, |flow| flow.at.balance.mass_error),
        linear_iterations: 0,
        share: step.share,
    })
}

/// How large the quantities of an iterate are.
fn sizes(system: &System<'_>, iterate: &Iterate, tractions: &[DVec3]) -> StateScales {
    let state = &iterate.state;
    let displacements = system.displacements(&state.unknowns, &state.load);
    // A body that does not move may still hold joints closed by its initial stress.
    let points = state.facet_points.iter();
    let openings = points.map(|point| point.joint.separation.opening.abs());
    let fluid = system.coupling().zip(state.fluid.as_ref());
    let moved = iterate.flow.as_ref().zip(fluid);
    StateScales {
        force: system.force_scale(&iterate.rock_forces, tractions, &state.load),
        displacement: openings.fold(largest(&displacements), f64::max),
        traction: largest(tractions).max(RECLOSING_SHARE * reclosing_traction(system, state)),
        pressure: moved.map_or(0.0, |(flow, (coupling, fluid))| {
            flow.moved(coupling, fluid, &state.load)
        }),
    }
}

/// Traction (Pa) that would close the widest of the fractures again, if any may be free of
/// traction.
fn reclosing_traction(system: &System<'_>, state: &State) -> f64 {
    if system.is_smooth() {
        return 0.0;
    }
    let points = interface(system).points.iter().zip(&state.facet_points);
    points
        .map(|(point, state)| point.spring * state.joint.separation.opening.abs())
        .fold(0.0, f64::max)
}

/// `value / scale`, and 0 where there is nothing to compare with nothing.
pub(super) fn ratio(value: f64, scale: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value / scale }
}
