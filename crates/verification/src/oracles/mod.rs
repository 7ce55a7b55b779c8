//! Closed forms, written without any code of the workspace but for the types of its input.

pub mod bedding;
pub mod diffusion;
pub mod similarity;
pub mod spherical_joint;
pub mod tunnel;
pub mod wedge;

/// Aperture over `b0` under the closing load `q = -sigma_n / (K_n0 b0) > 0`, by bisection on the
/// exponent.
pub fn closed_aperture(q: f64) -> f64 {
    let (mut low, mut high) = (-60.0_f64, 0.0_f64);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        // 1 - e^s loses digits near s = 0; expm1 keeps them.
        let load = -middle.exp_m1() * (1.0 + middle * middle);
        if load > q {
            low = middle;
        } else {
            high = middle;
        }
    }
    (0.5 * (low + high)).exp()
}

/// Values of the law from an independent computation, six digits: `(q, x, slope / K_n0)`.
pub const LOG_LAW_TABLE: [(f64, f64, f64); 10] = [
    (0.01, 0.990001, 1.000),
    (0.1, 0.901073, 1.034),
    (0.5, 0.602263, 1.927),
    (1.0, 0.424013, 4.067),
    (2.0, 0.268121, 9.919),
    (5.0, 0.115641, 38.65),
    (10.0, 0.0459915, 138.2),
    (20.0, 0.0124296, 717.5),
    (50.0, 9.0892e-4, 1.545e4),
    (100.0, 4.7722e-5, 4.171e5),
];

/// Moduli of rock with orthogonal joint sets of spacing `s` (Amadei & Goodman 1981):
/// `1/E' = 1/E + 1/(K_n s)`, `1/G' = 1/G + m/(K_s s)` for `m` of the two sets of a shear plane
/// present, `nu' = nu E'/E`.
pub fn jointed_moduli(e: f64, nu: f64, kn: f64, ks: f64, s: f64, m: f64) -> (f64, f64, f64) {
    let young = 1.0 / (1.0 / e + 1.0 / (kn * s));
    let shear = 1.0 / (2.0 * (1.0 + nu) / e + m / (ks * s));
    (young, shear, nu * young / e)
}
