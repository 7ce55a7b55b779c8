//! Closure, shear and friction of a fracture together.

use glam::{DMat3, DVec3};

use crate::closure::{Closure, NormalBalance, Separation, Tension};

/// Coulomb friction: the shear traction is at most `c - tan(phi) sigma_n`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Friction {
    /// `tan(phi)` of the friction angle.
    pub coefficient: f64,
    /// Cohesion `c` (Pa); lost once the walls are an aperture apart or a bond is broken.
    pub cohesion: f64,
    /// `tan(psi)` of the dilation angle: opening per slip beyond the elastic slip, `<= coefficient`.
    pub dilation: f64,
}

/// Law of a fracture: [`Closure`] across, elastic in shear, sliding by [`Friction`] if it has any.
///
/// `t = sigma_n(b) n + K_s w_s`, with the potential `Psi(b) + K_s |w_s|^2 / 2`, as long as it does
/// not slide. A fracture without friction whose tension is cut off lets go of its shear as it opens,
/// see `FractureLaw::hold`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FractureLaw {
    /// Normal part.
    pub closure: Closure,
    /// Shear stiffness `K_s` (Pa/m); infinite if only friction lets the walls slide.
    pub shear_stiffness: f64,
    /// Friction, if the shear traction is limited.
    pub friction: Option<Friction>,
}

/// Answer of a fracture law at one jump.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Response {
    /// Traction `t = stress . n` (Pa): what the plus side does to the wall of the minus side.
    pub traction: DVec3,
    /// `dt/dw` (Pa/m), symmetric.
    pub tangent: DMat3,
    /// Energy per area (J/m^2).
    pub potential: f64,
}

/// How much of the shear stiffness an open fracture keeps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ShearRetention {
    /// `g`, from 1 to 0.
    pub(crate) share: f64,
    /// `dg/dw_n` (1/m).
    pub(crate) slope: f64,
    /// `d^2 g/dw_n^2` (1/m^2).
    pub(crate) curvature: f64,
}

impl ShearRetention {
    const WHOLE: Self = Self {
        share: 1.0,
        slope: 0.0,
        curvature: 0.0,
    };

    /// `g = (1 - z)^2 (1 + 2 z)` with `z = opening / range` between 0 and 1.
    pub(crate) fn fading(opening: f64, range: f64) -> Self {
        let z = if range > 0.0 {
            opening / range
        } else {
            f64::from(u8::from(opening > 0.0))
        };
        if z <= 0.0 {
            return Self::WHOLE;
        }
        if z >= 1.0 {
            return Self {
                share: 0.0,
                slope: 0.0,
                curvature: 0.0,
            };
        }
        Self {
            share: (1.0 - z).powi(2) * (1.0 + 2.0 * z),
            slope: -6.0 * z * (1.0 - z) / range,
            curvature: (12.0 * z - 6.0) / (range * range),
        }
    }
}

impl FractureLaw {
    /// A fracture without friction.
    pub fn elastic(closure: Closure, shear_stiffness: f64) -> Self {
        Self {
            closure,
            shear_stiffness,
            friction: None,
        }
    }

    /// Response to `jump` (m) across a facet with unit `normal`, of a fracture that never slid.
    pub fn response(&self, jump: DVec3, normal: DVec3) -> Response {
        let opening = jump.dot(normal);
        let slip = jump - opening * normal;
        self.at(self.closure.opened(opening), slip, normal)
    }

    /// Elastic response at a separation and `slip` (m): with the share `g` of the shear stiffness that an open fracture keeps,
    /// `Psi(b) + g(w_n) K_s |w_s|^2 / 2`, its gradient and its second derivative.
    pub fn at(&self, separation: Separation, slip: DVec3, normal: DVec3) -> Response {
        let across = self.closure.at(separation);
        let hold = self.hold(separation);
        let balance = NormalBalance {
            separation,
            traction: across.traction,
        };
        let walls = self.elastic_state(balance, slip, self.shear_stiffness);
        let shear = hold.share * self.shear_stiffness;
        let energy = 0.5 * self.shear_stiffness * slip.length_squared();
        let coupling = hold.slope * self.shear_stiffness * slip;
        let across_tangent = across.tangent + hold.curvature * energy;
        Response {
            traction: walls.traction(normal),
            tangent: DMat3::from_diagonal(DVec3::splat(shear))
                + outer(normal, (across_tangent - shear) * normal)
                + outer(normal, coupling)
                + outer(coupling, normal),
            potential: across.potential + hold.share * energy,
        }
    }

    /// How much of the shear stiffness is left at a separation.
    ///
    /// If tension is cut off, an open fracture has no business carrying shear. To drop it all at once
    /// would make the law jump, and to drop it without a word to the normal traction would make it
    /// give or take energy over a cycle of loads. So the stiffness fades over one aperture, and the
    /// energy that the slip loses by it pushes the walls apart.
    pub(crate) fn hold(&self, separation: Separation) -> ShearRetention {
        let lets_go = self.closure.tension == Tension::CutOff && self.friction.is_none();
        if lets_go && self.closure.normal_stiffness > 0.0 {
            ShearRetention::fading(self.closure.gap(separation), self.closure.aperture)
        } else {
            ShearRetention::WHOLE
        }
    }

    /// Whether traction is proportional to the jump.
    pub fn is_linear(&self) -> bool {
        self.friction.is_none() && self.closure.is_linear()
    }

    /// Whether the tangent changes gradually: no sliding, no end of contact.
    pub fn is_smooth(&self) -> bool {
        self.friction.is_none() && self.closure.is_smooth()
    }

    /// Whether the traction depends on how a jump was reached.
    pub fn is_path_dependent(&self) -> bool {
        self.friction.is_some() || matches!(self.closure.tension, Tension::Cohesive { .. })
    }
}

/// `a b^T`.
pub(crate) fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::closure::ClosureKind;

    #[test]
    fn tangent_is_the_derivative_of_the_traction_and_traction_that_of_the_potential() {
        let kind = ClosureKind::Logarithmic { cutoff: Some(1e-6) };
        let mut closure = Closure::new(1e-4, 1e11, kind);
        let normal = DVec3::new(1.0, -2.0, 0.5).normalize();
        for tension in [Tension::Elastic, Tension::CutOff] {
            closure.tension = tension;
            let law = FractureLaw::elastic(closure, 3e10);
            for opening in [-9.95e-5, -5e-5, 2e-5, 7e-5, 2e-4] {
                let jump = opening * normal + DVec3::new(1e-5, 2e-5, -1e-5);
                let here = law.response(jump, normal);
                for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
                    let h = 1e-11 * axis;
                    let (above, below) = (
                        law.response(jump + h, normal),
                        law.response(jump - h, normal),
                    );
                    let change = above.traction - below.traction;
                    let difference = change / 2e-11 - here.tangent * axis;
                    assert!(difference.length() < 1e-5 * 1e11);
                    let force = (above.potential - below.potential) / 2e-11;
                    assert!((force - here.traction.dot(axis)).abs() < 1e-4 * 1e7);
                }
            }
        }
    }
}
