//! What the machine refuses: room for results, threads, memory. Exit code 1, a message, no panic.

use std::fs::{self, File};
use std::process::{Command, Stdio};

use crate::harness::{KLUFT, Run, Workshop, command, root, scratch};

fn program() -> Command {
    command(KLUFT)
}

fn assert_fails(run: &Run, says: &[&str]) {
    assert_eq!(run.code, Some(1), "{}", run.err);
    for text in says.iter().chain(&["remedy: "]) {
        assert!(run.err.contains(text), "{text}: {}", run.err);
    }
    for word in ["panicked", "defect in the input"] {
        assert!(!run.err.contains(word), "{word}: {}", run.err);
    }
}

fn mesh_in(folder: &std::path::Path) {
    fs::write(folder.join("base.msh"), include_str!("bad_input/base.msh")).expect("written");
}

#[test]
fn results_that_cannot_be_printed_are_a_failure() {
    let folder = scratch();
    mesh_in(folder.path());
    for arguments in [
        &["inspect", "base.msh", "--json"][..],
        &["explain"],
        &["schema"],
    ] {
        let full = File::options()
            .write(true)
            .open("/dev/full")
            .expect("Linux has it");
        let mut command = program();
        command
            .current_dir(folder.path())
            .args(arguments)
            .stdout(full);
        let run: Run = command
            .stderr(Stdio::piped())
            .output()
            .expect("it starts")
            .into();
        assert_fails(&run, &["standard output: ", "No space left"]);
    }
}

#[test]
fn a_closed_pipe_ends_quietly() {
    let folder = scratch();
    mesh_in(folder.path());
    for arguments in [&["inspect", "base.msh"][..], &["schema"]] {
        let mut command = program();
        command.current_dir(folder.path()).args(arguments);
        let mut child = command
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("it starts");
        drop(child.stdout.take());
        let run: Run = child.wait_with_output().expect("gone").into();
        assert_eq!((run.code, run.err.as_str()), (Some(0), ""), "{arguments:?}");
    }
}

/// A limit on the size of files stands for a disk that is full: both fail in the middle of a write.
#[test]
fn files_that_cannot_be_written_are_no_defect_of_the_input() {
    let workshop = Workshop::new("inclined-joint", &[("h = 0.2", "h = 0.1")]);
    let whole = workshop.solve("whole", &[]);
    let size = |name: &str| fs::metadata(whole.join(name)).expect("a file").len();
    let (mesh, grid) = (size("mesh.msh"), size("rock_0001.vtu"));
    assert!(
        mesh < grid - 2048,
        "the mesh fits where the grid does not: {mesh} {grid}"
    );
    let script = format!(
        "trap '' XFSZ; ulimit -f {}; exec \"$0\" \"$@\"",
        mesh.div_ceil(1024) + 1
    );
    let run = command("bash")
        .args(["-c", &script, KLUFT, "run"])
        .arg(workshop.scene())
        .output();
    let run: Run = run.expect("it starts").into();
    assert_fails(
        &run,
        &[
            "rock_0001.vtu: cannot be written",
            "no load step was finished",
        ],
    );
    let left: Vec<String> = crate::harness::files(&workshop.path("out"))
        .into_keys()
        .collect();
    assert_eq!(left, ["mesh.msh", "summary.json"]);
}

#[test]
fn threads_are_capped_with_a_word() {
    let scene = root().join("geometries/inclined-joint/scene.toml");
    let out = scratch();
    let mut command = program();
    command
        .args(["run", "-v", "--threads", "40000"])
        .arg(&scene);
    let run: Run = command
        .arg("--out")
        .arg(out.path())
        .output()
        .expect("it starts")
        .into();
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
    assert!(run.out.contains("instead of 40000"), "{}", run.out);
    let inspected = program()
        .arg("inspect")
        .arg(&scene)
        .arg("--out")
        .arg(out.path())
        .env("RAYON_NUM_THREADS", "1000000")
        .output();
    let run: Run = inspected.expect("it starts").into();
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
}

#[test]
fn a_system_that_gives_no_threads_is_a_failure() {
    let folder = scratch();
    mesh_in(folder.path());
    let script = "ulimit -v 100000; exec \"$0\" \"$@\"";
    let mut command = command("bash");
    command.args(["-c", script, KLUFT, "inspect", "base.msh"]);
    command
        .current_dir(folder.path())
        .env("RAYON_NUM_THREADS", "16");
    let run: Run = command.output().expect("it starts").into();
    assert_fails(&run, &["threads: the system does not give 16 threads"]);
}

/// Runs a scene where the address space is limited to so many kB; it must end by itself.
fn run_within(workshop: &Workshop, kilobytes: usize, threads: &str) -> Run {
    let script = format!("ulimit -v {kilobytes}; exec \"$0\" \"$@\"");
    let run = command("bash")
        .args(["-c", &script, KLUFT, "run", "--threads", threads])
        .arg(workshop.scene())
        .output();
    let run: Run = run.expect("it starts").into();
    let ended = matches!(run.code, Some(0..=2));
    assert!(ended, "{kilobytes} kB: {:?}: {}", run.code, run.err);
    assert!(!run.err.contains("panicked"), "{}", run.err);
    run
}

/// The kernels of each thread pack panels as large as the cache; what those of a factor do not get
/// is named.
#[test]
fn memory_that_kernels_do_not_get_is_a_failure() {
    let workshop = Workshop::new("sphere", &[]);
    for limit in [1_000_000, 1_100_000, 1_200_000] {
        let run = run_within(&workshop, limit, "2");
        assert!(
            run.code != Some(1) || run.err.contains("GB of memory"),
            "{}",
            run.err
        );
    }
}

#[test]
fn a_limit_of_the_address_space_refuses_what_would_not_fit() {
    let workshop = Workshop::new("inclined-joint", &[]);
    run_within(&workshop, 400_000, "1");
}

/// An allocation that is refused in the middle of a run would abort it.
#[test]
fn memory_that_a_run_does_not_get_is_a_failure() {
    let workshop = Workshop::new("inclined-joint", &[]);
    for limit in (200_000..420_000).step_by(20_000) {
        let run = run_within(&workshop, limit, "2");
        if run.err.contains("memory allocation of") {
            assert_fails(&run, &["memory of this process", "ulimit -v"]);
        }
    }
}
