//! The stability map: parameters swept over many decades beside methods that break; see README.md.
//!
//!     cargo bench --bench stability -- [--quick] [STUDY...]
//!
//! writes `docs/stability.md` and, for each study, its numbers and charts in `docs/stability`. With
//! `--quick` a few values only, into `target/stability`.
#![allow(clippy::print_stdout, reason = "progress is what one waits for")]
#![allow(dead_code, reason = "the tests use more of the shared scenes")]

#[path = "../../tests/physics/closing.rs"]
mod closing;
#[path = "../../tests/physics/crack_front.rs"]
mod crack_front;
#[path = "../../tests/physics/dice.rs"]
mod dice;
#[path = "../../tests/physics/networks.rs"]
mod networks;
#[path = "../../tests/physics/oracles.rs"]
mod oracles;
mod page;
#[path = "../../tests/physics/scenes.rs"]
mod scenes;
#[path = "../../tests/physics/spherical_joint.rs"]
mod spherical_joint;
#[path = "../../tests/physics/split_nodes.rs"]
mod split_nodes;
mod studies;
#[path = "../../tests/physics/voigt.rs"]
mod voigt;

use page::Page;
use studies::{ALL, PROMISE, PROMISE_WITH_FRICTION};

const HEAD: &str = "# Stability map

Written by `cargo bench --bench stability`: every parameter is swept over many decades, beside a method that breaks,
on small meshes and with default settings. Nothing here is typed in: numbers come from the run, and stand in
`docs/stability/*.csv`. Short forms of all studies are tests (`tests/physics/stability.rs`).

";

fn map() -> Page<'static> {
    Page {
        name: "stability",
        head: HEAD,
        columns: ["what breaks", "Kluft"],
        studies: &ALL,
        tables: &[],
        promise: format!(
            "Promised is: every case with a solution converges with default settings in at most {PROMISE} Newton iterations \
             a step, {PROMISE_WITH_FRICTION} with friction in each part that it divides a step into; every case without one \
             ends with exit code 1 and the name of a fracture or block; and what the studies compare agrees as they say."
        ),
    }
}

fn main() {
    page::run(&map());
}
