//! The hyperbolic closure of Barton and Bandis.
//!
//! S. C. Bandis, A. C. Lumsden and N. R. Barton, "Fundamentals of rock joint deformation", Int. J.
//! Rock Mech. Min. Sci. 20 (1983). With the closure `v = -w_n` and its largest value `v_m`:
//! `-sigma_n = K_n0 v / (1 - v / v_m)`. Below, `x = b / b0`, `y = x - 1`, `m = v_m / b0`, and
//! `g = m + y` is what is left to close.

/// `sigma_n`, its slope and `Psi` in units of `K_n0 b0`, `K_n0` and `K_n0 b0^2`, for `y <= 0`:
/// `m y / g`, `m^2 / g^2` and `m (y - m ln(1 + y / m))`.
pub(super) fn at(x: f64, y: f64, m: f64) -> (f64, f64, f64) {
    let g = left(x, y, m);
    if g <= 0.0 {
        return (f64::NEG_INFINITY, f64::INFINITY, f64::INFINITY);
    }
    let logarithm = if y > -0.5 * m {
        (y / m).ln_1p()
    } else {
        (g / m).ln()
    };
    (m * y / g, (m / g).powi(2), m * (y - m * logarithm))
}

/// `g`, with the digits of `x` where the walls may come as close as they like.
fn left(x: f64, y: f64, m: f64) -> f64 {
    if m == 1.0 { x } else { m + y }
}

/// Root `(x, y)` of `m y / g + kappa y = q <= 0`, a parabola in `y` as well as in `g`.
pub(super) fn balance(kappa: f64, q: f64, m: f64) -> (f64, f64) {
    let p = -q;
    let linear = 1.0 + kappa + p / m;
    let root = ((kappa - p / m).powi(2) + 1.0 + 2.0 * kappa + 2.0 * p / m).sqrt();
    let y = -2.0 * p / (linear + root);
    let of_gap = m * (1.0 - kappa) + p;
    if of_gap <= 0.0 {
        return (1.0 + y, y);
    }
    let g = 2.0 * m * m / (of_gap + (of_gap * of_gap + 4.0 * kappa * m * m).sqrt());
    ((1.0 - m) + g, y)
}
