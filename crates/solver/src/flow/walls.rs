//! The fluid pushes the walls of fractures apart.
//!
//! At constant hydraulic apertures the flow is linear in what drives it: the pressure under a load
//! is the sum of those of its cases, each with its factor, and so is their push.

use glam::DVec3;
use kluft_algebra::LinearFailure;
use lie_core::facet_points;

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
        let at_nodes = self.facet_pressures(state);
        let elements = &self.topology.mesh.facets.elements;
        // The points of a facet keep their order, wherever they stand.
        let mut seen = vec![0_usize; elements.len()];
        let points = interface.points().iter();
        let pressures = points.map(|point| {
            let facet = point.facet as usize;
            let place = seen[facet];
            seen[facet] += 1;
            let nodes = elements.nodes_of(facet).iter();
            let nodes: Vec<DVec3> = nodes
                .map(|&node| self.topology.mesh.nodes[node as usize])
                .collect();
            let rule = interface.rule_of(point.fracture);
            let shares = facet_points(elements.shapes[facet], &nodes, rule)
                .into_iter()
                .nth(place)
                .map_or_else(Vec::new, |own| own.nodes);
            let own = &at_nodes[elements.range(facet)];
            let terms = shares.into_iter();
            terms
                .map(|(local, share)| share * own[local as usize])
                .sum()
        });
        pressures.collect()
    }
}
