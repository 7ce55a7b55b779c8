//! Runs of the program.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};

use kluft_io::{GmshOptions, load_msh};
use kluft_run::{Ending, MESH, MeshInput, Outcome, Request, run};
use kluft_scene::Scene;
use kluft_solver::LinearMethod;

/// The root of the project.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// A number that the environment may set.
pub fn number(name: &str, default: u64) -> u64 {
    let set = std::env::var(name).ok().and_then(|text| text.parse().ok());
    set.unwrap_or(default)
}

/// The command for `ranks` ranks, more than there are cores if need be.
pub fn command(ranks: usize, arguments: &[&str]) -> Command {
    let mut command = Command::new("mpiexec");
    let count = ranks.to_string();
    command.args(["-n", &count, "--oversubscribe", "--allow-run-as-root"]);
    command.args(["--bind-to", "none", "--mca", "mpi_yield_when_idle", "1"]);
    command.args(["--mca", "btl_vader_single_copy_mechanism", "none"]);
    command.arg(env!("CARGO_BIN_EXE_kluft-mpi")).args(arguments);
    command.stdin(Stdio::null());
    command
}

/// What a run on some ranks did.
pub fn finished(ranks: usize, arguments: &[&str]) -> Output {
    let output = command(ranks, arguments).output();
    output.expect("mpiexec starts (`sh scripts/setup --mpi`)")
}

/// A run that goes on.
pub fn started(ranks: usize, arguments: &[&str]) -> Child {
    let mut command = command(ranks, arguments);
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let child = command.spawn();
    child.expect("mpiexec starts (`sh scripts/setup --mpi`)")
}

/// A scene that was run into a folder.
pub fn solved(ranks: usize, scene: &Path, out: &Path, more: &[&str]) {
    let (scene, out) = (scene.display().to_string(), out.display().to_string());
    let arguments = [&["run", &scene, "--out", &out], more].concat();
    let output = finished(ranks, &arguments);
    assert!(
        output.status.success(),
        "{scene} on {ranks} ranks: {}",
        String::from_utf8_lossy(&output.stderr)
    );
}

/// The serial run, all results in memory, on the mesh that a run on ranks has made in its folder,
/// if it made one.
pub fn serial(scene: &Path, out: &Path) -> Outcome {
    serial_by(scene, out, None)
}

/// The same by one linear solver.
pub fn serial_by(scene: &Path, out: &Path, method: Option<LinearMethod>) -> Outcome {
    let mut scene = Scene::read(scene).expect("a scene");
    scene.solver.linear = method.or(scene.solver.linear);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let pool = pool.expect("a thread");
    let mesh = out.join(MESH);
    let input = match mesh.is_file() {
        true => {
            let draft = load_msh(&mesh, out, &GmshOptions::default());
            MeshInput::Draft(Box::new(draft.expect("a mesh")))
        }
        false => MeshInput::OfScene,
    };
    let request = Request::in_memory(&scene, input, &pool);
    let outcome = run(request, &mut ()).expect("no defects");
    assert_eq!(outcome.ending, Ending::Solved);
    outcome
}

/// A scene of `geometries/`.
pub fn geometry(name: &str) -> PathBuf {
    root().join("geometries").join(name).join("scene.toml")
}

/// A scene of `geometries/` with a part of its text replaced, in a folder of its own.
pub fn changed(name: &str, from: &str, to: &str) -> tempfile::TempDir {
    let scene = geometry(name);
    let folder = tempfile::tempdir().expect("a folder");
    let text = fs::read_to_string(&scene).expect("a scene");
    assert!(text.contains(from), "{name} has no `{from}`");
    for entry in fs::read_dir(scene.parent().expect("a folder")).expect("files") {
        let entry = entry.expect("a file");
        if entry.path().is_file() {
            fs::copy(entry.path(), folder.path().join(entry.file_name())).expect("copied");
        }
    }
    fs::write(folder.path().join("scene.toml"), text.replace(from, to)).expect("written");
    folder
}
