//! A circular hole or a thick ring in elastic rock that is held at a large radius, in plane strain.
//!
//! Airy's function in polar coordinates, without and with `cos 2 theta` (J. H. Michell, Proceedings
//! of the London Mathematical Society 31, 1899): two coefficients of each layer for the mean, four
//! for the difference of the principal stresses. They follow from what is free, what is held, and
//! what passes between the layers.

/// Elastic constants.
#[derive(Debug, Clone, Copy)]
pub struct Isotropic {
    /// Young's modulus (Pa).
    pub young_modulus: f64,
    /// Poisson's ratio.
    pub poisson_ratio: f64,
}

/// A tunnel whose wall lets go all at once.
#[derive(Debug, Clone, Copy)]
pub struct Tunnel {
    /// Radius of the wall (m).
    pub radius: f64,
    /// Radius at which the rock is held (m).
    pub held: f64,
    /// The rock.
    pub rock: Isotropic,
    /// Inner radius (m) and material of a ring that is there before the wall lets go, free of
    /// stress.
    pub lining: Option<(f64, Isotropic)>,
    /// Initial stress along x and y (Pa), tension positive.
    pub stress: [f64; 2],
}

impl Tunnel {
    /// How far the wall moves outwards (m) where it crosses the axes x and y.
    pub fn wall(&self) -> [f64; 2] {
        let [x, y] = self.stress;
        let mean = self.amplitude(&even, &[0.5 * (x + y)]);
        let deviator = 0.5 * (x - y);
        let double = self.amplitude(&twice, &[deviator, -deviator]);
        [mean + double, mean - double]
    }

    /// Amplitude of the radial displacement of the wall (m), where the traction `stress` on it
    /// (radial, tangential) lets go.
    fn amplitude(&self, of: &dyn Fn(f64, Isotropic) -> Vec<Vec<f64>>, stress: &[f64]) -> f64 {
        let half = stress.len();
        let own = 2 * half;
        let (at_hold, at_wall) = (of(self.held, self.rock), of(self.radius, self.rock));
        let mut rows: Vec<(Vec<f64>, f64)> = Vec::new();
        let behind = |row: &[f64], count| [row, &vec![0.0; count]].concat();
        let ring = self.lining.map(|(inner, material)| {
            let wall = of(self.radius, material);
            (of(inner, material), wall)
        });
        let count = if ring.is_some() { own } else { 0 };
        // As a stress, so that what grows outwards is measured where the rock is held.
        let unit = 2.0 * shear_modulus(self.rock) / self.radius;
        let held = at_hold[..half].iter().map(|row| behind(row, count));
        rows.extend(held.map(|row| (row.iter().map(|entry| unit * entry).collect(), 0.0)));
        match ring {
            None => {
                let free = at_wall[half..].iter().zip(stress);
                rows.extend(free.map(|(row, stress)| (row.clone(), -stress)));
            }
            Some((inner, wall)) => {
                let jumps = [&vec![0.0; half][..], stress].concat();
                for ((rock, ring), jump) in at_wall.iter().zip(&wall).zip(jumps) {
                    let ring: Vec<f64> = ring.iter().map(|entry| -entry).collect();
                    rows.push(([&rock[..], &ring].concat(), -jump));
                }
                let free = inner[half..].iter();
                rows.extend(free.map(|row| ([&vec![0.0; own][..], row].concat(), 0.0)));
            }
        }
        let coefficients = solved(rows);
        let radial = at_wall[0].iter().zip(&coefficients);
        radial.map(|(entry, coefficient)| entry * coefficient).sum()
    }
}

fn shear_modulus(of: Isotropic) -> f64 {
    of.young_modulus / (2.0 * (1.0 + of.poisson_ratio))
}

/// `u_r` and `sigma_rr` at a radius of `A r + B/r`.
fn even(r: f64, material: Isotropic) -> Vec<Vec<f64>> {
    let shear = shear_modulus(material);
    let across = 2.0 * shear / (1.0 - 2.0 * material.poisson_ratio);
    vec![vec![r, 1.0 / r], vec![across, -2.0 * shear / (r * r)]]
}

/// `u_r`, `u_t`, `sigma_rr`, `sigma_rt` at a radius, over `cos 2 theta` and `sin 2 theta`, of
/// Airy's functions `r^2, r^4, r^-2, 1`.
fn twice(r: f64, material: Isotropic) -> Vec<Vec<f64>> {
    let double = 2.0 * shear_modulus(material);
    let kappa = 3.0 - 4.0 * material.poisson_ratio;
    let over = |row: [f64; 4]| row.map(|entry| entry / double).to_vec();
    let (cube, inverse) = (r.powi(3), 1.0 / r);
    vec![
        over([
            -2.0 * r,
            (kappa - 3.0) * cube,
            2.0 * inverse.powi(3),
            (kappa + 1.0) * inverse,
        ]),
        over([
            2.0 * r,
            (kappa + 3.0) * cube,
            2.0 * inverse.powi(3),
            (1.0 - kappa) * inverse,
        ]),
        vec![-2.0, 0.0, -6.0 * inverse.powi(4), -4.0 * inverse.powi(2)],
        vec![
            2.0,
            6.0 * r * r,
            -6.0 * inverse.powi(4),
            -2.0 * inverse.powi(2),
        ],
    ]
}

/// Solves equations, each its coefficients and its right-hand side, by elimination with the largest
/// pivots of scaled columns and rows.
fn solved(mut rows: Vec<(Vec<f64>, f64)>) -> Vec<f64> {
    let count = rows.len();
    let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
    let sizes: Vec<f64> = (0..count)
        .map(|column| largest(&mut rows.iter().map(|(row, _)| row[column].abs())))
        .collect();
    for (row, _) in &mut rows {
        row.iter_mut()
            .zip(&sizes)
            .for_each(|(entry, size)| *entry /= size);
    }
    for (row, right) in &mut rows {
        let size = largest(&mut row.iter().map(|entry| entry.abs()));
        row.iter_mut().for_each(|entry| *entry /= size);
        *right /= size;
    }
    for pivot in 0..count {
        let best = (pivot..count)
            .max_by(|&a, &b| rows[a].0[pivot].abs().total_cmp(&rows[b].0[pivot].abs()));
        rows.swap(pivot, best.unwrap_or(pivot));
        let (above, below) = rows.split_at_mut(pivot + 1);
        let (own, right) = &above[pivot];
        for (row, other) in below {
            let factor = row[pivot] / own[pivot];
            row.iter_mut()
                .zip(own)
                .for_each(|(entry, own)| *entry -= factor * own);
            *other -= factor * right;
        }
    }
    let mut found = vec![0.0; count];
    for pivot in (0..count).rev() {
        let (row, right) = &rows[pivot];
        let known: f64 = (pivot + 1..count)
            .map(|column| row[column] * found[column])
            .sum();
        found[pivot] = (right - known) / row[pivot];
    }
    found
        .iter()
        .zip(&sizes)
        .map(|(value, size)| value / size)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROCK: Isotropic = Isotropic {
        young_modulus: 5e9,
        poisson_ratio: 0.25,
    };

    /// Kirsch 1898: `u = (1 + nu)/E r ((s_x + s_y)/2 +- (3 - 4 nu) (s_x - s_y)/2)`, where the rock
    /// goes on without end; and a ring too thin to carry anything has no part in it.
    #[test]
    fn a_hole_in_rock_without_end_is_that_of_kirsch() {
        let stress = [-7.5e6, -5e6];
        let tunnel = Tunnel {
            radius: 3.0,
            held: 3e5,
            rock: ROCK,
            lining: None,
            stress,
        };
        let unit = (1.0 + 0.25) / 5e9 * 3.0;
        let kirsch = [1.0, -1.0].map(|sign| unit * (-6.25e6 + sign * 2.0 * -1.25e6));
        let found = tunnel.wall();
        for (found, wanted) in found.into_iter().zip(kirsch) {
            assert!((found / wanted - 1.0).abs() < 1e-8, "{found} {wanted}");
        }
        let thin = Tunnel {
            lining: Some((3.0 - 1e-7, ROCK)),
            ..tunnel
        };
        for (thin, found) in thin.wall().into_iter().zip(found) {
            assert!((thin / found - 1.0).abs() < 1e-6, "{thin} {found}");
        }
    }
}
