//! What of a flow stays whatever the apertures: its numbering, its stencils, where conditions act.

use kluft_mesh::{Defect, Mesh};
use lie_core::FacetFlow;

use super::conductance::{Conductance, stencils};
use super::networks::{self, FlowNetwork};
use super::numbering::FlowNodes;
use super::places::{self, Place};
use crate::problem::Flow;

/// Marks a row whose pressure is given.
pub(super) const GIVEN: u32 = u32::MAX;

/// The topology of the flow in the fractures of a mesh.
#[derive(Debug)]
pub(super) struct Topology<'a> {
    pub(super) mesh: &'a Mesh,
    pub(super) flow: &'a Flow,
    pub(super) nodes: FlowNodes,
    /// Stencil of each conducting facet.
    pub(super) stencils: Vec<FacetFlow>,
    /// Where each of [`Flow::conditions`] acts.
    pub(super) places: Vec<Place>,
    pub(super) networks: Vec<FlowNetwork>,
    pub(super) network_of_row: Vec<u32>,
    /// Rows whose pressure is not given, ascending.
    pub(super) free: Vec<u32>,
    /// Index of each row into `free`, or [`GIVEN`].
    pub(super) number: Vec<u32>,
}

impl<'a> Topology<'a> {
    /// The topology, and how facets of these transmissivities (m^3/(Pa s)) conduct.
    ///
    /// # Errors
    /// Fractures that conduct nothing, and conditions that meet no fracture or contradict each
    /// other.
    pub(super) fn of(
        (mesh, flow): (&'a Mesh, &'a Flow),
        nodes: FlowNodes,
        transmissivity: Vec<f64>,
    ) -> Result<(Self, Conductance), Vec<Defect>> {
        let stencils = stencils(mesh, &nodes);
        let conductance = Conductance::of(&nodes, &stencils, transmissivity);
        let shut = conductance.shut(mesh, &nodes);
        if !shut.is_empty() {
            return Err(shut);
        }
        let places = places::find((mesh, flow), &nodes, &stencils, &conductance)?;
        let (networks, network_of_row) = networks::find(mesh, &nodes, flow, &places);
        let mut number = vec![0; nodes.len()];
        for (place, condition) in places.iter().zip(&flow.conditions) {
            if condition.drive.is_pressure() && !place.is_well() {
                place.rows().for_each(|row| number[row] = GIVEN);
            }
        }
        let mut free = Vec::new();
        for (row, number) in number.iter_mut().enumerate() {
            if *number != GIVEN {
                *number = free.len() as u32;
                free.push(row as u32);
            }
        }
        let topology = Self {
            mesh,
            flow,
            nodes,
            stencils,
            places,
            networks,
            network_of_row,
            free,
            number,
        };
        Ok((topology, conductance))
    }

    /// Pressure before any load at each row (Pa).
    pub(super) fn initial_pressures(&self) -> Vec<f64> {
        let places = self.nodes.node.iter();
        let places = places.map(|&node| self.mesh.nodes[node as usize]);
        places
            .map(|place| self.flow.initial_pressure.at(place, 0.0))
            .collect()
    }
}
