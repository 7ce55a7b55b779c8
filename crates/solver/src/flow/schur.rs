//! The Schur complement of the pressures, by which rock and flow are preconditioned: with the
//! linearised flow `E` and the compliance `C` of walls that follow, `S = E + (rho / dt) C`.
//!
//! `C` is what every node opens by itself, and in time steps what patches of the fractures open
//! beyond that (see `compliance`). The latter is not sparse: systems with `S` are then solved by
//! conjugate gradients on the fractures, preconditioned by a factor of the rest.

use glam::DVec3;
use kluft_algebra::{
    ConjugateGradientSettings, ScalarCholesky, ScalarMatrix, conjugate_gradients, pack_scalars,
    unpack_scalars,
};

use super::compliance::PatchCompliance;

/// Residual that the iteration on the fractures leaves, as a share, and most of its iterations.
/// GMRES around it is a flexible one and asks for no more.
const SETTINGS: ConjugateGradientSettings = ConjugateGradientSettings {
    tolerance: 0.1,
    max_iterations: 60,
};

/// The Schur complement of the pressures that are not given.
pub(crate) struct PressureSchur {
    /// Of `matrix`.
    pub(super) factor: ScalarCholesky,
    /// `E` and what every node opens by itself (m^3/(s Pa)).
    pub(super) matrix: ScalarMatrix,
    /// What patches open beyond that; none in steady flow.
    pub(super) patches: Option<PatchCompliance>,
    /// Row of each unknown.
    pub(super) free: Vec<u32>,
    /// Unknown of each row; beyond the last where the pressure is given.
    pub(super) number: Vec<u32>,
}

impl PressureSchur {
    /// Pressures (Pa) for what is missing (m^3/s) where every node answers by itself.
    pub(crate) fn solve_alone(&self, missing: &[f64]) -> Vec<f64> {
        self.factor.solve(missing)
    }

    /// Pressures (Pa) for what is missing (m^3/s), approximately.
    pub(crate) fn solve(&self, missing: &[f64]) -> Vec<f64> {
        let Some(patches) = &self.patches else {
            return self.solve_alone(missing);
        };
        let count = missing.len();
        let mut rhs = vec![DVec3::ZERO; count.div_ceil(3)];
        pack_scalars(missing, &mut rhs);
        let mut solution = vec![DVec3::ZERO; rhs.len()];
        // Whatever is left, GMRES sees to it.
        let _ = conjugate_gradients(
            |vector, product| {
                pack_scalars(
                    &self.times(patches, &unpack_scalars(vector, count)),
                    product,
                );
            },
            |residual, correction| {
                let alone = self.solve_alone(&unpack_scalars(residual, count));
                pack_scalars(&alone, correction);
            },
            &rhs,
            &mut solution,
            SETTINGS,
        );
        unpack_scalars(&solution, count)
    }

    /// `S p`.
    fn times(&self, patches: &PatchCompliance, pressures: &[f64]) -> Vec<f64> {
        let of_row = |row: usize| pressures.get(self.number[row] as usize);
        let stored = patches.stored(|row| of_row(row).copied().unwrap_or(0.0));
        let rows = self.free.iter().enumerate();
        rows.map(|(unknown, &row)| {
            let entries = self.matrix.row(unknown);
            let driven = entries.map(|(column, value)| value * pressures[column]);
            stored[row as usize] + driven.sum::<f64>()
        })
        .collect()
    }
}
