//! `kluft run`: a scene file, solved on threads of its own, followed by the terminal.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use kluft_io::GmshOptions;
use kluft_run::{
    Caller, Ending, MeshInput, Origin, Outcome, REPORT, Request, ThreadCount, folder_for, memory,
    pool, thread_count,
};
use kluft_scene::{Scene, counted};

use crate::failure::Failure;
use crate::input::{expect_scene, scene_at};
use crate::ranks;
use crate::report::{Report, Verbosity};

/// How to run a scene.
#[derive(Debug, Clone)]
pub struct RunOptions {
    /// Folder for the results; `out` beside the scene if not given.
    pub out: Option<PathBuf>,
    /// Number of threads; all cores if not given.
    pub threads: Option<usize>,
    /// Number of processes that share the work; this one alone if not given.
    pub ranks: Option<u16>,
    /// How much to tell.
    pub verbosity: Verbosity,
    /// Whether to go on after the last load step that an interrupted run of the scene finished.
    pub resume: bool,
    /// Whether to write `report.html`.
    pub report: bool,
    /// Whether to end when the standard input is closed.
    pub is_tied: bool,
    /// How the program was called, for those who read the results.
    pub command: String,
    /// How gmsh is started, and what a geometry may do.
    pub gmsh: GmshOptions,
    /// The same as arguments of a program.
    pub gmsh_arguments: Vec<String>,
}

/// Runs a scene.
///
/// # Errors
/// [`Failure::BadInput`] with every defect found, [`Failure::NotConverged`] with where and why, or
/// [`Failure::Machine`]; the results of converged steps and `summary.json` are kept then.
pub fn run(scene_file: &Path, options: &RunOptions) -> Result<(), Failure> {
    if options.is_tied {
        end_with_standard_input();
    }
    let scene_file = &scene_at(scene_file)?;
    expect_scene(scene_file)?;
    if let Some(ranks) = options.ranks {
        return ranks::run(ranks, &arguments(scene_file, options));
    }
    let text = Scene::text(scene_file)?;
    let scene = Scene::parse_file(scene_file, &text)?;
    let folder = folder_for(scene_file, options.out.as_deref());
    let mut report = Report::new(options.verbosity);
    let ThreadCount { count, word } = thread_count(options.threads);
    if let Some(word) = word {
        report.entry("warning", &word);
    }
    let pool = pool(count).map_err(|defect| Failure::Machine(vec![defect]))?;
    let request = Request {
        scene: &scene,
        mesh: MeshInput::OfScene,
        pool: &pool,
        folder: Some(&folder),
        origin: Some(Origin {
            file: scene_file,
            text: &text,
        }),
        resume: options.resume,
        keep_results: false,
        report: options.report,
        caller: Caller {
            command: Some(&options.command),
            commit: option_env!("KLUFT_COMMIT"),
        },
        gmsh: options.gmsh.clone(),
        ranks: None,
    };
    let outcome = kluft_run::run(request, &mut report)?;
    if outcome.ending != Ending::NothingLeft {
        closing_lines(&report, &outcome, &folder);
    }
    match outcome.ending {
        Ending::Solved | Ending::NothingLeft => Ok(()),
        Ending::NotConverged(why) => Err(Failure::NotConverged(why)),
        Ending::Stopped => Err(Failure::NotConverged("the run was stopped".into())),
    }
}

/// What the program for many ranks is told.
fn arguments(scene_file: &Path, options: &RunOptions) -> Vec<OsString> {
    let mut all: Vec<OsString> = vec!["run".into(), scene_file.into()];
    if let Some(out) = &options.out {
        all.extend(["--out".into(), out.into()]);
    }
    if let Some(threads) = options.threads {
        all.extend(["--threads".into(), threads.to_string().into()]);
    }
    all.extend(options.resume.then(|| "--resume".into()));
    all.extend((!options.report).then(|| "--no-report".into()));
    all.extend(options.verbosity.argument().map(OsString::from));
    all.extend(options.gmsh_arguments.iter().map(OsString::from));
    all
}

/// Ends the process when whoever started it is gone.
fn end_with_standard_input() {
    std::thread::spawn(|| {
        // Whether it ends or breaks, nobody is there any more.
        let _ = std::io::copy(&mut std::io::stdin(), &mut std::io::sink());
        std::process::exit(1);
    });
}

fn closing_lines(report: &Report, outcome: &Outcome, folder: &Path) {
    let summary = &outcome.summary;
    report.fractures(&summary.fractures);
    report.comparisons(&summary.measures);
    for warning in &summary.warnings {
        report.entry("warning", warning);
    }
    let text = format!(
        "{:.2} s, {} at most, {}",
        summary.seconds.total,
        memory::in_words(summary.peak_memory_bytes as usize),
        counted(summary.threads, "thread")
    );
    report.entry("took", &text);
    let rock = folder.join("rock.pvd");
    if rock.exists() {
        let fractures = folder.join("fractures.pvd");
        let text = format!("{} and {}", rock.display(), fractures.display());
        report.entry("open", &text);
    }
    let page = folder.join(REPORT);
    if page.exists() {
        report.entry("page", &page.display().to_string());
    }
}
