//! Normal closure of a fracture: from the aperture to the normal traction.
//!
//! With `x = b / b0`, `y = x - 1 = w_n / b0`, in compression (`y < 0`) one of
//!
//! ```text
//! linear       sigma_n = K_n0 b0 y
//! logarithmic  sigma_n = K_n0 b0 (1 + ln^2 x) y                            (`logarithmic`)
//! hyperbolic   sigma_n = K_n0 b0 y / (1 + y / m),  m = max_closure / b0    (`hyperbolic`)
//! contact      b >= 0,  sigma_n <= 0,  b sigma_n = 0
//! ```
//!
//! and in tension (`y > 0`) the stiffness `K_n0`, nothing, or a cohesive bond (`tension`).
//! Contact has no stiffness and is open until `b = 0`.
//!
//! These are *total* laws. All but the cohesive bond have a convex potential `Psi`,
//! `sigma_n = dPsi/dw_n`, so the frictionless problem is a convex minimisation and its tangent is
//! positive semidefinite.

mod hyperbolic;
mod logarithmic;
mod own;
mod response;
mod tension;
#[cfg(test)]
mod tests;

use serde::{Deserialize, Serialize};

pub use own::{OwnLaw, OwnResponse};
pub use response::NormalResponse;
pub use tension::Tension;

/// How the normal stiffness depends on the aperture, in compression.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ClosureKind {
    /// Constant stiffness; the walls may overlap.
    Linear,
    /// Stiffness growing without bound as the fracture closes (Nagel 2017).
    Logarithmic {
        /// Aperture (m) below which the stiffness continues linearly, `0 < b_cut <= b0`. Without
        /// it the law is exact and the aperture stays positive under any load; with it the walls
        /// overlap beyond `|sigma_n| = K_n0 b0 (1 - ln x_c)^2`.
        cutoff: Option<f64>,
    },
    /// Barton-Bandis hyperbola: the closure approaches a largest value.
    Hyperbolic {
        /// Largest closure `v_m` (m), `0 < v_m <= b0`.
        max_closure: f64,
    },
    /// Unilateral contact: the walls touch or they do not, without a stiffness.
    Contact,
    /// A law of one's own; the walls never overlap.
    Own(OwnLaw),
}

impl ClosureKind {
    /// Whether a large enough load pushes the walls through each other: the aperture may be
    /// negative.
    pub fn may_overlap(&self) -> bool {
        matches!(self, Self::Linear | Self::Logarithmic { cutoff: Some(_) })
    }
}

/// How far the walls of a fracture are apart, to full relative precision wherever that matters:
/// the opening near the initial aperture, the aperture near closure.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
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
    /// Aperture without load, `b0` (m); 0 only for contact.
    pub aperture: f64,
    /// Stiffness without load, `K_n0` (Pa/m); 0 is a free crack, infinite is contact.
    pub normal_stiffness: f64,
    /// Dependence on the aperture in compression.
    pub kind: ClosureKind,
    /// What happens in tension; nothing but the gap opens in contact.
    pub tension: Tension,
}

/// A spring that holds the walls: it gives them `traction - stiffness (w_n - separation)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NormalSpring {
    /// Stiffness `k >= 0` (Pa/m).
    pub stiffness: f64,
    /// Where the walls are.
    pub separation: Separation,
    /// Normal traction there (Pa).
    pub traction: f64,
}

/// Where the law balances a spring.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NormalBalance {
    /// Separation of the walls.
    pub separation: Separation,
    /// Normal traction of the law there (Pa).
    pub traction: f64,
}

impl Closure {
    /// The law in tension and compression alike, with stiffness in tension.
    pub fn new(aperture: f64, normal_stiffness: f64, kind: ClosureKind) -> Self {
        Self {
            aperture,
            normal_stiffness,
            kind,
            tension: Tension::Elastic,
        }
    }

    /// Unilateral contact of walls that are `aperture` (m) apart.
    pub fn contact(aperture: f64) -> Self {
        Self {
            aperture,
            normal_stiffness: f64::INFINITY,
            kind: ClosureKind::Contact,
            tension: Tension::CutOff,
        }
    }

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

    /// Response at a separation, of a fracture that was never open.
    pub fn at(&self, separation: Separation) -> NormalResponse {
        self.at_after(separation, 0.0)
    }

    /// Response at a separation, of a fracture whose largest opening in the past was
    /// `largest_opening` (m).
    ///
    /// Where a law has no value its traction, tangent and potential are infinite: the logarithmic
    /// law without a cutoff at `b <= 0`, the hyperbola at its largest closure, contact at `b < 0`.
    /// Walls in contact (`b = 0`) have an infinite tangent, and no traction of their own.
    pub fn at_after(&self, separation: Separation, largest_opening: f64) -> NormalResponse {
        if self.normal_stiffness == 0.0 {
            return NormalResponse::NONE;
        }
        if self.kind == ClosureKind::Contact {
            return contact(separation.aperture);
        }
        if separation.opening > 0.0 {
            let opening = separation.opening;
            return self
                .tension
                .at(self.normal_stiffness, opening, largest_opening);
        }
        let x = separation.aperture / self.aperture;
        let y = separation.opening / self.aperture;
        let (traction, tangent, potential) = match self.kind {
            ClosureKind::Logarithmic { cutoff } if y < 0.0 => {
                logarithmic::at(x, y, cutoff.map(|b_cut| b_cut / self.aperture))
            }
            ClosureKind::Hyperbolic { max_closure } => {
                hyperbolic::at(x, y, max_closure / self.aperture)
            }
            ClosureKind::Own(law) if y < 0.0 => law.at(x, y),
            _ => (y, 1.0, 0.5 * y * y),
        };
        NormalResponse {
            traction: self.normal_stiffness * self.aperture * traction,
            tangent: self.normal_stiffness * tangent,
            potential: self.normal_stiffness * self.aperture.powi(2) * potential,
        }
    }

    /// Separation at which the law balances a spring: `sigma_n(w) + k w = load`, with
    /// `stiffness` = `k >= 0` (Pa/m) and `load` (Pa), of a fracture that was never open.
    ///
    /// The left side grows monotonically, so there is one solution for any load. Where neither law
    /// nor spring resists, the opening is 0.
    pub fn balanced(&self, stiffness: f64, load: f64) -> Separation {
        let spring = self.spring(stiffness, load);
        self.balanced_after(&spring, 0.0).separation
    }

    /// A spring of `stiffness` (Pa/m) that gives walls at their initial aperture `load` (Pa).
    pub fn spring(&self, stiffness: f64, load: f64) -> NormalSpring {
        NormalSpring {
            stiffness,
            separation: self.opened(0.0),
            traction: load,
        }
    }

    /// [`Closure::balanced`] with a spring, of a fracture whose largest opening in the past was
    /// `largest_opening` (m). A bond that softens faster than the spring gives way breaks.
    pub fn balanced_after(&self, spring: &NormalSpring, largest_opening: f64) -> NormalBalance {
        if self.kind == ClosureKind::Contact {
            return self.touching(spring);
        }
        let k = spring.stiffness;
        let load = spring.traction + k * spring.separation.opening;
        let opening = |opening: f64| self.opened(opening);
        let separation = if self.normal_stiffness == 0.0 {
            opening(if k > 0.0 { load / k } else { 0.0 })
        } else if load > 0.0 {
            let stiffness = self.normal_stiffness;
            opening(self.tension.balanced(stiffness, k, load, largest_opening))
        } else {
            self.closing(k, load)
        };
        NormalBalance {
            separation,
            traction: self.at_after(separation, largest_opening).traction,
        }
    }

    /// The traction of walls that touch is what they bear beyond a gap that may be tiny: friction
    /// on soft walls shows every digit of it.
    fn touching(&self, spring: &NormalSpring) -> NormalBalance {
        let k = spring.stiffness;
        let closed = spring.traction + k * spring.separation.aperture;
        let separation = if closed < 0.0 {
            Separation {
                opening: -self.aperture,
                aperture: 0.0,
            }
        } else if k > 0.0 {
            Separation {
                opening: spring.separation.opening + spring.traction / k,
                aperture: closed / k,
            }
        } else {
            self.opened(0.0)
        };
        NormalBalance {
            separation,
            traction: closed.min(0.0),
        }
    }

    fn closing(&self, spring: f64, load: f64) -> Separation {
        let kappa = spring / self.normal_stiffness;
        let q = load / (self.normal_stiffness * self.aperture);
        let (x, y) = match self.kind {
            ClosureKind::Logarithmic { cutoff } if load < 0.0 => {
                logarithmic::balance(kappa, q, cutoff.map(|b_cut| b_cut / self.aperture))
            }
            ClosureKind::Hyperbolic { max_closure } => {
                hyperbolic::balance(kappa, q, max_closure / self.aperture)
            }
            ClosureKind::Own(law) if load < 0.0 => law.balance(kappa, q),
            _ => return self.opened(load / (self.normal_stiffness + spring)),
        };
        Separation {
            opening: self.aperture * y,
            aperture: self.aperture * x,
        }
    }

    /// The cutoff aperture (m), if the law has one.
    pub fn cutoff(&self) -> Option<f64> {
        match self.kind {
            ClosureKind::Logarithmic { cutoff } => cutoff,
            _ => None,
        }
    }

    /// How far the walls are from touching without load (m), negative once they do.
    pub fn gap(&self, separation: Separation) -> f64 {
        if self.kind == ClosureKind::Contact {
            separation.aperture
        } else {
            separation.opening
        }
    }

    /// Whether the stiffness is the same at any aperture.
    pub fn is_linear(&self) -> bool {
        let flat = self.cutoff().is_some_and(|cutoff| cutoff >= self.aperture);
        let constant = self.kind == ClosureKind::Linear || flat;
        (constant && self.tension == Tension::Elastic) || self.normal_stiffness == 0.0
    }

    /// Whether the stiffness changes gradually with the aperture.
    pub fn is_smooth(&self) -> bool {
        self.tension == Tension::Elastic || self.normal_stiffness == 0.0
    }
}

fn contact(aperture: f64) -> NormalResponse {
    if aperture > 0.0 {
        return NormalResponse::NONE;
    }
    let inside = if aperture < 0.0 { f64::INFINITY } else { 0.0 };
    NormalResponse {
        traction: -inside,
        tangent: f64::INFINITY,
        potential: inside,
    }
}
