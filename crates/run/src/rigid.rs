//! A run in rigid rock: flow alone.

use std::time::Instant;

use kluft_io::Grid;
use kluft_mesh::Mesh;
use kluft_scene::in_terms_of_scene;
use kluft_solver::{Flow, Problem, Step};

use crate::decisions;
use crate::flow::{RunFlow, SolvedFlow};
use crate::flow_summary;
use crate::fluid_step::failed;
use crate::grids::{facet_grid, integer_field, real_field};
use crate::observer::Stage;
use crate::stages::{Interruption, Run};
use crate::summary::StepSummary;

impl Run<'_> {
    /// Solves and writes the flow of all load steps.
    ///
    /// # Errors
    /// Conditions that make no flow, numbers that are not finite, files that cannot be written.
    pub fn solve_flow(&mut self, problem: &Problem, flow: &Flow) -> Result<(), Interruption> {
        let made = self.stage(Stage::Assemble, |_| RunFlow::driven(problem, flow));
        let mut made = made.map_err(in_terms_of_scene)?;
        self.summary.unknowns.total = made.system().unknown_count();
        self.note_timed("assembled", &made.words());
        for decision in &self.summary.decisions {
            self.observer.note("decided", decision);
        }
        self.output.expect_steps(problem.schedule.steps.len())?;
        self.output.remove_former()?;
        self.write_summary()?;
        let factor = self.stage(Stage::PrepareSolver, |_| made.factorise());
        factor.map_err(failed)?;
        for index in 0..problem.schedule.steps.len() {
            self.flow_step(problem, &made, index)?;
        }
        Ok(())
    }

    fn flow_step(
        &mut self,
        problem: &Problem,
        made: &RunFlow<'_>,
        index: usize,
    ) -> Result<(), Interruption> {
        let step: &Step = &problem.schedule.steps[index];
        let start = Instant::now();
        let solved = self.stage(Stage::Solve, |_| made.solve(&step.load));
        self.summary.seconds.solve += start.elapsed().as_secs_f64();
        let solved = solved.map_err(failed)?;
        let text = format!(
            "step {} of {}, {}: {:.6e} m3/s in, {:.6e} m3/s out, mass error {:.1e}",
            index + 1,
            problem.schedule.steps.len(),
            decisions::of_step(&problem.schedule, step),
            solved.step.inflow,
            solved.step.outflow,
            solved.step.mass_error
        );
        self.observer.note("flow", &text);
        self.summary.steps.push(StepSummary {
            flow: Some(solved.step.clone()),
            ..StepSummary::without_measures(step)
        });
        let summary = made.summary(&solved);
        self.summary.measures = flow_summary::measures(&solved.step, &summary.fractures);
        self.summary.flow = Some(summary);
        self.stage(Stage::Write, |run| {
            let rock = || rock_grid(problem);
            let fractures = || fracture_grid(&problem.mesh, made, &solved);
            run.output.write_step(step.load.time, rock, fractures)?;
            run.write_sources()?;
            if run.request.keep_results {
                run.keep(rock(), fractures());
            }
            Ok::<(), Interruption>(())
        })?;
        self.write_summary()?;
        Ok(())
    }
}

/// The rock, which has neither moved nor carries anything that is known.
fn rock_grid(problem: &Problem) -> Grid {
    let mesh = &problem.mesh;
    let rocks = problem.rock_of_cell.iter().map(|&rock| rock as i32);
    Grid {
        points: mesh.nodes.iter().map(|x| x.to_array()).collect(),
        shapes: mesh.cells.shapes.clone(),
        offsets: mesh.cells.offsets.clone(),
        nodes: mesh.cells.nodes.clone(),
        point_fields: Vec::new(),
        cell_fields: vec![integer_field("rock", rocks)],
    }
}

/// The fractures, each facet with points of its own.
fn fracture_grid(mesh: &Mesh, made: &RunFlow<'_>, solved: &SolvedFlow) -> Grid {
    let apertures = made.apertures().iter().map(|aperture| [*aperture]);
    let mut grid = facet_grid(mesh, vec![real_field("aperture", apertures)]);
    grid.point_fields.extend(solved.point_fields());
    grid.cell_fields.extend(solved.cell_fields());
    grid
}
