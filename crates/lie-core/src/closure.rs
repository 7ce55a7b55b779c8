//! Normal closure of a fracture: from the aperture to the normal traction.
//!
//! T. Nagel, "One-sided incompressibility constraint for fracture models", 28 September 2017,
//! eqs. (1) to (6). With `x = b / b0`, `x_c = b_cut / b0`, `L = ln x_c`:
//!
//! ```text
//! sigma_n = K_n0 b0 m(x) (x - 1)
//! m(x) = 1                                        x >= 1          open
//!        1 + ln^2 x                               x_c < x < 1     closing
//!        1 + L^2 + 2 L / x_c (x - x_c)            x <= x_c        below the cutoff
//! ```
//!
//! This is the *total* law. It has the convex potential `Psi`, `sigma_n = dPsi/dw_n`, so the
//! frictionless problem is a convex minimisation and its tangent is positive definite.

use serde::{Deserialize, Serialize};

/// How the normal stiffness depends on the aperture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ClosureKind {
    /// Constant stiffness; the walls may overlap.
    Linear,
    /// Stiffness growing without bound as the fracture closes.
    Logarithmic {
        /// Aperture (m) below which the stiffness continues linearly, `0 < b_cut <= b0`. Without
        /// it the law is exact and the aperture stays positive under any load; with it the walls
        /// overlap beyond `|sigma_n| = K_n0 b0 (1 - ln x_c)^2`.
        cutoff: Option<f64>,
    },
}

/// How far the walls of a fracture are apart, to full relative precision wherever that matters:
/// the opening near the initial aperture, the aperture near closure.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Separation {
    /// Opening `w_n` (m).
    pub opening: f64,
    /// Aperture `b = b0 + w_n` (m).
    pub aperture: f64,
}

impl Separation {
    /// Moved apart by `opening` (m).
    #[must_use]
    pub fn moved(self, opening: f64) -> Self {
        Self {
            opening: self.opening + opening,
            aperture: self.aperture + opening,
        }
    }

    /// How much further apart than `other` (m).
    pub fn beyond(self, other: Self) -> f64 {
        if self.aperture.abs() < self.opening.abs() {
            self.aperture - other.aperture
        } else {
            self.opening - other.opening
        }
    }
}

/// Normal closure law of a fracture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Closure {
    /// Aperture without load, `b0` (m).
    pub aperture: f64,
    /// Stiffness without load, `K_n0` (Pa/m); 0 is a free crack.
    pub normal_stiffness: f64,
    /// Dependence on the aperture.
    pub kind: ClosureKind,
}

/// Answer of the closure law at one aperture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NormalResponse {
    /// Normal traction `sigma_n` (Pa), tension positive.
    pub traction: f64,
    /// Slope `d sigma_n / d b` (Pa/m).
    pub tangent: f64,
    /// Energy per area `Psi` (J/m^2), zero at `b0`.
    pub potential: f64,
}

impl Closure {
    /// Separation at an opening (m).
    pub fn opened(&self, opening: f64) -> Separation {
        Separation {
            opening,
            aperture: self.aperture + opening,
        }
    }

    /// Response at aperture `b` (m); see [`Closure::at`].
    pub fn at_aperture(&self, b: f64) -> NormalResponse {
        self.at(Separation {
            opening: b - self.aperture,
            aperture: b,
        })
    }

    /// Response at a separation.
    ///
    /// Without a cutoff the logarithmic law has no value at `b <= 0`: traction, tangent and
    /// potential are infinite there.
    pub fn at(&self, separation: Separation) -> NormalResponse {
        if self.normal_stiffness == 0.0 {
            return NormalResponse {
                traction: 0.0,
                tangent: 0.0,
                potential: 0.0,
            };
        }
        let x = separation.aperture / self.aperture;
        let y = separation.opening / self.aperture;
        let (traction, tangent, potential) = match self.kind {
            ClosureKind::Logarithmic { cutoff } if y < 0.0 => {
                logarithmic(x, y, cutoff.map(|b_cut| b_cut / self.aperture))
            }
            _ => (y, 1.0, 0.5 * y * y),
        };
        NormalResponse {
            traction: self.normal_stiffness * self.aperture * traction,
            tangent: self.normal_stiffness * tangent,
            potential: self.normal_stiffness * self.aperture.powi(2) * potential,
        }
    }

    /// Separation at which the law balances a spring: `sigma_n(w) + k w = load`, with
    /// `spring` = `k >= 0` (Pa/m) and `load` (Pa).
    ///
    /// The left side grows monotonically, so there is one solution for any load. With a free crack
    /// and no spring the opening is 0.
    pub fn balanced(&self, spring: f64, load: f64) -> Separation {
        let total = self.normal_stiffness + spring;
        if total == 0.0 {
            return self.opened(0.0);
        }
        let ClosureKind::Logarithmic { cutoff } = self.kind else {
            return self.opened(load / total);
        };
        if load >= 0.0 || self.normal_stiffness == 0.0 {
            return self.opened(load / total);
        }
        let kappa = spring / self.normal_stiffness;
        let q = load / (self.normal_stiffness * self.aperture);
        let at_cutoff = cutoff
            .map(|b_cut| b_cut / self.aperture)
            .filter(|&x_c| (1.0 + x_c.ln().powi(2) + kappa) * (x_c - 1.0) > q);
        let (x, y) = match at_cutoff {
            Some(x_c) => balance_below_cutoff(x_c, kappa, q),
            None => {
                let s = balance_logarithm(kappa, q);
                (s.exp(), s.exp_m1())
            }
        };
        Separation {
            opening: self.aperture * y,
            aperture: self.aperture * x,
        }
    }

    /// The cutoff aperture (m), if the law has one.
    pub fn cutoff(&self) -> Option<f64> {
        match self.kind {
            ClosureKind::Linear => None,
            ClosureKind::Logarithmic { cutoff } => cutoff,
        }
    }

    /// Whether stiffness depends on the aperture at all.
    pub fn is_linear(&self) -> bool {
        let flat = self.cutoff().is_some_and(|cutoff| cutoff >= self.aperture);
        self.kind == ClosureKind::Linear || self.normal_stiffness == 0.0 || flat
    }
}

/// `sigma_n`, its slope and `Psi` in units of `K_n0 b0`, `K_n0` and `K_n0 b0^2`, for `x < 1`, with
/// `y = x - 1`.
fn logarithmic(x: f64, y: f64, cutoff: Option<f64>) -> (f64, f64, f64) {
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

/// Root `s = ln x` of `(e^s - 1) (1 + s^2 + kappa) = q < 0`, by Newton kept inside a bracket.
fn balance_logarithm(kappa: f64, q: f64) -> f64 {
    // For s <= -1 the left side is below -0.63 (1 + s^2), which bounds the root.
    let mut low = -1.0 - (-q / 0.63).sqrt();
    let mut high = 0.0_f64;
    let mut s = (q / (1.0 + kappa)).max(low);
    for _ in 0..100 {
        let closing = s.exp_m1();
        let excess = closing * (1.0 + s * s + kappa) - q;
        if excess > 0.0 {
            high = s;
        } else {
            low = s;
        }
        let slope = (closing + 1.0) * (1.0 + s * s + kappa) + 2.0 * s * closing;
        let newton = s - excess / slope;
        let inside = newton > low && newton < high;
        let next = if inside { newton } else { 0.5 * (low + high) };
        if (next - s).abs() <= 4.0 * f64::EPSILON * s.abs() {
            return next;
        }
        s = next;
    }
    s
}

#[cfg(test)]
mod tests {
    use super::*;

    const CUTOFFS: [Option<f64>; 6] = [
        None,
        Some(1e-2),
        Some(1e-4),
        Some(1e-8),
        Some(1e-12),
        Some(1.0),
    ];

    fn unit(cutoff: Option<f64>) -> Closure {
        Closure {
            aperture: 1.0,
            normal_stiffness: 1.0,
            kind: ClosureKind::Logarithmic { cutoff },
        }
    }

    /// Independently computed values of the law: closing load, aperture, tangent.
    #[test]
    fn reference_table() {
        let table = [
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
        for (q, x, tangent) in table {
            let aperture = unit(None).balanced(0.0, -q).aperture;
            assert!((aperture / x - 1.0).abs() < 2e-5, "q = {q}: {aperture}");
            let slope = unit(None).at_aperture(aperture).tangent;
            assert!((slope / tangent - 1.0).abs() < 1e-3, "q = {q}: {slope}");
        }
    }

    #[test]
    fn derivatives_agree_with_differences_on_all_branches() {
        for cutoff in CUTOFFS {
            for x in [-3.0_f64, -0.5, 0.005, 0.02, 0.3, 0.7, 0.999, 1.001, 2.0] {
                if cutoff.is_none() && x <= 0.0 {
                    continue;
                }
                let law = unit(cutoff);
                let h = 1e-6 * f64::max(x.abs(), 1e-3);
                let (below, above) = (law.at_aperture(x - h), law.at_aperture(x + h));
                let here = law.at_aperture(x);
                let slope = (above.traction - below.traction) / (2.0 * h);
                assert!((slope / here.tangent - 1.0).abs() < 1e-5, "{cutoff:?} {x}");
                let force = (above.potential - below.potential) / (2.0 * h);
                let scale = here.traction.abs().max(1e-3);
                assert!(
                    (force - here.traction).abs() / scale < 1e-4,
                    "{cutoff:?} {x}"
                );
            }
        }
    }

    #[test]
    fn branches_join_smoothly() {
        for cutoff in [1e-2, 1e-6] {
            let law = unit(Some(cutoff));
            for x in [cutoff, 1.0] {
                let h = 1e-9 * x;
                let (below, above) = (law.at_aperture(x - h), law.at_aperture(x + h));
                assert!((below.traction - above.traction).abs() < 1e-6);
                assert!((below.tangent / above.tangent - 1.0).abs() < 1e-6);
                assert!((below.potential - above.potential).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn balance_holds_for_any_spring_load_and_cutoff() {
        for cutoff in CUTOFFS {
            for spring in [0.0, 1e-3, 1.0, 1e3] {
                for load in [-1e5, -300.0, -20.0, -1.0, -1e-3, 0.0, 1e-3, 5.0] {
                    let law = unit(cutoff);
                    let balance = law.balanced(spring, load);
                    let b = balance.aperture;
                    let response = law.at(balance);
                    let rest = response.traction + spring * balance.opening - load;
                    // The tangent turns the rounding of b itself into traction.
                    let rounding = 1e-14 * (load.abs() + (response.tangent + spring) * b.abs());
                    assert!(
                        rest.abs() <= 10.0 * rounding + 1e-15,
                        "{cutoff:?} {spring} {load}: {rest}"
                    );
                    assert!(cutoff.is_some() || b > 0.0);
                }
            }
        }
    }

    #[test]
    fn tiny_openings_keep_their_digits() {
        for load in [-1e-12, 1e-12, -1e-20] {
            let balance = unit(None).balanced(0.0, load);
            assert!((balance.opening / load - 1.0).abs() < 1e-12);
            assert!((unit(None).at(balance).traction / load - 1.0).abs() < 1e-15);
        }
    }

    #[test]
    fn walls_meet_at_the_predicted_load() {
        for x_c in [0.1_f64, 0.01, 0.001] {
            let touching = (1.0 - x_c.ln()).powi(2);
            assert!(unit(Some(x_c)).balanced(0.0, -touching).aperture.abs() < 1e-12);
        }
    }

    #[test]
    fn cutoff_at_the_initial_aperture_is_the_linear_law() {
        for b in [-2.0, 0.5, 1.0, 3.0] {
            let response = unit(Some(1.0)).at_aperture(b);
            assert_eq!((response.traction, response.tangent), (b - 1.0, 1.0));
        }
        assert!(unit(Some(1.0)).is_linear());
    }
}
