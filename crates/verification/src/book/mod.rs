//! The verification book: real runs beside closed forms, a page for each benchmark that no study of
//! a scene can say; those that one can stand in `docs/verification/studies.md`.
//!
//! A new page is a file here and an entry of [`report`].

mod bedded_tunnel;
mod estimate;
mod excavation;
mod factor_of_safety;
mod filled_penny;
mod filling_joint;
mod joint_sets;
mod leak_off;
mod line_source;
mod opened_channel;
mod oscillation;
mod parts;
mod patch_test;
mod paths;
mod periodic_pressure;
mod periodic_source;
mod permeability;
mod plane_cracks;
mod pressure_step;
mod pressurised_fault;
mod radial_flow;
mod refinement;
mod scene;
mod steady_flow;
mod varying_values;

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
            patch_test::PAGE,
            joint_sets::PAGE,
            oscillation::PAGE,
            plane_cracks::PAGE,
            bedded_tunnel::PAGE,
            varying_values::PAGE,
            excavation::PAGE,
            factor_of_safety::PAGE,
            paths::PAGE,
            estimate::PAGE,
            steady_flow::PAGE,
            permeability::PAGE,
            radial_flow::PAGE,
            opened_channel::PAGE,
            pressure_step::PAGE,
            leak_off::PAGE,
            periodic_pressure::PAGE,
            line_source::PAGE,
            periodic_source::PAGE,
            filling_joint::PAGE,
            filled_penny::PAGE,
            pressurised_fault::PAGE,
        ],
        layout: Layout::PageEach,
    }
}
