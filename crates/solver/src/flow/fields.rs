//! Fields of a flow for results.

use glam::DVec3;
use kluft_mesh::Mesh;
use lie_core::Conduction;

use super::loaded::FlowState;
use super::steady::FlowSystem;
use super::wall_points::of_corners;
use crate::problem::{Conduit, Flow};

/// Fields on the facets of all fractures; zero on those that are sealed.
#[derive(Debug, Clone, PartialEq)]
pub struct FlowFields {
    /// Pressure (Pa) at the nodes of the facets, in the order of their flat node list: between
    /// corners the mean of them.
    pub pressures: Vec<f64>,
    /// Hydraulic aperture (m), in the same order.
    pub hydraulic_apertures: Vec<f64>,
    /// `b_h^3 / 12` of each facet (m^3), which the viscosity divides to the transmissivity.
    pub transmissivities: Vec<f64>,
    /// Mean flux along each facet (m^2/s).
    pub fluxes: Vec<DVec3>,
}

impl FlowSystem<'_> {
    /// The fields of a state, with the apertures (m) that the system was made with.
    pub fn fields(&self, state: &FlowState, apertures: &[f64]) -> FlowFields {
        let elements = &self.topology.mesh.facets.elements;
        let mut fields = FlowFields {
            pressures: self.facet_pressures(state),
            hydraulic_apertures: hydraulic_apertures(
                self.topology.mesh,
                self.topology.flow,
                apertures,
            ),
            transmissivities: vec![0.0; elements.len()],
            fluxes: vec![DVec3::ZERO; elements.len()],
        };
        for (index, &facet) in self.topology.nodes.facets.iter().enumerate() {
            let transmissivity = self.operator.conductance.transmissivity[index];
            let corners = self.topology.nodes.corners.of(index).iter();
            let own: Vec<f64> = corners.map(|&row| state.potentials[row as usize]).collect();
            let gradient = self.topology.stencils[index].mean_gradient(&own);
            fields.transmissivities[facet as usize] =
                self.topology.flow.fluid.viscosity * transmissivity;
            fields.fluxes[facet as usize] = -transmissivity * gradient;
        }
        fields
    }

    /// Pressure (Pa) at the nodes of the facets, in the order of their flat node list.
    pub fn facet_pressures(&self, state: &FlowState) -> Vec<f64> {
        let elements = &self.topology.mesh.facets.elements;
        let mut pressures = vec![0.0; elements.nodes.len()];
        for (index, &facet) in self.topology.nodes.facets.iter().enumerate() {
            let facet = facet as usize;
            let corners = self.topology.nodes.corners.of(index).iter();
            let corners: Vec<f64> = corners.map(|&row| state.pressures[row as usize]).collect();
            let shape = elements.shapes[facet];
            for (local, value) in pressures[elements.range(facet)].iter_mut().enumerate() {
                let shares = of_corners(shape, local).into_iter();
                *value = shares.map(|(corner, share)| share * corners[corner]).sum();
            }
        }
        pressures
    }
}

fn hydraulic_apertures(mesh: &Mesh, flow: &Flow, apertures: &[f64]) -> Vec<f64> {
    let of = |aperture: &f64, conduit: Conduit| match conduit {
        Conduit::Sealed => 0.0,
        Conduit::Open(hydraulic) => {
            let Conduction {
                hydraulic_aperture, ..
            } = hydraulic.at(*aperture);
            hydraulic_aperture
        }
    };
    let facets = 0..mesh.facets.elements.len();
    let fields = facets.flat_map(|facet| {
        let conduit = flow.conduit(mesh, facet);
        let own = apertures[mesh.facets.elements.range(facet)].iter();
        own.map(move |aperture| of(aperture, conduit))
    });
    fields.collect()
}
