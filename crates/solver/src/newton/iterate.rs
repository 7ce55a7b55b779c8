//! What the iterations of an increment work on, and what they add to it.

use std::sync::Arc;

use glam::DVec3;
use kluft_algebra::largest;

use super::acceleration::Acceleration;
use super::damping::Damping;
use super::dashpots::Dashpots;
use super::facet_points::{Linearisation, Linearised};
use super::fluid::FlowIterate;
use super::last_trial::LastTrial;
use crate::problem::Load;
use crate::system::{State, StateScales, System};

/// What the iterations of an increment work on.
#[derive(Clone)]
pub(super) struct Iterate {
    pub(super) state: State,
    pub(super) last_trials: Vec<LastTrial>,
    /// Forces by which the rock resists the unknowns (N).
    pub(super) rock_forces: Vec<DVec3>,
    /// The flow that follows the walls, if there is any.
    pub(super) flow: Option<FlowIterate>,
    /// StateScales that its errors are measured against.
    pub(super) sizes: StateScales,
    /// Largest of the forces that must balance in the first guess (N).
    pub(super) first_force: f64,
    /// Springs on the facet points, see `damping`.
    pub(super) damping: Damping,
    /// Dashpots on the facet points, see `relaxation`.
    pub(super) dashpots: Dashpots,
    /// What stands for the laws in the next linear solve.
    pub(super) linearisation: Linearisation,
    /// Former iterates of the splitting.
    pub(super) acceleration: Acceleration,
    /// Whether what linear solves leave of a flow is found again, see `conservation`.
    pub(super) conserves: bool,
    /// Largest error allowed in the next linear solve, against its right-hand side.
    pub(super) forcing_term: f64,
    /// Errors after the last iteration, see `line_search`.
    pub(super) merit: Option<f64>,
    /// The guess that it began with, if it was made in the recycled space.
    pub(super) guess: Option<LastCorrection>,
    /// Its corrections, if they are to be recycled.
    pub(super) corrections: Vec<Arc<Correction>>,
}

/// What a linear solve does to the unknowns.
#[derive(Debug, Clone)]
pub(super) struct Correction {
    /// Change of the unknowns (m).
    pub(super) unknowns: Vec<DVec3>,
    /// Forces by which the rock resists it (N), if it is to be recycled.
    pub(super) rock_forces: Option<Vec<DVec3>>,
    /// Change of the pressures that are not given (Pa).
    pub(super) potentials: Vec<f64>,
    /// Its largest displacement (m).
    pub(super) size: f64,
}

/// A correction, and the planes of the laws on which it was found.
#[derive(Clone, Copy)]
pub(super) struct Update<'a> {
    pub(super) correction: &'a Correction,
    pub(super) planes: &'a Linearised,
}

impl Iterate {
    /// Lets only solves to come tell of the rock beside facet points.
    pub(super) fn forget_secants(&mut self) {
        self.last_trials
            .iter_mut()
            .for_each(LastTrial::forget_secant);
    }
}

impl Correction {
    pub(super) fn of(system: &System<'_>, unknowns: Vec<DVec3>, is_recycled: bool) -> Self {
        Self {
            rock_forces: is_recycled.then(|| system.rock_forces(&unknowns)),
            size: largest(&system.displacements(&unknowns, &Load::NONE)),
            potentials: Vec::new(),
            unknowns,
        }
    }

    /// Beside a change of pressures (Pa).
    pub(super) fn with_potentials(self, potentials: Vec<f64>) -> Self {
        Self { potentials, ..self }
    }

    pub(super) fn scaled(&self, share: f64) -> Self {
        let scaled = |vector: &Vec<DVec3>| vector.iter().map(|entry| share * *entry).collect();
        Self {
            unknowns: scaled(&self.unknowns),
            rock_forces: self.rock_forces.as_ref().map(scaled),
            potentials: self
                .potentials
                .iter()
                .map(|change| share * change)
                .collect(),
            size: share * self.size,
        }
    }
}

/// The last iteration of a guess that was made in the recycled space.
#[derive(Debug, Clone)]
pub(super) struct LastCorrection {
    /// The guess as coefficients of the directions.
    pub(super) coefficients: Vec<f64>,
    /// Closure errors (Pa).
    pub(super) errors: Vec<f64>,
    /// Bound of the displacements of the iteration (m).
    pub(super) displacement: f64,
}
