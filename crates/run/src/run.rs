//! A run, told as a story.

use kluft_mesh::Defect;
use kluft_scene::MeshSource;

use crate::adapt::{self, SIZES};
use crate::checkpoint;
use crate::ending::Ending;
use crate::failures;
use crate::flow::SOURCES;
use crate::observer::Observer;
use crate::outcome::Outcome;
use crate::output::{OWN, Output};
use crate::page;
use crate::prepare::{MESH, inputs};
use crate::probes;
use crate::ranks::agreed;
use crate::request::{MeshInput, Request};
use crate::resume::{self, FormerRun};
use crate::stages::{Interruption, Run};
use crate::strength_summary;

/// Runs a scene: mesh, enrich, assemble, solve, write.
///
/// # Errors
/// Every defect of geometry, mesh and scene, and files that cannot be written. A load step that
/// does not converge is no error: see [`Ending::NotConverged`].
pub fn run(request: Request<'_>, observer: &mut dyn Observer) -> Result<Outcome, Vec<Defect>> {
    let pool = request.pool;
    pool.install(|| run_here(request, observer))
}

/// Runs a scene on the present thread pool.
fn run_here(request: Request<'_>, observer: &mut dyn Observer) -> Result<Outcome, Vec<Defect>> {
    let output = agreed(request.ranks, output(&request))?;
    let version = env!("CARGO_PKG_VERSION");
    observer.note("kluft", &format!("{version}  {}", request.scene.title));
    let mut identity = resume::identity(request.scene, request.origin);
    identity.ranks = request.ranks.map_or(1, |ranks| ranks.count()) as u32;
    let mut former = None;
    if let Some(origin) = request.origin.filter(|_| request.resume) {
        let found = resume::find(origin.file, request.scene, &identity, &output);
        former = agreed(request.ranks, found)?;
        observer.note("resume", &what_is_left(former.as_ref(), &output));
    }
    if output.is_unguarded() {
        let text = "its file system knows no locks: let no other run write to this folder";
        observer.note("warning", text);
    }
    let is_finished = former.as_ref().is_some_and(FormerRun::is_finished);
    let mesh_is_kept = former.as_ref().is_some_and(|former| former.mesh_is_kept);
    let mut run = Run::new(request, output, observer, identity, former.as_ref());
    if is_finished {
        return Ok(run.into_outcome(Ending::NothingLeft));
    }
    match solve(&mut run, former, mesh_is_kept) {
        Ok(()) => run.finish(Ending::Solved),
        Err(Interruption::NotConverged(why)) => run.finish(Ending::NotConverged(why)),
        Err(Interruption::Stopped) => run.finish(Ending::Stopped),
        Err(Interruption::Defects(defects)) => {
            let kept = [run.output.sums().len(), run.checkpointed];
            Err(failures::with_what_is_kept(defects, kept))
        }
    }
}

/// The folder of a request, for the files that its run will write; the grids of the load steps are
/// known later.
fn output(request: &Request<'_>) -> Result<Output, Vec<Defect>> {
    let Some(folder) = request.folder else {
        return Output::nowhere();
    };
    if let Some(ranks) = request.ranks.filter(|ranks| !ranks.is_first()) {
        return Ok(Output::beside(folder, ranks.count()));
    }
    let mut names = OWN.to_vec();
    names.extend(request.scene.fluid.as_ref().map(|_| SOURCES));
    if request.scene.strength_reduction.is_some() {
        names.extend(strength_summary::GRIDS);
    }
    names.extend(request.report.then_some(page::NAME));
    if !request.scene.probes.is_empty() {
        names.push(probes::NAME);
    }
    if let (MeshSource::Geometry { adapt, .. }, MeshInput::OfScene) =
        (&request.scene.mesh, &request.mesh)
    {
        names.push(MESH);
        names.extend(adapt.map(|_| SIZES));
    }
    let inputs = match request.origin {
        Some(origin) => inputs(origin.file, Some(request.scene)),
        None => Vec::new(),
    };
    let mut output = Output::prepare(folder, &names, &inputs)?;
    output.pieces = request.ranks.map_or(1, |ranks| ranks.count());
    Ok(output.with_page(request.report))
}

fn solve(
    run: &mut Run<'_>,
    former: Option<FormerRun>,
    mesh_is_kept: bool,
) -> Result<(), Interruption> {
    if !mesh_is_kept {
        adapt::search(run)?;
    }
    if run.request.scene.has_stages() {
        return run.solve_stages(former);
    }
    let binding = run.prepare(former.as_ref())?;
    match &binding.flow {
        Some(flow) if run.request.scene.is_rigid() => {
            run.probes.all.clone_from(&binding.probes);
            run.solve_flow(&binding.problem, flow, former)
        }
        _ => run.solve(&binding, former),
    }
}

fn what_is_left(former: Option<&FormerRun>, output: &Output) -> String {
    match former {
        None => format!(
            "there is no {} in {}: from the beginning",
            checkpoint::NAME,
            output.path("").display()
        ),
        Some(former) if former.is_finished() => format!(
            "all {} load steps are finished: nothing is left to do",
            former.progress.files.len()
        ),
        Some(former) => format!(
            "{} load steps are finished{}",
            former.progress.files.len(),
            if former.mesh_is_kept {
                ", and their mesh is there"
            } else {
                ""
            }
        ),
    }
}
