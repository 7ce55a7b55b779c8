//! Preconditioned GMRES, for systems that are not symmetric.
//!
//! Y. Saad, "A flexible inner-outer preconditioned GMRES algorithm", SIAM J. Sci. Comput. 14
//! (1993): the preconditioner may itself be an iteration.

use glam::DVec3;
use rayon::prelude::*;

use crate::conjugate_gradients::{
    ConjugateGradientOutcome as Outcome, ConjugateGradientReport as Report,
    ConjugateGradientSettings as Settings,
};
use crate::vectors::{add_shares, dot_of_tasks, dots_of_tasks};

/// Directions that are kept before the iteration starts anew from what it has.
const RESTART: usize = 60;

/// Share of its length below which what is left of a vector is made orthogonal again.
const LITTLE: f64 = 0.1;

/// Share of the residual that a whole cycle may leave.
const STAGNANT: f64 = 0.3;

/// Solves `A x = b`: `product` computes `A v`, `precondition` an approximation of `A^-1 r`, each
/// into its second argument. `solution` is the initial guess on entry and the last iterate on
/// return. Sums have a fixed order.
pub fn gmres(
    mut product: impl FnMut(&[DVec3], &mut [DVec3]),
    mut precondition: impl FnMut(&[DVec3], &mut [DVec3]),
    rhs: &[DVec3],
    solution: &mut [DVec3],
    settings: Settings,
) -> Report {
    let scale = dot_of_tasks(rhs, rhs).sqrt();
    let mut residuals = vec![if scale > 0.0 { 1.0 } else { 0.0 }];
    let outcome = loop {
        let last = *residuals.last().unwrap_or(&f64::NAN);
        if !last.is_finite() {
            break Outcome::NotFinite;
        }
        let mut residual = vec![DVec3::ZERO; rhs.len()];
        product(solution, &mut residual);
        let pairs = residual.par_iter_mut().zip(rhs);
        pairs.for_each(|(image, force)| *image = *force - *image);
        let length = dot_of_tasks(&residual, &residual).sqrt();
        if scale == 0.0 || length <= settings.tolerance * scale {
            break Outcome::Converged;
        }
        if residuals.len() > settings.max_iterations {
            break Outcome::NotConverged;
        }
        let mut space = Krylov::from(residual, length);
        let goal = settings.tolerance * scale;
        let mut left = length;
        while space.images.len() < RESTART && residuals.len() <= settings.max_iterations {
            left = space.grow(&mut product, &mut precondition);
            residuals.push(left / scale);
            if !left.is_finite() || left <= goal {
                break;
            }
        }
        if !space.add_to(solution) {
            break Outcome::Breakdown;
        }
        // A cycle that gains little is followed by more of the same.
        if space.images.len() == RESTART && left > STAGNANT * length {
            break Outcome::Breakdown;
        }
    };
    Report {
        outcome,
        iterations: residuals.len() - 1,
        residuals,
    }
}

/// The space of one cycle, with the least-squares problem in it kept triangular.
struct Krylov {
    /// Orthonormal vectors.
    basis: Vec<Vec<DVec3>>,
    /// What the preconditioner made of each.
    images: Vec<Vec<DVec3>>,
    /// Columns of the triangle.
    triangle: Vec<Vec<f64>>,
    /// Cosine and sine of each rotation.
    rotations: Vec<(f64, f64)>,
    /// The right-hand side, rotated.
    rhs: Vec<f64>,
}

impl Krylov {
    fn from(mut residual: Vec<DVec3>, length: f64) -> Self {
        residual.par_iter_mut().for_each(|v| *v /= length);
        Self {
            basis: vec![residual],
            images: Vec::new(),
            triangle: Vec::new(),
            rotations: Vec::new(),
            rhs: vec![length],
        }
    }

    /// One more direction; returns the length of the residual that is left.
    fn grow(
        &mut self,
        product: &mut impl FnMut(&[DVec3], &mut [DVec3]),
        precondition: &mut impl FnMut(&[DVec3], &mut [DVec3]),
    ) -> f64 {
        let count = self.images.len();
        let mut image = vec![DVec3::ZERO; self.basis[count].len()];
        precondition(&self.basis[count], &mut image);
        let mut next = vec![DVec3::ZERO; image.len()];
        product(&image, &mut next);
        let mut column = vec![0.0; count + 1];
        let mut before = dot_of_tasks(&next, &next).sqrt();
        // Once more where little is left, because then rounding is not orthogonal (Giraud et al.
        // 2005, "Rounding error analysis of the classical Gram-Schmidt orthogonalization process").
        let length = loop {
            let shares = dots_of_tasks(&self.basis, &next);
            let opposite: Vec<f64> = shares.iter().map(|share| -share).collect();
            add_shares(&opposite, &self.basis, &mut next);
            for (entry, share) in column.iter_mut().zip(&shares) {
                *entry += share;
            }
            let left = dot_of_tasks(&next, &next).sqrt();
            if left > LITTLE * before || left <= f64::EPSILON * before || !left.is_finite() {
                break left;
            }
            before = left;
        };
        if length > 0.0 {
            next.par_iter_mut().for_each(|v| *v /= length);
        }
        self.basis.push(next);
        self.images.push(image);
        self.rotate(column, length);
        self.rhs[count + 1].abs()
    }

    fn rotate(&mut self, mut column: Vec<f64>, length: f64) {
        for (row, &(cosine, sine)) in self.rotations.iter().enumerate() {
            let (upper, lower) = (column[row], column[row + 1]);
            column[row] = cosine * upper + sine * lower;
            column[row + 1] = cosine * lower - sine * upper;
        }
        let count = self.rotations.len();
        let size = column[count].hypot(length);
        let (cosine, sine) = if size > 0.0 {
            (column[count] / size, length / size)
        } else {
            (1.0, 0.0)
        };
        column[count] = size;
        self.rotations.push((cosine, sine));
        let last = self.rhs[count];
        self.rhs[count] = cosine * last;
        self.rhs.push(-sine * last);
        self.triangle.push(column);
    }

    /// Adds the best of the space to `solution`; false if the space holds a direction without
    /// effect.
    fn add_to(&self, solution: &mut [DVec3]) -> bool {
        let count = self.triangle.len();
        let mut shares = self.rhs[..count].to_vec();
        for row in (0..count).rev() {
            let known: f64 = (row + 1..count)
                .map(|c| self.triangle[c][row] * shares[c])
                .sum();
            shares[row] = (shares[row] - known) / self.triangle[row][row];
        }
        if !shares.iter().all(|share| share.is_finite()) {
            return false;
        }
        add_shares(&shares, &self.images, solution);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A rotation plus a stretch: nothing that conjugate gradients could solve.
    #[test]
    fn a_matrix_that_is_not_symmetric_is_solved() {
        let rhs: Vec<DVec3> = (0..50)
            .map(|i| DVec3::new(1.0, f64::from(i), -2.0))
            .collect();
        let product = |v: &[DVec3], image: &mut [DVec3]| {
            for i in 0..v.len() {
                let beside = v[(i + 1) % v.len()];
                image[i] = 3.0 * v[i] + DVec3::new(-v[i].y, v[i].x, 0.5 * v[i].x) + beside;
            }
        };
        let mut solution = vec![DVec3::ZERO; rhs.len()];
        let report = gmres(
            product,
            |residual, correction| correction.copy_from_slice(residual),
            &rhs,
            &mut solution,
            Settings {
                tolerance: 1e-12,
                max_iterations: 200,
            },
        );
        assert_eq!(report.outcome, Outcome::Converged);
        let mut image = vec![DVec3::ZERO; rhs.len()];
        product(&solution, &mut image);
        for (image, rhs) in image.iter().zip(&rhs) {
            assert!((*image - *rhs).length() < 1e-9);
        }
    }
}
