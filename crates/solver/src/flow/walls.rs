//! The fluid pushes the walls of fractures apart.
//!
//! At constant hydraulic apertures the flow is linear in what drives it: the pressure under a load
//! is the sum of those of its cases, each with its factor, and so is their push.

use kluft_algebra::LinearFailure;

use super::solve::FlowState;
use super::steady::FlowSystem;
use crate::assembly::interface::Interface;
use crate::assembly::loads::{CaseLoads, Loads};
use crate::problem::Load;
use crate::system::System;

impl FlowSystem<'_> {
    /// Adds the push of this flow, on the mesh of the problem and factorised, to the forces of all
    /// load cases of a system.
    ///
    /// # Errors
    /// If a number is not finite.
    pub fn push_walls(&self, system: &mut System<'_>) -> Result<(), LinearFailure> {
        let interface = &system.discretisation().interface;
        let count = system.problem().schedule.case_count();
        let mut cases: Vec<CaseLoads> = system.loads().cases().to_vec();
        for (case, loads) in cases.iter_mut().enumerate() {
            let mut unit = Load {
                time: 0.0,
                factors: vec![0.0; count],
            };
            unit.factors[case] = 1.0;
            let pressures = self.point_pressures(&self.solve(&unit)?, interface);
            interface.add_pressures(&pressures, &mut loads.applied);
        }
        let loads = Loads::new(cases, system.loads().initial().to_vec());
        system.set_loads(loads);
        Ok(())
    }

    /// Pressure at each point of an interface (Pa): at control points, control values.
    pub fn point_pressures(&self, state: &FlowState, interface: &Interface) -> Vec<f64> {
        interface.point_values(self.topology.mesh, &self.facet_pressures(state))
    }
}
