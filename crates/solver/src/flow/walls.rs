//! The fluid pushes the walls of fractures apart.
//!
//! At constant hydraulic apertures the flow is linear in what drives it: the pressure under a load
//! is the sum of those of its cases, each with its factor, and so is their push.

use kluft_algebra::LinearFailure;

use super::steady::FlowSystem;
use super::wall_points::WallPoints;
use crate::assembly::interface::Interface;
use crate::assembly::loads::CaseLoads;
use crate::problem::Load;

impl FlowSystem<'_> {
    /// Adds the push of this flow, on the mesh of the interface and factorised, to the forces of
    /// all load cases.
    ///
    /// # Errors
    /// If a number is not finite.
    pub(crate) fn add_push(
        &self,
        interface: &Interface,
        cases: &mut [CaseLoads],
    ) -> Result<(), LinearFailure> {
        let points = WallPoints::of(&self.topology, interface);
        let count = cases.len();
        for (case, loads) in cases.iter_mut().enumerate() {
            let mut unit = Load {
                time: 0.0,
                factors: vec![0.0; count],
            };
            unit.factors[case] = 1.0;
            let state = self.solve(&unit)?;
            let pressures = points.at_points(|row| state.pressures[row]);
            interface.add_pressures(&pressures, &mut loads.applied);
        }
        Ok(())
    }
}
