//! Linear elastic rock that is stiffer in some directions than in others.

use glam::{DMat3, DVec3};

/// Axes 1 and 2, 2 and 3, 1 and 3: the order of the components `xy, yz, xz`.
const PAIRS: [[usize; 2]; 3] = [[0, 1], [1, 2], [0, 2]];

/// Engineering constants of an orthotropic rock along its axes 1, 2 and 3.
///
/// A stress along axis `i` strains axis `j` by `-nu_ij / E_i` (S. G. Lekhnitskii, Theory of
/// elasticity of an anisotropic body, 1981).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Orthotropy {
    /// Young's moduli `E_1, E_2, E_3` (Pa).
    pub young_moduli: [f64; 3],
    /// Poisson's ratios `nu_12, nu_23, nu_13`.
    pub poisson_ratios: [f64; 3],
    /// Shear moduli `G_12, G_23, G_13` (Pa).
    pub shear_moduli: [f64; 3],
    /// Unit vectors of the axes, one a column, at right angles.
    pub axes: DMat3,
}

impl Orthotropy {
    /// A rock that is the same in all directions of the plane of axes 1 and 2: `[E, E']` (Pa) and
    /// `[nu, nu']` in and across it, the shear modulus `G'` across it (Pa). A stress across the
    /// plane strains it by `-nu'/E'` (B. Amadei, Int. J. Rock Mech. Min. Sci. 33, 1996).
    pub fn transverse(
        [e, across]: [f64; 2],
        [nu, nu_across]: [f64; 2],
        shear_across: f64,
        axes: DMat3,
    ) -> Self {
        // `nu_i3 / E_i = nu' / E'`.
        let out = nu_across * e / across;
        Self {
            young_moduli: [e, e, across],
            poisson_ratios: [nu, out, out],
            shear_moduli: [0.5 * e / (1.0 + nu), shear_across, shear_across],
            axes,
        }
    }

    /// What the stretches along the axes are for stresses along them (1/Pa).
    fn stretching(&self) -> DMat3 {
        let mut compliance = DMat3::from_diagonal(DVec3::from(self.young_moduli).recip());
        for ([i, j], nu) in PAIRS.into_iter().zip(self.poisson_ratios) {
            let coupled = -nu / self.young_moduli[i];
            compliance.col_mut(i)[j] = coupled;
            compliance.col_mut(j)[i] = coupled;
        }
        compliance
    }

    /// Share of `1/(E_1 E_2 E_3)` that the determinant of the stretches has: 1 without Poisson's
    /// effect, 0 where some stress would cost no energy.
    ///
    /// `1 - nu_12 nu_21 - nu_23 nu_32 - nu_13 nu_31 - 2 nu_21 nu_32 nu_13`.
    pub fn definiteness(&self) -> f64 {
        let scale = DMat3::from_diagonal(DVec3::from(self.young_moduli.map(f64::sqrt)));
        (scale * self.stretching() * scale).determinant()
    }

    /// The largest magnitudes that Poisson's ratios may have, each by itself: `sqrt(E_i / E_j)`.
    pub fn poisson_bounds(&self) -> [f64; 3] {
        PAIRS.map(|[i, j]| (self.young_moduli[i] / self.young_moduli[j]).sqrt())
    }

    /// Whether every strain costs energy.
    pub fn is_positive_definite(&self) -> bool {
        /// Rounding of the determinant, and the least that leaves its inverse some digits.
        const LEAST: f64 = 1e-9;
        let mut pairs = self.poisson_ratios.iter().zip(self.poisson_bounds());
        pairs.all(|(nu, bound)| nu.abs() < bound) && self.definiteness() > LEAST
    }
}

/// Stiffness of a rock that is not isotropic, ready for use.
#[derive(Debug, Clone, PartialEq)]
pub struct Anisotropy {
    axes: DMat3,
    /// Stretches for stresses along the axes (1/Pa), and the other way round (Pa).
    stretching: DMat3,
    stiffness: DMat3,
    shear_moduli: [f64; 3],
    /// `between[3 i + k]_jl = C_ijkl` (Pa).
    between: [DMat3; 9],
}

impl Anisotropy {
    /// The stiffness with these constants, which must be positive definite.
    pub fn of(constants: &Orthotropy) -> Self {
        let stretching = constants.stretching();
        let mut own = Self {
            axes: constants.axes,
            stretching,
            stiffness: stretching.inverse(),
            shear_moduli: constants.shear_moduli,
            between: [DMat3::ZERO; 9],
        };
        own.between = own.components();
        own
    }

    /// `C_ijkl` is the stress `ij` at the displacement gradient with a one at `kl`. Components that
    /// are the same number have the same bits, so that stiffnesses are symmetric.
    fn components(&self) -> [DMat3; 9] {
        let mut found = [DMat3::ZERO; 9];
        for k in 0..3 {
            for l in 0..3 {
                let mut gradient = DMat3::ZERO;
                gradient.col_mut(l)[k] = 1.0;
                let stress = self.stress(gradient);
                for i in 0..3 {
                    for j in 0..3 {
                        found[3 * i + k].col_mut(l)[j] = stress.col(j)[i];
                    }
                }
            }
        }
        std::array::from_fn(|at| {
            let (i, k) = (at / 3, at % 3);
            0.5 * (found[at] + found[3 * k + i].transpose())
        })
    }

    /// Stress (Pa) at the displacement gradient `H_ij = du_i/dx_j`.
    pub fn stress(&self, gradient: DMat3) -> DMat3 {
        let strain = 0.5 * (gradient + gradient.transpose());
        let strain = self.axes.transpose() * strain * self.axes;
        let along = self.stiffness * diagonal(strain);
        let mut stress = DMat3::from_diagonal(along);
        for ([i, j], modulus) in PAIRS.into_iter().zip(self.shear_moduli) {
            let shear = 2.0 * modulus * strain.col(j)[i];
            stress.col_mut(j)[i] = shear;
            stress.col_mut(i)[j] = shear;
        }
        self.axes * stress * self.axes.transpose()
    }

    /// Energy density of a stress, `sigma : C^-1 : sigma` (J/m^3), twice what the rock stores.
    pub fn energy_density(&self, stress: DMat3) -> f64 {
        let stress = self.axes.transpose() * stress * self.axes;
        let along = diagonal(stress);
        let sheared = PAIRS.into_iter().zip(self.shear_moduli);
        let sheared = sheared.map(|([i, j], modulus)| stress.col(j)[i].powi(2) / modulus);
        along.dot(self.stretching * along) + sheared.sum::<f64>()
    }

    /// Stiffness between two nodes (N/m) from `M = int g_a (x) g_b dV` (m):
    /// `K_ik = sum_jl C_ijkl M_jl`.
    ///
    /// Terms `jl` and `lj` are added first: so `K_ba` is `K_ab^T` to the last bit.
    pub fn block(&self, m: &DMat3) -> DMat3 {
        let mut block = DMat3::ZERO;
        for i in 0..3 {
            for k in 0..3 {
                let c = &self.between[3 * i + k];
                let own = c.x_axis.x * m.x_axis.x + c.y_axis.y * m.y_axis.y;
                let own = own + c.z_axis.z * m.z_axis.z;
                let pair =
                    |j: usize, l: usize| c.col(l)[j] * m.col(l)[j] + c.col(j)[l] * m.col(j)[l];
                block.col_mut(k)[i] = own + pair(0, 1) + pair(1, 2) + pair(0, 2);
            }
        }
        block
    }

    /// Bulk and shear modulus (Pa) of the isotropic stiffness that is nearest to this one, by the
    /// squares of all components (M. J. P. Musgrave's and Fedorov's projection):
    /// `K = C_iijj / 9`, `G = (C_ijij - C_iijj / 3) / 10`.
    pub fn nearest_isotropic(&self) -> [f64; 2] {
        let (mut bulk, mut all) = (0.0, 0.0);
        for i in 0..3 {
            for j in 0..3 {
                bulk += self.between[3 * i + j].col(j)[i];
                all += self.between[3 * i + i].col(j)[j];
            }
        }
        [bulk / 9.0, (all - bulk / 3.0) / 10.0]
    }

    /// Whether the plane z = 0 is a plane of symmetry: strains in it cause no shear across it.
    pub fn is_symmetric_about_xy(&self) -> bool {
        let largest = self.stiffness.col(0)[0].max(self.stiffness.col(1)[1]);
        let largest = largest.max(self.stiffness.col(2)[2]);
        let crosses = |at: [usize; 4]| at.iter().filter(|&&axis| axis == 2).count() % 2 == 1;
        let all = (0..81).map(|at| [at / 27, at / 9 % 3, at / 3 % 3, at % 3]);
        let mut odd = all.filter(|at| crosses(*at));
        odd.all(|[i, j, k, l]| self.between[3 * i + k].col(l)[j].abs() < 1e-12 * largest)
    }
}

fn diagonal(m: DMat3) -> DVec3 {
    DVec3::new(m.x_axis.x, m.y_axis.y, m.z_axis.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tilted() -> DMat3 {
        DMat3::from_euler(glam::EulerRot::XYZ, 0.4, -1.1, 0.7)
    }

    const CONSTANTS: Orthotropy = Orthotropy {
        young_moduli: [60e9, 20e9, 35e9],
        poisson_ratios: [0.3, 0.1, 0.25],
        shear_moduli: [9e9, 12e9, 15e9],
        axes: DMat3::IDENTITY,
    };

    fn is_near(found: f64, wanted: f64) {
        assert!((found / wanted - 1.0).abs() < 1e-12, "{found:e} {wanted:e}");
    }

    /// A stress along each axis alone stretches by `1/E` and narrows by `nu/E`, whatever the axes.
    #[test]
    fn constants_are_those_of_single_stresses() {
        let rock = Anisotropy::of(&Orthotropy {
            axes: tilted(),
            ..CONSTANTS
        });
        for ([i, j], nu) in PAIRS.into_iter().zip(CONSTANTS.poisson_ratios) {
            let e = CONSTANTS.young_moduli[i];
            let k = 3 - i - j;
            let other = match (i, k) {
                (0, 1) => CONSTANTS.poisson_ratios[0],
                (0, 2) => CONSTANTS.poisson_ratios[2],
                _ => CONSTANTS.poisson_ratios[0] * e / CONSTANTS.young_moduli[0],
            };
            let mut stretch = DVec3::ZERO;
            (stretch[i], stretch[j], stretch[k]) = (1.0 / e, -nu / e, -other / e);
            let strain = tilted() * DMat3::from_diagonal(stretch) * tilted().transpose();
            let stress = tilted().transpose() * rock.stress(strain) * tilted();
            let mut wanted = DMat3::ZERO;
            wanted.col_mut(i)[i] = 1.0;
            assert!(
                (stress - wanted).abs_diff_eq(DMat3::ZERO, 1e-14),
                "{stress}"
            );
            is_near(
                rock.energy_density(tilted() * wanted * tilted().transpose()),
                1.0 / e,
            );
        }
    }

    #[test]
    fn blocks_are_those_of_stress_and_symmetric_to_the_last_bit() {
        let rock = Anisotropy::of(&Orthotropy {
            axes: tilted(),
            ..CONSTANTS
        });
        let (a, b) = (DVec3::new(0.3, -1.2, 0.7), DVec3::new(-0.4, 0.2, 1.9));
        let moment = crate::outer::outer(a, b);
        let block = rock.block(&moment);
        assert_eq!(rock.block(&moment.transpose()), block.transpose());
        for axis in DVec3::AXES {
            // The force at `a` is `sigma a` for the gradient `e (x) b`.
            let force = rock.stress(crate::outer::outer(axis, b)) * a;
            assert!((block * axis - force).length() < 1e-14 * force.length());
        }
    }

    #[test]
    fn the_nearest_isotropic_rock_of_an_isotropic_one_is_itself() {
        let rock = Anisotropy::of(&Orthotropy::transverse(
            [50e9; 2],
            [0.25; 2],
            20e9,
            tilted(),
        ));
        let [bulk, shear] = rock.nearest_isotropic();
        is_near(bulk, 50e9 / 1.5);
        is_near(shear, 20e9);
        assert!(rock.is_symmetric_about_xy());
    }

    /// Bounds of Amadei (1996): `nu'^2 < (E'/E) (1 - nu) / 2`.
    #[test]
    fn transverse_rock_is_definite_within_its_bounds() {
        let bound = (0.4_f64 * (1.0 - 0.3) / 2.0).sqrt();
        for (factor, is_definite) in [(0.999, true), (1.001, false), (-0.999, true)] {
            let ratios = [0.3, factor * bound];
            let rock = Orthotropy::transverse([50e9, 20e9], ratios, 10e9, DMat3::IDENTITY);
            assert_eq!(rock.is_positive_definite(), is_definite, "{factor}");
        }
        let unbounded = Orthotropy {
            poisson_ratios: [1.8, 0.0, 0.0],
            ..CONSTANTS
        };
        assert!(!unbounded.is_positive_definite());
    }

    #[test]
    fn planes_of_symmetry_are_found() {
        let turned = |axes| {
            let own = Orthotropy { axes, ..CONSTANTS };
            Anisotropy::of(&own).is_symmetric_about_xy()
        };
        assert!(turned(DMat3::from_rotation_z(0.6)));
        assert!(!turned(DMat3::from_rotation_x(0.6)));
    }
}
