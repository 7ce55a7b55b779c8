//! `kluft-mpi run`: a scene, solved by all ranks together, followed by the terminal of the first.

use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use kluft_mesh::Defect;
use kluft_program::failure::Failure;
use kluft_program::input::{expect_scene, scene_at};
use kluft_program::invocation::OwnProgram;
use kluft_program::report::{Report, Verbosity};
use kluft_run::{
    Caller, Ending, MeshInput, Observer, Origin, Outcome, Ranks, Request, folder_for, memory,
};
use kluft_scene::{MeshSource, Scene};
use kluft_solver::{LinearFailure, LinearMethod, System, TangentSolver};

use crate::answers::machine;
use crate::args::RunArgs;
use crate::communicator::communicator;
use crate::distributed::Distributed;
use crate::memory::solver_bytes;
use crate::partition::Partition;
use crate::petsc::World;
use crate::traffic;

/// Runs a scene.
///
/// # Errors
/// As `kluft run`; defects that another rank names are left out.
pub fn run(world: &Arc<World>, args: &RunArgs) -> Result<(), Failure> {
    let file = &scene_at(&args.scene)?;
    expect_scene(file)?;
    let text = Scene::text(file)?;
    let scene = Scene::parse_file(file, &text)?;
    refuse_what_is_serial(&scene, file)?;
    let folder = folder_for(file, args.out.as_deref());
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(usize::from(args.threads))
        .use_current_thread()
        .build()
        .map_err(|error| {
            let remedy = "ask for fewer threads of each rank, e.g. --threads 1";
            Failure::Machine(vec![Defect::new("threads", error.to_string(), remedy)])
        })?;
    let partition = Mutex::new(None);
    let on_machine = world.on_machine().map_err(machine)?;
    let communicator = communicator(world);
    let ranks = Ranks {
        communicator: &communicator,
        on_machine,
        solver: &|system| solver(world, system, &partition),
        owner: &|| present(&partition).map_or(Vec::new(), |present| present.owner.clone()),
        solver_bytes: &solver_bytes,
    };
    let request = Request {
        scene: &scene,
        mesh: MeshInput::OfScene,
        pool: &pool,
        folder: Some(&folder),
        origin: Some(Origin { file, text: &text }),
        resume: args.resume,
        keep_results: false,
        report: !args.no_report,
        caller: Caller::default(),
        gmsh: args.gmsh.options(OwnProgram::of_process().as_ref()),
        ranks: Some(ranks),
    };
    let mut report = Report::new(verbosity(args));
    let mut silent = ();
    let observer: &mut dyn Observer = match world.rank() {
        0 => &mut report,
        _ => &mut silent,
    };
    let outcome = kluft_run::run(request, observer)?;
    let told = traffic::told(world, present(&partition).as_deref()).map_err(machine)?;
    if world.rank() == 0 && outcome.ending != Ending::NothingLeft {
        closing_lines(&report, &outcome, &folder);
        if args.verbose {
            told.iter().for_each(|line| report.entry("ranks", line));
        }
    }
    match outcome.ending {
        Ending::Solved | Ending::NothingLeft => Ok(()),
        Ending::NotConverged(why) => Err(Failure::NotConverged(why)),
        Ending::Stopped => Err(Failure::NotConverged("the run was stopped".into())),
    }
}

fn verbosity(args: &RunArgs) -> Verbosity {
    match (args.quiet, args.verbose) {
        (true, _) => Verbosity::Quiet,
        (_, true) => Verbosity::Verbose,
        _ => Verbosity::Terminal,
    }
}

fn solver(
    world: &Arc<World>,
    system: &mut System<'_>,
    partition: &Mutex<Option<Arc<Partition>>>,
) -> Result<Box<dyn TangentSolver>, LinearFailure> {
    let solver = Distributed::new(world, system)?;
    let mut present = partition.lock().unwrap_or_else(PoisonError::into_inner);
    *present = Some(Arc::clone(solver.partition()));
    Ok(Box::new(solver))
}

/// Who owns which rows of the system that was prepared last.
fn present(partition: &Mutex<Option<Arc<Partition>>>) -> Option<Arc<Partition>> {
    let present = partition.lock().unwrap_or_else(PoisonError::into_inner);
    present.clone()
}

/// What only one process can do, by the name that the scene gives it.
fn refuse_what_is_serial(scene: &Scene, file: &Path) -> Result<(), Failure> {
    let place = file.display().to_string();
    let mut defects = Vec::new();
    if let MeshSource::Geometry { adapt: Some(_), .. } = &scene.mesh {
        let problem = "`adapt` searches for a mesh on one machine only";
        let remedy = "let `kluft run` find the mesh, then name it: [mesh] file = \"out/mesh.msh\"";
        defects.push(Defect::new(&place, problem, remedy));
    }
    let linear = scene.solver.linear;
    if let Some(method @ (LinearMethod::Direct | LinearMethod::Condensed)) = linear {
        let problem = format!("the {method} solver is not divided among ranks");
        let remedy = "take `linear` out of [solver], or run the scene with `kluft run`";
        defects.push(Defect::new(&place, problem, remedy));
    }
    if scene.is_rigid() {
        let problem = "flow in rigid rock is solved on one machine only";
        let remedy = "run the scene with `kluft run`";
        defects.push(Defect::new(&place, problem, remedy));
    }
    if scene.has_stages() {
        let problem = "volumes are removed and added on one machine only";
        let remedy = "run the scene with `kluft run`";
        defects.push(Defect::new(&place, problem, remedy));
    }
    if scene.strength_reduction.is_some() {
        let problem = "the strength is reduced on one machine only";
        let remedy = "run the scene with `kluft run`";
        defects.push(Defect::new(&place, problem, remedy));
    }
    match defects.is_empty() {
        true => Ok(()),
        false => Err(Failure::BadInput(defects)),
    }
}

fn closing_lines(report: &Report, outcome: &Outcome, folder: &Path) {
    let summary = &outcome.summary;
    report.fractures(&summary.fractures);
    report.comparisons(&summary.measures);
    for warning in &summary.warnings {
        report.entry("warning", warning);
    }
    let ranks = summary.ranks.clone().unwrap_or_default();
    let text = format!(
        "{:.2} s, {} with at most {} each, {} together",
        summary.seconds.total,
        match ranks.count {
            1 => "1 rank".to_owned(),
            count => format!("{count} ranks"),
        },
        memory::in_words(ranks.largest_peak_memory_bytes as usize),
        memory::in_words(ranks.sum_of_peak_memory_bytes as usize)
    );
    report.entry("took", &text);
    let [rock, fractures] = ["rock.pvd", "fractures.pvd"].map(|name| folder.join(name));
    if rock.exists() {
        let text = format!("{} and {}", rock.display(), fractures.display());
        report.entry("open", &text);
    }
}
