//! The plain direct solver: the whole tangent is factorised anew whenever it changes.

use glam::{DMat3, DVec3};

use super::{Analysis, Cholesky, LinearFailure, LinearSolution, TangentSolver};
use crate::system::System;

/// Cholesky factorisation of the whole tangent.
pub struct Whole {
    cholesky: Cholesky,
    /// Where the blocks of the fractures belong in the matrix.
    places: Vec<(usize, usize)>,
    /// Blocks of the fractures in the present factor.
    stiffness: Option<Vec<DMat3>>,
}

impl Whole {
    /// Prepares the solver; `analysis` may have any order.
    pub fn new(system: &System<'_>, analysis: Analysis) -> Self {
        Self {
            cholesky: Cholesky::new(analysis, system.rock_rows()),
            places: system.interface_places(),
            stiffness: None,
        }
    }
}

impl TangentSolver for Whole {
    fn update(&mut self, system: &System<'_>, tangents: &[DMat3]) -> Result<(), LinearFailure> {
        let stiffness = system.discretisation.interface.stiffness(tangents);
        if self.stiffness.as_ref() == Some(&stiffness) {
            return Ok(());
        }
        self.stiffness = None;
        for (row, place, block) in system.tangent_blocks(&self.places, &stiffness) {
            self.cholesky.set_block(row, place, block);
        }
        self.cholesky.factorise()?;
        self.stiffness = Some(stiffness);
        Ok(())
    }

    fn solve(
        &mut self,
        _: &System<'_>,
        right: &[DVec3],
        _: f64,
    ) -> Result<LinearSolution, LinearFailure> {
        Ok(LinearSolution {
            unknowns: self.cholesky.solve(right),
            iterations: 0,
        })
    }
}
