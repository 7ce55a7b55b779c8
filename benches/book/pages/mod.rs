//! The pages of the verification book, one file each.
//!
//! A new page is a file here and an entry of [`ALL`].

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
mod single_joint;
mod spherical_joint;

use kluft_chart::{Axis, Chart, Series};

use crate::studies::Table;

/// A benchmark.
pub struct Page {
    /// Name on the command line and of its files.
    pub name: &'static str,
    /// Its heading.
    pub title: &'static str,
    /// Who derived the closed form.
    pub oracle: &'static str,
    /// The closed form.
    pub closed_form: &'static str,
    /// Runs it.
    pub run: fn() -> Found,
}

/// All benchmarks, in the order of the book.
pub const ALL: [Page; 14] = [
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
];

/// What a benchmark found.
pub struct Found {
    /// What was solved, with its numbers.
    pub problem: String,
    /// The error, in a few words.
    pub reached: String,
    /// Unknowns of the largest mesh.
    pub unknowns: usize,
    /// Tables by the names of their files.
    pub tables: Vec<(&'static str, Table)>,
    /// Charts by the names of their files.
    pub charts: Vec<(&'static str, Chart)>,
    /// What the numbers say.
    pub shows: String,
}

/// A share as a percentage of three digits.
pub fn percent(share: f64) -> String {
    format!("{} %", digits(100.0 * share))
}

/// A number of three digits; very small and very large ones with their power of ten.
pub fn digits(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let power = value.abs().log10().floor();
    if !(-3.0..6.0).contains(&power) {
        return format!("{value:.2e}");
    }
    format!("{value:.*}", (2.0 - power).max(0.0) as usize)
}

/// A number of unknowns, in words if there are many.
pub fn count(value: f64) -> String {
    match value {
        ..1e3 => format!("{value:.0}"),
        ..1e6 => format!("{} thousand", digits(1e-3 * value)),
        _ => format!("{} million", digits(1e-6 * value)),
    }
}

/// `p` of `y ~ x^p` between two points.
pub fn slope(from: (f64, f64), to: (f64, f64)) -> f64 {
    (to.1 / from.1).ln() / (to.0 / from.0).ln()
}

/// Where a curve through points on two logarithmic axes reaches `y`: between two points that enclose it, else
/// continued from the two nearest; and whether it was continued.
pub fn reaches(points: &[(f64, f64)], y: f64) -> (f64, bool) {
    let mut points = points.to_vec();
    // Two tolerances may lead to one mesh.
    points.dedup_by(|a, b| a.0 == b.0);
    let enclosing = points
        .windows(2)
        .find(|pair| pair[0].1 >= y && pair[1].1 <= y);
    let is_above = points.iter().all(|point| point.1 > y);
    let pair = enclosing.unwrap_or(if is_above {
        &points[points.len() - 2..]
    } else {
        &points[..2]
    });
    let power = slope(pair[0], pair[1]);
    let x = pair[1].0 * (y / pair[1].1).powf(1.0 / power);
    (x, enclosing.is_none())
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
