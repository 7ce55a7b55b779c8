//! Laws of fracture sizes. The size is the radius of a disc, half the length of a rectangle.

use std::f64::consts::SQRT_2;

use crate::random::Stream;
use crate::statistics::Moments;

/// How sizes (m) are distributed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SizeLaw {
    /// All alike.
    Constant {
        /// The size (m).
        radius: f64,
    },
    /// Density proportional to `size^-exponent` between two bounds.
    PowerLaw {
        /// Exponent of the density.
        exponent: f64,
        /// Smallest size (m).
        min: f64,
        /// Largest size (m).
        max: f64,
    },
    /// The logarithm is normal; sizes out of bounds are drawn again.
    Lognormal {
        /// Mean without the bounds (m).
        mean: f64,
        /// Standard deviation without the bounds (m).
        sd: f64,
        /// Smallest size (m).
        min: f64,
        /// Largest size (m).
        max: f64,
    },
}

impl SizeLaw {
    /// Draws a size (m).
    pub fn draw(&self, stream: &mut Stream) -> f64 {
        match *self {
            SizeLaw::Constant { radius } => radius,
            SizeLaw::PowerLaw { exponent, min, max } => {
                power_quantile(exponent, min, max, stream.uniform())
            }
            SizeLaw::Lognormal { mean, sd, min, max } => loop {
                let (location, scale) = logarithmic(mean, sd);
                let size = libm::exp(location + scale * stream.normal());
                if (min..=max).contains(&size) {
                    return size;
                }
            },
        }
    }

    /// Largest possible size (m).
    pub fn largest(&self) -> f64 {
        match *self {
            SizeLaw::Constant { radius } => radius,
            SizeLaw::PowerLaw { max, .. } | SizeLaw::Lognormal { max, .. } => max,
        }
    }

    /// Smallest possible size (m).
    pub fn smallest(&self) -> f64 {
        match *self {
            SizeLaw::Constant { radius } => radius,
            SizeLaw::PowerLaw { min, .. } | SizeLaw::Lognormal { min, .. } => min,
        }
    }

    /// Mean of `size^power`, bounds included.
    pub fn moment(&self, power: f64) -> f64 {
        match *self {
            SizeLaw::Constant { radius } => libm::pow(radius, power),
            SizeLaw::PowerLaw { exponent, min, max } => {
                integral(power - exponent, min, max) / integral(-exponent, min, max)
            }
            SizeLaw::Lognormal { mean, sd, min, max } => {
                let (location, scale) = logarithmic(mean, sd);
                let whole = libm::exp(power * location + (power * scale).powi(2) / 2.0);
                let within = |shift: f64| {
                    let z = |size: f64| (libm::log(size) - location) / scale - shift;
                    phi(z(max)) - phi(z(min))
                };
                whole * within(power * scale) / within(0.0)
            }
        }
    }

    /// Part of all sizes that fall between the bounds of a lognormal law; 1 for the others.
    pub fn accepted(&self) -> f64 {
        let SizeLaw::Lognormal { mean, sd, min, max } = *self else {
            return 1.0;
        };
        let (location, scale) = logarithmic(mean, sd);
        let z = |size: f64| (libm::log(size) - location) / scale;
        phi(z(max)) - phi(z(min))
    }

    /// Mean and standard deviation (m), bounds included.
    pub fn moments(&self) -> Moments {
        let mean = self.moment(1.0);
        let variance = self.moment(2.0) - mean * mean;
        Moments {
            mean,
            sd: variance.max(0.0).sqrt(),
        }
    }
}

/// Mean and standard deviation of the logarithm, from those of the size.
fn logarithmic(mean: f64, sd: f64) -> (f64, f64) {
    let variance = libm::log1p((sd / mean).powi(2));
    (libm::log(mean) - variance / 2.0, variance.sqrt())
}

/// The normal distribution function.
fn phi(z: f64) -> f64 {
    libm::erfc(-z / SQRT_2) / 2.0
}

/// Integral of `x^power` from `min` to `max`.
fn integral(power: f64, min: f64, max: f64) -> f64 {
    let above = power + 1.0;
    let logarithm = libm::log(max / min);
    if (above * logarithm).abs() < 1e-8 {
        return logarithm * libm::pow(min, above);
    }
    libm::pow(min, above) * libm::expm1(above * logarithm) / above
}

/// The size below which a part `u` of a power law lies.
fn power_quantile(exponent: f64, min: f64, max: f64, u: f64) -> f64 {
    let above = 1.0 - exponent;
    let logarithm = libm::log(max / min);
    if (above * logarithm).abs() < 1e-8 {
        return min * libm::exp(u * logarithm);
    }
    min * libm::exp(libm::log1p(u * libm::expm1(above * logarithm)) / above)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::moments;

    const LAWS: [SizeLaw; 6] = [
        SizeLaw::Constant { radius: 2.0 },
        SizeLaw::PowerLaw {
            exponent: 2.5,
            min: 0.5,
            max: 8.0,
        },
        SizeLaw::PowerLaw {
            exponent: 1.0,
            min: 0.5,
            max: 8.0,
        },
        SizeLaw::PowerLaw {
            exponent: 3.0,
            min: 1.0,
            max: 2.0,
        },
        SizeLaw::Lognormal {
            mean: 2.0,
            sd: 1.0,
            min: 0.01,
            max: 100.0,
        },
        SizeLaw::Lognormal {
            mean: 2.0,
            sd: 1.0,
            min: 1.0,
            max: 3.0,
        },
    ];

    #[test]
    fn drawn_sizes_have_the_moments_of_their_law() {
        for law in LAWS {
            let mut stream = Stream::new(5, "sizes");
            let count = 100_000;
            let sizes: Vec<f64> = (0..count).map(|_| law.draw(&mut stream)).collect();
            let (asked, found) = (law.moments(), moments(&sizes));
            let error = asked.sd / f64::from(count).sqrt();
            assert!(
                (found.mean - asked.mean).abs() <= 4.0 * error + 1e-12,
                "{law:?} {found:?}"
            );
            assert!(
                (found.sd / asked.sd.max(1e-300) - 1.0).abs() < 0.03 || asked.sd < 1e-9,
                "{law:?} {found:?}"
            );
            assert!(sizes.iter().all(|&size| size <= law.largest()));
        }
    }

    #[test]
    fn moments_by_hand() {
        // x^-3 between 1 and 2: mean (1 - 1/2) / (3/8) = 4/3, second moment ln 2 / (3/8).
        let law = SizeLaw::PowerLaw {
            exponent: 3.0,
            min: 1.0,
            max: 2.0,
        };
        assert!((law.moment(1.0) - 4.0 / 3.0).abs() < 1e-12);
        assert!((law.moment(2.0) - 2.0_f64.ln() * 8.0 / 3.0).abs() < 1e-12);
        let wide = SizeLaw::Lognormal {
            mean: 2.0,
            sd: 1.0,
            min: 1e-9,
            max: 1e9,
        };
        assert!((wide.moments().mean - 2.0).abs() < 1e-9 && (wide.moments().sd - 1.0).abs() < 1e-9);
    }
}
