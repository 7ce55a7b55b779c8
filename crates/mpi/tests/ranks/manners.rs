//! What the program says, and that it ends on all ranks.

use std::fs;
use std::time::{Duration, Instant};

use crate::harness::{changed, finished, geometry, number, solved, started};

fn said(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn defects_are_named_once_and_end_all_ranks() {
    let folder = changed("closing-blocks", "young_modulus", "yuong_modulus");
    let scene = folder.path().join("scene.toml").display().to_string();
    for ranks in [1, 3] {
        let begun = Instant::now();
        let output = finished(ranks, &["run", &scene]);
        let err = said(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{err}");
        assert!(err.contains("yuong_modulus"), "{err}");
        assert_eq!(err.matches("remedy: ").count(), 1, "{err}");
        assert!(
            begun.elapsed() < Duration::from_secs(10),
            "{:?}",
            begun.elapsed()
        );
    }
}

#[test]
fn what_one_machine_alone_can_do_is_refused_by_name() {
    let folder = changed(
        "closing-blocks",
        "[mesh]",
        "[solver]\nlinear = \"direct\"\n\n[mesh]",
    );
    let direct = folder.path().join("scene.toml");
    let adaptive = geometry("small-cube-adaptive");
    for (scene, word) in [(&direct, "direct solver"), (&adaptive, "`adapt`")] {
        let output = finished(2, &["run", &scene.display().to_string()]);
        let err = said(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{err}");
        assert!(err.contains(word) && err.contains("kluft run"), "{err}");
    }
}

#[test]
fn a_file_that_one_rank_cannot_write_ends_all() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out");
    fs::write(&out, "no folder").expect("written");
    let scene = geometry("closing-blocks").display().to_string();
    let begun = Instant::now();
    let output = finished(3, &["run", &scene, "--out", &out.display().to_string()]);
    let err = said(&output.stderr);
    assert_ne!(output.status.code(), Some(0), "{err}");
    assert!(err.contains("remedy") || err.contains("failed"), "{err}");
    assert!(
        begun.elapsed() < Duration::from_secs(10),
        "{:?}",
        begun.elapsed()
    );
}

#[test]
fn threads_of_ranks_change_no_bit() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = geometry("closing-blocks");
    let grids = ["1", "3"].map(|threads| {
        let out = folder.path().join(threads);
        solved(2, &scene, &out, &["--threads", threads]);
        let names = ["rock_0001_0000.vtu", "fractures_0001_0001.vtu"];
        names.map(|name| fs::read(out.join(name)).expect("a piece"))
    });
    assert!(grids[0] == grids[1], "other bits on three threads");
}

#[test]
fn arguments_are_explained_once() {
    let output = finished(2, &["walk"]);
    let err = said(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{err}");
    assert_eq!(err.matches("Usage:").count(), 1, "{err}");
}

/// `KLUFT_STARTS` starts, by default a few; each must end by itself.
#[test]
fn no_start_hangs() {
    for start in 0..number("KLUFT_STARTS", 20) {
        let ranks = 1 + (start % 4) as usize;
        let mut child = started(ranks, &["--version"]);
        let begun = Instant::now();
        while child.try_wait().expect("a child").is_none() {
            assert!(
                begun.elapsed() < Duration::from_secs(60),
                "start {start} hangs"
            );
            std::thread::sleep(Duration::from_millis(10));
        }
    }
}

#[test]
fn verbose_runs_count_what_the_ranks_exchange() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = geometry("network-20").display().to_string();
    let out = folder.path().display().to_string();
    let output = finished(2, &["run", &scene, "--out", &out, "-v"]);
    let text = said(&output.stdout);
    assert!(output.status.success(), "{}", said(&output.stderr));
    let words: Vec<&str> = text.split_whitespace().collect();
    let at = words.iter().position(|word| *word == "reductions");
    let at = at.unwrap_or_else(|| panic!("no counts in\n{text}"));
    let numbers = words[at - 1..].iter().filter_map(|word| word.parse().ok());
    let numbers: Vec<f64> = numbers.take(3).collect();
    let [reductions, exchanges, levels] = numbers[..] else {
        panic!("no counts in\n{text}");
    };
    // Those of the method: two products of vectors and a norm.
    assert_eq!(reductions, 3.0);
    assert!(levels >= 3.0, "{levels} levels");
    assert!(
        exchanges > levels && exchanges <= 8.0 * levels,
        "{exchanges} exchanges over {levels} levels"
    );
}
