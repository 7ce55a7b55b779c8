//! Closure and shear of a fracture together: from the jump to the traction.

use glam::{DMat3, DVec3};

use crate::closure::{Closure, Separation};

/// Law of a fracture without friction: elastic in shear, [`Closure`] across.
///
/// `t = sigma_n(b) n + K_s w_s`, with the potential `Psi(b) + K_s |w_s|^2 / 2`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FractureLaw {
    /// Normal part.
    pub closure: Closure,
    /// Shear stiffness `K_s` (Pa/m).
    pub shear_stiffness: f64,
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

impl FractureLaw {
    /// Response to `jump` (m) across a facet with unit `normal`.
    pub fn response(&self, jump: DVec3, normal: DVec3) -> Response {
        let opening = jump.dot(normal);
        let slip = jump - opening * normal;
        self.at(self.closure.opened(opening), slip, normal)
    }

    /// Response at a separation and `slip` (m).
    pub fn at(&self, separation: Separation, slip: DVec3, normal: DVec3) -> Response {
        let across = self.closure.at(separation);
        let shear = self.shear_stiffness;
        Response {
            traction: across.traction * normal + shear * slip,
            tangent: DMat3::from_diagonal(DVec3::splat(shear))
                + outer(normal, (across.tangent - shear) * normal),
            potential: across.potential + 0.5 * shear * slip.length_squared(),
        }
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
    fn tangent_is_the_derivative_of_the_traction() {
        let law = FractureLaw {
            closure: Closure {
                aperture: 1e-4,
                normal_stiffness: 1e11,
                kind: ClosureKind::Logarithmic { cutoff: Some(1e-6) },
            },
            shear_stiffness: 3e10,
        };
        let normal = DVec3::new(1.0, -2.0, 0.5).normalize();
        for opening in [-9.95e-5, -5e-5, 2e-5] {
            let jump = opening * normal + DVec3::new(1e-5, 2e-5, -1e-5);
            let tangent = law.response(jump, normal).tangent;
            for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
                let h = 1e-11 * axis;
                let change = law.response(jump + h, normal).traction
                    - law.response(jump - h, normal).traction;
                let difference = change / 2e-11 - tangent * axis;
                assert!(difference.length() < 1e-5 * tangent.x_axis.length());
            }
        }
    }
}
