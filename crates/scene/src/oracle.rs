//! Closed forms that a scene may name for a fracture.
//!
//! A joint that a pressure closes has a file of its own, `joint`. All others have the shape
//! `value(x) = amplitude sqrt(1 - rho(x)^2)`, with `rho` the distance from the centre as a share of
//! the radius: cracks in unbounded rock, opened by a pressure `p` or sheared by a stress drop
//! `tau`. With `nu`, `E`, `mu = E / (2 (1 + nu))` of the rock:
//!
//! - disc ("penny"), opening `8 (1 - nu^2) p a / (pi E)` (I. N. Sneddon, Proc. R. Soc. A 187,
//!   1946), slip `8 (1 - nu) tau a / (pi (2 - nu) mu)` (C. M. Segedin, Proc. Camb. Phil. Soc. 47,
//!   1951);
//! - strip ("line"), opening and slip `4 (1 - nu^2) p a / E` (A. A. Griffith, Phil. Trans. R. Soc.
//!   A 221, 1921);
//! - "uniform": the same everywhere, as given.

mod joint;

use std::f64::consts::PI;

use glam::DVec3;
use kluft_solver::Fracture;
use lie_core::{Closure, Rock};

use crate::reader::Section;
use joint::PressedJoint;

/// Share of the radius next to the front that measures "inside" leave out, unless given.
const RING: f64 = 0.1;

/// The closed form of one fracture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Oracle {
    /// Where the fracture lies.
    pub extent: Extent,
    opening: Option<Prescribed>,
    slip: Option<Prescribed>,
    /// Normal traction as given (Pa), tension positive.
    normal_traction: Option<f64>,
    joint: Option<PressedJoint>,
    /// Share of the radius next to the crack front that measures "inside" leave out.
    pub ring: f64,
}

/// Where the fracture lies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Extent {
    /// A disc.
    Disc {
        /// Its centre (m).
        centre: DVec3,
        /// Its radius (m).
        radius: f64,
    },
    /// Endless across `along` in its plane.
    Strip {
        /// A point of its middle line (m).
        centre: DVec3,
        /// Unit vector from the middle line to the crack front.
        along: DVec3,
        /// Half its length along that (m).
        half_length: f64,
    },
    /// All of the fracture.
    Everywhere,
}

/// What a closed form follows from.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Prescribed {
    /// A pressure or a stress drop (Pa).
    Stress(f64),
    /// The value itself (m).
    Length(f64),
}

/// One component of a jump in closed form.
#[derive(Debug, Clone, Copy)]
pub struct JumpProfile {
    /// Where the fracture lies.
    pub extent: Extent,
    /// Value at the centre (m).
    amplitude: f64,
}

impl Oracle {
    /// Opening in closed form, in this rock.
    pub fn opening(&self, rock: &Rock) -> Option<JumpProfile> {
        let (e, nu) = (rock.young_modulus, rock.poisson_ratio);
        let per_stress = match self.extent {
            Extent::Disc { radius, .. } => 8.0 * (1.0 - nu * nu) * radius / (PI * e),
            Extent::Strip { half_length, .. } => 4.0 * (1.0 - nu * nu) * half_length / e,
            Extent::Everywhere => 0.0,
        };
        self.profile(self.opening, per_stress)
    }

    /// Magnitude of the slip in closed form, in this rock.
    pub fn slip(&self, rock: &Rock) -> Option<JumpProfile> {
        let (e, nu) = (rock.young_modulus, rock.poisson_ratio);
        let mu = e / (2.0 * (1.0 + nu));
        let per_stress = match self.extent {
            Extent::Disc { radius, .. } => 8.0 * (1.0 - nu) * radius / (PI * (2.0 - nu) * mu),
            Extent::Strip { half_length, .. } => 4.0 * (1.0 - nu * nu) * half_length / e,
            Extent::Everywhere => 0.0,
        };
        self.profile(self.slip, per_stress)
    }

    /// Normal traction everywhere (Pa), tension positive: as given, or what a joint with this law
    /// carries.
    pub fn normal_traction(&self, rock: &Rock, closure: &Closure) -> Option<f64> {
        let carried = |joint: PressedJoint| joint.carried(rock, closure);
        let of_joint = self.joint.and_then(carried).map(|pressure| -pressure);
        self.normal_traction.or(of_joint)
    }

    /// Aperture everywhere (m) of a joint with this law; none where it is 0, of which no error is a
    /// share.
    pub fn aperture(&self, rock: &Rock, closure: &Closure) -> Option<f64> {
        let aperture = self.joint?.aperture(rock, closure);
        aperture.filter(|aperture| *aperture != 0.0)
    }

    /// Why the closed form does not hold for a fracture, and the remedy.
    pub(crate) fn refusal(
        &self,
        fracture: &Fracture,
        is_isotropic: bool,
    ) -> Option<[&'static str; 2]> {
        let is_crack = !matches!(self.extent, Extent::Everywhere);
        let is_sphere = matches!(self.joint, Some(PressedJoint::Sphere { .. }));
        if !is_isotropic && (is_crack || is_sphere) {
            return Some([
                "this closed form holds in isotropic rock only",
                "remove it, or the constants that depend on the direction",
            ]);
        }
        self.joint?;
        if fracture.law.closure.normal_stiffness == 0.0 {
            return Some([
                "a fracture without stiffness carries no pressure",
                "give the fracture a normal_stiffness, or remove the closed form",
            ]);
        }
        (is_sphere && fracture.fluid_pressure != 0.0).then_some([
            "the closed form of a sphere has no fluid pressure",
            "remove the fluid_pressure of the fracture, or the closed form",
        ])
    }

    fn profile(&self, amount: Option<Prescribed>, per_stress: f64) -> Option<JumpProfile> {
        let amplitude = match amount? {
            Prescribed::Stress(stress) => stress * per_stress,
            Prescribed::Length(length) => length,
        };
        Some(JumpProfile {
            extent: self.extent,
            amplitude,
        })
    }

    /// `K_I` of the opening pressure (Pa sqrt(m)): `2 p sqrt(a / pi)` of a disc, `p sqrt(pi a)` of
    /// a strip.
    pub fn stress_intensity(&self) -> Option<f64> {
        let Some(Prescribed::Stress(p)) = self.opening else {
            return None;
        };
        match self.extent {
            Extent::Disc { radius, .. } => Some(2.0 * p * (radius / PI).sqrt()),
            Extent::Strip { half_length, .. } => Some(p * (PI * half_length).sqrt()),
            Extent::Everywhere => None,
        }
    }
}

impl Extent {
    /// Distance from the centre as a share of the radius.
    pub fn rho(&self, x: DVec3) -> f64 {
        match *self {
            Self::Disc { centre, radius } => (x - centre).length() / radius,
            Self::Strip {
                centre,
                along,
                half_length,
            } => (x - centre).dot(along).abs() / half_length,
            Self::Everywhere => 0.0,
        }
    }

    /// Radius or half-length (m).
    pub fn radius(&self) -> Option<f64> {
        match *self {
            Self::Disc { radius, .. } => Some(radius),
            Self::Strip { half_length, .. } => Some(half_length),
            Self::Everywhere => None,
        }
    }
}

impl JumpProfile {
    /// The value at a place.
    pub fn at(&self, x: DVec3) -> f64 {
        let rho = self.extent.rho(x);
        self.amplitude * (1.0 - rho * rho).max(0.0).sqrt()
    }

    /// Integral over a fracture whose facets have this area (m^2).
    pub fn volume(&self, area: f64) -> f64 {
        match self.extent {
            Extent::Disc { radius, .. } => 2.0 / 3.0 * PI * radius * radius * self.amplitude,
            Extent::Strip { .. } => 0.25 * PI * area * self.amplitude,
            Extent::Everywhere => area * self.amplitude,
        }
    }
}

/// Reads the section of one fracture.
pub(crate) fn read(section: &Section<'_, '_>) -> Option<Oracle> {
    section.require("form");
    let name = section.choice("form");
    if let Some("column" | "sphere") = name {
        let joint = joint::read(section, name == Some("sphere"))?;
        return Some(Oracle {
            extent: Extent::Everywhere,
            opening: None,
            slip: None,
            normal_traction: None,
            joint: Some(joint),
            ring: 0.0,
        });
    }
    let centre = || section.vector("centre").map(DVec3::from);
    let extent = match name? {
        "penny" => {
            section.require("centre");
            section.require("radius");
            let (centre, radius) = (centre(), section.number("radius"));
            centre
                .zip(radius)
                .map(|(centre, radius)| Extent::Disc { centre, radius })
        }
        "line" => read_strip(section, centre),
        "uniform" => Some(Extent::Everywhere),
        _ => None,
    };
    let crack = name? != "uniform";
    let stress = |key| section.number(key).map(Prescribed::Stress);
    let length = |key| section.number(key).map(Prescribed::Length);
    let (opening, slip) = match crack {
        true => (stress("pressure"), stress("stress_drop")),
        false => (length("opening"), length("slip")),
    };
    let normal_traction = section.number("normal_traction");
    let ring = section.number("ring");
    if opening.is_none() && slip.is_none() && normal_traction.is_none() {
        let keys = match crack {
            true => "`pressure`, `stress_drop` (Pa) and `normal_traction`",
            false => "`opening`, `slip` (m) and `normal_traction`",
        };
        section.refuse(
            "form",
            "the closed form says nothing".into(),
            format!("give at least one of {keys}"),
        );
        return None;
    }
    Some(Oracle {
        extent: extent?,
        opening,
        slip,
        normal_traction,
        joint: None,
        ring: if crack { ring.unwrap_or(RING) } else { 0.0 },
    })
}

fn read_strip(section: &Section<'_, '_>, centre: impl Fn() -> Option<DVec3>) -> Option<Extent> {
    for key in ["centre", "along", "half_length"] {
        section.require(key);
    }
    let along = section.vector("along").map(DVec3::from);
    let direction = along.and_then(DVec3::try_normalize);
    if along.is_some() && direction.is_none() {
        section.refuse(
            "along",
            "`along` has no direction".into(),
            "give the direction from the middle of the crack to its front, in its plane",
        );
    }
    Some(Extent::Strip {
        centre: centre()?,
        along: direction?,
        half_length: section.number("half_length")?,
    })
}

#[cfg(test)]
mod tests;
