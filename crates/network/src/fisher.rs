//! Fisher's distribution of directions on the sphere.

use std::f64::consts::PI;

use glam::DVec3;
use kluft_mesh::Orientation;

use crate::random::Stream;

/// Directions around a mean (Fisher 1953); here the poles of fractures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fisher {
    /// Mean orientation.
    pub mean: Orientation,
    /// Concentration: 0 is uniform over the sphere; large values crowd around the mean.
    pub kappa: f64,
}

impl Fisher {
    /// Draws a pole, a unit vector that may point down.
    pub fn draw(&self, stream: &mut Stream) -> DVec3 {
        let cos = self.cos_of(stream.uniform());
        let sin = (1.0 - cos * cos).max(0.0).sqrt();
        let (across, along) = libm::sincos(2.0 * PI * stream.uniform());
        let (strike, fall) = self.mean.strike_and_fall();
        (cos * self.mean.pole() + sin * (along * strike + across * fall)).normalize()
    }

    /// Cosine of the angle to the mean that a part `u` of all directions exceeds.
    fn cos_of(&self, u: f64) -> f64 {
        if self.kappa < 1e-6 {
            return 1.0 - 2.0 * u;
        }
        // 1 + ln(1 - u + u exp(-2 kappa)) / kappa, without the rounding of 1 - u near u = 0.
        let part = u * libm::expm1(-2.0 * self.kappa);
        (1.0 + libm::log1p(part) / self.kappa).max(-1.0)
    }

    /// Mean direction and concentration of drawn poles. The concentration has the largest
    /// likelihood, times `(n - 1)/n` against its bias; for large ones that is `(n - 1)/(n - R)`
    /// with the resultant `R`. It is infinite for fewer than two poles, or poles all alike.
    pub fn estimate(poles: &[DVec3]) -> Self {
        let resultant: DVec3 = poles.iter().sum();
        let count = poles.len() as f64;
        let likeliest = concentration(resultant.length() / count.max(1.0));
        let is_sample = poles.len() > 1;
        Self {
            mean: Orientation::of_normal(resultant.normalize_or(DVec3::Z)),
            kappa: if is_sample {
                likeliest * (count - 1.0) / count
            } else {
                f64::INFINITY
            },
        }
    }
}

/// The concentration at which the mean resultant `coth k - 1/k` is `length`; infinite above 1e9.
fn concentration(length: f64) -> f64 {
    // Below 1e-3 the difference is rounding, and the series is exact.
    let resultant = |k: f64| {
        if k < 1e-3 {
            k / 3.0
        } else {
            1.0 / libm::tanh(k) - 1.0 / k
        }
    };
    let (mut low, mut high) = (0.0, 1e9);
    if resultant(high) <= length {
        return f64::INFINITY;
    }
    for _ in 0..200 {
        let middle = (low + high) / 2.0;
        if resultant(middle) < length {
            low = middle;
        } else {
            high = middle;
        }
    }
    (low + high) / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn poles(fisher: &Fisher, count: usize) -> Vec<DVec3> {
        let mut stream = Stream::new(3, "fisher");
        (0..count).map(|_| fisher.draw(&mut stream)).collect()
    }

    #[test]
    fn mean_and_concentration_are_recovered() {
        for kappa in [2.0, 20.0, 300.0] {
            let mean = Orientation {
                dip: 65.0,
                dip_direction: 130.0,
            };
            let fisher = Fisher { mean, kappa };
            let count = 20_000;
            let found = Fisher::estimate(&poles(&fisher, count));
            // Standard errors: 1 / sqrt(n A') with A = coth k - 1/k, and 1 / sqrt(n k A) an axis.
            let root = (count as f64).sqrt();
            let slope = kappa.powi(-2) - libm::sinh(kappa).powi(-2);
            assert!(
                (found.kappa - kappa).abs() < 4.0 / (root * slope.sqrt()),
                "{found:?}"
            );
            let off = found.mean.pole().angle_between(mean.pole());
            let resultant = 1.0 / libm::tanh(kappa) - 1.0 / kappa;
            assert!(off < 4.0 / (root * (kappa * resultant).sqrt()), "{off}");
        }
    }

    #[test]
    fn no_concentration_is_uniform_over_the_sphere() {
        let mean = Orientation {
            dip: 20.0,
            dip_direction: 300.0,
        };
        let drawn = poles(&Fisher { mean, kappa: 0.0 }, 20_000);
        let middle = drawn.iter().sum::<DVec3>() / drawn.len() as f64;
        assert!(middle.length() < 4.0 / (3.0 * drawn.len() as f64 / 3.0).sqrt());
        assert!(drawn.iter().all(|pole| (pole.length() - 1.0).abs() < 1e-12));
    }

    #[test]
    fn one_pole_has_no_measurable_concentration() {
        assert_eq!(Fisher::estimate(&[DVec3::Z]).kappa, f64::INFINITY);
        assert_eq!(Fisher::estimate(&[]).kappa, f64::INFINITY);
    }
}
