//! The load steps of a run: each is solved, estimated, written, and can be resumed from.

use std::io::Write;
use std::path::Path;

use kluft_io::{Grid, write_atomically};
use kluft_scene::Binding;
use kluft_solver::{
    Determinacy, Estimator, FacetResult, Flow, Newton, Plan, Solution, StageEnd, State,
    StepOutcome, System, determinacy, solution,
};

use crate::accuracy::{self, Accuracy};
use crate::checkpoint::{self, Progress};
use crate::decisions;
use crate::doubts;
use crate::failures;
use crate::flow::{RunFlow, SolvedFlow};
use crate::flow_history::FlowEntry;
use crate::fluid_step;
use crate::fractures::fractures;
use crate::grids::{fracture_grid, in_plane, rock_grid};
use crate::history::{self, Entry, History, Parts};
use crate::measures::{energy, measures};
use crate::observer::{Stage, StepStart};
use crate::outcome::StepResult;
use crate::pieces::Piece;
use crate::probes::{self, Solved, SolvedFluid, SolvedRock};
use crate::resume::FormerRun;
use crate::stages::{Interruption, Run, newton_settings, solved};
use crate::summary::{StepFracture, StepMeasures, StepSummary, Summary};
use crate::undetermined;
use crate::unresolved;

/// A run that has a system and a solver.
pub(crate) struct Prepared<'s, 'p> {
    pub(crate) system: &'s System<'p>,
    flow: Option<&'s RunFlow<'p>>,
    /// What could flow, if there is a fluid.
    fluid: Option<&'p Flow>,
    pub(crate) newton: Newton,
    pub(crate) state: State,
    /// Made with the first results, so that it takes no memory from the first solve.
    estimator: Option<Estimator>,
    /// What its stage of the body began with, if it is not the first.
    pub(crate) stage: Option<&'s StageEnd>,
}

/// What the grids of a load step hold.
struct Written<'a> {
    solution: &'a Solution,
    nodes: &'a [FacetResult],
    accuracy: &'a Accuracy,
    facets: Option<&'a [Determinacy]>,
    flow: Option<&'a SolvedFlow>,
}

impl Run<'_> {
    /// Solves all load steps without writing anything: the number of unknowns and the estimated
    /// error at the end.
    ///
    /// # Errors
    /// As [`Self::solve`].
    pub fn trial(&mut self, binding: &Binding) -> Result<(usize, Accuracy), Interruption> {
        let problem = &binding.problem;
        let mut system = self.assemble(problem)?;
        self.let_flow(binding, &mut system)?;
        let plan = self.plan(&system, None)?;
        let mut prepared = Prepared {
            newton: self.set_up(&mut system, plan)?,
            state: system.initial_state(),
            system: &system,
            flow: None,
            fluid: None,
            estimator: None,
            stage: None,
        };
        for index in 0..problem.schedule.steps.len() {
            self.solve_step(&mut prepared, index)?;
        }
        self.summary.steps.clear();
        self.iterations.clear();
        let solution = solution(&system, &prepared.state);
        let unknowns = system.discretisation().unknown_count();
        let estimator = Estimator::of(&system);
        let accuracy = accuracy::of(&system, &mut prepared.newton, &estimator, &solution, true);
        Ok((unknowns, accuracy))
    }

    /// From the problem to the results of all load steps that are left.
    ///
    /// # Errors
    /// A load step that does not converge, a system that does not fit in memory, and files that
    /// cannot be written.
    pub fn solve(
        &mut self,
        binding: &Binding,
        former: Option<FormerRun>,
    ) -> Result<(), Interruption> {
        let problem = &binding.problem;
        let mut system = self.assemble(problem)?;
        let flow = self.let_flow(binding, &mut system)?;
        let plan = self.plan(&system, former.as_ref())?;
        if let Some(flow) = &binding.flow {
            self.permeability(problem, flow)?;
        }
        self.decide(binding);
        self.probes.all.clone_from(&binding.probes);
        let unbalanced = doubts::of_initial_stress(self.request.scene, &system);
        self.doubts.extend(unbalanced);
        self.summary.warnings.clone_from(&self.doubts);
        let mut prepared = match former {
            None => self.begin(&mut system, plan)?,
            Some(former) => self.go_on(&mut system, plan, former.progress)?,
        };
        prepared.flow = flow.as_ref();
        prepared.fluid = binding.flow.as_ref();
        self.solve_until(&mut prepared, problem.schedule.steps.len())?;
        let Prepared {
            mut newton, state, ..
        } = prepared;
        self.reduce_strength(&mut system, &mut newton, state)
    }

    /// Solves the load steps that are left up to one.
    ///
    /// # Errors
    /// As [`Self::solve`].
    pub(crate) fn solve_until(
        &mut self,
        prepared: &mut Prepared<'_, '_>,
        end: usize,
    ) -> Result<(), Interruption> {
        for index in self.finished.len()..end {
            self.go_on_if_asked()?;
            let measures = self.solve_step(prepared, index)?;
            self.finished.push(measures);
            self.take_results(prepared)?;
            self.write_summary()?;
            self.write_checkpoint(prepared)?;
        }
        Ok(())
    }

    /// Takes over and tells what was decided for a problem.
    pub fn decide(&mut self, binding: &Binding) {
        let settings = newton_settings(&self.request.scene.solver);
        self.summary.decisions.push(self.choice.1.clone());
        let of_problem =
            decisions::of_problem(&binding.problem, binding.flow.as_ref(), settings.path);
        self.summary.decisions.extend(of_problem);
        for decision in &self.summary.decisions {
            self.observer.note("decided", decision);
        }
    }

    /// Prepares for the first load step.
    pub(crate) fn begin<'s, 'p>(
        &mut self,
        system: &'s mut System<'p>,
        plan: Plan,
    ) -> Result<Prepared<'s, 'p>, Interruption> {
        let steps = system.problem().schedule.steps.len();
        self.output.expect_steps(steps)?;
        self.output.remove_former()?;
        self.write_summary()?;
        self.enter(system, plan)
    }

    /// Prepares for the first load step of a body.
    pub(crate) fn enter<'s, 'p>(
        &mut self,
        system: &'s mut System<'p>,
        plan: Plan,
    ) -> Result<Prepared<'s, 'p>, Interruption> {
        Ok(Prepared {
            newton: self.set_up(system, plan)?,
            state: system.initial_state(),
            system,
            flow: None,
            fluid: None,
            estimator: None,
            stage: None,
        })
    }

    /// Prepares for the load step after the last one that a former run finished.
    pub(crate) fn go_on<'s, 'p>(
        &mut self,
        system: &'s mut System<'p>,
        plan: Plan,
        former: Progress<'static>,
    ) -> Result<Prepared<'s, 'p>, Interruption> {
        let steps = &system.problem().schedule.steps;
        let done = &steps[..former.steps.len().min(steps.len())];
        let times = done.iter().map(|step| step.load.time);
        self.output.expect_steps(steps.len())?;
        self.output.go_on_after(times, former.files);
        let summaries = done.iter().zip(&former.steps);
        let has_stages = self.request.scene.has_stages();
        let summaries = summaries.map(|(step, measures)| {
            let summary = StepSummary::of(step, measures.clone());
            if has_stages {
                summary.of_stages()
            } else {
                summary
            }
        });
        self.summary.steps = summaries.collect();
        let of_steps = former.flows.into_iter().zip(former.step_fractures);
        for (step, former) in self.summary.steps.iter_mut().zip(of_steps) {
            (step.flow, step.fractures) = former;
        }
        self.summary.fractures = former.fractures;
        self.history = History::from_text(former.history);
        self.probes.text = former.probes;
        self.summary.measures = former.measures;
        self.summary.stress_error = former.stress_error;
        self.finished = former.steps;
        let mut newton = self.set_up(system, plan)?;
        let system = &*system;
        let restart = former.restart.filter(|restart| restart.fits(system));
        let Some(restart) = restart else {
            let path = self.output.path(checkpoint::NAME);
            return Err(checkpoint::other_build(&path).into());
        };
        let state = self.stage(Stage::RestoreSolver, |_| newton.restore(system, restart));
        let text = format!("after step {} of {}", self.finished.len(), steps.len());
        self.observer.note("resumed", &text);
        Ok(Prepared {
            state: solved(state, system)?,
            newton,
            system,
            flow: None,
            fluid: None,
            estimator: None,
            stage: None,
        })
    }

    /// Solves a load step.
    fn solve_step(
        &mut self,
        prepared: &mut Prepared<'_, '_>,
        index: usize,
    ) -> Result<StepMeasures, Interruption> {
        let system = prepared.system;
        let schedule = &system.problem().schedule;
        let step = &schedule.steps[index];
        self.observer.step_begins(StepStart {
            number: index + 1,
            count: schedule.steps.len(),
            what: &decisions::of_step(schedule, step),
        });
        let record = self.stage(Stage::Solve, |run| {
            let Prepared { newton, state, .. } = prepared;
            newton.solve_step(system, state, &step.load, |number, iteration| {
                run.ask_after(number, iteration)
            })
        });
        self.summary.seconds.factorise += record.factorise_seconds;
        self.summary.seconds.solve += record.solve_seconds;
        if record.fell_back {
            let text = decisions::of_fallback(index + 1);
            self.observer.note("decided", &text);
            self.summary.decisions.push(text);
        }
        let unresolved = unresolved::of_step(system, &record);
        let measures = StepMeasures::of(&record, unresolved);
        let summary = StepSummary {
            completed: record.completed,
            ..StepSummary::of(step, measures.clone())
        };
        let summary = match self.request.scene.has_stages() {
            true => summary.of_stages(),
            false => summary,
        };
        self.summary.steps.push(summary);
        if record.outcome == StepOutcome::Stopped {
            return Err(Interruption::Stopped);
        }
        if !record.converged() {
            let why = failures::not_converged(system, (index + 1, step), &record);
            return Err(Interruption::NotConverged(why));
        }
        Ok(measures)
    }

    /// Estimates the error of a load step, sums it up and writes its results.
    fn take_results(&mut self, prepared: &mut Prepared<'_, '_>) -> Result<(), Interruption> {
        let system = prepared.system;
        let is_last = self.finished.len() == system.problem().schedule.steps.len();
        let solution = solution(system, &prepared.state);
        let Prepared {
            newton, estimator, ..
        } = prepared;
        let accuracy = self.stage(Stage::Estimate, |_| {
            let estimator = estimator.get_or_insert_with(|| Estimator::of(system));
            accuracy::of(system, newton, estimator, &solution, is_last)
        });
        if !self.has_more_to_solve(system.problem().schedule.steps.len()) {
            // Nothing is solved any more, and to write takes memory too.
            newton.release();
            *estimator = None;
        }
        let interface = system.discretisation().interface();
        let nodes = solution.facet_nodes(system.problem(), interface);
        let mut fractures = fractures(system.problem(), interface, &solution, &nodes);
        accuracy.note_in(&mut fractures);
        let facets = determinacy(system, &prepared.state);
        if let Some(facets) = &facets {
            undetermined::note_in(&mut fractures, system, facets);
        }
        if let Some(step) = self.summary.steps.last_mut() {
            step.fractures = StepFracture::all(&fractures);
        }
        self.summary.fractures = fractures;
        self.summary.stress_error = accuracy.relative;
        // Closed forms speak of the end of the loads.
        let oracles = if is_last { &self.oracles[..] } else { &[] };
        self.summary.measures = measures(system, &solution, &self.summary.fractures, oracles);
        self.summary.measures.push(energy(accuracy.energy));
        let flow = self.take_flow(system, (&prepared.state, &nodes), prepared.flow)?;
        self.permeability_after_step(system.problem(), prepared.fluid, &nodes)?;
        let scene = self.request.scene;
        let (problem, fractures) = (system.problem(), &self.summary.fractures);
        let of_result = doubts::of_result(scene, problem, &solution, &nodes, fractures);
        let unclear = undetermined::warnings(scene, fractures);
        let unresolved = [unresolved::warning, unresolved::warning_of_time]
            .into_iter()
            .filter_map(|warning| warning(scene, &self.finished));
        self.summary.warnings = [self.doubts.clone(), of_result, unclear].concat();
        self.summary.warnings.extend(unresolved);
        let written = Written {
            solution: &solution,
            nodes: &nodes,
            accuracy: &accuracy,
            facets: facets.as_deref(),
            flow: flow.as_ref(),
        };
        self.write_grids(prepared, &written)?;
        self.write_sources()?;
        self.probe(prepared, (&solution, &nodes), flow.as_ref())?;
        self.write_history(prepared, &solution)
    }

    /// Writes the grids of the load step that was solved last.
    fn write_grids(
        &mut self,
        prepared: &Prepared<'_, '_>,
        written: &Written<'_>,
    ) -> Result<(), Interruption> {
        let system = prepared.system;
        let problem = system.problem();
        let &Written {
            solution,
            nodes,
            accuracy,
            facets,
            flow,
        } = written;
        let time = prepared.state.load.time;
        let ranks = self.request.ranks.filter(|ranks| ranks.count() > 1);
        self.stage(Stage::Write, |run| {
            let rock = || in_plane(&problem.mesh, rock_grid(system, solution, Some(accuracy)));
            let fractures = || {
                let mut grid = fracture_grid(system, nodes, Some(accuracy));
                grid.cell_fields.extend(facets.map(undetermined::field));
                if let Some(flow) = flow {
                    fluid_step::add_to(&mut grid, flow, nodes);
                }
                in_plane(&problem.mesh, grid)
            };
            if let Some(ranks) = ranks {
                let piece = Piece::of(system, &(ranks.owner)(), ranks.rank());
                let grids = [&rock(), &fractures()];
                return run.output.write_pieces(time, grids, &piece, ranks);
            }
            let of_one = |defect| vec![defect];
            if !run.request.keep_results {
                let written = run.output.write_step(time, rock, fractures);
                return written.map_err(of_one);
            }
            let (rock, fractures) = rayon::join(rock, fractures);
            let written = run
                .output
                .write_step(time, || rock.clone(), || fractures.clone());
            run.keep(rock, fractures);
            written.map_err(of_one)
        })?;
        Ok(())
    }

    /// Adds the load step that was solved last to the values of probes.
    fn probe(
        &mut self,
        prepared: &Prepared<'_, '_>,
        (solution, nodes): (&Solution, &[FacetResult]),
        flow: Option<&SolvedFlow>,
    ) -> Result<(), Interruption> {
        let number = self.finished.len();
        let system = prepared.system;
        let solved = Solved {
            number,
            step: &system.problem().schedule.steps[number - 1],
            mesh: &system.problem().mesh,
            rock: Some(SolvedRock {
                system,
                solution,
                nodes,
            }),
            fluid: flow.map(|flow| SolvedFluid {
                fields: &flow.fields,
                apertures: &[],
            }),
        };
        self.write_probes(&solved)
    }

    /// Adds a load step to the values of probes, if there are any.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub(crate) fn write_probes(&mut self, solved: &Solved<'_>) -> Result<(), Interruption> {
        if self.probes.all.is_empty() || !self.output.is_kept() {
            return Ok(());
        }
        self.probes.add(solved);
        let text = &self.probes.text;
        let write = |path: &Path| write_atomically(path, |out| out.write_all(text.as_bytes()));
        Ok(self.output.write(probes::NAME, write)?)
    }

    /// Adds the load step that was solved last to the history.
    fn write_history(
        &mut self,
        prepared: &Prepared<'_, '_>,
        solution: &Solution,
    ) -> Result<(), Interruption> {
        if !self.output.is_kept() && !self.request.keep_results {
            return Ok(());
        }
        let system = prepared.system;
        let number = self.finished.len();
        let last = self.finished.last();
        let parts = Parts::of(system, &prepared.state, solution);
        self.history.add(&Entry {
            number,
            step: &system.problem().schedule.steps[number - 1],
            newton_iterations: last.map_or(0, |last| last.newton_iterations),
            fractures: &self.summary.fractures,
            parts,
            flow: of_flow(&self.summary),
        });
        if !self.output.is_kept() {
            return Ok(());
        }
        let text = self.history.text();
        let write = |path: &Path| write_atomically(path, |out| out.write_all(text.as_bytes()));
        Ok(self.output.write(history::NAME, write)?)
    }

    /// Keeps the results of the load step that was solved last.
    pub fn keep(&mut self, rock: Grid, fracture_grid: Grid) {
        let Some(summary) = self.summary.steps.last() else {
            return;
        };
        let result = StepResult {
            summary: summary.clone(),
            fractures: self.summary.fractures.clone(),
            rock,
            fracture_grid,
        };
        self.observer.step_ends(&result);
        self.kept.push(result);
    }
}

/// The flow after the load step that was solved last, if there is one.
fn of_flow(summary: &Summary) -> Option<FlowEntry<'_>> {
    Some(FlowEntry {
        flow: summary.steps.last()?.flow.as_ref()?,
        conduits: &summary.flow.as_ref()?.fractures,
    })
}
