//! The flow of an increment: where it stands, and how it follows the unknowns.
//!
//! A transmissivity grows with the cube of its aperture. Where a correction changes an aperture
//! much, its slope would tell that so much fluid flows on as never does, so the correction is found
//! again with the transmissivities as they stand.

use std::sync::Arc;

use glam::DVec3;

use super::facet_points::interface;
use crate::flow::{Coupling, FlowAtWalls, FlowIncrement, FluidState, LinearisedFlow, Walls};
use crate::problem::Load;
use crate::system::{State, System};

/// Share of an aperture.
const FAR: f64 = 0.5;

/// The flow of an iterate.
#[derive(Debug, Clone)]
pub(super) struct FlowIterate {
    increment: Arc<FlowIncrement>,
    /// Pressures that the increment began with, at each node that has one (Pa).
    start: Arc<Vec<f64>>,
    /// Where it stands.
    pub(super) at: Arc<FlowAtWalls>,
    /// Largest change of a pressure in the last iteration (Pa).
    pub(super) change: f64,
}

/// Moves the fluid of a state, which stands under the load `from` at its end, to the load of the
/// state, and finds the flow there; none without a flow that follows the walls.
pub(super) fn begin(system: &System<'_>, state: &mut State, from: &Load) -> Option<FlowIterate> {
    let coupling = system.coupling()?;
    let fluid = state.fluid.as_mut()?;
    let increment = coupling.increment(fluid, from, &state.load);
    let start = fluid.potentials.clone();
    match coupling.steady(fluid, &state.load) {
        Some(steady) => fluid.potentials = steady,
        None => coupling.move_load(&mut fluid.potentials, from, &state.load),
    }
    let at = at(system, coupling, state, &increment)?;
    Some(FlowIterate {
        increment: Arc::new(increment),
        start: Arc::new(start),
        at: Arc::new(at),
        change: 0.0,
    })
}

/// Apertures at the jumps of the walls (m).
fn apertures(system: &System<'_>, state: &State) -> Vec<f64> {
    let points = interface(system).points.iter().zip(&state.facet_points);
    points
        .map(|(point, state)| state.aperture(point.normal))
        .collect()
}

/// The flow at a state.
fn at(
    system: &System<'_>,
    coupling: &Coupling<'_>,
    state: &State,
    increment: &FlowIncrement,
) -> Option<FlowAtWalls> {
    let fluid = state.fluid.as_ref()?;
    let walls = Walls {
        conducting: &fluid.apertures,
        storing: &apertures(system, state),
    };
    Some(coupling.at(walls, &fluid.potentials, (increment, &state.load)))
}

impl FlowIterate {
    /// Adds changes of the pressures that are not given (Pa), and follows the walls of a state to
    /// where they are.
    pub(super) fn follow(&mut self, system: &System<'_>, state: &mut State, changes: &[f64]) {
        let reached = apertures(system, state);
        let (Some(coupling), Some(fluid)) = (system.coupling(), state.fluid.as_mut()) else {
            return;
        };
        coupling.add(&mut fluid.potentials, changes);
        fluid.apertures = coupling.conducting(&fluid.apertures, &reached);
        self.change = changes
            .iter()
            .fold(0.0, |most, change| most.max(change.abs()));
        if let Some(at) = at(system, coupling, state, &self.increment) {
            self.at = Arc::new(at);
        }
    }

    /// The flow at the iterate, linearised.
    pub(super) fn linearised<'s, 'a>(
        &'s self,
        coupling: &'s Coupling<'a>,
        fluid: &FluidState,
        load: &Load,
    ) -> LinearisedFlow<'s, 'a> {
        coupling.linearised(&self.at, &fluid.potentials, (&self.increment, load))
    }

    /// Makes a converged flow the one that the next increment starts from.
    pub(super) fn commit(&self, coupling: &Coupling<'_>, fluid: &mut FluidState) {
        coupling.commit(fluid, &self.at, &self.increment);
    }

    /// Largest difference of a potential of the fluid from what the increment began with (Pa).
    pub(super) fn moved(&self, fluid: &FluidState) -> f64 {
        let pairs = fluid.potentials.iter().zip(&*self.start);
        pairs.fold(0.0, |most, (now, then)| most.max((now - then).abs()))
    }
}

/// Tractions on walls (Pa) with the push of the fluid of a state, if there is any.
pub(super) fn total_tractions(
    system: &System<'_>,
    state: &State,
    mut tractions: Vec<DVec3>,
) -> Vec<DVec3> {
    if let (Some(coupling), Some(fluid)) = (system.coupling(), &state.fluid) {
        let pressures = coupling.point_pressures(&fluid.potentials, &state.load);
        let points = interface(system).points.iter().zip(pressures);
        for (traction, (point, pressure)) in tractions.iter_mut().zip(points) {
            *traction -= pressure * point.normal;
        }
    }
    tractions
}

/// Whether a correction of the unknowns (m) changes an aperture by more than the share for which
/// the slope of a transmissivity speaks.
pub(super) fn goes_far(system: &System<'_>, state: &State, correction: &[DVec3]) -> bool {
    let jumps = interface(system).jumps(correction, &Load::NONE);
    let points = interface(system).points.iter().zip(&state.facet_points);
    let mut pairs = points.zip(jumps);
    pairs.any(|((point, state), jump)| {
        let before = state.aperture(point.normal);
        before > 0.0 && jump.dot(point.normal).abs() > FAR * before
    })
}
