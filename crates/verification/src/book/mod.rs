//! The verification book: real runs beside closed forms, a page for each benchmark.
//!
//! A new page is a file here and an entry of [`report`].

mod adaptive;
mod barton_bandis;
mod estimate;
mod inclined_crack;
mod inclined_penny;
mod joint_sets;
mod line_crack;
mod log_law;
mod oscillation;
mod patch_test;
mod paths;
mod penny;
mod scene;
mod single_joint;
mod spherical_joint;

use kluft_chart::{Axis, Chart, Series};

use crate::report::{Finding, Layout, Report};

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

impl Finding {
    /// Adds the closed form and its source; results follow.
    fn closed_form(self, closed_form: &str, source: &str) -> Self {
        self.heading("Closed form")
            .text(closed_form)
            .text(format!("Source: {source}."))
            .heading("Result")
    }

    /// Adds what the results show.
    fn shows(self, text: impl Into<String>) -> Self {
        self.heading("What it shows").text(text)
    }
}

/// Errors of something over the unknowns, a line for each family of meshes.
pub fn error_chart(body: &str, what: &str, families: impl Iterator<Item = Series>) -> Chart {
    Chart {
        series: families.collect(),
        ..Chart::new(
            format!("{body}: error of the {what}"),
            Axis::logarithmic("unknowns"),
            Axis::logarithmic(format!("error of the {what} (relative)")),
        )
    }
}

/// `sqrt(1 - x^2)` times a height, dense where it is steep.
pub fn half_circle(height: f64) -> Vec<(f64, f64)> {
    let angles = (0..=40).map(|i| f64::from(i) * std::f64::consts::FRAC_PI_2 / 40.0);
    let points = angles.map(|angle| (angle.sin(), height * angle.cos().max(0.0)));
    points.collect()
}
