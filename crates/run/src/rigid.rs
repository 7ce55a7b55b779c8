//! A run in rigid rock: flow alone.

use std::io::Write;
use std::path::Path;
use std::time::Instant;

use kluft_io::{Grid, write_atomically};
use kluft_mesh::{Elements, Mesh};
use kluft_scene::in_terms_of_scene;
use kluft_solver::{Flow, LinearFailure, Problem, Step, TransientFlow, TransientState};

use crate::checkpoint::{self, FlowRestart, Progress};
use crate::decisions;
use crate::flow::{RunFlow, SolvedFlow};
use crate::flow_history::{FlowEntry, FlowHistory};
use crate::flow_summary;
use crate::fluid_step::{failed, told};
use crate::grids::{facet_grid, in_plane, integer_field, real_field};
use crate::history;
use crate::observer::Stage;
use crate::probes::{Solved, SolvedFluid};
use crate::resume::FormerRun;
use crate::stages::{Interruption, Run, newton_settings};
use crate::summary::StepSummary;
use crate::unresolved;

impl Run<'_> {
    /// Solves and writes the flow of all load steps, and the permeability of the body if the scene
    /// asks for it; that alone if nothing drives the fluid.
    ///
    /// # Errors
    /// Conditions that make no flow, numbers that are not finite, files that cannot be written.
    pub fn solve_flow(
        &mut self,
        problem: &Problem,
        flow: &Flow,
        former: Option<FormerRun>,
    ) -> Result<(), Interruption> {
        for decision in &self.summary.decisions {
            self.observer.note("decided", decision);
        }
        let is_driven = !flow.conditions.is_empty();
        let steps = match is_driven || !self.request.scene.equivalent_permeability {
            true => problem.schedule.steps.len(),
            false => 0,
        };
        let is_stored = flow.is_stored(problem.schedule.is_timed);
        let made = (steps > 0)
            .then(|| self.flow_system(problem, flow, is_stored))
            .transpose()?;
        self.output.expect_steps(steps)?;
        let mut restart = None;
        match former {
            Some(former) => restart = self.take_over(problem, former.progress),
            None => self.output.remove_former()?,
        }
        self.write_summary()?;
        self.permeability(problem, flow)?;
        let Some(mut made) = made else {
            return Ok(());
        };
        let done = self.summary.steps.len();
        if !is_stored {
            let factor = self.stage(Stage::PrepareSolver, |_| made.factorise());
            factor.map_err(failed)?;
        }
        let accuracy = newton_settings(&self.request.scene.solver).time;
        let mut in_time = is_stored.then(|| made.in_time(&problem.schedule, accuracy));
        if let (Some(flow), Some(reached)) = (&mut in_time, restart) {
            let load = &problem.schedule.steps[done - 1].load;
            if !flow.go_on(load, reached) {
                let path = self.output.path(checkpoint::NAME);
                return Err(checkpoint::other_build(&path).into());
            }
        }
        for index in done..steps {
            if index > done && self.observer.goes_on().is_break() {
                return Err(Interruption::Stopped);
            }
            let solved = self.flow_at(problem, (&made, in_time.as_mut()), index)?;
            self.flow_step(problem, (&made, &solved), index)?;
            if index + 1 < steps {
                self.write_flow_checkpoint(FlowRestart {
                    state: in_time.as_ref().map(|flow| flow.state().clone()),
                    warnings: self.summary.warnings.clone(),
                })?;
            }
        }
        Ok(())
    }

    /// Takes over what a former run has finished, and tells what the next load step starts from, if
    /// the fluid is stored.
    fn take_over(
        &mut self,
        problem: &Problem,
        former: Progress<'static>,
    ) -> Option<TransientState> {
        let steps = &problem.schedule.steps;
        let done = &steps[..former.files.len().min(steps.len())];
        let times = done.iter().map(|step| step.load.time);
        self.output.go_on_after(times, former.files);
        let summaries = done
            .iter()
            .zip(former.flows)
            .map(|(step, flow)| StepSummary {
                flow,
                ..StepSummary::without_measures(step)
            });
        self.summary.steps = summaries.collect();
        self.summary.measures = former.measures;
        self.flow_history = FlowHistory::from_text(former.history);
        self.probes.text = former.probes;
        self.take_over_origins(former.origins);
        let text = format!("after step {} of {}", done.len(), steps.len());
        self.observer.note("resumed", &text);
        let restart = former.flow_restart?;
        self.summary.warnings = restart.warnings;
        restart.state
    }

    /// The flow at the end of a load step.
    fn flow_at(
        &mut self,
        problem: &Problem,
        (made, in_time): (&RunFlow<'_>, Option<&mut TransientFlow<'_, '_>>),
        index: usize,
    ) -> Result<SolvedFlow, Interruption> {
        let load = &problem.schedule.steps[index].load;
        let start = Instant::now();
        let solved = self.stage(Stage::Solve, |_| match in_time {
            Some(flow) => {
                let step = flow.step(&problem.schedule, load)?;
                Ok((made.told(&step.state), step.error))
            }
            None => Ok::<_, LinearFailure>((made.solve(load)?, None)),
        });
        self.summary.seconds.solve += start.elapsed().as_secs_f64();
        let (solved, error) = solved.map_err(failed)?;
        if let Some(error) = error {
            let warning = unresolved::long_time_step(self.request.scene, (index + 1, error), 0);
            self.summary.warnings.extend(warning);
        }
        Ok(solved)
    }

    fn flow_system<'p>(
        &mut self,
        problem: &'p Problem,
        flow: &'p Flow,
        is_stored: bool,
    ) -> Result<RunFlow<'p>, Interruption> {
        let made = self.stage(Stage::Assemble, |_| match is_stored {
            // It begins with the pressures that fractures have.
            true => RunFlow::of(problem, flow),
            false => RunFlow::driven(problem, flow),
        });
        let made = made.map_err(in_terms_of_scene)?;
        self.summary.unknowns.total = made.system().unknown_count();
        self.note_timed("assembled", &made.words());
        Ok(made)
    }

    fn flow_step(
        &mut self,
        problem: &Problem,
        (made, solved): (&RunFlow<'_>, &SolvedFlow),
        index: usize,
    ) -> Result<(), Interruption> {
        let step: &Step = &problem.schedule.steps[index];
        let text = format!(
            "step {} of {}, {}: {}",
            index + 1,
            problem.schedule.steps.len(),
            decisions::of_step(&problem.schedule, step),
            told(&solved.step)
        );
        self.observer.note("flow", &text);
        self.summary.steps.push(StepSummary {
            flow: Some(solved.step.clone()),
            ..StepSummary::without_measures(step)
        });
        let summary = made.summary(solved);
        self.summary.measures = flow_summary::measures(&solved.step, &summary.fractures);
        let entry = FlowEntry {
            flow: &solved.step,
            conduits: &summary.fractures,
        };
        self.flow_history.add((index + 1, step), &entry);
        self.summary.flow = Some(summary);
        self.stage(Stage::Write, |run| {
            let mesh = &problem.mesh;
            let rock = || in_plane(mesh, rock_grid(problem));
            let fractures = || in_plane(mesh, fracture_grid(mesh, made, solved));
            run.output
                .write_step(step.load.time, rock, fractures, || ())?;
            run.write_sources()?;
            let text = run.flow_history.text().as_bytes();
            let write = |path: &Path| write_atomically(path, |out| out.write_all(text));
            if run.output.is_kept() {
                run.output.write(history::NAME, write)?;
            }
            if run.request.keep_results {
                run.keep(rock(), fractures());
            }
            Ok::<(), Interruption>(())
        })?;
        self.write_probes(&Solved {
            number: index + 1,
            step,
            mesh: &problem.mesh,
            rock: None,
            fluid: Some(SolvedFluid {
                fields: &solved.fields,
                apertures: made.apertures(),
            }),
        })?;
        self.write_summary()?;
        Ok(())
    }
}

/// The rock, which has neither moved nor carries anything that is known; where the mesh holds
/// surfaces alone, its outer faces.
fn rock_grid(problem: &Problem) -> Grid {
    let mesh = &problem.mesh;
    if mesh.cells.is_empty() {
        return outer_grid(mesh);
    }
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

/// The parts of the outer surface, numbered in the order of the mesh.
fn outer_grid(mesh: &Mesh) -> Grid {
    let mut whole = Elements::new();
    let mut part_of_facet = Vec::new();
    for (part, boundary) in (0..).zip(&mesh.boundaries) {
        whole.extend(&boundary.elements);
        part_of_facet.resize(whole.len(), part);
    }
    let mut used = whole.nodes.clone();
    used.sort_unstable();
    used.dedup();
    let number = |node: &u32| used.partition_point(|other| other < node) as u32;
    Grid {
        points: used
            .iter()
            .map(|&node| mesh.nodes[node as usize].to_array())
            .collect(),
        nodes: whole.nodes.iter().map(number).collect(),
        shapes: whole.shapes,
        offsets: whole.offsets,
        point_fields: Vec::new(),
        cell_fields: vec![integer_field("boundary", part_of_facet.into_iter())],
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
