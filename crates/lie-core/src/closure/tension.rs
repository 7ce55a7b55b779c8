//! What a fracture does in tension.

use super::NormalResponse;

/// Normal traction of a fracture that opens beyond its aperture without load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Tension {
    /// The stiffness without load, `K_n0`, for ever.
    Elastic,
    /// None.
    CutOff,
    /// A bond that breaks in mode I: stiff to its strength, then softening linearly with the
    /// opening until the energy is spent; unloading to the origin.
    ///
    /// With `w_p = t / K_n0` and `w_f = 2 G / t`, and the largest opening of the past
    /// `w_d = max(w_p, largest)`: `sigma_n = t (w_f - w) / (w_f - w_p)` for `w_d < w < w_f`, 0
    /// beyond, and the line from there to the origin below `w_d`.
    Cohesive {
        /// Tensile strength `t` (Pa).
        strength: f64,
        /// Energy `G` to break the bond (J/m^2), more than `t^2 / (2 K_n0)`.
        energy: f64,
    },
}

/// The softening line of a cohesive bond.
struct Softening {
    strength: f64,
    peak: f64,
    broken: f64,
}

impl Softening {
    fn of(stiffness: f64, strength: f64, energy: f64) -> Self {
        Self {
            strength,
            peak: strength / stiffness,
            broken: 2.0 * energy / strength,
        }
    }

    fn traction(&self, opening: f64) -> f64 {
        let left = ((self.broken - opening) / (self.broken - self.peak)).clamp(0.0, 1.0);
        self.strength * left
    }

    /// How fast the traction falls (Pa/m).
    fn steepness(&self) -> f64 {
        self.strength / (self.broken - self.peak)
    }
}

impl Tension {
    /// Response at an opening `w > 0` (m) after the largest opening of the past (m).
    pub(super) fn at(&self, stiffness: f64, w: f64, largest: f64) -> NormalResponse {
        match *self {
            Self::Elastic => NormalResponse {
                traction: stiffness * w,
                tangent: stiffness,
                potential: 0.5 * stiffness * w * w,
            },
            Self::CutOff => NormalResponse::NONE,
            Self::Cohesive { strength, energy } => {
                let line = Softening::of(stiffness, strength, energy);
                let reached = largest.max(line.peak);
                let secant = line.traction(reached) / reached;
                let traction = if w <= reached {
                    secant * w
                } else {
                    line.traction(w)
                };
                let tangent = if w <= reached {
                    secant
                } else if w < line.broken {
                    -line.steepness()
                } else {
                    0.0
                };
                NormalResponse {
                    traction,
                    tangent,
                    // Of the bond as it is: what unloading gives back.
                    potential: 0.5 * traction * w,
                }
            }
        }
    }

    /// Root `w` of `sigma_n(w) + k w = load > 0`, with `k = spring >= 0` (Pa/m); 0 if nothing
    /// resists.
    pub(super) fn balanced(&self, stiffness: f64, spring: f64, load: f64, largest: f64) -> f64 {
        let alone = if spring > 0.0 { load / spring } else { 0.0 };
        match *self {
            Self::Elastic => load / (stiffness + spring),
            Self::CutOff => alone,
            Self::Cohesive { strength, energy } => {
                let line = Softening::of(stiffness, strength, energy);
                let reached = largest.max(line.peak);
                let secant = line.traction(reached) / reached;
                let whole = load / (secant + spring);
                if whole <= reached {
                    return whole;
                }
                let steepness = line.steepness();
                let softening = (load - line.broken * steepness) / (spring - steepness);
                if spring > steepness && softening < line.broken {
                    softening
                } else {
                    alone.max(line.broken)
                }
            }
        }
    }

    /// Share of the bond that is broken after the largest opening of the past (m): 0 of a whole
    /// bond and of a fracture that has none.
    pub(crate) fn damage(&self, stiffness: f64, largest: f64) -> f64 {
        match *self {
            Self::Cohesive { strength, energy } => {
                let line = Softening::of(stiffness, strength, energy);
                let reached = largest.max(line.peak);
                1.0 - line.traction(reached) / reached / stiffness
            }
            _ => 0.0,
        }
    }
}
