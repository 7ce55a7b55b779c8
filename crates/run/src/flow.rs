//! The flow of a run: made once, solved at each load step, told.

use std::path::Path;

use kluft_io::printable::cell;
use kluft_io::{Field, write_atomically};
use kluft_mesh::{Defect, Mesh};
use kluft_solver::{
    Flow, FlowFields, FlowState, FlowSystem, FluxError, LinearFailure, Load, Problem, Schedule,
    State, System, TransientFlow,
};

use crate::flow_summary::{self, FlowSummary, Hydraulics, StepFlow};
use crate::grids::real_field;
use crate::summary::StepSummary;

/// The file of what flows where it is driven.
pub const SOURCES: &str = "sources.csv";

/// The flow of a run.
pub struct RunFlow<'p> {
    mesh: &'p Mesh,
    flow: &'p Flow,
    system: FlowSystem<'p>,
    /// Apertures that it was made with (m), as in the flat node list of the facets.
    apertures: Vec<f64>,
}

/// The flow under one load.
pub struct SolvedFlow {
    /// Its numbers.
    pub step: StepFlow,
    /// Its fields.
    pub fields: FlowFields,
    /// Estimated error of the flux along each facet (m^2/s).
    pub flux_errors: Vec<f64>,
}

impl<'p> RunFlow<'p> {
    /// The flow in the fractures of a problem at their apertures without load.
    ///
    /// # Errors
    /// As [`FlowSystem::of`].
    pub fn of(problem: &'p Problem, flow: &'p Flow) -> Result<Self, Vec<Defect>> {
        let mesh = &problem.mesh;
        let apertures = problem.initial_apertures();
        Ok(Self {
            system: FlowSystem::of(mesh, flow, &apertures)?,
            mesh,
            flow,
            apertures,
        })
    }

    /// The same, if something determines every pressure.
    ///
    /// # Errors
    /// As [`Self::of`], and networks without a pressure.
    pub fn driven(problem: &'p Problem, flow: &'p Flow) -> Result<Self, Vec<Defect>> {
        let made = Self::of(problem, flow)?;
        let undriven = made.system.undriven();
        match undriven.is_empty() {
            true => Ok(made),
            false => Err(undriven),
        }
    }

    /// What was made.
    pub fn system(&self) -> &FlowSystem<'p> {
        &self.system
    }

    /// Aperture without load at the nodes of the facets (m).
    pub fn apertures(&self) -> &[f64] {
        &self.apertures
    }

    /// Factorises the matrix, once for the run.
    ///
    /// # Errors
    /// As [`FlowSystem::factorise`].
    pub fn factorise(&mut self) -> Result<(), LinearFailure> {
        self.system.factorise()
    }

    /// The flow under a load.
    ///
    /// # Errors
    /// As [`FlowSystem::solve`].
    pub fn solve(&self, load: &Load) -> Result<SolvedFlow, LinearFailure> {
        Ok(self.told(&self.system.solve(load)?))
    }

    /// The flow in time, from the initial pressure on, to an accuracy of its time steps.
    pub fn in_time(&self, schedule: &Schedule, accuracy: f64) -> TransientFlow<'_, 'p> {
        TransientFlow::of(&self.system, &self.apertures, schedule, accuracy)
    }

    /// The flow in a state.
    pub fn told(&self, state: &FlowState) -> SolvedFlow {
        self.solved(state, self.system.fields(state, &self.apertures))
    }

    fn solved(&self, state: &FlowState, fields: FlowFields) -> SolvedFlow {
        let error = FluxError::of(self.mesh, &fields, self.flow.fluid.viscosity);
        SolvedFlow {
            step: flow_summary::of_step(self.flow, state, error.relative),
            fields,
            flux_errors: error.of_facet,
        }
    }

    /// The flow that follows the walls of a system in a state; `apertures` (m) are those at the
    /// nodes of the facets. None if it follows none.
    pub fn beside(
        &self,
        system: &System<'_>,
        state: &State,
        apertures: &[f64],
    ) -> Option<SolvedFlow> {
        let (coupling, fluid) = system.coupling().zip(state.fluid.as_ref())?;
        let flow = coupling.state(fluid, &state.load);
        let fields = coupling.fields(fluid, &state.load, apertures);
        Some(self.solved(&flow, fields))
    }

    /// How large it is, in words.
    pub fn words(&self) -> String {
        let networks = match self.system.networks().len() {
            1 => "1 hydraulic network".to_owned(),
            count => format!("{count} hydraulic networks"),
        };
        format!("{} pressures, {networks}", self.system.unknown_count())
    }

    /// How its fractures connect.
    pub fn hydraulics(&self) -> Hydraulics {
        flow_summary::hydraulics(self.mesh, self.flow, &self.system)
    }

    /// The numbers of the whole flow, and of its last state.
    pub fn summary(&self, last: &SolvedFlow) -> FlowSummary {
        FlowSummary {
            hydraulics: self.hydraulics(),
            fractures: flow_summary::conduits(self.mesh, &last.fields),
        }
    }
}

impl SolvedFlow {
    /// Fields at the points of the fracture grid.
    pub fn point_fields(&self) -> [Field; 2] {
        let field = |name, values: &[f64]| real_field(name, values.iter().map(|value| [*value]));
        [
            field("pressure", &self.fields.pressures),
            field("hydraulic_aperture", &self.fields.hydraulic_apertures),
        ]
    }

    /// Fields of the cells of the fracture grid.
    pub fn cell_fields(&self) -> [Field; 3] {
        let transmissivities = self.fields.transmissivities.iter();
        let fluxes = self.fields.fluxes.iter().map(|flux| flux.to_array());
        [
            real_field("transmissivity", transmissivities.map(|value| [*value])),
            real_field("flux", fluxes),
            real_field("flux_error", self.flux_errors.iter().map(|error| [*error])),
        ]
    }
}

/// Writes what flows where it is driven at the end of each load step.
///
/// # Errors
/// If the file cannot be written.
pub fn write_sources(path: &Path, steps: &[StepSummary]) -> Result<(), Defect> {
    write_atomically(path, |out| {
        let mut table = csv::Writer::from_writer(out);
        table.write_record(["step", "time", "source", "pressure", "rate", "volume"])?;
        for (index, step) in steps.iter().enumerate() {
            for source in step.flow.iter().flat_map(|flow| &flow.sources) {
                let number = (index + 1).to_string();
                let values = [step.time, source.pressure, source.rate, source.volume];
                let [time, pressure, rate, volume] = values.map(|value| format!("{value:?}"));
                let name = cell(&source.name);
                table.write_record([number, time, name, pressure, rate, volume])?;
            }
        }
        table.flush()
    })
}
