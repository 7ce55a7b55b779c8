//! The stages of a run, and what it leaves behind after each load step.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use kluft_io::load_msh;
use kluft_mesh::{Defect, Draft};
use kluft_solver::{
    Discretisation, Estimator, LinearFailure, Newton, NewtonSettings, Plan, Problem, State,
    StepRecord, System, Workload, solution,
};

use crate::accuracy::{self, Accuracy};
use crate::checkpoint::{self, Identity, Progress};
use crate::decisions;
use crate::measures::{energy, measures};
use crate::memory;
use crate::output::Output;
use crate::prepare::{self, MeshFile};
use crate::report::{Failure, Report};
use crate::resume::Former;
use crate::summary::{self, StepMeasures, StepSummary, Summary};
use kluft_scene::Oracle;
use kluft_scene::{Binding, MeshSource, Scene, SolverEntry};

/// A run under way.
pub struct Run<'a> {
    /// What is asked for.
    pub scene: &'a Scene,
    /// Where results go.
    pub output: Output,
    /// What the user is told.
    pub report: Report,
    /// What `summary.json` will hold.
    pub summary: Summary,
    /// What checkpoints belong to.
    pub identity: Identity,
    /// When it would have begun, had a former run not been interrupted.
    pub start: Instant,
    /// The finished load steps.
    finished: Vec<StepMeasures>,
    /// Name of the linear solver, and why it was chosen.
    choice: (String, String),
    /// Closed form of each fracture that has one.
    oracles: Vec<Option<Oracle>>,
    /// What the next mesh is made by.
    meshing: Remeshing,
}

/// How a scene that adapts its mesh gets the next one.
enum Remeshing {
    /// As the geometry says.
    Given,
    /// With these sizes.
    Sized(PathBuf),
    /// Not at all: the last one stays.
    Kept,
}

impl<'a> Run<'a> {
    /// A run of a scene, or of what is left of it.
    pub fn new(
        scene: &'a Scene,
        output: Output,
        report: Report,
        identity: Identity,
        former: Option<&Former>,
    ) -> Self {
        let mut summary = Summary {
            kluft: env!("CARGO_PKG_VERSION"),
            title: scene.title.clone(),
            threads: rayon::current_num_threads(),
            ..Summary::default()
        };
        let mut start = Instant::now();
        if let Some(former) = former {
            summary.seconds = former.progress.seconds.clone();
            summary.peak_memory_bytes = former.progress.peak_memory_bytes;
            let before = Duration::try_from_secs_f64(summary.seconds.total).unwrap_or_default();
            start = start.checked_sub(before).unwrap_or(start);
        }
        Self {
            scene,
            output,
            report,
            summary,
            identity,
            start,
            finished: Vec::new(),
            choice: Default::default(),
            oracles: Vec::new(),
            meshing: Remeshing::Given,
        }
    }

    /// From the scene to a checked problem.
    ///
    /// # Errors
    /// Defects of geometry, mesh and scene, and a mesh that is not the one of the former run.
    pub fn prepare(&mut self, former: Option<&Former>) -> Result<Problem, Failure> {
        let file = self.mesh_file(former)?;
        let (problem, took) = self.report.stage("reading", |_| {
            let draft = load_msh(&file.path, &self.output.path(""))?;
            self.identity.mesh = one(checkpoint::fingerprint_of(&file.path))?;
            if former.is_some_and(|former| former.mesh != self.identity.mesh) {
                let is_made = file.meshing.is_some();
                return Err(vec![checkpoint::other_mesh(&file.path, is_made)]);
            }
            build_problem(self.scene, draft, &mut self.summary)
        });
        self.summary.seconds.read += took.as_secs_f64();
        let binding = problem?;
        self.oracles = binding.oracles;
        let mesh = &self.summary.mesh;
        let size = format!(
            "{} nodes, {} cells, {} fracture facets, at most {} sectors at a node",
            mesh.nodes, mesh.cells, mesh.fracture_facets, mesh.max_sectors
        );
        self.report.entry("read", &timed(&size, took));
        Ok(binding.problem)
    }

    /// The mesh file; gmsh makes it if it has to.
    fn mesh_file(&mut self, former: Option<&Former>) -> Result<MeshFile, Vec<Defect>> {
        let is_kept = matches!(self.meshing, Remeshing::Kept);
        let file = match is_kept || former.is_some_and(|former| former.mesh_is_kept) {
            true => MeshFile {
                path: self.output.path("mesh.msh"),
                meshing: None,
            },
            false => {
                let sizes = match &self.meshing {
                    Remeshing::Sized(path) => Some(path.as_path()),
                    _ => None,
                };
                prepare::mesh_file(self.scene, &self.output, sizes, &mut self.report)?
            }
        };
        if let (Some(took), MeshSource::Geometry { geometry, .. }) =
            (file.meshing, &self.scene.mesh)
        {
            self.summary.seconds.mesh += took.as_secs_f64();
            let geometry = geometry.display().to_string();
            self.report.entry("meshed", &timed(&geometry, took));
        }
        Ok(file)
    }

    /// Keeps the mesh for what follows.
    pub fn keep_mesh(&mut self) {
        self.meshing = Remeshing::Kept;
    }

    /// Makes the next mesh with the sizes of a file.
    pub fn mesh_again_with(&mut self, sizes: PathBuf) {
        self.meshing = Remeshing::Sized(sizes);
        self.summary.decisions.clear();
    }

    /// Solves all load steps without writing anything: the number of unknowns and the estimated error at
    /// the end.
    ///
    /// # Errors
    /// As [`Self::solve`].
    pub fn trial(&mut self, problem: &Problem) -> Result<(usize, Accuracy), Failure> {
        let system = self.assemble(problem)?;
        let plan = self.plan(&system, None)?;
        let mut newton = self.set_up(&system, plan)?;
        let mut state = system.initial_state();
        for index in 0..problem.schedule.steps.len() {
            let record = self.solve_step(&system, &mut newton, &mut state, index);
            if !record.converged() {
                let why = decisions::not_converged(problem, &system, index + 1, &record);
                return Err(Failure::NotConverged(why));
            }
        }
        self.summary.steps.clear();
        let solution = solution(&system, &state);
        let unknowns = system.discretisation.unknown_count();
        let estimator = Estimator::of(&system);
        let accuracy = accuracy::of(&system, &mut newton, &estimator, &solution, true);
        Ok((unknowns, accuracy))
    }

    /// From the problem to the written results of all load steps that are left.
    ///
    /// # Errors
    /// A load step that does not converge, a system that does not fit in memory, and files that
    /// cannot be written.
    pub fn solve(&mut self, problem: &Problem, former: Option<Former>) -> Result<(), Failure> {
        let system = self.assemble(problem)?;
        let plan = self.plan(&system, former.as_ref())?;
        self.summary.decisions.push(self.choice.1.clone());
        self.summary.decisions.extend(decisions::of_problem(
            problem,
            &newton_settings(&self.scene.solver),
        ));
        for decision in &self.summary.decisions {
            self.report.entry("decided", decision);
        }
        let (mut newton, mut state) = match former {
            None => self.begin(&system, plan)?,
            Some(former) => self.go_on(&system, plan, former.progress)?,
        };
        // Made with the first results, so that it takes no memory from the first solve.
        let mut estimator = None;
        for index in self.finished.len()..problem.schedule.steps.len() {
            let record = self.solve_step(&system, &mut newton, &mut state, index);
            if !record.converged() {
                let why = decisions::not_converged(problem, &system, index + 1, &record);
                return Err(Failure::NotConverged(why));
            }
            self.finished.push((&record).into());
            self.write_step(&system, &mut newton, &mut estimator, &state)?;
            one(self.write_summary())?;
            self.write_checkpoint(problem, &newton, &state)?;
        }
        Ok(())
    }

    /// Enriches the problem and assembles what stays the same for the whole run.
    fn assemble<'p>(&mut self, problem: &'p Problem) -> Result<System<'p>, Failure> {
        let (discretisation, took) = self
            .report
            .stage("enriching", |_| Discretisation::of(problem));
        let discretisation = discretisation?;
        self.summary.seconds.enrich += took.as_secs_f64();
        self.summary.unknowns = summary::UnknownSummary {
            total: discretisation.unknown_count(),
            jump: 3 * discretisation.points.jump_count(),
        };
        let unknowns = &self.summary.unknowns;
        let text = format!(
            "{} unknowns, {} of them jumps",
            unknowns.total, unknowns.jump
        );
        self.report.entry("enriched", &timed(&text, took));
        let (system, took) = self
            .report
            .stage("assembling", |_| System::assemble(problem, discretisation));
        self.summary.seconds.assemble += took.as_secs_f64();
        let text = timed("rock and loads, once for the run", took);
        self.report.entry("assembled", &text);
        Ok(system)
    }

    /// Chooses the linear solver, the former run's if there was one, and refuses what would not fit in
    /// memory.
    fn plan(&mut self, system: &System<'_>, former: Option<&Former>) -> Result<Plan, Failure> {
        let asked = self.scene.solver;
        let available = memory::available_bytes().unwrap_or(usize::MAX);
        let limit = asked.memory_limit.map_or(available, |limit| limit as usize);
        let before = former.and_then(|former| former.progress.choice.0.parse().ok());
        let (plan, took) = self.report.stage("choosing a solver", |_| {
            let workload = Workload::of(system.problem);
            let unknowns = (&system.discretisation).into();
            Plan::of(unknowns, workload, before.or(asked.linear), limit)
        });
        self.summary.seconds.factorise += took.as_secs_f64();
        let plan = solved(plan, system)?;
        let prediction = plan.prediction();
        self.summary.predicted_memory_bytes =
            (memory::used_bytes() + prediction.memory_bytes) as u64;
        if prediction.memory_bytes > limit {
            return Err(vec![decisions::too_large(&plan, &asked, limit)].into());
        }
        self.choice = match former {
            Some(former) => former.progress.choice.clone(),
            None => (plan.method.to_string(), decisions::of_plan(&plan, &asked)),
        };
        Ok(plan)
    }

    /// Prepares for the first load step.
    fn begin(&mut self, system: &System<'_>, plan: Plan) -> Result<(Newton, State), Failure> {
        one(self.output.remove_former())?;
        one(self.write_summary())?;
        let newton = self.set_up(system, plan)?;
        Ok((newton, system.initial_state()))
    }

    /// Prepares for the load step after the last one that a former run finished.
    fn go_on(
        &mut self,
        system: &System<'_>,
        plan: Plan,
        former: Progress<'static>,
    ) -> Result<(Newton, State), Failure> {
        let steps = &system.problem.schedule.steps;
        let done = &steps[..former.steps.len().min(steps.len())];
        let times = done.iter().map(|step| step.load.time);
        self.output.go_on_after(times);
        let summaries = done.iter().zip(&former.steps);
        let summaries = summaries.map(|(step, measures)| StepSummary::of(step, measures.clone()));
        self.summary.steps = summaries.collect();
        self.summary.fractures = former.fractures;
        self.summary.measures = former.measures;
        self.summary.stress_error = former.stress_error;
        self.finished = former.steps;
        let mut newton = self.set_up(system, plan)?;
        let bookmark = former.bookmark.filter(|bookmark| bookmark.fits(system));
        let Some(bookmark) = bookmark else {
            let path = self.output.path(checkpoint::NAME);
            return Err(vec![checkpoint::other_build(&path)].into());
        };
        let (state, took) = self
            .report
            .stage("factorising", |_| newton.turn_to(system, bookmark));
        self.summary.seconds.factorise += took.as_secs_f64();
        let text = format!("after step {} of {}", self.finished.len(), steps.len());
        self.report.entry("resumed", &text);
        Ok((newton, solved(state, system)?))
    }

    /// Prepares what the linear solver needs once a run.
    fn set_up(&mut self, system: &System<'_>, plan: Plan) -> Result<Newton, Failure> {
        let name = plan.method.name();
        let settings = newton_settings(&self.scene.solver);
        let (newton, took) = self.report.stage("preparing the solver", |_| {
            Newton::planned(system, settings, plan)
        });
        self.summary.seconds.factorise += took.as_secs_f64();
        let text = timed(&format!("{name} solver, once for the run"), took);
        self.report.entry("prepared", &text);
        solved(newton, system)
    }

    fn solve_step(
        &mut self,
        system: &System<'_>,
        newton: &mut Newton,
        state: &mut State,
        index: usize,
    ) -> StepRecord {
        let schedule = &system.problem.schedule;
        let step = &schedule.steps[index];
        let what = decisions::of_step(schedule, step);
        self.report.step(index + 1, schedule.steps.len(), &what);
        let (record, _) = self.report.stage("factorising and solving", |report| {
            newton.step(system, state, &step.load, |number, iteration| {
                report.iteration(number, iteration);
            })
        });
        self.summary.seconds.factorise += record.factorise_seconds;
        self.summary.seconds.solve += record.solve_seconds;
        let summary = StepSummary::of(step, (&record).into());
        self.summary.steps.push(summary);
        record
    }

    /// Estimates the error of a step and writes its results.
    fn write_step(
        &mut self,
        system: &System<'_>,
        newton: &mut Newton,
        estimator: &mut Option<Estimator>,
        state: &State,
    ) -> Result<(), Failure> {
        let is_last = self.finished.len() == system.problem.schedule.steps.len();
        let solution = solution(system, state);
        let (accuracy, took) = self.report.stage("estimating the error", |_| {
            let estimator = estimator.get_or_insert_with(|| Estimator::of(system));
            accuracy::of(system, newton, estimator, &solution, is_last)
        });
        self.summary.seconds.estimate += took.as_secs_f64();
        let (written, took) = self.report.stage("writing", |_| {
            self.output
                .write_step(system, &solution, &accuracy, state.load.time)
        });
        self.summary.seconds.write += took.as_secs_f64();
        let interface = &system.discretisation.interface;
        self.summary.fractures = summary::fractures(system.problem, interface, &solution);
        self.summary.stress_error = accuracy.relative;
        accuracy.note_in(&mut self.summary.fractures);
        // Closed forms speak of the end of the loads.
        let oracles = if is_last { &self.oracles[..] } else { &[] };
        self.summary.measures = measures(system, &solution, &self.summary.fractures, oracles);
        self.summary.measures.push(energy(accuracy.energy));
        self.summary.warnings = decisions::warnings(&self.summary.fractures);
        Ok(one(written)?)
    }

    /// Writes the summary of what is finished so far.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write_summary(&mut self) -> Result<(), Defect> {
        self.summary.seconds.total = self.start.elapsed().as_secs_f64();
        let peak = memory::peak_bytes() as u64;
        self.summary.peak_memory_bytes = self.summary.peak_memory_bytes.max(peak);
        self.summary.write(&self.output.path("summary.json"))
    }

    /// Lets the run be resumed from here.
    fn write_checkpoint(
        &mut self,
        problem: &Problem,
        newton: &Newton,
        state: &State,
    ) -> Result<(), Failure> {
        let start = Instant::now();
        let is_left = self.finished.len() < problem.schedule.steps.len();
        let progress = Progress {
            choice: self.choice.clone(),
            steps: self.finished.clone(),
            fractures: self.summary.fractures.clone(),
            measures: self.summary.measures.clone(),
            stress_error: self.summary.stress_error,
            seconds: self.summary.seconds.clone(),
            peak_memory_bytes: self.summary.peak_memory_bytes,
            bookmark: is_left.then(|| newton.bookmark(state)),
        };
        let path = self.output.path(checkpoint::NAME);
        let written = checkpoint::write(&path, &self.identity, &progress);
        self.summary.seconds.write += start.elapsed().as_secs_f64();
        Ok(one(written)?)
    }
}

fn build_problem(
    scene: &Scene,
    draft: Draft,
    summary: &mut Summary,
) -> Result<Binding, Vec<Defect>> {
    let mut binding = scene.problem(draft)?;
    summary.decisions.append(&mut binding.decisions);
    let mesh = &binding.problem.mesh;
    let counts = mesh.sectors.count.iter();
    summary.mesh = summary::MeshSummary {
        nodes: counts.clone().filter(|&&count| count > 0).count(),
        cells: mesh.cells.len(),
        fracture_facets: mesh.facets.elements.len(),
        max_sectors: counts.copied().max().unwrap_or(0),
    };
    Ok(binding)
}

/// A single defect as a failure.
pub fn one<T>(result: Result<T, Defect>) -> Result<T, Vec<Defect>> {
    result.map_err(|defect| vec![defect])
}

/// The failure of a linear solver in words.
fn solved<T>(result: Result<T, LinearFailure>, system: &System<'_>) -> Result<T, Failure> {
    result.map_err(|failure| {
        Failure::NotConverged(decisions::linear_failure(system.problem, system, &failure))
    })
}

fn timed(text: &str, took: Duration) -> String {
    format!("{text} ({:.2} s)", took.as_secs_f64())
}

fn newton_settings(asked: &SolverEntry) -> NewtonSettings {
    let settings = NewtonSettings::default();
    NewtonSettings {
        path: asked.path_accuracy.unwrap_or(settings.path),
        ..settings
    }
}
