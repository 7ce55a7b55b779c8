//! What a fluid adds to a run in rock that deforms.

use std::path::Path;

use kluft_io::Grid;
use kluft_scene::{Binding, in_terms_of_scene};
use kluft_solver::{FacetResult, LinearFailure, Problem, System};

use crate::failures;
use crate::flow::{RunFlow, SOURCES, SolvedFlow, write_sources};
use crate::flow_summary;
use crate::grids::real_field;
use crate::observer::Stage;
use crate::stages::{Interruption, Run};

/// Why a flow could not be solved.
pub fn failed(failure: LinearFailure) -> Interruption {
    Interruption::NotConverged(failures::flow_failure(&failure))
}

impl Run<'_> {
    /// The flow of a problem, whose push on the walls is added to the loads of its system; none
    /// without a fluid.
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
        let made = self.stage(Stage::Assemble, |_| RunFlow::driven(&binding.problem, flow));
        let mut made = made.map_err(in_terms_of_scene)?;
        let solved = self.stage(Stage::PrepareSolver, |_| {
            made.factorise()?;
            made.system().push_walls(system)
        });
        solved.map_err(failed)?;
        self.note_timed("flow", &made.words());
        Ok(Some(made))
    }

    /// The flow at the end of the load step that was solved last, summed up.
    ///
    /// # Errors
    /// Numbers that are not finite.
    pub fn take_flow(
        &mut self,
        problem: &Problem,
        made: Option<&RunFlow<'_>>,
    ) -> Result<Option<SolvedFlow>, Interruption> {
        let Some(made) = made else {
            return Ok(None);
        };
        let steps = problem.schedule.steps.iter();
        let mut last = None;
        // Those of a former run are not kept by its checkpoint.
        for (summary, step) in self.summary.steps.iter_mut().zip(steps) {
            if summary.flow.is_none() {
                let solved = made.solve(&step.load).map_err(failed)?;
                summary.flow = Some(solved.step.clone());
                last = Some(solved);
            }
        }
        if let Some(solved) = &last {
            let summary = made.summary(solved);
            let measures = flow_summary::measures(&solved.step, &summary.fractures);
            self.summary.measures.extend(measures);
            self.summary.flow = Some(summary);
        }
        Ok(last)
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
