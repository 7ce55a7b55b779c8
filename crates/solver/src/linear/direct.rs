//! The plain direct solver: the whole tangent is factorised anew whenever it changes.

use glam::{DMat3, DVec3};
use kluft_algebra::{Analysis, Cholesky, FixedPart, LinearFailure};

use crate::linear::tangent_solver::{LinearSolution, TangentSolver};

/// Cholesky factorisation of the whole tangent.
pub struct Direct {
    cholesky: Cholesky,
    /// Where the blocks of the fractures belong in the matrix.
    places: Vec<(usize, usize)>,
    /// Blocks of the fractures in the present factor.
    stiffness: Option<Vec<DMat3>>,
}

impl Direct {
    /// Prepares the solver; `analysis` may have any order.
    pub fn new(fixed: FixedPart<'_>, analysis: Analysis) -> Self {
        Self {
            cholesky: Cholesky::new(analysis, fixed.matrix),
            places: fixed.places(),
            stiffness: None,
        }
    }
}

impl TangentSolver for Direct {
    fn update(&mut self, fixed: FixedPart<'_>, stiffness: Vec<DMat3>) -> Result<(), LinearFailure> {
        if self.stiffness.as_ref() == Some(&stiffness) {
            return Ok(());
        }
        self.stiffness = None;
        for (row, place, block) in fixed.blocks(&self.places, &stiffness) {
            self.cholesky.set_block(row, place, block);
        }
        self.cholesky.factorise()?;
        self.stiffness = Some(stiffness);
        Ok(())
    }

    fn solve(
        &mut self,
        _: FixedPart<'_>,
        rhs: &[DVec3],
        _: f64,
    ) -> Result<LinearSolution, LinearFailure> {
        Ok(LinearSolution {
            unknowns: self.cholesky.solve(rhs),
            iterations: 0,
        })
    }
}
