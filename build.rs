//! Notes the commit that a release is built from, for `summary.json` and `report.html`.
//!
//! Other builds are not for results that outlast them, and would be made anew after each commit.

use std::process::Command;

/// Names the commit where there is no repository, or overrides it.
const GIVEN: &str = "KLUFT_COMMIT";

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed={GIVEN}");
    let is_release = std::env::var("PROFILE").is_ok_and(|profile| profile == "release");
    let given = std::env::var(GIVEN)
        .ok()
        .filter(|commit| !commit.is_empty());
    if given.is_none() && is_release {
        // Whatever else lies in the folder is no part of the program.
        for path in ["src", "crates", "Cargo.lock"] {
            println!("cargo::rerun-if-changed={path}");
        }
        if let Some(head) = git(&["rev-parse", "--git-path", "logs/HEAD"]) {
            println!("cargo::rerun-if-changed={head}");
        }
    }
    if let Some(commit) = given.or_else(|| is_release.then(described).flatten()) {
        println!("cargo::rustc-env={GIVEN}={commit}");
    }
}

/// The commit, and whether files differ from it.
fn described() -> Option<String> {
    let commit = git(&["rev-parse", "--short=12", "HEAD"])?;
    let changes = git(&[
        "status",
        "--porcelain",
        "--untracked-files=no",
        "src",
        "crates",
    ])?;
    Some(match changes.is_empty() {
        true => commit,
        false => format!("{commit}-dirty"),
    })
}

fn git(arguments: &[&str]) -> Option<String> {
    let done = Command::new("git").args(arguments).output().ok()?;
    let said = String::from_utf8(done.stdout).ok()?;
    done.status.success().then(|| said.trim().to_owned())
}
