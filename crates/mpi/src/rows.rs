//! Rows of blocks on their way to PETSc.

use std::sync::Arc;

use kluft_solver::multigrid::BlockList;

use crate::petsc::{Matrix, PetscFailure, World};

/// Most blocks of a row that the shim takes at once.
const MOST_AT_ONCE: usize = 256;

impl Matrix {
    /// The matrix whose rows of this rank are given in blocks; `number` gives a column its global
    /// number, and `columns` of all of them are this rank's own.
    ///
    /// # Errors
    /// Those of PETSc.
    pub fn new<const M: usize, const L: usize>(
        world: &Arc<World>,
        rows: &BlockList<M, L>,
        columns: usize,
        number: impl Fn(u32) -> i64,
    ) -> Result<Self, PetscFailure> {
        Self::by_rows([rows.rows(), columns], world, |row, blocks| {
            let entries = rows.row(row);
            blocks.extend(entries.map(|(column, block)| (number(column), *block)));
        })
    }

    /// The matrix with so many block rows and columns of this rank, of which `row` adds one to a
    /// list: global numbers of columns, and blocks as lines. It is called twice a row, so that
    /// nothing of the matrix is held but by PETSc.
    ///
    /// # Errors
    /// Those of PETSc.
    pub fn by_rows<const M: usize, const L: usize>(
        [rows, columns]: [usize; 2],
        world: &Arc<World>,
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
        let matrix = Self::allocated::<M, L>(world, columns, [&own, &others])?;
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

/// Hands over blocks of a row in the order of their columns, all numbers line by line, no more at
/// once than the shim takes.
pub(crate) fn in_lines<const M: usize, const L: usize>(
    blocks: &mut [(i64, [[f64; L]; M])],
    mut hand_over: impl FnMut(&[i64], &[f64]) -> Result<(), PetscFailure>,
) -> Result<(), PetscFailure> {
    blocks.sort_unstable_by_key(|(column, _)| *column);
    blocks.chunks(MOST_AT_ONCE).try_for_each(|some| {
        let columns: Vec<i64> = some.iter().map(|(column, _)| *column).collect();
        let line = |line: usize| some.iter().flat_map(move |(_, block)| block[line]);
        let lines: Vec<f64> = (0..M).flat_map(line).collect();
        hand_over(&columns, &lines)
    })
}

/// Number of the blocks of a row, which have as many numbers each.
///
/// # Panics
/// If there are more than the shim takes at once, or not as many numbers.
pub(crate) fn checked(columns: &[i64], lines: &[f64], block: usize) -> i32 {
    assert!(
        columns.len() <= MOST_AT_ONCE,
        "more blocks than there is room for"
    );
    assert_eq!(lines.len(), block * columns.len(), "numbers of the blocks");
    columns.len() as i32
}
