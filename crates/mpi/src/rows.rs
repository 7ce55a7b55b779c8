//! Rows of blocks on their way to PETSc.

use std::sync::Arc;

use kluft_solver::multigrid::BlockList;

use crate::lines::{EntryShape, in_lines};
use crate::petsc::{Matrix, PetscFailure, World};

impl Matrix {
    /// The square matrix whose rows of this rank are given in blocks; `number` gives a column its
    /// global number.
    ///
    /// # Errors
    /// Those of PETSc.
    pub fn square<const N: usize>(
        world: &Arc<World>,
        rows: &BlockList<N, N>,
        number: impl Fn(u32) -> i64,
    ) -> Result<Self, PetscFailure> {
        let sizes = [rows.rows(); 2];
        Self::by_rows(world, (EntryShape::square(N), sizes), |row, blocks| {
            let entries = rows.row(row);
            blocks.extend(entries.map(|(column, block)| (number(column), *block)));
        })
    }

    /// The matrix with so many block rows and columns of this rank, of which `row` adds one to a
    /// list: global numbers of columns, and entries as lines. It is called twice a row, so that
    /// nothing of the matrix is held but by PETSc.
    ///
    /// # Errors
    /// Those of PETSc.
    pub(crate) fn by_rows<const M: usize, const L: usize>(
        world: &Arc<World>,
        (shape, [rows, columns]): (EntryShape, [usize; 2]),
        mut row: impl FnMut(usize, &mut Vec<(i64, [[f64; L]; M])>),
    ) -> Result<Self, PetscFailure> {
        let starts = world.gather(&[rows as u64, columns as u64])?;
        let before = |which: usize| -> i64 {
            let of_ranks = starts.chunks_exact(2).take(world.rank());
            of_ranks.map(|counts| counts[which] as i64).sum()
        };
        let (first_row, first) = (before(0), before(1));
        let mut blocks = Vec::new();
        let (mut own, mut others) = (vec![0_i32; rows], vec![0_i32; rows]);
        for at in 0..rows {
            blocks.clear();
            row(at, &mut blocks);
            let here = first..first + columns as i64;
            let of_rank = blocks.iter().filter(|(column, _)| here.contains(column));
            own[at] = of_rank.count() as i32;
            others[at] = blocks.len() as i32 - own[at];
        }
        let matrix = Self::allocated(world, shape, columns, [&own, &others])?;
        for at in 0..rows {
            blocks.clear();
            row(at, &mut blocks);
            let row = first_row + at as i64;
            in_lines(&mut blocks, |columns, lines| {
                matrix.set_row(row, columns, lines)
            })?;
        }
        matrix.end()?;
        Ok(matrix)
    }
}
