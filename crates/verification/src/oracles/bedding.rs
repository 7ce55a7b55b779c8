//! A circular hole of radius 1 m in a plate of bedded rock, in plane strain (S. G. Lekhnitskii,
//! Anisotropic Plates, 1968): displacements and stresses by complex potentials `C_k / zeta_k`, one
//! for each root of the characteristic equation, `zeta_k` being the map of the outside of the hole
//! in `x + mu_k y` on that of the unit circle.

use faer::c64;

/// A plate with a hole, in axes of its own: x along the bedding.
pub struct Hole {
    /// Angle from the x axis of the user to the bedding (radians).
    angle: f64,
    /// Initial stress xx, yy, xy (Pa).
    stress: [f64; 3],
    /// Roots, coefficients of the potentials (Pa), and what they do to displacements (1/Pa).
    parts: [Part; 2],
}

struct Part {
    root: c64,
    coefficient: c64,
    across: [c64; 2],
}

/// Constants of bedded rock: in the plane of isotropy and across it.
#[derive(Debug, Clone, Copy)]
pub struct Bedded {
    /// `E` and `E'` (Pa).
    pub young_moduli: [f64; 2],
    /// `nu` and `nu'`.
    pub poisson_ratios: [f64; 2],
    /// `G'` (Pa).
    pub shear_modulus: f64,
}

impl Hole {
    /// In rock whose bedding rises by `angle` (radians), under the initial stress xx and yy (Pa).
    pub fn of(rock: Bedded, angle: f64, [xx, yy]: [f64; 2]) -> Self {
        let ([e, across], [nu, nu_across]) = (rock.young_moduli, rock.poisson_ratios);
        let b11 = (1.0 - nu * nu) / e;
        let b22 = 1.0 / across - nu_across * nu_across * e / (across * across);
        let b12 = -nu_across * (1.0 + nu) / across;
        let mixed = 2.0 * b12 + 1.0 / rock.shear_modulus;
        let root = c64::new(mixed * mixed - 4.0 * b11 * b22, 0.0).sqrt();
        let square = |sign: f64| (c64::new(-mixed, 0.0) + root * sign) / (2.0 * b11);
        let roots = [-1.0, 1.0].map(|sign| {
            let root = square(sign).sqrt();
            if root.im > 0.0 { root } else { -root }
        });
        let (sin, cos) = angle.sin_cos();
        let stress = [
            xx * cos * cos + yy * sin * sin,
            xx * sin * sin + yy * cos * cos,
            (yy - xx) * sin * cos,
        ];
        // The tractions of the potentials and of the initial stress leave the wall free.
        let [x, y, shear] = stress.map(|own| 0.5 * own);
        let (sum, weighted) = (c64::new(-y, shear), c64::new(shear, -x));
        let [first, second] = roots;
        let coefficients = [
            (weighted - second * sum) / (first - second),
            (weighted - first * sum) / (second - first),
        ];
        let part = |(root, coefficient): (c64, c64)| Part {
            root,
            coefficient,
            across: [
                root * root * b11 + b12,
                root * b12 + c64::new(b22, 0.0) / root,
            ],
        };
        Self {
            angle,
            stress,
            parts: [0, 1].map(|k| part((roots[k], coefficients[k]))),
        }
    }

    /// Displacement (m) at a place (m).
    pub fn displacement(&self, place: [f64; 2]) -> [f64; 2] {
        let own = self.turned(place, 1.0);
        let sum = |axis: usize| -> f64 {
            let parts = self.parts.iter();
            parts
                .map(|part| 2.0 * (part.across[axis] * part.coefficient / part.zeta(own).0).re)
                .sum()
        };
        self.turned([sum(0), sum(1)], -1.0)
    }

    /// Stress xx, yy, xy (Pa) at a place (m).
    pub fn stress(&self, place: [f64; 2]) -> [f64; 3] {
        let own = self.turned(place, 1.0);
        let [mut xx, mut yy, mut xy] = self.stress;
        for part in &self.parts {
            let (zeta, root) = part.zeta(own);
            let slope = -part.coefficient / (zeta * root);
            xx += 2.0 * (part.root * part.root * slope).re;
            yy += 2.0 * slope.re;
            xy -= 2.0 * (part.root * slope).re;
        }
        let (sin, cos) = self.angle.sin_cos();
        [
            xx * cos * cos + yy * sin * sin - 2.0 * xy * sin * cos,
            xx * sin * sin + yy * cos * cos + 2.0 * xy * sin * cos,
            (xx - yy) * sin * cos + xy * (cos * cos - sin * sin),
        ]
    }

    /// A vector in the axes of the bedding, or back.
    fn turned(&self, [x, y]: [f64; 2], sign: f64) -> [f64; 2] {
        let (sin, cos) = (sign * self.angle).sin_cos();
        [x * cos + y * sin, y * cos - x * sin]
    }
}

impl Part {
    /// `zeta` at a place in the axes of the bedding, and `zeta / (d zeta / d z)`.
    fn zeta(&self, [x, y]: [f64; 2]) -> (c64, c64) {
        let z = self.root * y + x;
        let root = (z * z - 1.0 - self.root * self.root).sqrt();
        let of = |root: c64| (z + root) / (c64::new(1.0, 0.0) - c64::new(0.0, 1.0) * self.root);
        let outside = of(root);
        if outside.norm() >= of(-root).norm() {
            (outside, root)
        } else {
            (of(-root), -root)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rock that is almost isotropic has the hoop stresses of Kirsch, `3 s_y - s_x` and `3 s_x -
    /// s_y`; at any constants the wall is free.
    #[test]
    fn the_wall_is_free_and_isotropic_rock_has_the_stresses_of_kirsch() {
        let shear = 40e9 / 2.5;
        let nearly = Bedded {
            young_moduli: [40e9, 40e9 * (1.0 - 1e-6)],
            poisson_ratios: [0.25; 2],
            shear_modulus: shear,
        };
        let isotropic = Hole::of(nearly, 0.4, [-7.5e6, -5e6]);
        let [_, side, _] = isotropic.stress([1.0, 0.0]);
        let [crown, _, _] = isotropic.stress([0.0, 1.0]);
        assert!((side / -7.5e6 - 1.0).abs() < 1e-4, "{side}");
        assert!((crown / -17.5e6 - 1.0).abs() < 1e-4, "{crown}");
        let shale = Bedded {
            young_moduli: [40e9, 20e9],
            poisson_ratios: [0.25, 0.2],
            shear_modulus: 8e9,
        };
        let bedded = Hole::of(shale, 30_f64.to_radians(), [-7.5e6, -5e6]);
        for number in 0..8 {
            let (sin, cos) = (0.3 + 0.7 * f64::from(number)).sin_cos();
            let [xx, yy, xy] = bedded.stress([cos, sin]);
            for traction in [xx * cos + xy * sin, xy * cos + yy * sin] {
                assert!(traction.abs() < 1e-2, "{traction}");
            }
        }
    }
}
