//! The stability map: parameters swept over many decades beside methods that break, one study a
//! file.
//!
//! A new study is a file here, an entry of [`report`] and a test in `tests/physics/stability.rs`.

mod blocks;
pub mod contact;
pub mod contrast;
mod counts;
pub mod coupled_flow;
mod coupled_linear;
mod coupled_steps;
mod coupled_sweeps;
mod coupled_walks;
pub mod cutoff;
pub mod cycles;
pub mod flow;
pub mod front;
pub mod hopeless;
pub mod increments;
pub mod locking;
pub mod opening;
pub mod sliding;
pub mod slivers;
pub mod steps;
pub mod units;

use crate::report::{Layout, Report};

use counts::{PROMISE, PROMISE_WITH_FRICTION};
pub use counts::{entry, most};

const HEAD: &str = "# Stability map

Written by `cargo run --release -p kluft-verification --bin verify -- stability`: every parameter is swept over \
many decades, beside a method that breaks, on small meshes and with default settings. Nothing here is typed in: \
numbers come from the run, and stand in `docs/verification/stability/*.csv`. Short forms of all studies are tests \
(`tests/physics/stability.rs`).";

/// All studies, in the order of the map.
pub fn report() -> Report {
    Report {
        name: "stability",
        head: HEAD,
        columns: &["study", "sweep", "what breaks", "Kluft"],
        studies: vec![
            cutoff::STUDY,
            contrast::STUDY,
            front::STUDY,
            increments::STUDY,
            contact::STUDY,
            opening::STUDY,
            sliding::STUDY,
            hopeless::STUDY,
            cycles::STUDY,
            locking::STUDY,
            slivers::STUDY,
            units::STUDY,
            steps::STUDY,
            flow::STUDY,
            coupled_flow::STUDY,
        ],
        layout: Layout::OnePage { promise: promise() },
    }
}

fn promise() -> String {
    format!(
        "Promised is: every case with a solution converges with default settings in at most \
         {PROMISE} Newton iterations a step, {PROMISE_WITH_FRICTION} with friction in each part \
         that it divides a step into; every case without one ends with exit code 1 and the name of \
         a fracture or block; and what the studies compare agrees as they say."
    )
}
