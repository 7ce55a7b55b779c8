//! Runs that are interrupted and resumed: to the last bit the results of one that is not.
//! `KLUFT_KILLS` sets how many runs are killed for each linear solver, by default 3.
#![allow(
    clippy::print_stdout,
    reason = "the long suite keeps the count of interrupted runs"
)]

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::harness::{Run, Workshop, files, kluft_with, summary};

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
    Command::new(env!("CARGO_BIN_EXE_kluft"))
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
fn resume_without_gmsh(workshop: &Workshop, out: &str) -> Run {
    let environment = [("KLUFT_GMSH", "/no/gmsh/here")];
    kluft_with(&arguments(workshop, out, &["--resume", "-v"]), &environment)
}

/// Everything that must not depend on interruptions: the files without their unfinished neighbours,
/// and the summary without times and memory.
fn outcome(out: &Path) -> (BTreeMap<String, Vec<u8>>, Value) {
    let mut left = files(out);
    // A gmsh that lost its master goes on, and leaves its mesh under a name of its own.
    left.retain(|name, _| !name.starts_with(".mesh."));
    assert!(left.remove("resume.bin").is_some() && left.remove("summary.json").is_some());
    let mut said = summary(out);
    let said_of = said.as_object_mut().expect("an object");
    for key in ["seconds", "peak_memory_bytes", "predicted_memory_bytes"] {
        assert!(said_of.remove(key).is_some());
    }
    (left, said)
}

/// Whatever stands in the folder is whole, and the collections list nothing that is not there.
fn assert_valid(out: &Path) {
    let Ok(entries) = fs::read_dir(out) else {
        return;
    };
    let names: Vec<String> = entries
        .map(|entry| entry.expect("an entry").file_name().display().to_string())
        .collect();
    let has = |name: &str| names.iter().any(|other| other == name);
    for collection in ["rock.pvd", "fractures.pvd"]
        .into_iter()
        .filter(|name| has(name))
    {
        let text = fs::read_to_string(out.join(collection)).expect("a collection");
        assert!(text.ends_with("</VTKFile>\n"), "{text}");
        let listed = text.split("file=\"").skip(1);
        for name in listed.map(|rest| rest.split('"').next().expect("a name")) {
            let grid = fs::read(out.join(name)).expect("a grid that is listed");
            assert!(grid.trim_ascii_end().ends_with(b"</VTKFile>"), "{name}");
        }
    }
    if has("summary.json") {
        let steps = summary(out)["steps"].as_array().expect("steps").len();
        let grids = names
            .iter()
            .filter(|name| name.starts_with("rock_"))
            .count();
        assert!(steps == grids || steps + 1 == grids, "{steps} of {grids}");
    }
}

/// The generator xorshift64: other places to kill at each time, the same in every test run.
struct Random(u64);

impl Random {
    fn below(&mut self, end: Duration) -> Duration {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        end.mul_f64((self.0 >> 11) as f64 / (1_u64 << 53) as f64)
    }
}

/// Kills runs of one scene at random, up to four times each, and compares how they end.
fn kill_and_compare(linear: &str, seed: u64) {
    let kills = std::env::var("KLUFT_KILLS").ok();
    let runs: usize = kills.and_then(|kills| kills.parse().ok()).unwrap_or(3);
    let workshop = workshop(linear);
    let begin = Instant::now();
    let expected = outcome(&workshop.solve("whole", &[]));
    let took = begin.elapsed();
    let mut random = Random(seed);
    let (mut killed, mut continued) = (0, 0);
    for number in 0..runs {
        let out = format!("killed-{number}");
        for attempt in 0..=number % 4 {
            let flags: &[&str] = if attempt == 0 { &[] } else { &["--resume"] };
            let child = start(&workshop, &out, flags);
            std::thread::sleep(random.below(took));
            let hit = kill(child);
            assert_valid(&workshop.path(&out));
            let goes_on = workshop.path(&out).join("resume.bin").exists();
            killed += usize::from(hit);
            continued += usize::from(hit && goes_on);
        }
        let found = outcome(&workshop.solve(&out, &["--resume"]));
        assert_eq!(found.1, expected.1, "{linear}, run {number}");
        let names = |files: &BTreeMap<String, Vec<u8>>| files.keys().cloned().collect::<Vec<_>>();
        assert_eq!(names(&found.0), names(&expected.0));
        for (name, bytes) in &found.0 {
            assert!(*bytes == expected.0[name], "{linear}, run {number}: {name}");
        }
        fs::remove_dir_all(workshop.path(&out)).expect("removed");
    }
    println!(
        "{runs} of {runs} interrupted runs ({linear}) end as the whole one: killed {killed} times, {continued} of them after the first step"
    );
}

#[test]
fn killed_direct_runs_resume_to_the_same_bytes() {
    kill_and_compare("direct", 0x9e37_79b9_7f4a_7c15);
}

#[test]
fn killed_condensed_runs_resume_to_the_same_bytes() {
    kill_and_compare("condensed", 0xd1b5_4a32_d192_ed03);
}

#[test]
fn killed_iterative_runs_resume_to_the_same_bytes() {
    kill_and_compare("iterative", 0x8cb9_2ba7_2f3d_8dd7);
}

/// Killed as soon as there is a checkpoint, a run goes on from there, without gmsh.
#[test]
fn a_resumed_run_does_not_mesh_again() {
    let workshop = workshop("iterative");
    let child = start(&workshop, "out", &[]);
    let checkpoint = workshop.path("out/resume.bin");
    let begin = Instant::now();
    while !checkpoint.exists() && begin.elapsed() < Duration::from_secs(60) {
        std::thread::sleep(Duration::from_millis(1));
    }
    assert!(kill(child), "it ended before it was killed");
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
    for unfinished in [".rock_0003.vtu.tmp", ".resume.bin.tmp"] {
        fs::write(workshop.path("out").join(unfinished), "half").expect("written");
    }
    let of_gmsh = workshop.path("out/.mesh.77.gmsh");
    fs::create_dir(&of_gmsh).expect("a folder");
    fs::write(of_gmsh.join("made.msh"), "half").expect("written");
    let text = fs::read_to_string(workshop.scene()).expect("the scene");
    let text = text.replace("steps = [1e-9, 1e-8, 1.0]", "steps = [1.0]");
    fs::write(workshop.scene(), text).expect("written");
    assert!(checkpoint.exists());
    assert_eq!(workshop.run("out", &[]).code, Some(1));
    let left: Vec<String> = files(&workshop.path("out")).into_keys().collect();
    assert_eq!(left, ["mesh.msh", "summary.json"]);
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
    fs::write(
        &gmsh,
        "#!/bin/sh\nexec gmsh \"$@\" -setnumber Mesh.RandomSeed 7 -clscale 0.9\n",
    )
    .expect("written");
    let made = Command::new("chmod").arg("+x").arg(&gmsh).status();
    assert!(made.expect("chmod").success());
    fs::remove_file(&mesh).expect("removed");
    let gmsh = gmsh.display().to_string();
    let flags = arguments(&workshop, "out", &["--resume"]);
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
