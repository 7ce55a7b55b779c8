//! The first guess of a linear solve, in the recycled space.

use glam::DVec3;

use super::space::RecycledSpace;
use crate::linear::NonsymmetricSolver;
use crate::newton::dense;
use crate::system::System;

/// Corrections of an increment of laws with kinks that are kept: those after them remove what
/// linear solves have left, which no other leaves.
pub(in crate::newton) const KEPT_AT_KINKS: usize = 4;

impl RecycledSpace {
    /// The unknowns (m) in the space that leave nothing of `forces` (N) in it out of balance, on
    /// the tangent that `linear` has (Galerkin): `V c` with `V^T (K + fractures) V c = V^T forces`.
    /// None if there are no directions.
    pub(in crate::newton) fn answer(
        &self,
        system: &System<'_>,
        linear: &NonsymmetricSolver,
        forces: &[DVec3],
    ) -> Option<Vec<DVec3>> {
        if self.directions.is_empty() {
            return None;
        }
        let matrix = self.tangent(system, linear.stiffness(), linear.is_symmetric());
        let coefficients = dense::solve(matrix, &self.projected(forces))?;
        Some(self.combination(&coefficients, forces.len()))
    }
}

#[cfg(test)]
mod tests {
    use glam::DMat3;
    use kluft_algebra::norm;

    use super::*;
    use crate::linear::fractured_tests::{problem, system};
    use crate::linear::{Iterative, Tangents};

    /// Forces that directions of the space answer are answered by those directions, on tangents
    /// that are not symmetric.
    #[test]
    fn what_former_corrections_answer_is_found_in_their_space() {
        let problem = problem(|z| z);
        let system = system(&problem);
        let interface = &system.discretisation.interface;
        let skew = DMat3::from_cols_array(&[3.0, 0.0, 0.5, 0.0, 1.0, 0.0, 0.0, -2.0, 2.0]);
        let tangents = Tangents {
            exact: vec![skew; interface.points.len()],
            positive: Some(vec![DMat3::IDENTITY; interface.points.len()]),
        };
        let number = |at: usize| ((at * 7919 + 13) % 1009) as f64 / 1009.0 - 0.5;
        let supports = &system.discretisation.supports;
        let direction = |first: usize| -> Vec<DVec3> {
            let entry =
                |at: usize| DVec3::from_array([0, 1, 2].map(|i| number(3 * at + i + first)));
            let count = system.discretisation.points.len();
            (0..count)
                .map(|at| supports.project(at, entry(at)))
                .collect()
        };
        let directions = [direction(0), direction(400), direction(800)];
        let mut space = RecycledSpace::default();
        for direction in &directions {
            let rock_forces = system.rock_forces(direction);
            space.add_direction(direction.clone(), &rock_forces, 1.0);
        }
        let weights = [2.0, -3.0, 0.5];
        let expected: Vec<DVec3> = (0..directions[0].len())
            .map(|at| (0..3).map(|i| weights[i] * directions[i][at]).sum())
            .collect();
        let mut forces = vec![DVec3::ZERO; expected.len()];
        let stiffness = interface.stiffness(&tangents.exact);
        system
            .fixed_part()
            .multiply(&stiffness, &expected, &mut forces);
        let inner = Iterative::new(&system).expect("definite");
        let mut linear = NonsymmetricSolver::new(Box::new(inner));
        linear.update(&system, &tangents).expect("definite");
        let mut answer = space.answer(&system, &linear, &forces).expect("directions");
        for (entry, expected) in answer.iter_mut().zip(&expected) {
            *entry -= *expected;
        }
        assert!(
            norm(&answer) < 1e-9 * norm(&expected),
            "{:e}",
            norm(&answer)
        );
        let none = RecycledSpace::default().answer(&system, &linear, &forces);
        assert!(none.is_none());
    }
}
