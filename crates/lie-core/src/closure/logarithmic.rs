//! The logarithmic closure.
//!
//! T. Nagel, "One-sided incompressibility constraint for fracture models", 28 September 2017,
//! eqs. (1) to (6). With `x = b / b0 < 1`, `x_c = b_cut / b0`, `L = ln x_c`:
//!
//! ```text
//! sigma_n = K_n0 b0 m(x) (x - 1)
//! m(x) = 1 + ln^2 x                               x_c < x < 1     closing
//!        1 + L^2 + 2 L / x_c (x - x_c)            x <= x_c        below the cutoff
//! ```

/// `sigma_n`, its slope and `Psi` in units of `K_n0 b0`, `K_n0` and `K_n0 b0^2`, for `x < 1`, with
/// `y = x - 1`.
pub(super) fn at(x: f64, y: f64, cutoff: Option<f64>) -> (f64, f64, f64) {
    match cutoff {
        Some(x_c) if x <= x_c => below_cutoff(x, x_c),
        _ if x <= 0.0 => (f64::NEG_INFINITY, f64::INFINITY, f64::INFINITY),
        _ => {
            let l = if x > 0.5 { y.ln_1p() } else { x.ln() };
            let m = 1.0 + l * l;
            (m * y, m + 2.0 * l * y / x, potential_of_logarithm(x))
        }
    }
}

/// `Psi = x^2/2 - x + x^2/2 (ln^2 x - ln x + 1/2) - x (ln^2 x - 2 ln x + 2) + 9/4`.
fn potential_of_logarithm(x: f64) -> f64 {
    let l = x.ln();
    0.5 * x * x - x + 0.5 * x * x * (l * l - l + 0.5) - x * (l * l - 2.0 * l + 2.0) + 2.25
}

/// The stiffness factor, not the traction, is continued linearly: the traction is a parabola.
fn below_cutoff(x: f64, x_c: f64) -> (f64, f64, f64) {
    let l = x_c.ln();
    let (m_c, slope) = (1.0 + l * l, 2.0 * l / x_c);
    let d = x - x_c;
    let potential = potential_of_logarithm(x_c)
        + m_c * (x_c - 1.0) * d
        + (m_c + slope * (x_c - 1.0)) * d * d / 2.0
        + slope * d.powi(3) / 3.0;
    (
        (m_c + slope * d) * (x - 1.0),
        m_c + slope * d + slope * (x - 1.0),
        potential,
    )
}

/// Root `(x, x - 1)` of `m(x) (x - 1) + kappa (x - 1) = q < 0`.
pub(super) fn balance(kappa: f64, q: f64, cutoff: Option<f64>) -> (f64, f64) {
    let at_cutoff = cutoff.filter(|&x_c| (1.0 + x_c.ln().powi(2) + kappa) * (x_c - 1.0) > q);
    match at_cutoff {
        Some(x_c) => balance_below_cutoff(x_c, kappa, q),
        None => {
            let s = balance_logarithm(kappa, q);
            (s.exp(), s.exp_m1())
        }
    }
}

/// Root `(x, x - 1)` of `(m_c + slope d + kappa) (d - (1 - x_c)) = q`, a parabola in
/// `d = x - x_c < 0`.
fn balance_below_cutoff(x_c: f64, kappa: f64, q: f64) -> (f64, f64) {
    let l = x_c.ln();
    let (steepness, stiffness, a) = (-2.0 * l / x_c, 1.0 + l * l + kappa, 1.0 - x_c);
    let linear = stiffness + steepness * a;
    let excess = -a * stiffness - q;
    let d = -2.0 * excess / (linear + (linear * linear + 4.0 * steepness * excess).sqrt());
    (x_c + d, d - a)
}

/// Step of Halley's method, against the root, that leaves nothing but rounding: the error after a
/// step is as its cube.
const LAST_STEP: f64 = 5e-6;

/// Root `s = ln x` of `(e^s - 1) (1 + s^2 + kappa) = q < 0`, by Halley kept inside a bracket.
fn balance_logarithm(kappa: f64, q: f64) -> f64 {
    // For s <= -1 the left side is below -0.63 (1 + s^2), which bounds the root.
    let mut low = -1.0 - (-q / 0.63).sqrt();
    let mut high = 0.0_f64;
    let mut s = guess(q / (1.0 + kappa)).max(low);
    for _ in 0..100 {
        let closing = s.exp_m1();
        let excess = closing * (1.0 + s * s + kappa) - q;
        if excess > 0.0 {
            high = s;
        } else {
            low = s;
        }
        let (x, m) = (closing + 1.0, 1.0 + s * s + kappa);
        let slope = x * m + 2.0 * s * closing;
        let bend = x * (m + 4.0 * s) + 2.0 * closing;
        let newton = excess / slope;
        let halley = s - newton / (1.0 - 0.5 * newton * bend / slope).max(0.5);
        let inside = halley >= low && halley <= high;
        let next = if inside { halley } else { 0.5 * (low + high) };
        if inside && (next - s).abs() <= LAST_STEP * s.abs() {
            return next;
        }
        s = next;
    }
    s
}

/// About `ln(1 + y)`, where `y < 0` is what the law closes by without its logarithm.
fn guess(y: f64) -> f64 {
    const FAR: f64 = -0.8;
    if y < FAR {
        y
    } else {
        y * (6.0 + y) / (6.0 + 4.0 * y)
    }
}
