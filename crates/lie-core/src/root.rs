//! The root of a function that grows.

/// Evaluations after which the bracket is taken as it is.
const MOST: usize = 200;

/// Root of a growing function that is negative at 0 and positive from `high` on.
pub(crate) fn root(function: impl Fn(f64) -> f64, high: f64) -> f64 {
    let (mut low, mut high) = (0.0, high);
    let (mut at_low, mut at_high) = (function(low), function(high));
    for _ in 0..MOST {
        if at_high <= 0.0 || high - low <= 4.0 * f64::EPSILON * high {
            break;
        }
        // Illinois: the secant, with the value of an end that stays halved.
        let secant = low - at_low * (high - low) / (at_high - at_low);
        let x = if secant > low && secant < high {
            secant
        } else {
            0.5 * (low + high)
        };
        let at_x = function(x);
        if at_x == 0.0 {
            return x;
        }
        if at_x > 0.0 {
            (high, at_high) = (x, at_x);
            at_low *= 0.5;
        } else {
            (low, at_low) = (x, at_x);
            at_high *= 0.5;
        }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_of_smooth_and_kinked_functions() {
        let at = 0.3_f64;
        let functions: [&dyn Fn(f64) -> f64; 3] = [
            &|x| x * x * x - at * at * at,
            &|x| if x < at { x - at } else { 1e9 * (x - at) },
            &|x| x - at,
        ];
        for function in functions {
            assert!((root(function, 1.0) - at).abs() < 1e-14);
        }
    }
}
