//! Numbers in words.

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

/// Where a curve through points on two logarithmic axes reaches `y`: between two points that
/// enclose it, else continued from the two nearest; and whether it was continued.
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

/// The largest of some numbers; not a number if one of them is not.
pub fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    let larger = |most: f64, value: f64| {
        if most.is_nan() || most >= value {
            most
        } else {
            value
        }
    };
    values.into_iter().fold(0.0, larger)
}
