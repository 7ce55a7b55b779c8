//! The verification book: real runs beside closed forms, a page for each benchmark.
//!
//! A new page is a file here and an entry of [`report`].

mod adaptive;
mod barton_bandis;
mod charts;
mod estimate;
mod inclined_crack;
mod inclined_penny;
mod joint_sets;
mod line_crack;
mod log_law;
mod oscillation;
mod parts;
mod patch_test;
mod paths;
mod penny;
mod scene;
mod single_joint;
mod spherical_joint;

use crate::report::{Layout, Report};

const HEAD: &str = "# Verification book

Written by `cargo run --release -p kluft-verification --bin verify -- book`: every benchmark is a real run beside \
a closed form that knows nothing of the program. Nothing here is typed in; all numbers of a page stand in its CSV \
files. Errors are relative.";

/// All benchmarks, in the order of the book.
pub fn report() -> Report {
    Report {
        name: "book",
        head: HEAD,
        columns: &[
            "benchmark",
            "oracle",
            "error reached",
            "most unknowns",
            "time of the page",
        ],
        studies: vec![
            penny::PAGE,
            adaptive::PAGE,
            line_crack::PAGE,
            inclined_crack::PAGE,
            inclined_penny::PAGE,
            single_joint::PAGE,
            log_law::PAGE,
            patch_test::PAGE,
            joint_sets::PAGE,
            spherical_joint::PAGE,
            oscillation::PAGE,
            paths::PAGE,
            barton_bandis::PAGE,
            estimate::PAGE,
        ],
        layout: Layout::PageEach,
    }
}
