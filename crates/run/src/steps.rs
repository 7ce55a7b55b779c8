//! The load steps of a run: each is solved, estimated, written, and can be resumed from.

use kluft_scene::Binding;
use kluft_solver::{Estimator, Flow, Newton, Plan, StageEnd, State, StepOutcome, System, solution};

use crate::accuracy::{self, Accuracy};
use crate::checkpoint::{self, Origins, Progress};
use crate::choice::Choice;
use crate::decisions;
use crate::doubts;
use crate::failures;
use crate::flow::RunFlow;
use crate::history::History;
use crate::observer::{Stage, StepStart};
use crate::resume::FormerRun;
use crate::stages::{Interruption, Run, newton_settings, solved};
use crate::summary::{StepMeasures, StepSummary};
use crate::unresolved;

/// A run that has a system and a solver.
pub(crate) struct Prepared<'s, 'p> {
    pub(crate) system: &'s System<'p>,
    pub(crate) flow: Option<&'s RunFlow<'p>>,
    /// What could flow, if there is a fluid.
    pub(crate) fluid: Option<&'p Flow>,
    pub(crate) newton: Newton,
    pub(crate) state: State,
    /// Made with the first results, so that it takes no memory from the first solve.
    pub(crate) estimator: Option<Estimator>,
    /// What its stage of the body began with, if it is not the first.
    pub(crate) stage: Option<&'s StageEnd>,
    /// The load step that it begins with, counted from 0.
    pub(crate) first: usize,
}

impl Run<'_> {
    /// Solves all load steps without writing anything: the number of unknowns and the estimated
    /// error at the end. Its load steps, and the solver that was chosen for them, are not those of
    /// the run.
    ///
    /// # Errors
    /// As [`Self::solve`].
    pub fn trial(&mut self, binding: &Binding) -> Result<(usize, Accuracy), Interruption> {
        let tried = self.solve_and_forget(binding);
        self.summary.steps.clear();
        self.iterations.clear();
        self.choice = Choice::default();
        tried
    }

    fn solve_and_forget(&mut self, binding: &Binding) -> Result<(usize, Accuracy), Interruption> {
        let problem = &binding.problem;
        let mut system = self.assemble(problem)?;
        self.let_flow(binding, &mut system)?;
        let plan = self.plan(&system, problem.schedule.steps.len(), None)?;
        let mut prepared = Prepared {
            newton: self.set_up(&mut system, plan)?,
            state: system.initial_state(),
            system: &system,
            flow: None,
            fluid: None,
            estimator: None,
            stage: None,
            first: 0,
        };
        for index in 0..problem.schedule.steps.len() {
            self.solve_step(&mut prepared, index)?;
        }
        let unknowns = system.discretisation().unknown_count();
        let duals = accuracy::duals(&system, &mut prepared.newton, &prepared.state);
        prepared.newton.release();
        let solution = solution(&system, &prepared.state);
        let estimator = Estimator::of(&system);
        let accuracy = accuracy::of(&system, &estimator, &solution, duals.as_ref());
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
        let steps = problem.schedule.steps.len();
        let plan = self.plan(&system, steps, former.as_ref())?;
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
        self.solve_until(&mut prepared, steps)?;
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
            self.choose_again(prepared, end)?;
            self.write_summary()?;
            self.write_checkpoint(prepared)?;
        }
        Ok(())
    }

    /// Takes over and tells what was decided for a problem.
    pub fn decide(&mut self, binding: &Binding) {
        let settings = newton_settings(&self.request.scene.solver);
        self.summary.decisions.push(self.choice.why.clone());
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
            first: 0,
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
        self.iterations = former.iterations;
        self.take_over_origins(former.origins);
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
            first: 0,
        })
    }

    /// Takes over where a former run's mesh came from, and what it decided.
    pub(crate) fn take_over_origins(&mut self, former: Origins) {
        self.summary.meshes = former.meshes;
        self.summary.decisions = former.decisions;
        let gmsh = &mut self.summary.provenance.gmsh;
        *gmsh = former.gmsh.or(gmsh.take());
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
}
