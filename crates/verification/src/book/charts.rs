//! Charts that several pages have.

use kluft_chart::{Axis, Chart, Series};

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
