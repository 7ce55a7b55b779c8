//! A run of Kluft, told as a story: read the scene, mesh, enrich, assemble, solve, write.

pub mod chart;
mod decisions;
mod inspect;
mod memory;
mod network;
mod output;
mod prepare;
mod reader;
mod report;
mod scene;
mod summary;

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use lie_io::load_msh;
use lie_mesh::{Draft, Faces, Mesh};
use lie_solver::{
    Discretisation, Load, Newton, NewtonSettings, Plan, Problem, State, StepRecord, System,
    Workload, solution,
};

pub use inspect::{InspectOptions, inspect};
pub use lie_network::{Domain, Grouping};
pub use network::{NetworkOptions, make_network};
pub use report::{Failure, Verbosity, print_failure};
pub use scene::{
    Binding, BodyEntry, BoundaryEntry, FixedPointEntry, FractureEntry, History, MeshSource, Named,
    Scene, SolverEntry, StepEnd, Timetable, bind, surface_roles,
};
pub use summary::{FractureSummary, Spread, StepSummary, Summary};

use output::Output;
use report::Report;

/// How to run a scene.
#[derive(Debug, Clone)]
pub struct Options {
    /// Folder for the results; `out` beside the scene if not given.
    pub out: Option<PathBuf>,
    /// Number of threads; all cores if not given.
    pub threads: Option<usize>,
    /// How much to tell.
    pub verbosity: Verbosity,
}

/// Runs a scene.
///
/// # Errors
/// [`Failure::BadInput`] with every defect found, or [`Failure::NotConverged`] with where and why;
/// the results of converged steps and `summary.json` are kept then.
pub fn run(scene_file: &Path, options: &Options) -> Result<(), Failure> {
    let start = Instant::now();
    let threads = options.threads.unwrap_or(0);
    // Fails only if a pool exists already, as in a program that runs many scenes.
    let _ = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build_global();
    let mut report = Report::new(options.verbosity);
    let scene = Scene::read(scene_file)?;
    let folder = prepare::folder_for(scene_file, options.out.as_deref());
    let mut output = Output::prepare(&folder).map_err(|defect| vec![defect])?;
    let mut summary = Summary {
        kluft: env!("CARGO_PKG_VERSION"),
        title: scene.title.clone(),
        threads: rayon::current_num_threads(),
        ..Summary::default()
    };
    report.entry("kluft", &format!("{}  {}", summary.kluft, scene.title));
    let problem = prepare(&scene, &output, &mut report, &mut summary)?;
    let result = solve(
        &problem,
        &scene.solver,
        &mut output,
        &mut report,
        &mut summary,
    );
    summary.seconds.total = start.elapsed().as_secs_f64();
    summary.peak_memory_bytes = memory::peak_bytes() as u64;
    if !matches!(result, Err(Failure::BadInput(_))) {
        let path = output.path("summary.json");
        summary.write(&path).map_err(|defect| vec![defect])?;
        closing_lines(&report, &summary, &output);
    }
    result
}

/// From the scene to a checked problem.
fn prepare(
    scene: &Scene,
    output: &Output,
    report: &mut Report,
    summary: &mut Summary,
) -> Result<Problem, Failure> {
    let file = prepare::mesh_file(scene, output, report)?;
    if let (Some(took), MeshSource::Geometry { geometry, .. }) = (file.meshing, &scene.mesh) {
        summary.seconds.mesh = took.as_secs_f64();
        report.entry("meshed", &timed(&geometry.display().to_string(), took));
    }
    let (problem, took) = report.stage("reading", |_| {
        let scratch = output.path("");
        let draft = load_msh(&file.path, &scratch)?;
        build_problem(scene, draft, summary)
    });
    summary.seconds.read = took.as_secs_f64();
    let problem = problem?;
    let mesh = &summary.mesh;
    let size = format!(
        "{} nodes, {} cells, {} fracture facets, at most {} sectors at a node",
        mesh.nodes, mesh.cells, mesh.fracture_facets, mesh.max_sectors
    );
    report.entry("read", &timed(&size, took));
    Ok(problem)
}

fn build_problem(
    scene: &Scene,
    draft: Draft,
    summary: &mut Summary,
) -> Result<Problem, Vec<lie_mesh::Defect>> {
    let faces = Faces::of(&draft);
    let roles = prepare::roles(scene, &draft, &faces.inner_surfaces(&draft))?;
    summary.decisions.extend(roles.decisions);
    let binding = bind(scene, Mesh::build_on(draft, faces, &roles.of_group)?)?;
    summary.decisions.extend(binding.decisions);
    let mesh = &binding.problem.mesh;
    summary.mesh = summary::MeshSummary {
        nodes: mesh
            .sectors
            .count
            .iter()
            .filter(|&&count| count > 0)
            .count(),
        cells: mesh.cells.len(),
        fracture_facets: mesh.facets.elements.len(),
        max_sectors: mesh.sectors.count.iter().copied().max().unwrap_or(0),
    };
    Ok(binding.problem)
}

/// From the problem to the written results of all load steps.
fn solve(
    problem: &Problem,
    solver: &SolverEntry,
    output: &mut Output,
    report: &mut Report,
    summary: &mut Summary,
) -> Result<(), Failure> {
    let system = assemble(problem, report, summary)?;
    let plan = plan(&system, solver, report, summary)?;
    summary.decisions.push(decisions::of_plan(&plan, solver));
    summary.decisions.extend(decisions::of_problem(problem));
    for decision in &summary.decisions {
        report.entry("decided", decision);
    }
    output.remove_former().map_err(|defect| vec![defect])?;
    let mut newton = set_up(&system, plan, report, summary)?;
    let mut state = system.initial_state();
    let schedule = &problem.schedule;
    for (number, step) in schedule.steps.iter().enumerate() {
        let what = decisions::of_step(schedule, step);
        report.step(number + 1, schedule.steps.len(), &what);
        let record = solve_step(&system, &mut newton, &mut state, &step.load, report);
        summary.seconds.factorise += record.factorise_seconds;
        summary.seconds.solve += record.solve_seconds;
        summary.steps.push(StepSummary::of(step, &record));
        if !record.converged() {
            let why = decisions::not_converged(problem, &system, number + 1, &record);
            return Err(Failure::NotConverged(why));
        }
        write_step(&system, &state, output, report, summary)?;
    }
    summary.warnings = decisions::warnings(&summary.fractures);
    Ok(())
}

/// Chooses the linear solver, and refuses what would not fit in memory.
fn plan(
    system: &System<'_>,
    solver: &SolverEntry,
    report: &mut Report,
    summary: &mut Summary,
) -> Result<Plan, Failure> {
    let available = memory::available_bytes().unwrap_or(usize::MAX);
    let limit = solver
        .memory_limit
        .map_or(available, |limit| limit as usize);
    let (plan, took) = report.stage("choosing a solver", |_| {
        let workload = Workload::of(system.problem);
        Plan::of(
            (&system.discretisation).into(),
            workload,
            solver.linear,
            limit,
        )
    });
    summary.seconds.factorise = took.as_secs_f64();
    let plan = plan.map_err(|failure| {
        Failure::NotConverged(decisions::linear_failure(system.problem, system, &failure))
    })?;
    let prediction = plan.prediction();
    summary.predicted_memory_bytes = (memory::used_bytes() + prediction.memory_bytes) as u64;
    if prediction.memory_bytes > limit {
        return Err(vec![decisions::too_large(&plan, solver, limit)].into());
    }
    Ok(plan)
}

/// Prepares what the linear solver needs once a run.
fn set_up(
    system: &System<'_>,
    plan: Plan,
    report: &mut Report,
    summary: &mut Summary,
) -> Result<Newton, Failure> {
    let name = plan.method.name();
    let (newton, took) = report.stage("preparing the solver", |_| {
        Newton::planned(system, NewtonSettings::default(), plan)
    });
    summary.seconds.factorise += took.as_secs_f64();
    report.entry(
        "prepared",
        &timed(&format!("{name} solver, once for the run"), took),
    );
    newton.map_err(|failure| {
        Failure::NotConverged(decisions::linear_failure(system.problem, system, &failure))
    })
}

/// Enriches the problem and assembles what stays the same for the whole run.
fn assemble<'a>(
    problem: &'a Problem,
    report: &mut Report,
    summary: &mut Summary,
) -> Result<System<'a>, Failure> {
    let (discretisation, took) = report.stage("enriching", |_| Discretisation::of(problem));
    let discretisation = discretisation?;
    summary.seconds.enrich = took.as_secs_f64();
    summary.unknowns = summary::UnknownSummary {
        total: discretisation.unknown_count(),
        jump: 3 * discretisation.points.jump_count(),
    };
    let unknowns = &summary.unknowns;
    let text = format!(
        "{} unknowns, {} of them jumps",
        unknowns.total, unknowns.jump
    );
    report.entry("enriched", &timed(&text, took));
    let (system, took) = report.stage("assembling", |_| System::assemble(problem, discretisation));
    summary.seconds.assemble = took.as_secs_f64();
    report.entry(
        "assembled",
        &timed("rock and loads, once for the run", took),
    );
    Ok(system)
}

fn write_step(
    system: &System<'_>,
    state: &State,
    output: &mut Output,
    report: &mut Report,
    summary: &mut Summary,
) -> Result<(), Failure> {
    let (written, took) = report.stage("writing", |_| {
        let solution = solution(system, state);
        let interface = &system.discretisation.interface;
        summary.fractures = summary::fractures(system.problem, interface, &solution);
        output.write_step(system, &solution, state.load.time)
    });
    summary.seconds.write += took.as_secs_f64();
    Ok(written.map_err(|defect| vec![defect])?)
}

fn solve_step(
    system: &System<'_>,
    newton: &mut Newton,
    state: &mut State,
    load: &Load,
    report: &mut Report,
) -> StepRecord {
    let (record, _) = report.stage("factorising and solving", |report| {
        newton.step(system, state, load, |number, iteration| {
            report.iteration(number, iteration);
        })
    });
    record
}

fn timed(text: &str, took: Duration) -> String {
    format!("{text} ({:.2} s)", took.as_secs_f64())
}

fn closing_lines(report: &Report, summary: &Summary, output: &Output) {
    report.fractures(&summary.fractures);
    for warning in &summary.warnings {
        report.entry("warning", warning);
    }
    let megabytes = summary.peak_memory_bytes as f64 / 1e6;
    let text = format!(
        "{:.2} s, {megabytes:.0} MB at most, {} threads",
        summary.seconds.total, summary.threads
    );
    report.entry("took", &text);
    if !summary.steps.is_empty() {
        let rock = output.path("rock.pvd");
        let fractures = output.path("fractures.pvd");
        let text = format!("{} and {}", rock.display(), fractures.display());
        report.entry("open", &text);
    }
}
