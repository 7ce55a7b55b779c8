//! What finer and finer meshes approach, and how fast (Richardson extrapolation).

/// Rates that are looked for; what converges faster or slower does neither visibly.
const RATES: (f64, f64) = (0.05, 20.0);

/// Values that differ by less, as a share, are the same but for rounding.
const SAME: f64 = 1e-9;

/// What values on finer and finer meshes approach.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Limit {
    /// The extrapolated value; that of the finest mesh if there is no rate.
    pub(super) value: f64,
    /// The extrapolation's distance from the value on the finest mesh. If there is no rate, the
    /// distance between the largest and the smallest of the values if they swing, and infinity if
    /// they drift.
    pub(super) uncertainty: f64,
    /// Observed rate `p` of `value + C size^p`; none if the differences do not shrink as they
    /// would.
    pub(super) rate: Option<f64>,
}

/// The limit of values on the three finest of some meshes, each given by the size of its cells and
/// the value; none of fewer than three sizes. A rate above `most` is observed, but not believed:
/// the extrapolation goes further with `most`, and so does its uncertainty.
///
/// With `f_i = f + C s_i^p` on the sizes `s_1 > s_2 > s_3`, the rate solves
/// `(f_1 - f_2) / (f_2 - f_3) = (s_1^p - s_2^p) / (s_2^p - s_3^p)`, and
/// `f = f_3 + (f_3 - f_2) s_3^p / (s_2^p - s_3^p)` (Roache 1994, for refinements that differ).
pub(super) fn limit(values: &[(f64, f64)], most: f64) -> Option<Limit> {
    let mut values: Vec<(f64, f64)> = values.to_vec();
    values.retain(|(size, value)| size.is_finite() && value.is_finite() && *size > 0.0);
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    values.dedup_by(|a, b| a.0 == b.0);
    let &[(s3, f3), (s2, f2), (s1, f1)] = values.first_chunk()?;
    let (sizes, ratio) = ((s1 / s3, s2 / s3), (f1 - f2) / (f2 - f3));
    let rate = rate(sizes, ratio);
    // Differences that do not shrink say nothing of the limit.
    let drifts = ratio > 0.0 && ratio < ratio_at(sizes, RATES.0);
    let spread = f1.max(f2).max(f3) - f1.min(f2).min(f3);
    let beyond = |rate: f64| (f3 - f2) / ((s2 / s3).powf(rate.min(most)) - 1.0);
    Some(match rate.map(beyond).filter(|beyond| beyond.is_finite()) {
        Some(beyond) => Limit {
            value: f3 + beyond,
            uncertainty: beyond.abs(),
            rate,
        },
        None => Limit {
            value: f3,
            uncertainty: match drifts && spread > SAME * f3.abs() {
                true => f64::INFINITY,
                false => spread,
            },
            rate: None,
        },
    })
}

/// Ratio of the differences between three values at a rate; it grows with the rate. Sizes are those
/// of the coarse and the middle mesh in units of the finest.
fn ratio_at((coarse, middle): (f64, f64), rate: f64) -> f64 {
    (coarse.powf(rate) - middle.powf(rate)) / (middle.powf(rate) - 1.0)
}

/// The rate at which the differences between three values have a ratio.
fn rate(sizes: (f64, f64), ratio: f64) -> Option<f64> {
    let (mut low, mut high) = RATES;
    if !(ratio_at(sizes, low) <= ratio && ratio <= ratio_at(sizes, high)) {
        return None;
    }
    for _ in 0..100 {
        let half = f64::midpoint(low, high);
        match ratio_at(sizes, half) < ratio {
            true => low = half,
            false => high = half,
        }
    }
    Some(f64::midpoint(low, high))
}

/// Slope of `log y` over `log x` by least squares through the three last points; none of fewer than
/// two, or of values that are not positive.
pub(super) fn slope(points: &[(f64, f64)]) -> Option<f64> {
    let last = &points[points.len().saturating_sub(3)..];
    let logs: Vec<(f64, f64)> = last.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    let mean = |of: fn(&(f64, f64)) -> f64| logs.iter().map(of).sum::<f64>() / logs.len() as f64;
    let (x, y) = (mean(|log| log.0), mean(|log| log.1));
    let sum = |of: &dyn Fn(&(f64, f64)) -> f64| logs.iter().map(of).sum::<f64>();
    let across = sum(&|log| (log.0 - x) * (log.0 - x));
    let slope = sum(&|log| (log.0 - x) * (log.1 - y)) / across;
    (logs.len() > 1 && across > 0.0 && slope.is_finite()).then_some(slope)
}

/// `a` and `b`, neither of them negative, of `y = a + b x` by least squares; none without points.
pub(super) fn proportion(points: &[(f64, f64)]) -> Option<(f64, f64)> {
    let count = points.len() as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / count;
    let (x, y) = (mean(|point| point.0), mean(|point| point.1));
    let across: f64 = points.iter().map(|point| (point.0 - x).powi(2)).sum();
    let along: f64 = points
        .iter()
        .map(|point| (point.0 - x) * (point.1 - y))
        .sum();
    let each = along / across;
    match points {
        [] => None,
        _ if !(each.is_finite() && each >= 0.0) => Some((y, 0.0)),
        _ if y < each * x => Some((0.0, y / x)),
        _ => Some((y - each * x, each)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: f64, b: f64, share: f64) {
        assert!((a - b).abs() <= share * b.abs(), "{a} is not {b}");
    }

    /// Values of a closed form `f + C s^p` on some sizes.
    fn series(sizes: &[f64], rate: f64) -> Vec<(f64, f64)> {
        sizes
            .iter()
            .map(|&s| (s, 3.0 - 0.7 * s.powf(rate)))
            .collect()
    }

    #[test]
    fn powers_of_the_size_are_extrapolated_exactly() {
        for rate in [0.5, 1.0, 2.0, 3.3] {
            for sizes in [[0.4, 0.2, 0.1], [0.5, 0.31, 0.1], [0.1, 0.11, 0.13]] {
                let limit = limit(&series(&sizes, rate), 4.0).expect("a limit");
                close(limit.value, 3.0, 1e-10);
                close(limit.rate.expect("a rate"), rate, 1e-8);
                let finest = sizes.iter().copied().fold(f64::INFINITY, f64::min);
                close(limit.uncertainty, 0.7 * finest.powf(rate), 1e-8);
            }
        }
    }

    #[test]
    fn only_the_three_finest_count() {
        let mut values = series(&[0.05, 0.2, 0.1], 1.0);
        values.push((0.9, -55.0));
        close(limit(&values, 4.0).expect("a limit").value, 3.0, 1e-10);
    }

    #[test]
    fn three_different_meshes_are_needed() {
        assert_eq!(limit(&series(&[0.2, 0.1], 1.0), 4.0), None);
        assert_eq!(limit(&series(&[0.2, 0.1, 0.1], 1.0), 4.0), None);
        assert_eq!(limit(&[(0.4, 1.0), (0.2, f64::NAN), (0.1, 1.0)], 4.0), None);
    }

    #[test]
    fn rates_that_are_too_good_make_the_limit_less_certain() {
        let lucky = limit(&series(&[0.4, 0.2, 0.1], 6.0), 2.0).expect("a limit");
        close(lucky.rate.expect("a rate"), 6.0, 1e-8);
        let last = 0.7 * (0.2_f64.powi(6) - 0.1_f64.powi(6));
        close(lucky.uncertainty, last / 3.0, 1e-8);
        assert!(
            (lucky.value - 3.0).abs() < lucky.uncertainty,
            "it covers the limit"
        );
    }

    #[test]
    fn values_that_swing_have_no_rate_but_an_uncertainty() {
        for values in [
            [1.0, 2.0, 1.5],
            [1.0, 1.0, 1.0],
            [1.0, 1.0 + 1e-15, 1.0 + 3e-15],
        ] {
            let [coarse, middle, fine] = values;
            let limit = limit(&[(0.4, coarse), (0.2, middle), (0.1, fine)], 4.0);
            let limit = limit.expect("a limit");
            assert_eq!((limit.rate, limit.value), (None, fine));
            let spread = values
                .map(|value| value - 1.0)
                .into_iter()
                .fold(0.0, f64::max);
            assert_eq!(limit.uncertainty, spread);
        }
    }

    #[test]
    fn nothing_is_known_of_the_limit_of_a_drift() {
        for fine in [1.2, 2.0] {
            let limit = limit(&[(0.4, 1.0), (0.2, 1.1), (0.1, fine)], 4.0).expect("a limit");
            assert_eq!((limit.rate, limit.uncertainty), (None, f64::INFINITY));
        }
    }

    #[test]
    fn slopes_are_those_of_the_last_three_points() {
        let mut points: Vec<(f64, f64)> = vec![(1.0, 1e9)];
        points.extend([1e2_f64, 1e3, 2e4].map(|n| (n, 5.0 * n.powf(-2.0 / 3.0))));
        close(slope(&points).expect("a slope"), -2.0 / 3.0, 1e-12);
        assert_eq!(slope(&points[..1]), None);
        assert_eq!(slope(&[(1.0, 0.0), (2.0, 1.0)]), None);
        assert_eq!(slope(&[(1.0, 1.0), (1.0, 2.0)]), None);
    }

    #[test]
    fn proportions_are_not_negative() {
        assert_eq!(proportion(&[]), None);
        assert_eq!(proportion(&[(2.0, 3.0)]), Some((3.0, 0.0)));
        assert_eq!(proportion(&[(1.0, 3.0), (3.0, 7.0)]), Some((1.0, 2.0)));
        assert_eq!(proportion(&[(1.0, 7.0), (3.0, 3.0)]), Some((5.0, 0.0)));
        assert_eq!(proportion(&[(1.0, 0.0), (3.0, 8.0)]), Some((0.0, 2.0)));
    }
}
