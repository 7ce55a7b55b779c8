//! What a load step starts from and leaves behind.

use glam::DVec3;
use lie_core::{JointHistory, JointState};
use serde::{Deserialize, Serialize};

use crate::flow::FluidState;
use crate::problem::Load;

/// The state of a run: what a load step starts from and leaves behind.
///
/// Apertures and tractions are kept beside the unknowns and follow them by increments. Computed
/// anew from displacements, a stiff fracture would multiply the rounding of the displacements by
/// its stiffness.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct State {
    /// Load under which the state stands.
    pub load: Load,
    /// Unknown 3-vectors (m).
    pub unknowns: Vec<DVec3>,
    /// State of each facet point.
    pub facet_points: Vec<FacetPointState>,
    /// The fluid, if it follows the walls.
    pub fluid: Option<FluidState>,
    /// Largest sizes of the states on the way to it.
    pub(crate) reached: StateScales,
    /// Which laws of the system it was reached with.
    pub(super) generation: u32,
}

/// How large the quantities of a state are: what "small" is measured against.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct StateScales {
    /// Largest of the forces that must balance (N).
    pub(crate) force: f64,
    /// Largest displacement or opening (m).
    pub(crate) displacement: f64,
    /// Largest normal traction of a fracture (Pa).
    pub(crate) traction: f64,
    /// Largest change of a pressure since the run began (Pa).
    pub(crate) pressure: f64,
}

impl State {
    /// Becomes a copy of another state, in the memory that it has.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.load.clone_from(&other.load);
        self.unknowns.clone_from(&other.unknowns);
        self.facet_points.clone_from(&other.facet_points);
        self.fluid.clone_from(&other.fluid);
        self.reached = other.reached;
        self.generation = other.generation;
    }
}

impl StateScales {
    /// The larger of each, where the other counts with a `share`.
    pub(crate) fn or_share(self, share: f64, other: Self) -> Self {
        Self {
            force: self.force.max(share * other.force),
            displacement: self.displacement.max(share * other.displacement),
            traction: self.traction.max(share * other.traction),
            pressure: self.pressure.max(share * other.pressure),
        }
    }
}

/// State of one facet point.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub struct FacetPointState {
    /// Where the law is linearised, which is where the walls are once converged.
    pub joint: JointState,
    /// Jump of the walls beyond that (m); rounding once converged.
    pub jump_residual: DVec3,
    /// What former steps left behind.
    pub history: JointHistory,
}

impl FacetPointState {
    /// Aperture at the jump of the walls (m), for a facet with unit `normal`.
    pub(crate) fn aperture(&self, normal: DVec3) -> f64 {
        let beyond = self.jump_residual.dot(normal);
        self.joint.separation.moved(beyond).aperture
    }
}
