//! The soak: random and damaged input, runs that are killed, race and find the disk full; how they
//! end is counted.
//!
//! A new suite is a file here, a row of [`ALL`] and a test.

mod asked;
mod damage;
pub mod disks;
mod folder;
mod kept_ends;
pub mod kills;
mod material;
pub mod materials;
mod meshes;
pub mod mutated_meshes;
pub mod mutated_scenes;
pub mod networks;
mod program;
pub mod races;
mod random_stream;
mod records;
mod solve;
mod tally;
mod workers;

pub use asked::Asked;

use crate::report::{Finding, Layout, Report, Study};

const HEAD: &str = "# Soak

Written by `cargo run --release -p kluft-verification --bin verify -- soak`: what comes of random and damaged input, \
and of runs that are killed, race for a folder or find the disk full. Nothing here is typed in. A case is seen again \
by `verify soak --only SUITE --seed SEED --case CASE`, which leaves its input in `target/verification/soak/kept`. \
Short forms of all suites are tests (`crates/verification/tests`, `tests/program/soak.rs`).";

const PROMISE: &str = "Promised is: no panic, no abort, no hang; exit codes 0, 1 and 2 only; one \
    answer whatever the linear solver and the number of load steps, or a run that says that the \
    state is not unique; no file lost or mixed, and no process left behind.";

/// A suite: a study whose cases one may choose.
pub struct Suite {
    /// The study with its usual cases.
    pub study: Study,
    /// Runs the cases that are asked for.
    pub run: fn(&Asked) -> Finding,
}

const fn suite(study: Study, run: fn(&Asked) -> Finding) -> Suite {
    Suite { study, run }
}

/// All suites, in the order of the page.
pub const ALL: [Suite; 7] = [
    suite(materials::STUDY, materials::run),
    suite(networks::STUDY, networks::run),
    suite(mutated_scenes::STUDY, mutated_scenes::run),
    suite(mutated_meshes::STUDY, mutated_meshes::run),
    suite(kills::STUDY, kills::run),
    suite(races::STUDY, races::run),
    suite(disks::STUDY, disks::run),
];

/// All suites as studies with their usual cases.
pub fn report() -> Report {
    Report {
        name: "soak",
        head: HEAD,
        columns: &[
            "suite",
            "what is tried",
            "cases",
            "outcomes",
            "did not hold",
        ],
        studies: ALL.iter().map(|suite| suite.study).collect(),
        layout: Layout::OnePage {
            promise: PROMISE.to_owned(),
        },
    }
}
