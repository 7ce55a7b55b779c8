//! Rows of blocks on their way to PETSc.

use std::sync::Arc;

use crate::lines::in_lines;
use crate::petsc::{Matrix, PetscFailure, World};

impl Matrix {
    /// The square matrix with so many block rows of this rank, of which `row` adds one to a list:
    /// global numbers of columns, and blocks as lines. It is called twice a row, so that nothing of
    /// the matrix is held but by PETSc.
    ///
    /// # Errors
    /// Those of PETSc.
    pub fn by_rows<const N: usize>(
        world: &Arc<World>,
        rows: usize,
        mut row: impl FnMut(usize, &mut Vec<(i64, [[f64; N]; N])>),
    ) -> Result<Self, PetscFailure> {
        let counts = world.gather(&[rows as u64])?;
        let first: i64 = counts
            .iter()
            .take(world.rank())
            .map(|&rows| rows as i64)
            .sum();
        let mut blocks = Vec::new();
        let (mut own, mut others) = (vec![0_i32; rows], vec![0_i32; rows]);
        for at in 0..rows {
            blocks.clear();
            row(at, &mut blocks);
            let here = first..first + rows as i64;
            let of_rank = blocks.iter().filter(|(column, _)| here.contains(column));
            own[at] = of_rank.count() as i32;
            others[at] = blocks.len() as i32 - own[at];
        }
        let matrix = Self::allocated(world, N, [&own, &others])?;
        for at in 0..rows {
            blocks.clear();
            row(at, &mut blocks);
            let row = first + at as i64;
            in_lines(&mut blocks, |columns, lines| {
                matrix.set_row::<N>(row, columns, lines)
            })?;
        }
        matrix.end()?;
        Ok(matrix)
    }
}
