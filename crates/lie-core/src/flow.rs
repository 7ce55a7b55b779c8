//! Flow along a fracture at a point: hydraulic aperture and transmissivity, with their slopes.
//!
//! The flux along a fracture is `q = -T grad(p - rho g . x)` (m^2/s) with the transmissivity of the
//! cubic law, `T = b_h^3 / (12 mu)`. The hydraulic aperture `b_h` follows from the aperture `b`:
//!
//! ```text
//! b_h^3 = e(b)^3 + r^3,    e(b) = 0                                 where b <= 0
//!                          e(b) = b / f^(1/3)                       with a roughness factor f >= 1
//!                          e(b) = min(b, b^2 / (JRC^2.5 1e-6 m))    with a roughness coefficient
//! ```
//!
//! The residual aperture `r` is what walls in contact leave open. The factor is that of Witherspoon
//! et al. (1980), `T = b^3 / (12 f mu)`; the joint roughness coefficient is that of Barton, Bandis
//! and Bakhtar (1985), who state it for apertures in micrometres. All of it grows with `b`, and
//! with a residual aperture it is positive whatever `b` is.

/// Length that Barton's formula is stated in (m).
const MICROMETRE: f64 = 1e-6;

/// How rough walls narrow the aperture for a flow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Roughness {
    /// The factor `f >= 1` by which they lower the transmissivity; 1 for smooth walls.
    Factor(f64),
    /// Barton's joint roughness coefficient, 0 to 20.
    Coefficient(f64),
}

/// The hydraulic aperture of a fracture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum HydraulicAperture {
    /// The same at any aperture (m).
    Constant(f64),
    /// That of the walls.
    OfWalls {
        /// How rough they are.
        roughness: Roughness,
        /// What they leave open in contact, `r` (m).
        residual: f64,
    },
}

/// How a fracture conducts at one aperture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conduction {
    /// Hydraulic aperture `b_h` (m).
    pub hydraulic_aperture: f64,
    /// `d b_h / d b`.
    pub slope: f64,
}

impl Roughness {
    /// `e(b)` (m) and its slope.
    fn narrowed(self, aperture: f64) -> (f64, f64) {
        if aperture <= 0.0 {
            return (0.0, 0.0);
        }
        match self {
            Self::Factor(factor) => (aperture / factor.cbrt(), 1.0 / factor.cbrt()),
            Self::Coefficient(coefficient) => {
                let length = coefficient.powf(2.5) * MICROMETRE;
                if aperture >= length {
                    (aperture, 1.0)
                } else {
                    (aperture * (aperture / length), 2.0 * aperture / length)
                }
            }
        }
    }
}

impl HydraulicAperture {
    /// How a fracture conducts at an aperture (m), which may be negative.
    pub fn at(self, aperture: f64) -> Conduction {
        let (roughness, residual) = match self {
            Self::Constant(constant) => {
                return Conduction {
                    hydraulic_aperture: constant,
                    slope: 0.0,
                };
            }
            Self::OfWalls {
                roughness,
                residual,
            } => (roughness, residual),
        };
        let (narrowed, slope) = roughness.narrowed(aperture);
        if residual == 0.0 {
            return Conduction {
                hydraulic_aperture: narrowed,
                slope,
            };
        }
        let whole = (narrowed.powi(3) + residual.powi(3)).cbrt();
        Conduction {
            hydraulic_aperture: whole,
            slope: (narrowed / whole).powi(2) * slope,
        }
    }

    /// Whether it does not depend on the aperture.
    pub fn is_constant(self) -> bool {
        matches!(self, Self::Constant(_))
    }
}

impl Conduction {
    /// Transmissivity (m^3/(Pa s)) for a fluid of this viscosity `mu` (Pa s): `T = b_h^3 / (12
    /// mu)`.
    pub fn transmissivity(&self, viscosity: f64) -> f64 {
        self.hydraulic_aperture.powi(3) / (12.0 * viscosity)
    }

    /// `dT/db` (m^2/(Pa s)): `b_h^2 / (4 mu)` times the slope of the hydraulic aperture.
    pub fn transmissivity_slope(&self, viscosity: f64) -> f64 {
        self.hydraulic_aperture.powi(2) / (4.0 * viscosity) * self.slope
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const VISCOSITY: f64 = 1e-3;

    fn of_walls(roughness: Roughness, residual: f64) -> HydraulicAperture {
        HydraulicAperture::OfWalls {
            roughness,
            residual,
        }
    }

    fn is_close(found: f64, expected: f64) {
        let error = (found - expected).abs();
        assert!(error <= 1e-12 * expected.abs(), "{found} {expected}");
    }

    #[test]
    fn smooth_walls_follow_the_cubic_law() {
        let conduction = of_walls(Roughness::Factor(1.0), 0.0).at(1e-4);
        assert_eq!(conduction.hydraulic_aperture, 1e-4);
        is_close(conduction.transmissivity(VISCOSITY), 1e-12 / 12e-3);
        is_close(conduction.transmissivity_slope(VISCOSITY), 1e-8 / 4e-3);
    }

    #[test]
    fn a_factor_divides_the_transmissivity_and_a_residual_adds_to_it() {
        let rough = of_walls(Roughness::Factor(1.5), 3e-5).at(1e-4);
        let expected = (1e-12 / 1.5 + 2.7e-14) / 12e-3;
        is_close(rough.transmissivity(VISCOSITY), expected);
    }

    /// JRC 8 has 8^2.5 = 181.0193: 100 um narrow to 1e4 / 181.0193 = 55.24272 um, and 250 um not.
    #[test]
    fn a_roughness_coefficient_narrows_tight_joints_only() {
        let joint = of_walls(Roughness::Coefficient(8.0), 0.0);
        let tight = joint.at(1e-4).hydraulic_aperture;
        assert!((tight - 55.242_717e-6).abs() < 1e-12, "{tight}");
        assert_eq!(joint.at(2.5e-4).hydraulic_aperture, 2.5e-4);
    }

    #[test]
    fn overlapping_walls_conduct_by_their_residual_aperture() {
        for aperture in [0.0, -1e-5] {
            let closed = of_walls(Roughness::Factor(2.0), 1e-6).at(aperture);
            is_close(closed.hydraulic_aperture, 1e-6);
            assert_eq!(closed.slope, 0.0);
        }
        let shut = of_walls(Roughness::Coefficient(9.0), 0.0).at(-1e-5);
        assert_eq!(shut.transmissivity(VISCOSITY), 0.0);
    }

    #[test]
    fn a_constant_does_not_follow_the_walls() {
        let constant = HydraulicAperture::Constant(2e-4);
        assert!(constant.is_constant());
        for aperture in [-1.0, 0.0, 1e-3] {
            let conduction = constant.at(aperture);
            assert_eq!(
                (conduction.hydraulic_aperture, conduction.slope),
                (2e-4, 0.0)
            );
            assert_eq!(conduction.transmissivity_slope(VISCOSITY), 0.0);
        }
    }

    /// Central differences, whose error is of the order of the square of their step.
    #[test]
    fn slopes_are_those_of_differences() {
        let laws = [
            of_walls(Roughness::Factor(1.0), 0.0),
            of_walls(Roughness::Factor(1.7), 2e-5),
            of_walls(Roughness::Coefficient(6.0), 0.0),
            of_walls(Roughness::Coefficient(12.0), 5e-6),
        ];
        for law in laws {
            for aperture in [2e-6, 3e-5, 8e-5, 4e-4, 2e-3] {
                let step = 1e-5 * aperture;
                let [below, above] = [-step, step].map(|by| law.at(aperture + by));
                let here = law.at(aperture);
                let rise = |of: &dyn Fn(&Conduction) -> f64| {
                    let rounding = 4.0 * f64::EPSILON * of(&above);
                    [of(&above) - of(&below), rounding].map(|value| value / (2.0 * step))
                };
                let pairs = [
                    (here.slope, rise(&|c| c.hydraulic_aperture)),
                    (
                        here.transmissivity_slope(VISCOSITY),
                        rise(&|c| c.transmissivity(VISCOSITY)),
                    ),
                ];
                for (slope, [difference, rounding]) in pairs {
                    let error = (slope - difference).abs();
                    let is_close = error < 1e-8 * slope + rounding;
                    assert!(is_close, "{law:?} at {aperture}: {slope} {difference}");
                }
            }
        }
    }

    #[test]
    fn what_conducts_grows_with_the_aperture() {
        for law in [
            of_walls(Roughness::Factor(1.2), 1e-6),
            of_walls(Roughness::Coefficient(10.0), 1e-6),
        ] {
            let apertures = (-5..400).map(|i| f64::from(i) * 1e-6);
            let widths: Vec<f64> = apertures.map(|b| law.at(b).hydraulic_aperture).collect();
            assert!(widths.iter().all(|width| *width > 0.0));
            assert!(widths.is_sorted(), "{law:?}");
        }
    }
}
