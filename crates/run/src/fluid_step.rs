//! What a fluid adds to a run in rock that deforms.

use std::path::Path;

use kluft_io::Grid;
use kluft_scene::{Binding, in_terms_of_scene};
use kluft_solver::{FacetResult, LinearFailure, State, System};

use crate::failures;
use crate::flow::{RunFlow, SOURCES, SolvedFlow, write_sources};
use crate::flow_summary::{self, StepFlow};
use crate::grids::real_field;
use crate::observer::Stage;
use crate::stages::{Interruption, Run};

/// Why a flow could not be solved.
pub fn failed(failure: LinearFailure) -> Interruption {
    Interruption::NotConverged(failures::flow_failure(&failure))
}

impl Run<'_> {
    /// The flow of a problem: it follows the walls of its system, or its push on them is added to
    /// the loads; none without a fluid, or where nothing but the permeability is asked of it.
    ///
    /// # Errors
    /// Conditions that make no flow, and numbers that are not finite.
    pub fn let_flow<'p>(
        &mut self,
        binding: &'p Binding,
        system: &mut System<'p>,
    ) -> Result<Option<RunFlow<'p>>, Interruption> {
        let Some(flow) = &binding.flow else {
            return Ok(None);
        };
        let is_asked = self.request.scene.equivalent_permeability;
        if is_asked && flow.conditions.is_empty() {
            return Ok(None);
        }
        let problem = &binding.problem;
        if flow.follows_walls(problem.schedule.is_timed) {
            let made = self.stage(Stage::Assemble, |_| {
                system.couple(flow)?;
                RunFlow::of(problem, flow)
            });
            let made = made.map_err(in_terms_of_scene)?;
            self.note_timed("flow", &made.words());
            return Ok(Some(made));
        }
        let made = self.stage(Stage::Assemble, |_| RunFlow::driven(problem, flow));
        let mut made = made.map_err(in_terms_of_scene)?;
        let solved = self.stage(Stage::PrepareSolver, |_| {
            made.factorise()?;
            system.push_walls(made.system())
        });
        solved.map_err(failed)?;
        self.note_timed("flow", &made.words());
        Ok(Some(made))
    }

    /// The flow in a state at the end of the load step that was solved last, summed up; `nodes` are
    /// the results at the nodes of the facets.
    ///
    /// # Errors
    /// Numbers that are not finite.
    pub fn take_flow(
        &mut self,
        system: &System<'_>,
        (state, nodes): (&State, &[FacetResult]),
        made: Option<&RunFlow<'_>>,
    ) -> Result<Option<SolvedFlow>, Interruption> {
        let Some(made) = made else {
            return Ok(None);
        };
        let apertures: Vec<f64> = nodes.iter().map(|node| node.aperture).collect();
        let solved = match made.beside(system, state, &apertures) {
            Some(solved) => solved,
            None => made.solve(&state.load).map_err(failed)?,
        };
        if system.coupling().is_some() {
            self.observer.note("flow", &told(&solved.step));
        }
        if let Some(step) = self.summary.steps.last_mut() {
            step.flow = Some(solved.step.clone());
        }
        let summary = made.summary(&solved);
        let measures = flow_summary::measures(&solved.step, &summary.fractures);
        self.summary.measures.extend(measures);
        self.summary.flow = Some(summary);
        Ok(Some(solved))
    }

    /// Writes what flows where it is driven, at the end of the load steps so far.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write_sources(&mut self) -> Result<(), Interruption> {
        let steps = &self.summary.steps;
        if steps.iter().all(|step| step.flow.is_none()) || !self.output.is_kept() {
            return Ok(());
        }
        let write = |path: &Path| write_sources(path, steps);
        Ok(self.output.write(SOURCES, write)?)
    }
}

/// The flow of a load step in words.
pub fn told(flow: &StepFlow) -> String {
    let stored = match flow.stored {
        0.0 => String::new(),
        stored => format!(" {stored:.6e} m3/s stored,"),
    };
    format!(
        "{:.6e} m3/s in, {:.6e} m3/s out,{stored} mass error {:.1e}",
        flow.inflow, flow.outflow, flow.mass_error
    )
}

/// Adds a flow to the grid of the fractures; `nodes` are the results at their nodes.
pub fn add_to(grid: &mut Grid, solved: &SolvedFlow, nodes: &[FacetResult]) {
    let pressures = solved.fields.pressures.iter();
    let total = nodes.iter().zip(pressures);
    let total = total.map(|(node, pressure)| [node.normal_traction - pressure]);
    grid.point_fields.extend(solved.point_fields());
    grid.point_fields
        .push(real_field("total_normal_traction", total));
    grid.cell_fields.extend(solved.cell_fields());
}
