//! Runs that are interrupted and resumed: to the last bit the results of one that is not. The soak
//! kills them at random.

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

use kluft_mesh::Defect;
use kluft_run::{Ending, MeshInput, Observer, Origin, Outcome, Request, Stage, StepStart};
use kluft_scene::Scene;
use kluft_solver::Iteration;
use serde_json::Value;

use crate::harness::{
    KLUFT, Run, Workshop, command, files, kluft_with, root, scratch, summary, without_times,
    write_gmsh,
};

/// Loading, unloading and loading again, so that a step depends on several before it.
const PATH: &str = "[[load.phase]]\nname = \"loading\"\nuntil = 1.0\nsteps = 5\n\n\
    [[load.phase]]\nname = \"turning\"\nuntil = 3.0\nsteps = 6\n\n[mesh]";
const TOP: (&str, &str) = (
    "traction = [0.0, 0.0, -10e6]",
    "traction = [0.0, 0.0, -10e6]\nhistory = [[0, 0], [1, 1], [2, 0.25], [3, 1.5]]",
);

fn workshop(linear: &str) -> Workshop {
    let solver = format!("[solver]\nlinear = \"{linear}\"\n\n{PATH}");
    let edits = [("h = 0.15", "h = 0.25"), ("[mesh]", &solver[..]), TOP];
    Workshop::new("three-planes", &edits)
}

fn arguments(workshop: &Workshop, out: &str, flags: &[&str]) -> Vec<std::ffi::OsString> {
    let (scene, out) = (workshop.scene(), workshop.path(out));
    let fixed = [OsStr::new("run"), scene.as_os_str(), OsStr::new("--out")];
    let flags = flags.iter().map(OsStr::new);
    let all = fixed.into_iter().chain([out.as_os_str()]).chain(flags);
    all.map(OsStr::to_owned).collect()
}

fn start(workshop: &Workshop, out: &str, flags: &[&str]) -> Child {
    command(KLUFT)
        .args(arguments(workshop, out, flags))
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the program starts")
}

/// `kill -9`, unless it has ended by itself.
fn kill(mut child: Child) -> bool {
    let runs = child.try_wait().expect("a child").is_none();
    child.kill().expect("killed");
    child.wait().expect("gone");
    runs
}

/// Resumes where gmsh is not to be found.
pub fn resume_without_gmsh(workshop: &Workshop, out: &str) -> Run {
    let environment = [("KLUFT_GMSH", "/no/gmsh/here")];
    kluft_with(&arguments(workshop, out, &["--resume", "-v"]), &environment)
}

/// Everything that must not depend on interruptions: the files without their unfinished neighbours,
/// and the summary without times and memory.
pub fn outcome(out: &Path) -> (BTreeMap<String, Vec<u8>>, Value) {
    let mut left = files(out);
    // A gmsh that lost its master goes on, and leaves its mesh under a name of its own.
    left.retain(|name, _| !name.starts_with(".mesh."));
    assert!(left.remove("resume.bin").is_some());
    without_times(&mut left);
    let mut said = summary(out);
    let said_of = said.as_object_mut().expect("an object");
    for key in [
        "seconds",
        "peak_memory_bytes",
        "predicted_memory_bytes",
        "provenance",
    ] {
        assert!(said_of.remove(key).is_some());
    }
    (left, said)
}

/// Starts a run and kills it as soon as there is a checkpoint.
pub fn kill_after_a_step(workshop: &Workshop) {
    kill_at(workshop, "resume.bin");
}

/// Starts a run and kills it as soon as there is a file of this name.
pub fn kill_at(workshop: &Workshop, file: &str) {
    let child = start(workshop, "out", &[]);
    let awaited = workshop.path("out").join(file);
    let begin = Instant::now();
    while !awaited.exists() && begin.elapsed() < Duration::from_secs(60) {
        std::thread::sleep(Duration::from_millis(1));
    }
    assert!(kill(child), "it ended before it was killed");
}

/// Kills a run after a step and resumes it: what it leaves is what a run leaves that was never
/// interrupted.
pub fn goes_on_to_the_same_bits(workshop: &Workshop) {
    kill_after_a_step(workshop);
    ends_in_the_same_bits(workshop);
}

/// Resumes a run that was killed: what it leaves is what a run leaves that was never interrupted.
pub fn ends_in_the_same_bits(workshop: &Workshop) {
    let run = resume_without_gmsh(workshop, "out");
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
    assert!(run.out.contains("resumed    after step "), "{}", run.out);
    let expected = outcome(&workshop.solve("whole", &[]));
    assert_eq!(outcome(&workshop.path("out")), expected);
}

/// Pressures, volumes and the flow of former steps come back with the rest.
#[test]
fn a_flow_that_takes_time_is_resumed_to_the_same_bits() {
    let longer = [
        ("first = 0.1", "first = 0.02"),
        ("growth = 1.05", "growth = 1.02"),
    ];
    let workshop = Workshop::new("filling-joint", &longer);
    goes_on_to_the_same_bits(&workshop);
}

/// So does a flow alone, between walls that do not move.
#[test]
fn a_flow_in_rigid_rock_is_resumed_to_the_same_bits() {
    let times: Vec<String> = (1..=400).map(|step| format!("{step}e-6")).collect();
    let load = format!("[load]\ntimes = [{}]\n\n[boundary.left]", times.join(", "));
    let stored = "viscosity = 1e-3\ncompressibility = 4.5e-10";
    let edits = [("viscosity = 1e-3", stored), ("[boundary.left]", &load[..])];
    let workshop = Workshop::new("flow-star", &edits);
    goes_on_to_the_same_bits(&workshop);
    let again = resume_without_gmsh(&workshop, "out");
    assert!(again.out.contains("nothing is left to do"), "{}", again.out);
}

/// Killed as soon as there is a checkpoint, a run goes on from there, without gmsh.
#[test]
fn a_resumed_run_does_not_mesh_again() {
    let workshop = workshop("iterative");
    kill_after_a_step(&workshop);
    let run = resume_without_gmsh(&workshop, "out");
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
    for text in [
        "load steps are finished, and their mesh is there",
        "resumed    after step ",
    ] {
        assert!(run.out.contains(text), "{text:?} is not in\n{}", run.out);
    }
    assert!(!run.out.contains("\nstep 1 of 11"), "{}", run.out);
    assert!(run.out.contains("\nstep 11 of 11"), "{}", run.out);
    let expected = outcome(&workshop.solve("whole", &[]));
    assert_eq!(outcome(&workshop.path("out")), expected);
}

/// The third step of this scene cannot converge, so that two finished steps and a checkpoint are
/// left.
fn stuck() -> Workshop {
    let edits = [
        ("[mesh]", "[load]\nsteps = [1e-9, 1e-8, 1.0]\n\n[mesh]"),
        ("cutoff_aperture = 1e-7\n", ""),
        (
            "traction = [0.0, 0.0, -7e3]",
            "traction = [0.0, 0.0, -1e11]",
        ),
    ];
    let workshop = Workshop::new("inclined-joint", &edits);
    assert_eq!(workshop.run("out", &[]).code, Some(1));
    workshop
}

#[test]
fn a_step_that_fails_is_tried_again() {
    let workshop = stuck();
    let before = outcome(&workshop.path("out"));
    let run = resume_without_gmsh(&workshop, "out");
    assert_eq!(run.code, Some(1), "{}", run.err);
    assert!(
        run.err.contains("not converged: step 3 (load 1)"),
        "{}",
        run.err
    );
    assert!(
        run.out.contains("resumed    after step 2 of 3"),
        "{}",
        run.out
    );
    assert_eq!(outcome(&workshop.path("out")), before);
}

#[test]
fn a_finished_run_has_nothing_left_to_do() {
    let workshop = Workshop::new("inclined-joint", &[]);
    let before = files(&workshop.solve("out", &[]));
    let run = resume_without_gmsh(&workshop, "out");
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
    assert!(run.out.contains("nothing is left to do"), "{}", run.out);
    assert_eq!(files(&workshop.path("out")), before);
}

#[test]
fn without_a_checkpoint_a_run_begins() {
    let workshop = Workshop::new("inclined-joint", &[]);
    let expected = outcome(&workshop.solve("whole", &[]));
    let run = workshop.run("out", &["--resume", "-v"]);
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
    assert!(
        run.out.contains("there is no resume.bin in "),
        "{}",
        run.out
    );
    assert!(run.out.contains("from the beginning"), "{}", run.out);
    assert_eq!(outcome(&workshop.path("out")), expected);
}

#[test]
fn a_new_run_removes_the_checkpoint() {
    let workshop = stuck();
    let checkpoint = workshop.path("out/resume.bin");
    let unfinished = workshop.path("out/.kluft/tmp");
    fs::create_dir_all(&unfinished).expect("a folder");
    fs::write(unfinished.join("rock_0003.vtu"), "half").expect("written");
    let text = fs::read_to_string(workshop.scene()).expect("the scene");
    let text = text.replace("steps = [1e-9, 1e-8, 1.0]", "steps = [1.0]");
    fs::write(workshop.scene(), text).expect("written");
    assert!(checkpoint.exists());
    assert_eq!(workshop.run("out", &[]).code, Some(1));
    let left: Vec<String> = files(&workshop.path("out")).into_keys().collect();
    assert_eq!(left, ["mesh.msh", "report.html", "summary.json"]);
    assert!(!unfinished.exists());
    assert_eq!(
        summary(&workshop.path("out"))["steps"][0]["converged"],
        false
    );
}

/// Resumes what `spoil` has spoilt: refused with all of `says`, and nothing is touched.
fn assert_refused(workshop: &Workshop, says: &[&str]) {
    let before = files(&workshop.path("out"));
    let run = workshop.run("out", &["--resume"]);
    assert_eq!((run.code, run.out.as_str()), (Some(2), ""), "{}", run.err);
    for text in says
        .iter()
        .chain(&["run without --resume: it starts from the beginning"])
    {
        assert!(run.err.contains(text), "{text:?} is not in\n{}", run.err);
    }
    assert_eq!(files(&workshop.path("out")), before);
}

fn append(path: &Path, text: &str) {
    let before = fs::read_to_string(path).expect("a text");
    fs::write(path, before + text).expect("written");
}

#[test]
fn what_changed_is_named() {
    let workshop = stuck();
    append(&workshop.scene(), "\n# another scene\n");
    assert_refused(
        &workshop,
        &["scene.toml: the scene has changed", "undo the change"],
    );
    append(
        &workshop.path("inclined-joint.geo"),
        "\n// another geometry\n",
    );
    let geometry = "inclined-joint.geo: the geometry has changed";
    assert_refused(&workshop, &["2 defects", "the scene has changed", geometry]);
}

#[test]
fn another_mesh_is_named() {
    let made = stuck();
    let mesh = fs::read(made.path("out/mesh.msh")).expect("the mesh");
    let parameters = "geometry = \"inclined-joint.geo\"\nparameters = { h = 0.2, dip = 50 }";
    let workshop = Workshop::new("inclined-joint", &[(parameters, "file = \"given.msh\"")]);
    fs::write(workshop.path("given.msh"), &mesh).expect("written");
    workshop.solve("out", &[]);
    let finer = Workshop::new("inclined-joint", &[("h = 0.2", "h = 0.15")]);
    fs::copy(
        finer.solve("out", &[]).join("mesh.msh"),
        workshop.path("given.msh"),
    )
    .expect("copied");
    assert_refused(
        &workshop,
        &[
            "given.msh: the mesh has changed",
            "put the former mesh back",
        ],
    );
}

/// A mesh that gmsh makes again is taken if it is the same, and refused if not.
#[test]
fn a_mesh_that_is_gone_is_made_again() {
    let workshop = stuck();
    let mesh = workshop.path("out/mesh.msh");
    fs::remove_file(&mesh).expect("removed");
    let run = workshop.run("out", &["--resume", "-v"]);
    assert_eq!(run.code, Some(1), "{}", run.err);
    assert!(run.out.contains("meshed "), "{}", run.out);
    assert!(
        run.out.contains("resumed    after step 2 of 3"),
        "{}",
        run.out
    );
    // Another gmsh, which makes another mesh of the same geometry.
    let gmsh = workshop.path("gmsh");
    write_gmsh(
        &gmsh,
        "exec gmsh \"$@\" -setnumber Mesh.RandomSeed 7 -clscale 0.9",
    );
    fs::remove_file(&mesh).expect("removed");
    let gmsh = gmsh.display().to_string();
    // A confined gmsh starts no other program.
    let flags = arguments(&workshop, "out", &["--resume", "--trust"]);
    let run = kluft_with(&flags, &[("KLUFT_GMSH", &gmsh)]);
    assert_eq!(run.code, Some(2), "{}", run.err);
    assert!(
        run.err.contains("gmsh now makes another mesh"),
        "{}",
        run.err
    );
}

#[test]
fn a_checkpoint_that_is_damaged_is_refused() {
    let workshop = stuck();
    let path = workshop.path("out/resume.bin");
    let whole = fs::read(&path).expect("the checkpoint");
    let flipped = |at: usize| {
        let mut bytes = whole.clone();
        bytes[at] ^= 1;
        bytes
    };
    let spoilt = [
        Vec::new(),
        b"something else".to_vec(),
        whole[..whole.len() / 2].to_vec(),
        [&whole[..], b"x"].concat(),
        flipped(0),
        flipped(40),
        flipped(whole.len() / 2),
        flipped(whole.len() - 1),
    ];
    for bytes in spoilt {
        fs::write(&path, bytes).expect("written");
        assert_refused(&workshop, &["resume.bin: the checkpoint is damaged"]);
    }
}

#[test]
fn results_that_are_gone_are_named() {
    let workshop = stuck();
    fs::remove_file(workshop.path("out/rock_0001.vtu")).expect("removed");
    let says = ["rock_0001.vtu: the results of a finished load step are gone"];
    assert_refused(&workshop, &says);
}

/// Grids of another run of the same number, as they stand there when two runs were mixed.
#[test]
fn results_of_another_run_are_not_taken_for_its_own() {
    let (workshop, other) = (
        stuck(),
        Workshop::new("inclined-joint", &[("h = 0.2", "h = 0.3")]),
    );
    let strange = other.solve("out", &[]).join("rock_0001.vtu");
    fs::copy(strange, workshop.path("out/rock_0002.vtu")).expect("copied");
    let says = ["rock_0002.vtu: the results of a finished load step are not those of this run"];
    assert_refused(&workshop, &says);
}

/// Spoils the page of a run once the grids of its last load step are written, so that the run
/// fails before its end.
struct Spoiler {
    page: PathBuf,
    grids: PathBuf,
}

impl Observer for Spoiler {
    fn stage_ends(&mut self, stage: Stage, _took: Duration) {
        if stage == Stage::Write && self.grids.exists() {
            fs::create_dir(&self.page).expect("a folder in its place");
        }
    }
}

fn solve_in_two_steps(
    folder: &Path,
    resume: bool,
    observer: &mut dyn Observer,
) -> Result<Outcome, Vec<Defect>> {
    let steps = |text: String| format!("{text}\n[load]\nsteps = [0.5, 1.0]\n");
    solve_geometry("inclined-joint", steps, (folder, resume), observer)
}

/// Solves a geometry with an edit of its scene into a folder, from where a former run stopped if
/// that is asked for.
fn solve_geometry(
    name: &str,
    edit: impl Fn(String) -> String,
    (folder, resume): (&Path, bool),
    observer: &mut dyn Observer,
) -> Result<Outcome, Vec<Defect>> {
    let place = root().join("geometries").join(name);
    let file = place.join("scene.toml");
    let text = edit(fs::read_to_string(&file).expect("a scene"));
    let scene = Scene::parse(&text, "scene.toml", &place).expect("a sound scene");
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build();
    let pool = pool.expect("threads");
    let request = Request {
        folder: Some(folder),
        origin: Some(Origin {
            file: &file,
            text: &text,
        }),
        resume,
        ..Request::in_memory(&scene, MeshInput::OfScene, &pool)
    };
    kluft_run::run(request, observer)
}

/// A run that fails between its last load step and its end.
#[test]
fn a_run_that_dies_after_its_last_step_ends_when_it_is_resumed() {
    let folder = scratch();
    let [whole, died] = ["whole", "died"].map(|name| folder.path().join(name));
    solve_in_two_steps(&whole, false, &mut ()).expect("no defects");
    let page = died.join("report.html");
    let grids = died.join("fractures_0002.vtu");
    let mut spoiler = Spoiler {
        page: page.clone(),
        grids,
    };
    solve_in_two_steps(&died, false, &mut spoiler).expect_err("no place for the page");
    fs::remove_dir(&page).expect("removed");
    let resumed = solve_in_two_steps(&died, true, &mut ()).expect("no defects");
    assert_eq!(resumed.ending, Ending::Solved);
    assert_eq!(outcome(&died), outcome(&whole));
    assert!(page.is_file());
    let again = solve_in_two_steps(&died, true, &mut ()).expect("no defects");
    assert_eq!(again.ending, Ending::NothingLeft);
}

/// Stops a run in the middle of the search for a factor of safety.
struct Doubter {
    factors: usize,
}

impl Observer for Doubter {
    fn step_begins(&mut self, step: StepStart<'_>) {
        self.factors += usize::from(step.what.starts_with("strength"));
    }

    fn iteration(&mut self, _: usize, _: &Iteration) -> ControlFlow<()> {
        match self.factors > 3 {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    }
}

/// After a search for a factor of safety that was interrupted the last load step is solved again,
/// and the search finds the same.
#[test]
fn a_factor_of_safety_is_found_again() {
    let folder = scratch();
    let [whole, stopped] = ["whole", "stopped"].map(|name| folder.path().join(name));
    let coarse = |text: String| {
        let text = text.replace("accuracy = 1e-3", "accuracy = 0.02");
        format!("{text}\n[load]\nsteps = [0.5, 1.0]\n")
    };
    let solve = |out: &Path, resume: bool, observer: &mut dyn Observer| {
        let ending = solve_geometry("cliff-wedge", coarse, (out, resume), observer);
        ending.expect("no defects").ending
    };
    assert_eq!(solve(&whole, false, &mut ()), Ending::Solved);
    let mut doubter = Doubter { factors: 0 };
    assert_eq!(solve(&stopped, false, &mut doubter), Ending::Stopped);
    assert_eq!(doubter.factors, 4);
    assert!(summary(&stopped)["strength_reduction"].is_null());
    assert_eq!(solve(&stopped, true, &mut ()), Ending::Solved);
    assert_eq!(outcome(&stopped), outcome(&whole));
    let page = fs::read_to_string(stopped.join("report.html")).expect("a page");
    let last = "Fractures after the last load step";
    for said in [last, "Factor of safety", "Motion of blocks across"] {
        assert!(page.contains(said), "{said}");
    }
    assert_eq!(solve(&stopped, true, &mut ()), Ending::NothingLeft);
}
