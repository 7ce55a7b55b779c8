//! What is left of a linear solver that has given its memory back.

use glam::{DMat3, DVec3};
use kluft_algebra::{FixedPart, LinearFailure};

use crate::linear::tangent_solver::{LinearSolution, TangentSolver};

/// A solver that has given its memory back; it refuses every call.
pub struct Released;

fn refusal() -> LinearFailure {
    LinearFailure::Analysis("the linear solver has given its memory back".to_owned())
}

impl TangentSolver for Released {
    fn update(&mut self, _: FixedPart<'_>, _: Vec<DMat3>) -> Result<(), LinearFailure> {
        Err(refusal())
    }

    fn solve(
        &mut self,
        _: FixedPart<'_>,
        _: &[DVec3],
        _: f64,
    ) -> Result<LinearSolution, LinearFailure> {
        Err(refusal())
    }
}

#[cfg(test)]
mod tests {
    use kluft_algebra::LinearFailure;

    use crate::linear::fractured_tests::{problem, system};
    use crate::newton::{Newton, NewtonSettings};

    #[test]
    fn no_solver_works_once_its_memory_is_given_back() {
        let problem = problem(|z| z);
        let system = system(&problem);
        let mut newton = Newton::new(&system, NewtonSettings::default()).expect("definite");
        let forces = vec![glam::DVec3::X; system.discretisation.points.len()];
        newton.release();
        let refused = newton.respond(&system, &forces, 1e-3);
        assert!(matches!(refused, Err(LinearFailure::Analysis(_))));
    }
}
