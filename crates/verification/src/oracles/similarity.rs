//! A joint of any law that fills from its end: `b_t = (k(b) b_x)_x` with `k = b^3 p'(b) / (12 mu)`
//! between rigid blocks under a constant normal stress. Apertures depend on `xi = x / sqrt(t)` only
//! (Wijesinghe 1986):
//!
//! ```text
//! k(b) b' = F,    F' = -xi b' / 2,    b(0) = b_in,    b(inf) = b_far
//! ```
//!
//! by the classical method of Runge and Kutta, with the flux `F(0)` by bisection.

/// Steps between the end and where nothing has arrived.
const STEPS: usize = 4000;

/// How a joint fills.
pub struct Filling {
    /// `xi` (m / sqrt(s)) between the values of `apertures`.
    step: f64,
    /// Apertures (m).
    apertures: Vec<f64>,
    /// What enters times the root of the time (m^2 / sqrt(s)) for each metre of width.
    pub inflow: f64,
}

impl Filling {
    /// Of a joint with this `k` (m^2/s) by its aperture (m), from one aperture at its end to
    /// another, smaller one far away.
    pub fn of(k: impl Fn(f64) -> f64, [within, far]: [f64; 2]) -> Self {
        let reach = 14.0 * k(within).sqrt();
        let step = reach / STEPS as f64;
        let (mut low, mut high) = (0.0, 4.0 * k(within).sqrt() * (within - far));
        for _ in 0..100 {
            let inflow = 0.5 * (low + high);
            match profile(&k, [within, far], inflow, step).last() {
                Some(&last) if last > far => low = inflow,
                _ => high = inflow,
            }
        }
        Self {
            step,
            apertures: profile(&k, [within, far], low, step),
            inflow: low,
        }
    }

    /// Aperture (m) at `x` (m) and `t` (s).
    pub fn aperture(&self, x: f64, t: f64) -> f64 {
        let place = x / t.sqrt() / self.step;
        let last = self.apertures.len() - 1;
        let index = (place as usize).min(last - 1);
        let share = (place - index as f64).min(1.0);
        (1.0 - share) * self.apertures[index] + share * self.apertures[index + 1]
    }

    /// What has entered by the time `t` (s), for each metre of width (m^2).
    pub fn entered(&self, t: f64) -> f64 {
        2.0 * self.inflow * t.sqrt()
    }
}

/// Apertures from the end on, up to the first that is too small.
fn profile(k: &impl Fn(f64) -> f64, [within, far]: [f64; 2], inflow: f64, step: f64) -> Vec<f64> {
    let slope = |xi: f64, [b, flux]: [f64; 2]| {
        let db = flux / k(b);
        [db, -0.5 * xi * db]
    };
    let mut at = [within, -inflow];
    let mut apertures = vec![within];
    for index in 0..STEPS {
        let xi = index as f64 * step;
        let moved = |by: [f64; 2], share: f64| [0, 1].map(|i| at[i] + share * step * by[i]);
        let first = slope(xi, at);
        let second = slope(xi + 0.5 * step, moved(first, 0.5));
        let third = slope(xi + 0.5 * step, moved(second, 0.5));
        let fourth = slope(xi + step, moved(third, 1.0));
        let mean = [0, 1].map(|i| (first[i] + 2.0 * (second[i] + third[i]) + fourth[i]) / 6.0);
        at = moved(mean, 1.0);
        apertures.push(at[0]);
        if at[0] < far {
            break;
        }
    }
    apertures
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers of another computation, whose volumes balance to 1e-9.
    #[test]
    fn a_linear_joint_fills_as_it_should() {
        let filling = Filling::of(|b| b.powi(3) * 1e11 / 12e-3, [1.9e-5, 1e-5]);
        let is_close = |found: f64, expected: f64| {
            assert!((found / expected - 1.0).abs() < 2e-6, "{found} {expected}");
        };
        is_close(filling.inflow, 1.023_310 * 1e-5 * 8.333_333e-3_f64.sqrt());
        is_close(filling.entered(500.0), 4.177_646e-5);
        for (x, b) in [
            (0.5, 1.812_777e-5),
            (2.0, 1.475_684e-5),
            (4.0, 1.034_303e-5),
        ] {
            is_close(filling.aperture(x, 100.0), b);
        }
    }
}
