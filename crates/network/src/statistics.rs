//! Numbers that sum up many.

use serde::Serialize;

/// Mean and standard deviation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Moments {
    /// Mean.
    pub mean: f64,
    /// Standard deviation.
    pub sd: f64,
}

/// Moments of a sample; both 0 of an empty one, and the deviation 0 of a single value.
pub fn moments(values: &[f64]) -> Moments {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count.max(1.0);
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    Moments {
        mean,
        sd: (squares / (count - 1.0).max(1.0)).sqrt(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_of_small_samples() {
        assert_eq!(moments(&[]), Moments { mean: 0.0, sd: 0.0 });
        assert_eq!(moments(&[3.0]), Moments { mean: 3.0, sd: 0.0 });
        assert_eq!(
            moments(&[1.0, 3.0]),
            Moments {
                mean: 2.0,
                sd: 2.0_f64.sqrt()
            }
        );
    }
}
