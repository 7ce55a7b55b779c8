//! The flow of an increment: where it stands, and how it follows the unknowns.
//!
//! A transmissivity grows with the cube of its aperture. Where a correction opens an aperture much,
//! its slope would tell that so much fluid flows on as never does, so the correction is found again
//! with the transmissivities as they stand. Where it closes one the slope holds the fluid back.

use std::sync::Arc;

use glam::DVec3;
use rayon::prelude::*;

use super::facet_points::interface;
use crate::flow::{Coupling, FlowAtWalls, FlowIncrement, FluidState, LinearisedFlow};
use crate::problem::Load;
use crate::system::{State, System};

/// Share of a pressure below which its change within an increment is none.
const LEAST_CHANGE: f64 = 1e-7;

/// Share of an aperture.
const FAR: f64 = 0.5;

/// The flow of an iterate.
#[derive(Debug, Clone)]
pub(super) struct FlowIterate {
    increment: Arc<FlowIncrement>,
    /// Pressures that the increment began with, nodes ascending (Pa).
    start: Arc<Vec<f64>>,
    /// Where it stands.
    pub(super) at: Arc<FlowAtWalls>,
    /// Largest change of a pressure in the last iteration (Pa).
    pub(super) change: f64,
}

/// The flow of an increment from a state to a guess, which stands under its load at the end; none
/// without a flow that follows the walls.
pub(super) fn begin(system: &System<'_>, from: &State, guess: &mut State) -> Option<FlowIterate> {
    let coupling = system.coupling()?;
    let mut fluid = guess.fluid.take()?;
    let (increment, at) = first(system, coupling, [from, guess], &mut fluid);
    guess.fluid = Some(fluid);
    let start = from.fluid.as_ref();
    let start = start.map_or_else(Vec::new, |fluid| coupling.pressures(fluid, &from.load));
    Some(FlowIterate {
        increment: Arc::new(increment),
        start: Arc::new(start),
        at: Arc::new(at),
        change: 0.0,
    })
}

/// The increment between two states, and where the flow of the second one stands, whose fluid is
/// given.
fn first(
    system: &System<'_>,
    coupling: &Coupling<'_>,
    [from, guess]: [&State; 2],
    fluid: &mut FluidState,
) -> (FlowIncrement, FlowAtWalls) {
    let begins = system.problem.schedule.walked_from(&from.load);
    let increment = coupling.increment(fluid, begins);
    if let Some(steady) = coupling.steady(fluid, &guess.load) {
        fluid.potentials = steady;
    }
    let at = coupling.at(fluid, &apertures(system, guess), (&increment, &guess.load));
    (increment, at)
}

/// Moves the fluid of a state to another load: pressures stay, but those that are given.
pub(super) fn move_load(system: &System<'_>, state: &mut State, load: &Load) {
    if let Some((coupling, fluid)) = system.coupling().zip(state.fluid.as_mut()) {
        coupling.move_load(fluid, &state.load, load);
    }
}

/// Potentials of the fluid of a state and what they are counted from (Pa); none without a fluid
/// that follows the walls.
pub(super) fn potentials(state: &State) -> [&[f64]; 2] {
    let fluid = state.fluid.as_ref();
    fluid.map_or([&[]; 2], |fluid| [&fluid.potentials, &fluid.references])
}

/// Replaces what [`potentials`] gives.
pub(super) fn set_potentials(state: &mut State, [potentials, references]: [Vec<f64>; 2]) {
    if let Some(fluid) = &mut state.fluid {
        fluid.potentials = potentials;
        fluid.references = references;
    }
}

/// Lets the fluid of a state conduct where the walls are.
pub(super) fn conduct(system: &System<'_>, state: &mut State) {
    let reached = apertures(system, state);
    conduct_at(system, state, &reached);
}

fn conduct_at(system: &System<'_>, state: &mut State, reached: &[f64]) {
    if let Some((coupling, fluid)) = system.coupling().zip(state.fluid.as_mut()) {
        fluid.apertures = coupling.conducting(&fluid.apertures, reached);
    }
}

/// Mass error of a guess for an increment from a state.
pub(super) fn mass_error(system: &System<'_>, from: &State, guess: &State) -> f64 {
    let parts = system.coupling().zip(guess.fluid.clone());
    parts.map_or(f64::INFINITY, |(coupling, mut fluid)| {
        let (_, at) = first(system, coupling, [from, guess], &mut fluid);
        at.balance.mass_error
    })
}

/// Apertures at the jumps of the walls (m).
fn apertures(system: &System<'_>, state: &State) -> Vec<f64> {
    let points = interface(system).points.par_iter().zip(&state.facet_points);
    points
        .map(|(point, state)| state.aperture(point.normal))
        .collect()
}

impl FlowIterate {
    /// Adds changes of the pressures that are not given (Pa), and follows the walls of a state to
    /// where they are.
    pub(super) fn follow(&mut self, system: &System<'_>, state: &mut State, changes: &[f64]) {
        let reached = apertures(system, state);
        conduct_at(system, state, &reached);
        let (Some(coupling), Some(fluid)) = (system.coupling(), state.fluid.as_mut()) else {
            return;
        };
        coupling.add(&mut fluid.potentials, changes);
        self.change = changes
            .iter()
            .fold(0.0, |most, change| most.max(change.abs()));
        let at = coupling.at(fluid, &reached, (&self.increment, &state.load));
        self.at = Arc::new(at);
    }

    /// The flow at the iterate, linearised.
    pub(super) fn linearised<'s, 'a>(
        &'s self,
        coupling: &'s Coupling<'a>,
        fluid: &FluidState,
        load: &Load,
    ) -> LinearisedFlow<'s, 'a> {
        coupling.linearised(&self.at, fluid, (&self.increment, load))
    }

    /// Makes a flow that has converged under a load the one that the next increment starts from.
    pub(super) fn commit(&self, coupling: &Coupling<'_>, fluid: &mut FluidState, load: &Load) {
        coupling.commit(fluid, &self.at, (&self.increment, load));
    }

    /// Largest difference of a pressure of the fluid under a load from what the increment began
    /// with (Pa). Where pressures stand still it is the least share of them that would count as a
    /// change: rounding is no scale.
    pub(super) fn moved(&self, coupling: &Coupling<'_>, fluid: &FluidState, load: &Load) -> f64 {
        let pressures = coupling.pressures(fluid, load);
        let pairs = pressures.iter().zip(&*self.start);
        pairs.fold(0.0, |most, (now, then)| {
            most.max((now - then).abs()).max(LEAST_CHANGE * now.abs())
        })
    }
}

/// Tractions on walls (Pa) with the push of the fluid of a state, if there is any.
pub(super) fn total_tractions(
    system: &System<'_>,
    state: &State,
    mut tractions: Vec<DVec3>,
) -> Vec<DVec3> {
    if let (Some(coupling), Some(fluid)) = (system.coupling(), &state.fluid) {
        let pressures = coupling.point_pressures(fluid, &state.load);
        let points = interface(system).points.par_iter().zip(&pressures);
        let pairs = tractions.par_iter_mut().zip(points);
        pairs.for_each(|(traction, (point, pressure))| *traction -= *pressure * point.normal);
    }
    tractions
}

/// Whether a correction of the unknowns (m) opens an aperture by more than the share for which
/// the slope of a transmissivity speaks.
pub(super) fn goes_far(system: &System<'_>, state: &State, correction: &[DVec3]) -> bool {
    let jumps = interface(system).jumps(correction, &Load::NONE);
    let points = interface(system).points.iter().zip(&state.facet_points);
    let mut pairs = points.zip(jumps);
    pairs.any(|((point, state), jump)| {
        let before = state.aperture(point.normal);
        let opens = jump.dot(point.normal);
        // They close further then than the slope can tell.
        let change = match system.law(point).lets_walls_pass() {
            true => opens.abs(),
            false => opens,
        };
        before > 0.0 && change > FAR * before
    })
}
