//! Closed forms of joints that close under a pressure.
//!
//! In a column the joint carries the pressure `p`. Around a spherical core (radius `a`) in a shell
//! (outer radius `b`) of the same rock it carries `q`, and `p` acts outside (G. Lame's hollow
//! sphere): with `K = E / (3 (1 - 2 nu))` and `G = E / (2 (1 + nu))`
//!
//! ```text
//! core     u = -q r (1 - 2 nu) / E
//! shell    u = C r + D / r^2
//!          D = (q - p) / (4 G (1/a^3 - 1/b^3))
//!          C = (4 G D / b^3 - p) / (3 K)
//! joint    u_shell(a) - u_core(a) = w(q)
//! ```
//!
//! The aperture under a pressure is the root of the closure law, found by formulas and bisection of
//! this file and not by the code of the law: an oracle shares nothing with what it judges.

use lie_core::{Closure, ClosureKind, Rock};

use crate::reader::Section;

/// How a pressure (Pa, compression positive) closes a joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum PressedJoint {
    /// The joint carries it.
    Column { pressure: f64 },
    /// It acts outside of a shell around a core, with the joint between them.
    Sphere {
        /// Radius of the joint (m).
        radius: f64,
        /// Radius of the shell outside (m).
        outer_radius: f64,
        pressure: f64,
    },
}

impl PressedJoint {
    /// What the joint carries (Pa).
    pub(super) fn carried(&self, rock: &Rock, closure: &Closure) -> Option<f64> {
        let (radii, p) = match *self {
            Self::Column { pressure } => return Some(pressure),
            Self::Sphere {
                radius,
                outer_radius,
                pressure,
            } => ([radius, outer_radius], pressure),
        };
        // Rock without a joint carries the pressure everywhere, and no joint carries more.
        let is_below = |q: f64| {
            let of_law = aperture_under(closure, q)? - closure.aperture;
            Some(spherical_opening(rock, radii, [p, q]) < of_law)
        };
        bisect([0.0, p], is_below)
    }

    /// Aperture of the joint (m).
    pub(super) fn aperture(&self, rock: &Rock, closure: &Closure) -> Option<f64> {
        aperture_under(closure, self.carried(rock, closure)?)
    }
}

/// Opening (m) between core and shell with `p` outside and `q` on the joint (Pa).
fn spherical_opening(rock: &Rock, [a, b]: [f64; 2], [p, q]: [f64; 2]) -> f64 {
    let (e, nu) = (rock.young_modulus, rock.poisson_ratio);
    let (bulk, shear) = (e / (3.0 * (1.0 - 2.0 * nu)), e / (2.0 * (1.0 + nu)));
    let d = (q - p) / (4.0 * shear * (a.powi(-3) - b.powi(-3)));
    let c = (4.0 * shear * d / b.powi(3) - p) / (3.0 * bulk);
    let core = -q * a * (1.0 - 2.0 * nu) / e;
    c * a + d / (a * a) - core
}

/// Aperture (m) at which a law carries a pressure `p >= 0` (Pa); none for laws of one's own, and
/// without a stiffness.
fn aperture_under(closure: &Closure, p: f64) -> Option<f64> {
    let (b0, stiffness) = (closure.aperture, closure.normal_stiffness);
    let aperture = match closure.kind {
        ClosureKind::Linear => b0 - p / stiffness,
        ClosureKind::Logarithmic { cutoff } => {
            let cut = cutoff.map(|cutoff| cutoff / b0);
            b0 * logarithmic(p / (stiffness * b0), cut)?
        }
        // v_m - v, in which no digits are lost as v comes close to v_m.
        ClosureKind::Hyperbolic { max_closure: vm } => b0 - vm + vm / (1.0 + p / (stiffness * vm)),
        ClosureKind::Contact => 0.0,
        ClosureKind::Own(_) => return None,
    };
    Some(aperture).filter(|aperture| aperture.is_finite())
}

/// The root `x = b / b0` of `m(x) (1 - x) = load`, `m = 1 + ln^2 x`, with `m` going on linearly
/// below `cut`.
fn logarithmic(load: f64, cut: Option<f64>) -> Option<f64> {
    if !load.is_finite() {
        return None;
    }
    // In s = ln x; 1 - e^s loses digits near s = 0, expm1 keeps them.
    let exact = |s: f64| -s.exp_m1() * (1.0 + s * s);
    if let Some(cut) = cut.filter(|cut| load > exact(cut.ln())) {
        let ln = cut.ln();
        let m = |x: f64| 1.0 + ln * ln + 2.0 * ln / cut * (x - cut);
        return bisect([1.0 - load, cut], |x| Some(m(x) * (1.0 - x) > load));
    }
    let lowest = -1.0 - 2.0 * load.sqrt();
    bisect([lowest, 0.0], |s| Some(exact(s) > load)).map(f64::exp)
}

/// Where `is_below` turns from true to false.
fn bisect([mut low, mut high]: [f64; 2], is_below: impl Fn(f64) -> Option<bool>) -> Option<f64> {
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if is_below(middle)? {
            low = middle;
        } else {
            high = middle;
        }
    }
    Some(0.5 * (low + high))
}

/// Reads a joint in a column or around a sphere.
pub(super) fn read(section: &Section<'_, '_>, is_sphere: bool) -> Option<PressedJoint> {
    section.require("pressure");
    let pressure = section.number("pressure");
    if let Some(pressure) = pressure.filter(|pressure| *pressure <= 0.0) {
        section.refuse(
            "pressure",
            format!("a pressure of {pressure} closes no joint"),
            "write the compression as a positive number, e.g. pressure = 5e6",
        );
        return None;
    }
    if !is_sphere {
        return pressure.map(|pressure| PressedJoint::Column { pressure });
    }
    section.require("radius");
    section.require("outer_radius");
    let (radius, outer_radius) = (section.number("radius"), section.number("outer_radius"));
    let (radius, outer_radius) = (radius?, outer_radius?);
    if outer_radius <= radius {
        section.refuse(
            "outer_radius",
            format!("the outer radius {outer_radius} is not above the radius {radius}"),
            "give the radius of the shell outside, above that of the joint",
        );
        return None;
    }
    Some(PressedJoint::Sphere {
        radius,
        outer_radius,
        pressure: pressure?,
    })
}

#[cfg(test)]
mod tests;
