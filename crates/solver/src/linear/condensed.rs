//! The condensed direct solver: the rock is factorised once, and what changes is solved for the
//! jumps alone.
//!
//! With the jumps ordered last, the trailing block of the Cholesky factor of the rock is the factor
//! of the rock's Schur complement. The rock alone may leave blocks free to move, so it is
//! factorised together with springs `C_0` of its own stiffness on all facet points, which the
//! condensed problem takes away again. Their size is that of the Schur complement, so the
//! difference loses no digits.

use glam::DMat3;
use glam::DVec3;

use super::jump_problem::JumpProblem;
use super::{Analysis, Cholesky, LinearFailure, LinearSolution, SolverHistory, TangentSolver};
use crate::system::System;

/// Condensed solver of a system.
pub struct Condensed {
    cholesky: Cholesky,
    /// Number of scalars eliminated before the jumps.
    rock_size: usize,
    jumps: JumpProblem,
}

impl Condensed {
    /// Factorises the rock; `analysis` has the unknowns of the interface last.
    ///
    /// # Errors
    /// If the rock is not positive definite or memory runs out.
    pub fn new(system: &System<'_>, analysis: Analysis) -> Result<Self, LinearFailure> {
        let interface = &system.discretisation.interface;
        let mut cholesky = Cholesky::new(analysis, system.rock_rows());
        let springs: Vec<DMat3> = interface
            .points
            .iter()
            .map(|point| point.spring * DMat3::IDENTITY)
            .collect();
        let springs = interface.stiffness(&springs);
        for (row, place, block) in system.tangent_blocks(&system.interface_places(), &springs) {
            cholesky.set_block(row, place, block);
        }
        cholesky.factorise()?;
        cholesky.forget_values();
        let order = cholesky.order();
        let rock_size = 3 * (order.len() - interface.unknowns.len());
        let lower = cholesky.trailing_factor(rock_size);
        let places = places(system, &order[rock_size / 3..]);
        Ok(Self {
            jumps: JumpProblem::new(&lower, places, springs),
            rock_size,
            cholesky,
        })
    }
}

/// Block row and column of each block of the fractures, counted in the order of the jumps.
fn places(system: &System<'_>, jumps: &[usize]) -> Vec<(u32, u32)> {
    let interface = &system.discretisation.interface;
    let mut number = vec![0_u32; system.discretisation.points.len()];
    for (index, &unknown) in jumps.iter().enumerate() {
        number[unknown] = index as u32;
    }
    let rows = interface.unknowns.iter().enumerate();
    rows.flat_map(|(index, &row)| {
        let number = &number;
        let columns = interface.columns.of(index).iter();
        columns.map(move |&column| (number[row as usize], number[column as usize]))
    })
    .collect()
}

impl TangentSolver for Condensed {
    fn update(&mut self, system: &System<'_>, tangents: &[DMat3]) -> Result<(), LinearFailure> {
        let interface = &system.discretisation.interface;
        self.jumps.set_stiffness(&interface.stiffness(tangents));
        Ok(())
    }

    fn solve(
        &mut self,
        _: &System<'_>,
        right: &[DVec3],
        tolerance: f64,
    ) -> Result<LinearSolution, LinearFailure> {
        let mut column = self.cholesky.ordered(right);
        self.cholesky.eliminate(self.rock_size, &mut column);
        let solved = self.jumps.solve(&mut column[self.rock_size..], tolerance);
        let iterations = solved.map_err(|failure| self.named(failure))?;
        self.cholesky.substitute(self.rock_size, &mut column);
        Ok(LinearSolution {
            unknowns: self.cholesky.restored(&column),
            iterations,
        })
    }

    fn history(&self) -> SolverHistory {
        SolverHistory {
            stiffness: self.jumps.factored().map(<[DMat3]>::to_vec),
            preconditioned: None,
            margin: None,
        }
    }

    fn restore(&mut self, _: &System<'_>, history: SolverHistory) -> Result<(), LinearFailure> {
        let restored = self.jumps.factorise_again(history.stiffness);
        restored.map_err(|failure| self.named(failure))
    }
}

impl Condensed {
    /// Translates the number of a jump to that of its unknown.
    fn named(&self, failure: LinearFailure) -> LinearFailure {
        match failure {
            LinearFailure::Indefinite(jump) => {
                LinearFailure::Indefinite(self.cholesky.order()[self.rock_size / 3 + jump])
            }
            other => other,
        }
    }
}
