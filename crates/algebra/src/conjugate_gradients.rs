//! Preconditioned conjugate gradients.

use glam::DVec3;
use rayon::prelude::*;

use crate::vectors::PER_TASK;

/// When to stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConjugateGradientSettings {
    /// Length of the residual, as a share of the length of the rhs-hand side.
    pub tolerance: f64,
    /// Most iterations.
    pub max_iterations: usize,
}

/// How a solution by conjugate gradients ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ConjugateGradientOutcome {
    /// The residual is within the tolerance.
    Converged,
    /// The iterations are used up.
    NotConverged,
    /// A direction has no positive energy: matrix or preconditioner is not positive definite, or
    /// rounding leaves nothing to gain.
    Breakdown,
    /// A number is not finite.
    NotFinite,
}

/// What happened.
#[derive(Debug, Clone, PartialEq)]
pub struct ConjugateGradientReport {
    /// How it ended.
    pub outcome: ConjugateGradientOutcome,
    /// Iterations done.
    pub iterations: usize,
    /// Length of the residual as a share of that of the rhs-hand side, at the start and after
    /// each iteration.
    pub residuals: Vec<f64>,
}

impl ConjugateGradientReport {
    fn of(outcome: ConjugateGradientOutcome, residuals: Vec<f64>) -> Self {
        Self {
            outcome,
            iterations: residuals.len() - 1,
            residuals,
        }
    }
}

/// Vectors and partial sums.
struct Iterates {
    residual: Vec<DVec3>,
    preconditioned: Vec<DVec3>,
    direction: Vec<DVec3>,
    a_p: Vec<DVec3>,
    sums: Vec<[f64; 2]>,
}

/// Solves `A x = b` for symmetric positive definite `A`: `product` computes `A v`, `precondition`
/// an approximation of `A^-1 r`, each into its second argument. `solution` is the initial guess on
/// entry and the last iterate on return, however it ended.
///
/// The new direction is conjugate to the last one by the formula of Polak and Ribière, which
/// forgives a preconditioner that is symmetric only up to rounding (Notay 2000). Sums have a fixed
/// order; iterations allocate nothing.
///
/// # Panics
/// If the lengths of `rhs` and `solution` differ.
pub fn conjugate_gradients(
    mut product: impl FnMut(&[DVec3], &mut [DVec3]),
    mut precondition: impl FnMut(&[DVec3], &mut [DVec3]),
    rhs: &[DVec3],
    solution: &mut [DVec3],
    settings: ConjugateGradientSettings,
) -> ConjugateGradientReport {
    assert_eq!(rhs.len(), solution.len(), "one entry a row");
    let mut state = Iterates::new(rhs.len());
    let scale = state.length(rhs);
    if scale == 0.0 {
        solution.fill(DVec3::ZERO);
        return ConjugateGradientReport::of(ConjugateGradientOutcome::Converged, vec![0.0]);
    }
    // `A x` of nothing stands there already.
    if solution.par_iter().any(|entry| *entry != DVec3::ZERO) {
        product(solution, &mut state.a_p);
    }
    let mut length = state.start(rhs) / scale;
    let mut residuals = Vec::with_capacity(settings.max_iterations + 1);
    residuals.push(length);
    let (mut energy, mut step) = (0.0, 0.0);
    let outcome = loop {
        if !length.is_finite() {
            break ConjugateGradientOutcome::NotFinite;
        }
        if length <= settings.tolerance {
            break ConjugateGradientOutcome::Converged;
        }
        if residuals.len() > settings.max_iterations {
            break ConjugateGradientOutcome::NotConverged;
        }
        precondition(&state.residual, &mut state.preconditioned);
        let last = energy;
        let change;
        [energy, change] = state.preconditioned_dots();
        // Every residual is the one before minus `step` times `A p`.
        let beta = if last > 0.0 {
            -step * change / last
        } else {
            0.0
        };
        state.update_direction(beta);
        product(&state.direction, &mut state.a_p);
        let curvature = state.curvature();
        if !(energy.is_finite() && curvature.is_finite()) {
            break ConjugateGradientOutcome::NotFinite;
        }
        if energy <= 0.0 || curvature <= 0.0 {
            break ConjugateGradientOutcome::Breakdown;
        }
        step = energy / curvature;
        length = state.advance(step, solution) / scale;
        residuals.push(length);
    };
    ConjugateGradientReport::of(outcome, residuals)
}

impl Iterates {
    fn new(length: usize) -> Self {
        // Pages that all threads map where they use them.
        Self {
            residual: bytemuck::zeroed_vec(length),
            preconditioned: bytemuck::zeroed_vec(length),
            direction: bytemuck::zeroed_vec(length),
            a_p: bytemuck::zeroed_vec(length),
            sums: Vec::with_capacity(length.div_ceil(PER_TASK)),
        }
    }

    /// Euclidean length of a vector.
    fn length(&mut self, vector: &[DVec3]) -> f64 {
        let tasks = vector.par_chunks(PER_TASK);
        let squares = |chunk: &[DVec3]| chunk.iter().map(|v| v.length_squared()).sum();
        let sums = tasks.map(|chunk| [squares(chunk), 0.0]);
        sums.collect_into_vec(&mut self.sums);
        ordered(&self.sums)[0].sqrt()
    }

    /// `r = b - A x`, with `A x` in the place of `A p`; returns its length.
    fn start(&mut self, rhs: &[DVec3]) -> f64 {
        let tasks = self.residual.par_chunks_mut(PER_TASK);
        let tasks = tasks.zip(rhs.par_chunks(PER_TASK));
        let tasks = tasks.zip(self.a_p.par_chunks(PER_TASK));
        let sums = tasks.map(|((residual, rhs), a_p)| {
            let mut sum = 0.0;
            for ((residual, rhs), a_p) in residual.iter_mut().zip(rhs).zip(a_p) {
                *residual = rhs - a_p;
                sum += residual.length_squared();
            }
            [sum, 0.0]
        });
        sums.collect_into_vec(&mut self.sums);
        ordered(&self.sums)[0].sqrt()
    }

    /// `r.z` and `(A p).z`.
    fn preconditioned_dots(&mut self) -> [f64; 2] {
        let tasks = self.preconditioned.par_chunks(PER_TASK);
        let tasks = tasks.zip(self.residual.par_chunks(PER_TASK));
        let tasks = tasks.zip(self.a_p.par_chunks(PER_TASK));
        let sums = tasks.map(|((z, r), a_p)| {
            let mut sum = [0.0; 2];
            for ((z, r), a_p) in z.iter().zip(r).zip(a_p) {
                sum[0] += r.dot(*z);
                sum[1] += a_p.dot(*z);
            }
            sum
        });
        sums.collect_into_vec(&mut self.sums);
        ordered(&self.sums)
    }

    /// `p = z + beta p`.
    fn update_direction(&mut self, beta: f64) {
        let tasks = self.direction.par_chunks_mut(PER_TASK);
        let tasks = tasks.zip(self.preconditioned.par_chunks(PER_TASK));
        tasks.for_each(|(direction, z)| {
            for (p, z) in direction.iter_mut().zip(z) {
                *p = z + beta * *p;
            }
        });
    }

    /// `p.(A p)`.
    fn curvature(&mut self) -> f64 {
        let tasks = self.direction.par_chunks(PER_TASK);
        let tasks = tasks.zip(self.a_p.par_chunks(PER_TASK));
        let sums = tasks.map(|(p, a_p)| {
            let dots = p.iter().zip(a_p).map(|(p, a_p)| p.dot(*a_p));
            [dots.sum(), 0.0]
        });
        sums.collect_into_vec(&mut self.sums);
        ordered(&self.sums)[0]
    }

    /// `x += step p`, `r -= step A p`; returns the length of the residual.
    fn advance(&mut self, step: f64, solution: &mut [DVec3]) -> f64 {
        let tasks = solution.par_chunks_mut(PER_TASK);
        let tasks = tasks.zip(self.residual.par_chunks_mut(PER_TASK));
        let sources = self.direction.par_chunks(PER_TASK);
        let sources = sources.zip(self.a_p.par_chunks(PER_TASK));
        let sums = tasks.zip(sources).map(|((x, r), (p, a_p))| {
            let mut sum = 0.0;
            for ((x, r), (p, a_p)) in x.iter_mut().zip(r).zip(p.iter().zip(a_p)) {
                *x += step * p;
                *r -= step * a_p;
                sum += r.length_squared();
            }
            [sum, 0.0]
        });
        sums.collect_into_vec(&mut self.sums);
        ordered(&self.sums)[0].sqrt()
    }
}

fn ordered(sums: &[[f64; 2]]) -> [f64; 2] {
    let add = |sum: [f64; 2], part: &[f64; 2]| [sum[0] + part[0], sum[1] + part[1]];
    sums.iter().fold([0.0; 2], add)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SETTINGS: ConjugateGradientSettings = ConjugateGradientSettings {
        tolerance: 1e-12,
        max_iterations: 50,
    };

    fn solve(diagonal: &[DVec3], rhs: &[DVec3]) -> (Vec<DVec3>, ConjugateGradientReport) {
        let mut solution = vec![DVec3::ZERO; rhs.len()];
        let product = |vector: &[DVec3], product: &mut [DVec3]| {
            for ((product, vector), d) in product.iter_mut().zip(vector).zip(diagonal) {
                *product = *vector * *d;
            }
        };
        let report = conjugate_gradients(
            product,
            |residual, correction| correction.copy_from_slice(residual),
            rhs,
            &mut solution,
            SETTINGS,
        );
        (solution, report)
    }

    #[test]
    fn a_diagonal_takes_as_many_iterations_as_it_has_values() {
        let diagonal = [DVec3::new(1.0, 2.0, 3.0), DVec3::new(3.0, 2.0, 1.0)];
        let rhs = [DVec3::new(1.0, -1.0, 2.0), DVec3::new(0.5, 3.0, 1.0)];
        let (solution, report) = solve(&diagonal, &rhs);
        assert_eq!(report.outcome, ConjugateGradientOutcome::Converged);
        assert_eq!(report.iterations, 3);
        assert_eq!(report.residuals.len(), 4);
        for ((x, d), b) in solution.iter().zip(diagonal).zip(rhs) {
            assert!((*x * d - b).length() < 1e-11);
        }
    }

    #[test]
    fn what_goes_wrong_is_told() {
        let rhs = [DVec3::ONE];
        let indefinite = solve(&[DVec3::new(1.0, -2.0, 0.5)], &rhs).1;
        assert_eq!(indefinite.outcome, ConjugateGradientOutcome::Breakdown);
        let broken = solve(&[DVec3::new(1.0, f64::NAN, 1.0)], &rhs).1;
        assert_eq!(broken.outcome, ConjugateGradientOutcome::NotFinite);
        let endless = solve(&[DVec3::ONE], &[DVec3::new(f64::INFINITY, 0.0, 0.0)]).1;
        assert_eq!(endless.outcome, ConjugateGradientOutcome::NotFinite);
    }

    #[test]
    fn nothing_to_solve_is_solved() {
        let (solution, report) = solve(&[DVec3::ONE], &[DVec3::ZERO]);
        assert_eq!(report.outcome, ConjugateGradientOutcome::Converged);
        assert_eq!(solution, [DVec3::ZERO]);
    }
}
