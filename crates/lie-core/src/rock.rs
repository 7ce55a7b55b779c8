//! Linear elastic rock.

use std::sync::Arc;

use glam::{DMat3, DVec3};

use crate::anisotropy::{Anisotropy, Orthotropy};

/// Stress as its six components `xx, yy, zz, xy, yz, xz` (Pa), tension positive.
pub type SymmetricStress = [f64; 6];

/// Elastic constants of a rock.
#[derive(Debug, Clone, PartialEq)]
pub struct Rock {
    /// Young's modulus `E` (Pa); of an anisotropic rock that of the nearest isotropic one, a scale.
    pub young_modulus: f64,
    /// Poisson's ratio, likewise.
    pub poisson_ratio: f64,
    /// Density (kg/m^3); 0 where gravity plays no part.
    pub density: f64,
    /// The stiffness, if it is not isotropic.
    pub anisotropy: Option<Arc<Anisotropy>>,
}

/// What makes a stiffness of a cell's shape, see [`Elasticity::block`].
#[derive(Debug, Clone, Copy)]
pub enum Elasticity<'a> {
    /// Lamé's constants `lambda`, `mu` (Pa).
    Isotropic(f64, f64),
    /// All components.
    Anisotropic(&'a Anisotropy),
}

impl Elasticity<'_> {
    /// Stiffness between two nodes (N/m) from `M = int g_a (x) g_b dV` (m), `g = grad N`:
    /// `K_ik = sum_jl C_ijkl M_jl`, which is `lambda M + mu M^T + mu tr(M) I` in isotropic rock.
    #[inline]
    pub fn block(self, m: DMat3) -> DMat3 {
        match self {
            Self::Isotropic(lambda, mu) => {
                let trace = m.x_axis.x + m.y_axis.y + m.z_axis.z;
                lambda * m + mu * m.transpose() + DMat3::from_diagonal(DVec3::splat(mu * trace))
            }
            Self::Anisotropic(rock) => rock.block(&m),
        }
    }
}

impl Rock {
    /// Rock that nothing deforms: its stiffness is infinite. Elements take none of it.
    pub fn rigid(density: f64) -> Self {
        Self {
            young_modulus: f64::INFINITY,
            poisson_ratio: 0.0,
            density,
            anisotropy: None,
        }
    }

    /// Rock with these constants, which must be positive definite.
    pub fn orthotropic(constants: &Orthotropy, density: f64) -> Self {
        let anisotropy = Anisotropy::of(constants);
        let [bulk, shear] = anisotropy.nearest_isotropic();
        Self {
            young_modulus: 9.0 * bulk * shear / (3.0 * bulk + shear),
            poisson_ratio: (3.0 * bulk - 2.0 * shear) / (2.0 * (3.0 * bulk + shear)),
            density,
            anisotropy: Some(Arc::new(anisotropy)),
        }
    }

    /// What makes stiffnesses of cells.
    pub fn elasticity(&self) -> Elasticity<'_> {
        match &self.anisotropy {
            Some(anisotropy) => Elasticity::Anisotropic(anisotropy),
            None => {
                let (lambda, mu) = self.lame();
                Elasticity::Isotropic(lambda, mu)
            }
        }
    }

    /// Whether nothing deforms it.
    pub fn is_rigid(&self) -> bool {
        self.young_modulus == f64::INFINITY
    }

    /// Lamé's constants `(lambda, mu)` (Pa), of an anisotropic rock those of the nearest isotropic
    /// one.
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
    /// `((1 + nu) sigma : sigma - nu tr(sigma)^2) / E` in isotropic rock.
    #[inline]
    pub fn energy_density(&self, stress: &SymmetricStress) -> f64 {
        let [xx, yy, zz, xy, yz, xz] = *stress;
        if let Some(anisotropy) = &self.anisotropy {
            let columns = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
            return anisotropy.energy_density(DMat3::from_cols_array_2d(&columns));
        }
        let square = xx * xx + yy * yy + zz * zz + 2.0 * (xy * xy + yz * yz + xz * xz);
        let trace = xx + yy + zz;
        let nu = self.poisson_ratio;
        ((1.0 + nu) * square - nu * trace * trace) / self.young_modulus
    }

    /// Stress at the displacement gradient `H_ij = du_i/dx_j`:
    /// `sigma = C eps`, `eps = (H + H^T) / 2`; `lambda tr(eps) I + 2 mu eps` in isotropic rock.
    pub fn stress(&self, gradient: DMat3) -> DMat3 {
        if let Some(anisotropy) = &self.anisotropy {
            return anisotropy.stress(gradient);
        }
        let (lambda, mu) = self.lame();
        let trace = gradient.x_axis.x + gradient.y_axis.y + gradient.z_axis.z;
        DMat3::from_diagonal(DVec3::splat(lambda * trace)) + (gradient + gradient.transpose()) * mu
    }
}
