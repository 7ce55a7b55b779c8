//! Where a run stands between two load steps, so that another process can go on from there.

use kluft_algebra::LinearFailure;
use std::borrow::Cow;

use serde::{Deserialize, Serialize};

use super::Newton;
use super::extrapolation::Path;
use super::recycling::RecycledSpace;
use crate::flow::FluidState;
use crate::linear::SolverHistory;
use crate::system::{State, System};

/// Everything that the next load step depends on beside the system and the settings: continued from
/// it, a run gives the same bits as one that never stopped.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct RestartState<'a> {
    state: Cow<'a, State>,
    path: Cow<'a, Path>,
    recycled: Cow<'a, Option<RecycledSpace>>,
    linear: SolverHistory,
}

impl RestartState<'_> {
    /// Whether it was made for a system of the same size.
    pub fn fits(&self, system: &System<'_>) -> bool {
        let unknowns = system.discretisation.points.len();
        let facet_points = system.discretisation.interface.points.len();
        let blocks = system.discretisation.interface.columns.entries.len();
        let recycled = (*self.recycled).as_ref();
        let fluid = |fluid: &FluidState| system.coupling().is_some_and(|flow| flow.fits(fluid));
        self.state.unknowns.len() == unknowns
            && self.state.fluid.as_ref().is_none_or(fluid)
            && self.state.fluid.is_some() == system.coupling().is_some()
            && self.state.facet_points.len() == facet_points
            && self.path.fits(&self.state)
            && recycled.is_none_or(|space| space.fits(unknowns))
            && self.linear.fits(blocks)
    }
}

impl Newton {
    /// What a run continues from after a load step that led to `state`.
    pub fn restart_state<'a>(&'a self, state: &'a State) -> RestartState<'a> {
        RestartState {
            state: Cow::Borrowed(state),
            path: Cow::Borrowed(&self.path),
            recycled: Cow::Borrowed(&self.recycled),
            linear: self.linear.history(),
        }
    }

    /// Brings the solver to where it was when `restart`, which fits the system, was made; returns
    /// the state of that time.
    ///
    /// # Errors
    /// If the linear solver cannot be brought there.
    pub fn restore(
        &mut self,
        system: &System<'_>,
        restart: RestartState<'_>,
    ) -> Result<State, LinearFailure> {
        self.linear.restore(system, restart.linear)?;
        self.path = restart.path.into_owned();
        self.recycled = restart.recycled.into_owned();
        Ok(restart.state.into_owned())
    }
}
