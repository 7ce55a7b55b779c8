//! Where a run stands between two load steps, so that another process can go on from there.

use std::borrow::Cow;

use kluft_algebra::LinearFailure;
use serde::{Deserialize, Serialize};

use super::Newton;
use super::extrapolation::Path;
use super::subspace::Subspace;
use crate::linear::SolverHistory;
use crate::system::{State, System};

/// Everything that the next load step depends on beside the system and the settings: continued from
/// it, a run gives the same bits as one that never stopped.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct RestartState<'a> {
    state: Cow<'a, State>,
    path: Cow<'a, Path>,
    subspace: Cow<'a, Option<Subspace>>,
    linear: SolverHistory,
}

impl RestartState<'_> {
    /// Whether it was made for a system of the same size.
    pub fn fits(&self, system: &System<'_>) -> bool {
        let unknowns = system.discretisation.points.len();
        let facet_points = system.discretisation.interface.points.len();
        let blocks = system.discretisation.interface.columns.entries.len();
        self.state.unknowns.len() == unknowns
            && self.state.facet_points.len() == facet_points
            && self.path.fits(unknowns, facet_points)
            && (*self.subspace).as_ref().is_none_or(|s| s.fits(unknowns))
            && self.linear.fits(blocks)
    }
}

impl Newton {
    /// Marks the place after a load step that led to `state`.
    pub fn bookmark<'a>(&'a self, state: &'a State) -> RestartState<'a> {
        RestartState {
            state: Cow::Borrowed(state),
            path: Cow::Borrowed(&self.path),
            subspace: Cow::Borrowed(&self.subspace),
            linear: self.linear.history(),
        }
    }

    /// Goes back to a place that fits the system, and returns its state.
    ///
    /// # Errors
    /// If the linear solver cannot be brought to where it was.
    pub fn restore(
        &mut self,
        system: &System<'_>,
        bookmark: RestartState<'_>,
    ) -> Result<State, LinearFailure> {
        self.linear.restore(system, bookmark.linear)?;
        self.path = bookmark.path.into_owned();
        self.subspace = bookmark.subspace.into_owned();
        Ok(bookmark.state.into_owned())
    }
}
