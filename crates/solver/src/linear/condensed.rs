//! The condensed direct solver: the rock is factorised once, and what changes is solved for the
//! jumps alone.
//!
//! With the jumps ordered last, the trailing block of the Cholesky factor of the rock is the factor
//! of the rock's Schur complement. The rock alone may leave blocks free to move, so it is
//! factorised together with springs `C_0` of its own stiffness on all facet points, which the
//! condensed problem takes away again. Their size is that of the Schur complement, so the
//! difference loses no digits.

use glam::{DMat3, DVec3};
use kluft_algebra::{Analysis, Cholesky, FixedPart, LinearFailure, SchurComplement};

use crate::linear::tangent_solver::{LinearSolution, SolverHistory, TangentSolver};

/// Condensed solver of a system.
pub struct Condensed {
    cholesky: Cholesky,
    /// Number of scalars eliminated before the jumps.
    rock_size: usize,
    jumps: SchurComplement,
}

impl Condensed {
    /// Factorises the rock together with `reference`, blocks of springs on all facet points;
    /// `analysis` has the unknowns of the interface last.
    ///
    /// # Errors
    /// If the rock is not positive definite or memory runs out.
    pub fn new(
        fixed: FixedPart<'_>,
        reference: Vec<DMat3>,
        analysis: Analysis,
    ) -> Result<Self, LinearFailure> {
        let mut cholesky = Cholesky::new(analysis, fixed.matrix);
        for (row, place, block) in fixed.blocks(&fixed.places(), &reference) {
            cholesky.set_block(row, place, block);
        }
        cholesky.factorise()?;
        cholesky.forget_values();
        let order = cholesky.order();
        let rock_size = 3 * (order.len() - fixed.interface.rows.len());
        let lower = cholesky.trailing_factor(rock_size);
        let places = places(fixed, &order[rock_size / 3..]);
        Ok(Self {
            jumps: SchurComplement::new(&lower, places, reference),
            rock_size,
            cholesky,
        })
    }
}

/// Block row and column of each block of the fractures, counted in the order of the jumps.
fn places(fixed: FixedPart<'_>, jumps: &[usize]) -> Vec<(u32, u32)> {
    let mut number = vec![0_u32; fixed.matrix.rows()];
    for (index, &unknown) in jumps.iter().enumerate() {
        number[unknown] = index as u32;
    }
    let rows = fixed.interface.rows.iter().enumerate();
    rows.flat_map(|(index, &row)| {
        let number = &number;
        let columns = fixed.interface.columns.of(index).iter();
        columns.map(move |&column| (number[row as usize], number[column as usize]))
    })
    .collect()
}

impl TangentSolver for Condensed {
    fn update(&mut self, _: FixedPart<'_>, stiffness: Vec<DMat3>) -> Result<(), LinearFailure> {
        self.jumps.set_stiffness(&stiffness);
        Ok(())
    }

    fn solve(
        &mut self,
        _: FixedPart<'_>,
        rhs: &[DVec3],
        tolerance: f64,
    ) -> Result<LinearSolution, LinearFailure> {
        let mut column = self.cholesky.ordered(rhs);
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
            ..SolverHistory::default()
        }
    }

    fn restore(&mut self, _: FixedPart<'_>, history: SolverHistory) -> Result<(), LinearFailure> {
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
