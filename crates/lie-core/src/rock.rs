//! Linear elastic rock.

use glam::{DMat3, DVec3};

/// Stress as its six components `xx, yy, zz, xy, yz, xz` (Pa), tension positive.
pub type SymmetricStress = [f64; 6];

/// Elastic constants of an isotropic rock.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rock {
    /// Young's modulus `E` (Pa).
    pub young_modulus: f64,
    /// Poisson's ratio.
    pub poisson_ratio: f64,
    /// Density (kg/m^3); 0 where gravity plays no part.
    pub density: f64,
}

impl Rock {
    /// Rock that nothing deforms: its stiffness is infinite. Elements take none of it.
    pub fn rigid(density: f64) -> Self {
        Self {
            young_modulus: f64::INFINITY,
            poisson_ratio: 0.0,
            density,
        }
    }

    /// Whether nothing deforms it.
    pub fn is_rigid(&self) -> bool {
        self.young_modulus == f64::INFINITY
    }

    /// Lamé's constants `(lambda, mu)` (Pa).
    pub fn lame(&self) -> (f64, f64) {
        let (e, nu) = (self.young_modulus, self.poisson_ratio);
        (
            e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)),
            e / (2.0 * (1.0 + nu)),
        )
    }

    /// Constrained modulus `lambda + 2 mu` (Pa).
    pub fn constrained_modulus(&self) -> f64 {
        let (lambda, mu) = self.lame();
        lambda + 2.0 * mu
    }

    /// Energy density of a stress, `sigma : C^-1 : sigma` (J/m^3), twice what the rock stores:
    /// `((1 + nu) sigma : sigma - nu tr(sigma)^2) / E`.
    pub fn energy_density(&self, stress: &SymmetricStress) -> f64 {
        let [xx, yy, zz, xy, yz, xz] = *stress;
        let square = xx * xx + yy * yy + zz * zz + 2.0 * (xy * xy + yz * yz + xz * xz);
        let trace = xx + yy + zz;
        let nu = self.poisson_ratio;
        ((1.0 + nu) * square - nu * trace * trace) / self.young_modulus
    }

    /// Stress at the displacement gradient `H_ij = du_i/dx_j`:
    /// `sigma = lambda tr(eps) I + 2 mu eps`, `eps = (H + H^T) / 2`.
    pub fn stress(&self, gradient: DMat3) -> DMat3 {
        let (lambda, mu) = self.lame();
        let trace = gradient.x_axis.x + gradient.y_axis.y + gradient.z_axis.z;
        DMat3::from_diagonal(DVec3::splat(lambda * trace)) + (gradient + gradient.transpose()) * mu
    }
}
