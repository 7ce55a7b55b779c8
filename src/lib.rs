//! A run of Kluft, told as a story: read the scene, mesh, enrich, assemble, solve, write.

mod accuracy;
mod adapt;
mod checkpoint;
mod crack_front;
mod decisions;
mod inspect;
mod measures;
mod memory;
mod network;
mod output;
mod prepare;
mod report;
mod resume;
mod run;
mod study;
mod summary;

use std::path::{Path, PathBuf};

pub use inspect::{InspectOptions, inspect};
pub use kluft_network::{Domain, Grouping};
pub use kluft_scene::Scene;
pub use measures::Measure;
pub use network::{NetworkOptions, make_network};
pub use report::{Failure, Verbosity, print_failure};
pub use study::{StudyOptions, study};
pub use summary::{FractureSummary, Spread, StepSummary, Summary};

use output::Output;
use report::Report;
use resume::Former;
use run::{Run, one};

/// How to run a scene.
#[derive(Debug, Clone)]
pub struct Options {
    /// Folder for the results; `out` beside the scene if not given.
    pub out: Option<PathBuf>,
    /// Number of threads; all cores if not given.
    pub threads: Option<usize>,
    /// How much to tell.
    pub verbosity: Verbosity,
    /// Whether to go on after the last load step that an interrupted run of the scene finished.
    pub resume: bool,
}

/// Runs a scene.
///
/// # Errors
/// [`Failure::BadInput`] with every defect found, or [`Failure::NotConverged`] with where and why;
/// the results of converged steps and `summary.json` are kept then.
pub fn run(scene_file: &Path, options: &Options) -> Result<(), Failure> {
    let threads = options.threads.unwrap_or(0);
    // Fails only if a pool exists already, as in a program that runs many scenes.
    let _ = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build_global();
    let report = Report::new(options.verbosity);
    let text = Scene::text(scene_file)?;
    let scene = Scene::parse_file(scene_file, &text)?;
    let folder = prepare::folder_for(scene_file, options.out.as_deref());
    let output = one(Output::prepare(&folder))?;
    let version = env!("CARGO_PKG_VERSION");
    report.entry("kluft", &format!("{version}  {}", scene.title));
    let identity = resume::identity(&scene, &text);
    let former = match options.resume {
        true => resume::find(scene_file, &scene, &identity, &output)?,
        false => None,
    };
    if options.resume {
        report.entry("resume", &what_is_left(former.as_ref(), &output));
    }
    if former.as_ref().is_some_and(Former::is_finished) {
        return Ok(());
    }
    let mut run = Run::new(&scene, output, report, identity, former.as_ref());
    if !former.as_ref().is_some_and(|former| former.mesh_is_kept) {
        adapt::search(&mut run)?;
    }
    let problem = run.prepare(former.as_ref())?;
    let result = run.solve(&problem, former);
    if !matches!(result, Err(Failure::BadInput(_))) {
        one(run.write_summary())?;
        closing_lines(&run.report, &run.summary, &run.output);
    }
    result
}

fn what_is_left(former: Option<&Former>, output: &Output) -> String {
    match former {
        None => format!(
            "there is no {} in {}: from the beginning",
            checkpoint::NAME,
            output.path("").display()
        ),
        Some(former) if former.is_finished() => format!(
            "all {} load steps are finished: nothing is left to do",
            former.progress.steps.len()
        ),
        Some(former) => format!(
            "{} load steps are finished{}",
            former.progress.steps.len(),
            match former.mesh_is_kept {
                true => ", and their mesh is there",
                false => "",
            }
        ),
    }
}

fn closing_lines(report: &Report, summary: &Summary, output: &Output) {
    report.fractures(&summary.fractures);
    report.comparisons(&summary.measures);
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
