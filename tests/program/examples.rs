//! The examples that teach run, and print what theory says.

use std::path::{Path, PathBuf};
use std::process::Command;

/// Numbers of the table that an example prints, row by row; `cargo test` builds all examples.
fn table(name: &str) -> Vec<Vec<f64>> {
    let test: PathBuf = std::env::current_exe().expect("a test binary");
    let profile = test
        .parent()
        .and_then(Path::parent)
        .expect("a folder of builds");
    let example = profile.join("examples").join(name);
    let output = Command::new(&example).output();
    let output = output.unwrap_or_else(|error| panic!("{}: {error}", example.display()));
    assert!(output.status.success(), "{output:?}");
    let text = String::from_utf8(output.stdout).expect("text");
    let row = |line: &str| -> Vec<f64> {
        let words = line.split_whitespace();
        words.map(|word| word.parse().expect("a number")).collect()
    };
    text.lines().skip(1).map(row).collect()
}

/// Every load of the block passes the joint; the aperture stays positive and shrinks.
#[test]
fn the_first_joint_carries_its_load_and_closes() {
    let rows = table("first_joint");
    assert_eq!(rows.len(), 4);
    for row in &rows {
        assert!(
            (row[2] + 20.0 * row[0]).abs() < 0.011,
            "equilibrium: {row:?}"
        );
    }
    let closes = |pair: &[Vec<f64>]| 0.0 < pair[1][1] && pair[1][1] < pair[0][1];
    assert!(rows.windows(2).all(closes), "{rows:?}");
}

/// A stiffer joint closes less.
#[test]
fn a_sweep_of_stiffness_opens_the_joint() {
    let rows = table("sweep_stiffness");
    assert_eq!(rows.len(), 5);
    assert!(
        rows.windows(2).all(|pair| pair[0][2] < pair[1][2]),
        "{rows:?}"
    );
}

/// Rock without a Poisson effect passes the pressure on, so the law alone gives the aperture.
#[test]
fn a_law_of_ones_own_meets_its_closed_form() {
    let rows = table("own_law");
    assert_eq!(rows.len(), 4);
    for row in rows {
        assert!((row[1] - row[2]).abs() <= 2e-7 * row[2] + 1e-7, "{row:?}");
    }
}
