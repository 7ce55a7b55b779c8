//! The matrix that a hierarchy is made of: the rock, and what the fractures add to it.

use glam::DMat3;

use super::block_rows::{BlockRows, DROPPED};
use crate::pattern::Lists;

/// Stiffness of the fractures, to be added to that of the rock.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Springs<'a> {
    /// Rows they act on, ascending.
    pub(crate) rows: &'a [u32],
    /// For each of them the columns, ascending; the rock has blocks there too.
    pub(crate) columns: &'a Lists,
    /// The blocks, one for each of the columns.
    pub(crate) blocks: &'a [DMat3],
}

impl<'a> Springs<'a> {
    /// Columns and blocks of one of its rows.
    pub(super) fn row(&self, index: usize) -> impl Iterator<Item = (u32, &'a DMat3)> + use<'a> {
        let range = self.columns.offset[index]..self.columns.offset[index + 1];
        let columns = self.columns.entries[range.clone()].iter().copied();
        columns.zip(&self.blocks[range])
    }
}

/// Rows and columns of a matrix that are left when others are dropped.
#[derive(Clone, Copy)]
pub(super) struct Kept<'a> {
    /// Those that are left, ascending.
    pub(super) rows: &'a [u32],
    /// New number of each, [`DROPPED`] for the others.
    pub(super) number: &'a [u32],
}

/// Rows of the sum of rock and springs.
#[derive(Clone, Copy)]
pub(super) struct TangentRows<'a> {
    pub(super) rock: BlockRows<'a>,
    pub(super) springs: Option<Springs<'a>>,
    /// If not all rows count.
    pub(super) kept: Option<Kept<'a>>,
}

impl<'a> TangentRows<'a> {
    /// All rows of the rock alone.
    pub(super) fn of_rock(rock: BlockRows<'a>) -> Self {
        Self {
            rock,
            springs: None,
            kept: None,
        }
    }

    /// Number of rows.
    pub(super) fn count(&self) -> usize {
        self.kept.map_or(self.rock.rows(), |kept| kept.rows.len())
    }

    /// The rock alone.
    pub(super) fn without_springs(self) -> Self {
        Self {
            springs: None,
            ..self
        }
    }

    /// Whether springs act on one of some rows.
    pub(super) fn has_springs(&self, rows: &[u32]) -> bool {
        let act = |springs: Springs<'_>| {
            let mut rows = rows.iter();
            rows.any(|row| springs.rows.binary_search(row).is_ok())
        };
        self.springs.is_some_and(act)
    }

    /// Calls `treat` with each column and block of a row, columns ascending; blocks that are zero,
    /// as beside held nodes, are left out.
    #[inline]
    pub(super) fn for_each(&self, row: usize, mut treat: impl FnMut(u32, &DMat3)) {
        if let Some(kept) = self.kept {
            for (column, block) in self.rock.row(kept.rows[row] as usize) {
                let column = kept.number[column as usize];
                if column != DROPPED && *block != DMat3::ZERO {
                    treat(column, block);
                }
            }
            return;
        }
        let mut springs = self.springs_of(row).peekable();
        for (column, block) in self.rock.row(row) {
            match springs.next_if(|(at, _)| *at == column) {
                Some((_, spring)) => treat(column, &(*block + *spring)),
                None if *block != DMat3::ZERO => treat(column, block),
                None => {}
            }
        }
    }

    fn springs_of(&self, row: usize) -> impl Iterator<Item = (u32, &'a DMat3)> + use<'a> {
        let found = self.springs.and_then(|springs| {
            let index = springs.rows.binary_search(&(row as u32)).ok()?;
            Some((springs, index))
        });
        found
            .into_iter()
            .flat_map(|(springs, index)| springs.row(index))
    }
}

/// A block as its rows.
pub(super) fn rows_of(block: &DMat3) -> [[f64; 3]; 3] {
    block.transpose().to_cols_array_2d()
}
