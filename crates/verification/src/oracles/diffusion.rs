//! Pressures that diffuse through a joint of constant diffusivity `D` (m^2/s): closed forms, their
//! integrals by the trapezoidal rule, which converges exponentially for what decays like these.

use std::f64::consts::PI;

/// `erfc(x)`, of an argument that is not negative: `2/pi int_0^inf exp(-x^2 (1 + t^2))/(1 + t^2)`
/// with `t = sinh s`.
fn erfc(x: f64) -> f64 {
    let integrand = |s: f64| (-(x * s.cosh()).powi(2)).exp() / s.cosh();
    2.0 / PI * trapezoidal(integrand)
}

/// `int_0^inf` of an even function that decays like an exponential at least.
fn trapezoidal(integrand: impl Fn(f64) -> f64) -> f64 {
    const STEP: f64 = 1.0 / 64.0;
    let terms = (1..64 * 45).map(|index| integrand(f64::from(index) * STEP));
    STEP * (0.5 * integrand(0.0) + terms.sum::<f64>())
}

/// Pressure over that at the end of a half space, at `x` (m) and time `t` (s) after it has risen.
pub fn half_space(diffusivity: f64, x: f64, t: f64) -> f64 {
    erfc(0.5 * x / (diffusivity * t).sqrt())
}

/// Odd numbers times `pi / 2`, with `(-1)^n`.
fn odd() -> impl Iterator<Item = (f64, f64)> {
    let sign = |n: u32| if n.is_multiple_of(2) { 1.0 } else { -1.0 };
    (0..200_u32).map(move |n| (sign(n), 0.5 * PI * f64::from(2 * n + 1)))
}

/// Pressure over that at the open end, at a share `x` of the way to a closed end and the time
/// `D t / L^2`.
pub fn to_closed_end(x: f64, time: f64) -> f64 {
    let terms =
        odd().map(|(sign, k)| 2.0 * sign / k * (-k * k * time).exp() * (k * (1.0 - x)).cos());
    1.0 - terms.sum::<f64>()
}

/// What has entered by the time `D t / L^2`, over what enters in the end.
pub fn taken_up(time: f64) -> f64 {
    let terms = odd().map(|(_, k)| 2.0 / (k * k) * (-k * k * time).exp());
    1.0 - terms.sum::<f64>()
}

/// `E_1(u)`, `int_0^inf exp(-u e^s) ds`, with `s = ln(1 + v)` and `v = exp(w - exp(-w))`.
fn exponential_integral(u: f64) -> f64 {
    const STEP: f64 = 1.0 / 64.0;
    let terms = (-64 * 6..64 * 12).map(|index| {
        let w = f64::from(index) * STEP;
        let v = (w - (-w).exp()).exp();
        let slope = v * (1.0 + (-w).exp());
        (-u * (1.0 + v)).exp() / (1.0 + v) * slope
    });
    STEP * terms.sum::<f64>()
}

/// Pressure (Pa) at `r` (m) and `t` (s) beside a line that feeds a plane of transmissivity `T`
/// (m^3/(Pa s)) at a rate (m^3/s): Theis 1935.
pub fn theis([diffusivity, transmissivity]: [f64; 2], rate: f64, r: f64, t: f64) -> f64 {
    rate / (4.0 * PI * transmissivity) * exponential_integral(r * r / (4.0 * diffusivity * t))
}

/// Cosine and sine of the pressure (Pa) at `r` (m) beside a line that feeds a plane of
/// transmissivity `T` (m^3/(Pa s)) at a rate (m^3/s) times the cosine of `w t`, with
/// `K_0(z) = int_0^inf exp(-z cosh s) ds` (Carslaw and Jaeger 1959, section 10.4).
pub fn periodic_source(
    [diffusivity, transmissivity]: [f64; 2],
    rate: f64,
    r: f64,
    frequency: f64,
) -> [f64; 2] {
    // Real and imaginary part of z = sqrt(i w/D) r.
    let z = r * (0.5 * frequency / diffusivity).sqrt();
    let factor = rate / (2.0 * PI * transmissivity);
    let integrand =
        |of: fn(f64) -> f64| trapezoidal(move |s: f64| (-z * s.cosh()).exp() * of(z * s.cosh()));
    [f64::cos, f64::sin].map(|of| factor * integrand(of))
}

/// Share of the fall of an even pressure by which a half space falls at `x` (m) whose fluid leaks
/// off with `1/sqrt(t)` from the beginning (s), while the pressure at its end stands:
/// `1 - sqrt(pi) ierfc(y)` with `y = x / (2 sqrt(D t))`.
pub fn leaking(diffusivity: f64, x: f64, t: f64) -> f64 {
    let y = 0.5 * x / (diffusivity * t).sqrt();
    1.0 - (-y * y).exp() + PI.sqrt() * y * erfc(y)
}

/// Real and imaginary part of `cosh((1 + i) z / sqrt(2))`.
fn complex_cosh(z: f64) -> [f64; 2] {
    let z = z * std::f64::consts::FRAC_1_SQRT_2;
    [z.cosh() * z.cos(), z.sinh() * z.sin()]
}

/// `a / b` of complex numbers.
fn ratio([a, b]: [f64; 2], [c, d]: [f64; 2]) -> [f64; 2] {
    let size = c * c + d * d;
    [(a * c + b * d) / size, (b * c - a * d) / size]
}

/// Cosine and sine of the pressure at a share `x` of the way to a closed end, where that at the
/// open end is the cosine of `w t`; `number` is `L sqrt(w / D)`.
pub fn periodic_to_closed_end(number: f64, x: f64) -> [f64; 2] {
    let [real, imaginary] = ratio(complex_cosh(number * (1.0 - x)), complex_cosh(number));
    [real, -imaginary]
}

/// Cosine and sine of what enters there, over `T / L` times the swing: `k L tanh(k L)`.
pub fn periodic_inflow(number: f64) -> [f64; 2] {
    let z = number * std::f64::consts::FRAC_1_SQRT_2;
    let sinh = [z.sinh() * z.cos(), z.cosh() * z.sin()];
    let [a, b] = ratio(sinh, complex_cosh(number));
    // Times `(1 + i) z`.
    [z * (a - b), -z * (a + b)]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_close(found: f64, expected: f64) {
        assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
    }

    /// Numbers of another computation, seven digits.
    #[test]
    fn closed_forms_have_their_numbers() {
        for (x, p) in [(0.5, 0.795_012_2), (2.0, 0.298_697_6), (4.0, 0.037_666_92)] {
            is_close(half_space(1_851.851_85, x, 1e-3), p);
        }
        for (time, p) in [(0.1, 0.050_694_64), (0.5, 0.629_222_6), (1.0, 0.892_023_0)] {
            is_close(to_closed_end(1.0, time), p);
        }
        is_close(taken_up(0.1), 0.356_823_4);
        let storage = 1e-4 * 4.5e-10 + 1e-11;
        let plane = [1e-12 / 12e-3 / storage, 1e-12 / 12e-3];
        is_close(plane[0], 8.296_001_5);
        // Amplitudes at a closed end after 20 m, and of what enters for 1 Pa.
        for (period, end, enters) in [
            (10.0, 4.080_864e-2, 2.293_237e-11),
            (100.0, 0.624_612_8, 8.279_486e-12),
        ] {
            let number = 20.0 * (2.0 * PI / period / plane[0]).sqrt();
            let [cosine, sine] = periodic_to_closed_end(number, 1.0);
            is_close(cosine.hypot(sine), end);
            let [cosine, sine] = periodic_inflow(number);
            is_close(cosine.hypot(sine) * plane[1] / 20.0, enters);
        }
        for (r, p) in [(1.0, 2_821.590), (5.0, 322.979_7), (10.0, 12.248_26)] {
            is_close(theis(plane, 1e-6, r, 1.0), p);
        }
    }

    /// Numbers of another computation, seven digits.
    #[test]
    fn amplitudes_of_a_periodic_source_have_their_numbers() {
        for (r, p) in [(1.0, 3059.283), (2.0, 1929.161), (5.0, 727.3513)] {
            let [cosine, sine] = periodic_source([8.296_001, 1e-12 / 12e-3], 1e-6, r, 0.2 * PI);
            is_close(cosine.hypot(sine), p);
        }
    }
}
