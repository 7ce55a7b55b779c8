//! The numbers of a flow.

use kluft_mesh::Mesh;
use kluft_solver::{Flow, FlowFields, FlowState, FlowSystem};
use serde::{Deserialize, Serialize};

use crate::measure::Measure;
use crate::spread::Spread;

/// Flow through one condition.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SourceFlow {
    /// How the scene calls it.
    pub name: String,
    /// Pressure there (Pa): at the wall of a borehole, else the mean of the nodes.
    pub pressure: f64,
    /// What flows in (m^3/s); negative where it flows out.
    pub rate: f64,
    /// What has flowed in since the run began (m^3); zero in steady flow.
    pub volume: f64,
}

/// The flow at the end of a load step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StepFlow {
    /// What flows in (m^3/s).
    pub inflow: f64,
    /// What flows out (m^3/s).
    pub outflow: f64,
    /// What fractures take up (m^3/s); zero in steady flow.
    pub stored: f64,
    /// What nodes lose or gain that should not, as a share of what flows.
    pub mass_error: f64,
    /// The part of it that rounding explains; large where next to nothing moves any more.
    #[serde(default)]
    pub mass_rounding: f64,
    /// Estimated error of the flux as a share of it, in the energy norm, for the sake of the mesh.
    #[serde(default)]
    pub flux_error: f64,
    /// What flows where it is driven.
    pub sources: Vec<SourceFlow>,
}

/// Fractures between which fluid can pass.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NetworkSummary {
    /// Their names.
    pub fractures: Vec<String>,
    /// Number of nodes with a pressure.
    pub nodes: usize,
    /// What drives the fluid in them.
    pub sources: Vec<String>,
}

/// The flow in one fracture.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ConduitSummary {
    /// Its name.
    pub name: String,
    /// Pressure (Pa).
    pub pressure: Spread,
    /// Hydraulic aperture (m).
    pub hydraulic_aperture: Spread,
    /// Largest flux (m^2/s).
    pub flux_max: f64,
}

/// How fractures connect for a fluid.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Hydraulics {
    /// Number of unknown pressures.
    pub unknowns: usize,
    /// What hangs together.
    pub networks: Vec<NetworkSummary>,
    /// Edges of facets across which pressure drives fluid backwards, because of obtuse corners.
    pub backward_edges: usize,
}

/// The flow of a run after the last load step.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FlowSummary {
    /// How fractures connect.
    #[serde(flatten)]
    pub hydraulics: Hydraulics,
    /// The fractures that conduct.
    pub fractures: Vec<ConduitSummary>,
}

/// The numbers of a state.
pub fn of_step(flow: &Flow, state: &FlowState, flux_error: f64) -> StepFlow {
    let sources = flow.conditions.iter().zip(&state.conditions);
    let sources = sources.zip(&state.entered);
    let sources = sources.map(|((condition, found), volume)| SourceFlow {
        volume: *volume,
        name: condition.name.clone(),
        pressure: found.pressure,
        rate: found.rate,
    });
    StepFlow {
        inflow: state.balance.inflow,
        outflow: state.balance.outflow,
        stored: state.balance.stored,
        mass_error: state.balance.mass_error,
        mass_rounding: state.balance.rounding,
        flux_error,
        sources: sources.collect(),
    }
}

/// How fractures connect in a flow.
pub fn hydraulics(mesh: &Mesh, flow: &Flow, system: &FlowSystem<'_>) -> Hydraulics {
    let name = |fracture: &u32| mesh.fractures[*fracture as usize].clone();
    let networks = system.networks().iter();
    let told = networks.map(|network| NetworkSummary {
        fractures: network.fractures.iter().map(name).collect(),
        nodes: network.nodes,
        sources: network
            .conditions
            .iter()
            .map(|&condition| flow.conditions[condition].name.clone())
            .collect(),
    });
    Hydraulics {
        unknowns: system.unknown_count(),
        networks: told.collect(),
        backward_edges: system.backward_edges(),
    }
}

/// The numbers of the fractures that conduct; means are taken over their area.
pub fn conduits(mesh: &Mesh, fields: &FlowFields) -> Vec<ConduitSummary> {
    let areas: Vec<f64> = mesh
        .facet_areas()
        .iter()
        .map(|area| area.length())
        .collect();
    let names = mesh.fractures.iter().enumerate();
    let all = names.filter_map(|(fracture, name)| {
        let own = mesh.facets.of_fracture(fracture);
        let conducting = own.filter(|&facet| fields.transmissivities[facet] > 0.0);
        let facets: Vec<usize> = conducting.collect();
        if facets.is_empty() {
            return None;
        }
        let fluxes = facets.iter().map(|&facet| fields.fluxes[facet].length());
        Some(ConduitSummary {
            name: name.clone(),
            pressure: spread(mesh, &areas, &facets, &fields.pressures),
            hydraulic_aperture: spread(mesh, &areas, &facets, &fields.hydraulic_apertures),
            flux_max: fluxes.fold(0.0, f64::max),
        })
    });
    all.collect()
}

/// Spread of a field at the nodes of facets, of each facet the mean of its corners.
fn spread(mesh: &Mesh, areas: &[f64], facets: &[usize], field: &[f64]) -> Spread {
    let elements = &mesh.facets.elements;
    let corners = |facet: usize| {
        let count = elements.shapes[facet].corner_count();
        &field[elements.range(facet)][..count]
    };
    let values = || facets.iter().flat_map(|&facet| corners(facet)).copied();
    let (mut sum, mut whole) = (0.0, 0.0);
    for &facet in facets {
        let own = corners(facet);
        sum += areas[facet] * own.iter().sum::<f64>() / own.len() as f64;
        whole += areas[facet];
    }
    let min = values().fold(f64::INFINITY, f64::min);
    let max = values().fold(f64::NEG_INFINITY, f64::max);
    Spread {
        min,
        // Rounding puts the mean of what is the same everywhere beside it.
        mean: (sum / whole).max(min).min(max),
        max,
    }
}

/// Numbers by which runs are compared: rates of what drives the fluid, mean pressures.
pub fn measures(step: &StepFlow, conduits: &[ConduitSummary]) -> Vec<Measure> {
    let plain = |name: String, fracture: Option<String>, value: f64| Measure {
        name,
        fracture,
        value: Some(value),
        exact: None,
        error: None,
    };
    let rates = step.sources.iter();
    let rates = rates.map(|source| plain(format!("rate {}", source.name), None, source.rate));
    let pressures = conduits.iter().map(|conduit| {
        let name = Some(conduit.name.clone());
        plain("mean_pressure".into(), name, conduit.pressure.mean)
    });
    rates.chain(pressures).collect()
}
