//! A first guess for a load step: the path of the last two states, continued.
//!
//! Displacements and tractions are continued alike. Both enter the balance of forces linearly, so
//! the guess is in balance; all that is wrong with it is how far the apertures are from the law.

use glam::DVec3;
use rayon::prelude::*;

use crate::system::{FacetPointState, State, System};

/// Longest continuation, against the step that it continues.
const LONGEST: f64 = 2.0;

/// A converged state to continue from, beside the one a step starts from.
#[derive(Debug, Clone)]
pub(super) struct Former {
    load: f64,
    unknowns: Vec<DVec3>,
    /// Tractions of the laws (Pa).
    tractions: Vec<DVec3>,
}

impl Former {
    pub(super) fn of(system: &System<'_>, state: &State) -> Self {
        Self {
            load: state.load,
            unknowns: state.unknowns.clone(),
            tractions: system.law_tractions(state),
        }
    }

    /// Continues the straight path from here through `state` to `load`.
    pub(super) fn continue_through(&self, system: &System<'_>, state: &mut State, load: f64) {
        let ratio = (load - state.load) / (state.load - self.load);
        if !(ratio.abs() <= LONGEST && ratio != 0.0) {
            return;
        }
        let tractions = system.law_tractions(state);
        let before = system
            .discretisation
            .interface
            .jumps(&state.unknowns, state.load);
        let unknowns = state.unknowns.par_iter_mut().zip(&self.unknowns);
        unknowns.for_each(|(now, former)| *now += ratio * (*now - *former));
        state.load = load;
        let after = system.discretisation.interface.jumps(&state.unknowns, load);
        let points = &system.discretisation.interface.points;
        for (index, point) in points.iter().enumerate() {
            let traction = tractions[index] + ratio * (tractions[index] - self.tractions[index]);
            let moved = (after[index] - before[index]).dot(point.normal);
            let closure = &system.law(point).closure;
            let state = &mut state.facet_points[index];
            let across = traction.dot(point.normal);
            let landed = state.separation.moved(state.mismatch + moved);
            let separation = if closure.normal_stiffness == 0.0 {
                landed
            } else {
                closure.balanced(0.0, across)
            };
            *state = FacetPointState {
                separation,
                mismatch: landed.beyond(separation),
                shear: traction - across * point.normal,
            };
        }
    }
}
