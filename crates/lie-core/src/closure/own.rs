//! A closure law of one's own, as a function of the aperture.

use crate::root::root;

/// A closure law in compression that whoever uses the library brings along.
///
/// In units of `b0`, `K_n0 b0` and `K_n0 b0^2`, with `x = b / b0` in `0 < x <= 1`. Newton's method
/// relies on a traction that grows with `x` from `-infinity` at `x = 0`, is 0 with the slope 1 at
/// `x = 1`, and is the derivative of the potential. Laws are the same if their names are.
#[derive(Debug, Clone, Copy)]
pub struct OwnLaw {
    /// Its name.
    pub name: &'static str,
    /// Traction, slope and potential at `x`; `y = x - 1` to full precision near the initial
    /// aperture.
    pub at: fn(x: f64, y: f64) -> OwnResponse,
}

/// Answer of an [`OwnLaw`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OwnResponse {
    /// `sigma_n / (K_n0 b0)`, negative in compression.
    pub traction: f64,
    /// Its derivative by `x`.
    pub tangent: f64,
    /// Its integral from `x = 1`.
    pub potential: f64,
}

impl PartialEq for OwnLaw {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl OwnLaw {
    /// `sigma_n`, its slope and `Psi` in units of `K_n0 b0`, `K_n0` and `K_n0 b0^2`.
    pub(super) fn at(&self, x: f64, y: f64) -> (f64, f64, f64) {
        if x <= 0.0 {
            return (f64::NEG_INFINITY, f64::INFINITY, f64::INFINITY);
        }
        let response = (self.at)(x, y);
        (response.traction, response.tangent, response.potential)
    }

    /// Root `(x, y)` of `sigma(x) + kappa y = q <= 0`: in `y` near the initial aperture, in `x`
    /// near closure, each to full relative precision.
    pub(super) fn balance(&self, kappa: f64, q: f64) -> (f64, f64) {
        let residual = |x: f64, y: f64| self.at(x, y).0 + kappa * y - q;
        if residual(0.5, -0.5) > 0.0 {
            let x = root(|x| residual(x, x - 1.0), 0.5);
            return (x, x - 1.0);
        }
        let closed = root(|closed| -residual(1.0 - closed, -closed), 0.5);
        (1.0 - closed, -closed)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Closure, ClosureKind};
    use super::*;

    /// `1 - 1 / x`: the hyperbola whose largest closure is the aperture.
    const HYPERBOLA: OwnLaw = OwnLaw {
        name: "hyperbola",
        at: |x, y| OwnResponse {
            traction: y / x,
            tangent: 1.0 / (x * x),
            potential: y - x.ln(),
        },
    };

    #[test]
    fn a_hyperbola_of_ones_own_is_the_one_that_is_there() {
        let law = |kind| Closure::new(2e-4, 3e10, kind);
        let own = law(ClosureKind::Own(HYPERBOLA));
        let known = law(ClosureKind::Hyperbolic { max_closure: 2e-4 });
        for spring in [0.0, 1e9, 1e12] {
            for load in [-1e-3, -1e4, -6e6, -1e9, -1e14] {
                let (a, b) = (own.balanced(spring, load), known.balanced(spring, load));
                assert!((a.aperture / b.aperture - 1.0).abs() < 1e-12, "{a:?} {b:?}");
                assert!((a.opening / b.opening - 1.0).abs() < 1e-12, "{a:?} {b:?}");
                let (a, b) = (own.at(a), known.at(b));
                assert!((a.traction / b.traction - 1.0).abs() < 1e-11, "{a:?} {b:?}");
                assert!((a.tangent / b.tangent - 1.0).abs() < 1e-11, "{a:?} {b:?}");
            }
        }
    }
}
