//! Single ranks that are killed: the others end, files are whole, and the run goes on to the bits
//! of one that nobody disturbed. `KLUFT_KILLS` sets how many are killed.

use std::fs;
use std::path::Path;
use std::process::{Child, Command};
use std::time::{Duration, Instant};

use crate::harness::{changed, geometry, number, solved, started};

/// Time that all others may take to end (s).
const END: Duration = Duration::from_secs(10);
const RANKS: usize = 3;

/// Numbers of the processes that mpiexec started.
fn ranks_of(child: &Child) -> Vec<u32> {
    let path = format!("/proc/{0}/task/{0}/children", child.id());
    let text = fs::read_to_string(path).unwrap_or_default();
    let numbers = text.split_whitespace().filter_map(|word| word.parse().ok());
    let is_rank = |number: &u32| {
        let command = fs::read_to_string(format!("/proc/{number}/cmdline"));
        command.is_ok_and(|text| text.contains("kluft-mpi") && !text.contains("mpiexec"))
    };
    numbers.filter(is_rank).collect()
}

fn is_alive(number: u32) -> bool {
    let stat = fs::read_to_string(format!("/proc/{number}/stat"));
    stat.is_ok_and(|text| !text.contains(") Z"))
}

/// The files of results that hold numbers of the run, and not times or the mesh.
fn results(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let entries = fs::read_dir(folder).expect("a folder");
    let mut files: Vec<(String, Vec<u8>)> = entries
        .filter_map(|entry| {
            let entry = entry.expect("a file");
            let name = entry.file_name().to_string_lossy().into_owned();
            let counts = [".vtu", ".pvtu", ".pvd", ".csv"]
                .iter()
                .any(|end| name.ends_with(end));
            counts.then(|| (name, fs::read(entry.path()).expect("bytes")))
        })
        .collect();
    files.sort();
    files
}

/// Every file is whole: each piece that is listed is there, and ends as it should.
fn are_whole(folder: &Path) {
    for (name, bytes) in results(folder) {
        let ending = bytes.trim_ascii_end();
        let is_csv = name.ends_with(".csv");
        assert!(
            is_csv || ending.ends_with(b"</VTKFile>"),
            "{name} is not whole"
        );
        if name.ends_with(".pvtu") {
            for piece in crate::pieces::listed(&folder.join(&name)) {
                assert!(folder.join(&piece).is_file(), "{name} lists {piece}");
            }
        }
    }
}

#[test]
fn a_killed_rank_ends_all_and_the_run_goes_on_to_the_same_bits() {
    let stepped = changed(
        "closing-blocks",
        "[mesh]",
        "[load]\nsteps = [0.3, 0.5, 0.7, 0.85, 1.0]\n\n[mesh]",
    );
    let scene = stepped.path().join("scene.toml");
    let whole = tempfile::tempdir().expect("a folder");
    let begun = Instant::now();
    solved(RANKS, &scene, whole.path(), &[]);
    let took = begun.elapsed();
    let expected = results(whole.path());
    for kill in 0..number("KLUFT_KILLS", 3) {
        let folder = tempfile::tempdir().expect("a folder");
        let (file, out) = (
            scene.display().to_string(),
            folder.path().display().to_string(),
        );
        let mut child = started(RANKS, &["run", &file, "--out", &out]);
        // Spread over the run by the golden ratio.
        let share = (0.618_034 * (kill + 1) as f64).fract();
        std::thread::sleep(took.mul_f64(0.1 + 0.85 * share));
        let ranks = ranks_of(&child);
        if let Some(&victim) = ranks.get(kill as usize % RANKS) {
            let killed = Command::new("kill")
                .args(["-9", &victim.to_string()])
                .status();
            assert!(killed.is_ok(), "kill");
        }
        let begun = Instant::now();
        while child.try_wait().expect("a child").is_none() {
            assert!(begun.elapsed() < END, "kill {kill}: mpiexec goes on");
            std::thread::sleep(Duration::from_millis(20));
        }
        while ranks.iter().any(|&rank| is_alive(rank)) {
            assert!(begun.elapsed() < END, "kill {kill}: a rank goes on");
            std::thread::sleep(Duration::from_millis(20));
        }
        are_whole(folder.path());
        solved(RANKS, &scene, folder.path(), &["--resume"]);
        let found = results(folder.path());
        assert_eq!(found.len(), expected.len(), "kill {kill}");
        for ((name, bytes), (other, expected)) in found.iter().zip(&expected) {
            assert_eq!(name, other, "kill {kill}");
            assert!(bytes == expected, "kill {kill}: {name} differs");
        }
    }
}

#[test]
fn a_run_is_not_resumed_on_another_number_of_ranks() {
    let scene = geometry("closing-blocks");
    let folder = tempfile::tempdir().expect("a folder");
    solved(2, &scene, folder.path(), &[]);
    let (file, out) = (
        scene.display().to_string(),
        folder.path().display().to_string(),
    );
    let output = crate::harness::finished(3, &["run", &file, "--out", &out, "--resume"]);
    let err = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{err}");
    assert_eq!(
        err.matches("on 2 ranks, and there are 3").count(),
        1,
        "{err}"
    );
}
