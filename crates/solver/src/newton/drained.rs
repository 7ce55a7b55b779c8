//! The guess that fluid has come to rest, for joints that it opens wide.
//!
//! A closed joint conducts next to nothing, and iterations that begin there fill it from node to
//! node. Pressures that open it at all mostly open it within the increment, so the guess is the
//! other end: the pressures of the steady flow, and each facet point where its law balances them
//! and the rock beside it. It conducts from the first linear solve on; walls stay, and follow with
//! that solve, which empties again what has not had the time to fill.

use lie_core::TrialState;

use super::facet_points::{self, interface, jump_beyond};
use super::fluid;
use crate::flow::Coupling;
use crate::problem::Load;
use crate::system::{FacetPointState, State, System};

/// Factor by which the fluid at rest opens a facet point, at the least, for the guess to be made.
const WIDE: f64 = 2.0;

/// The guess for an increment from a state to a load, where the flow takes time, laws are smooth
/// and the fluid at rest opens a joint wide; else none.
pub(super) fn guess(system: &System<'_>, from: &State, load: &Load) -> Option<State> {
    let coupling = system.coupling()?;
    if !coupling.is_transient() || !system.is_smooth() {
        return None;
    }
    let before = coupling.point_pressures(from.fluid.as_ref()?, &from.load);
    let mut state = from.clone();
    fluid::move_load(system, &mut state, load);
    facet_points::move_supports(system, &mut state, load);
    let fluid = state.fluid.as_mut()?;
    fluid.potentials = coupling.at_rest(fluid, load)?;
    let after = coupling.point_pressures(fluid, load);
    let rise: Vec<f64> = after.iter().zip(before).map(|(p, was)| p - was).collect();
    opens_wide(system, &mut state, &rise).then(|| {
        conduct(coupling, &mut state);
        state
    })
}

/// Takes facet points to where their laws balance pressures that have risen (Pa); whether one of
/// them opens wide.
fn opens_wide(system: &System<'_>, state: &mut State, rise: &[f64]) -> bool {
    let points = interface(system).points.iter().zip(rise);
    let mut is_wide = false;
    for ((point, rise), own) in points.zip(&mut state.facet_points) {
        let before = own.joint.separation.aperture;
        let trial = TrialState {
            separation: own.joint.separation,
            slip: own.joint.slip,
            normal_traction: own.joint.normal_traction + rise,
            shear: own.joint.shear,
        };
        let law = system.law(point);
        own.joint = law.return_map(&trial, point.rock_stiffness(), &own.history);
        let reached = own.joint.separation;
        own.jump_residual += jump_beyond(point, &trial, &own.joint);
        is_wide |= before > 0.0 && reached.aperture > WIDE * before;
    }
    is_wide
}

/// Lets the fluid conduct where the laws of the facet points are, not yet the walls.
fn conduct(coupling: &Coupling<'_>, state: &mut State) {
    let aperture = |own: &FacetPointState| own.joint.separation.aperture;
    let reached: Vec<f64> = state.facet_points.iter().map(aperture).collect();
    if let Some(fluid) = &mut state.fluid {
        fluid.apertures = coupling.conducting(&fluid.apertures, &reached);
    }
}
