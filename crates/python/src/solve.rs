//! A run of a scene.

use std::path::PathBuf;

use kluft::Invocation;
use kluft_mesh::Defect;
use kluft_run::{Caller, Ending, MeshInput, Outcome, Request, run};
use pyo3::prelude::*;

use crate::asked::threads;
use crate::errors::sound;
use crate::follow::{Told, sides};
use crate::mesh::Mesh;
use crate::program::{Own, gmsh_options};
use crate::results::Results;
use crate::scene::Scene;

/// How a run ended (`solved`, `stopped`, `not converged`), why, its results, and what a signal or
/// the callback raised.
type Ended = (&'static str, String, Results, Option<Py<PyAny>>);

/// Solves all load steps of a scene, on a mesh in memory or on that which the scene names. `folder`
/// takes what the command writes; with `keeps` the results of all load steps are returned.
#[pyfunction]
pub fn solve(
    py: Python<'_>,
    scene: Py<Scene>,
    mesh: Option<Py<Mesh>>,
    asked: (Option<usize>, Option<PathBuf>, bool, Own),
    callback: Option<Bound<'_, PyAny>>,
) -> PyResult<Ended> {
    let (count, folder, keeps, own) = asked;
    let mesh = mesh.map_or(MeshInput::OfScene, |mesh| {
        MeshInput::Draft(Box::new(mesh.get().draft.clone()))
    });
    let (mut told, mut follower) = sides(callback.is_some());
    // The script, or whatever else Python was started with.
    let command = Invocation::of_process().command_line();
    let solving = |told: &mut Told| -> Result<Outcome, Vec<Defect>> {
        let pool = threads(count).map_err(|defect| vec![defect])?;
        let request = Request {
            folder: folder.as_deref(),
            keep_results: keeps,
            caller: Caller {
                command: Some(&command),
                commit: option_env!("KLUFT_COMMIT"),
            },
            gmsh: gmsh_options(own, told.stop()),
            ..Request::in_memory(&scene.get().scene, mesh, &pool)
        };
        run(request, told)
    };
    let (outcome, followed) = std::thread::scope(|scope| {
        let working = scope.spawn(move || {
            let bell = told.bell();
            let outcome = solving(&mut told);
            bell.ring();
            outcome
        });
        let followed = follower.follow(py, callback.as_ref());
        (py.detach(|| working.join()), followed)
    });
    let outcome = outcome.unwrap_or_else(|panic| std::panic::resume_unwind(panic));
    let (outcome, raised) = match (outcome, followed) {
        // A run that was stopped while gmsh made its mesh.
        (Err(_), Err(raised)) => return Err(raised),
        (outcome, followed) => (sound(py, outcome)?, followed.err()),
    };
    let (ending, why) = match outcome.ending {
        Ending::Solved | Ending::NothingLeft => ("solved", String::new()),
        Ending::Stopped => ("stopped", String::new()),
        Ending::NotConverged(why) => ("not converged", why),
    };
    let raised = raised.map(|error| error.into_value(py).into_any());
    let results = Results::of(py, outcome.summary, outcome.history, outcome.steps);
    Ok((ending, why, results, raised))
}
