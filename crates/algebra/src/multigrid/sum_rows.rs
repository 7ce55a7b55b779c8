//! The matrix that a hierarchy is made of: a fixed one, and what an interface adds to it.

use glam::DMat3;

use crate::block_rows::{BlockRows, DROPPED};
use crate::interface::InterfaceBlocks;

/// Rows and columns of a matrix that are left when others are dropped.
#[derive(Clone, Copy)]
pub(super) struct RowSubset<'a> {
    /// Those that are left, ascending.
    pub(super) rows: &'a [u32],
    /// New number of each, [`DROPPED`] for the others.
    pub(super) number: &'a [u32],
}

/// Rows of the sum of a fixed matrix and an interface.
#[derive(Clone, Copy)]
pub(super) struct SumRows<'a> {
    pub(super) fixed: BlockRows<'a>,
    pub(super) interface: Option<InterfaceBlocks<'a>>,
    /// If not all rows count.
    pub(super) subset: Option<RowSubset<'a>>,
}

impl<'a> SumRows<'a> {
    /// All rows of the fixed matrix alone.
    pub(super) fn of_fixed(fixed: BlockRows<'a>) -> Self {
        Self {
            fixed,
            interface: None,
            subset: None,
        }
    }

    /// Number of rows.
    pub(super) fn count(&self) -> usize {
        let subset = self.subset.map(|subset| subset.rows.len());
        subset.unwrap_or(self.fixed.rows())
    }

    /// The fixed matrix alone.
    pub(super) fn without_interface(self) -> Self {
        Self {
            interface: None,
            ..self
        }
    }

    /// Whether the interface adds to one of some rows.
    pub(super) fn is_changed(&self, rows: &[u32]) -> bool {
        let adds = |interface: InterfaceBlocks<'_>| {
            let mut rows = rows.iter();
            rows.any(|row| interface.pattern.rows.binary_search(row).is_ok())
        };
        self.interface.is_some_and(adds)
    }

    /// Calls `treat` with each column and block of a row, columns ascending; blocks that are zero,
    /// as beside held nodes, are left out.
    #[inline]
    pub(super) fn for_each(&self, row: usize, mut treat: impl FnMut(u32, &DMat3)) {
        if let Some(subset) = self.subset {
            self.fixed
                .row(subset.rows[row] as usize)
                .for_each(|(column, block)| {
                    let column = subset.number[column as usize];
                    if column != DROPPED && block != DMat3::ZERO {
                        treat(column, &block);
                    }
                });
            return;
        }
        let mut added = self.added_to(row).peekable();
        self.fixed.row(row).for_each(|(column, block)| {
            match added.next_if(|(at, _)| *at == column) {
                Some((_, other)) => treat(column, &(block + *other)),
                None if block != DMat3::ZERO => treat(column, &block),
                None => {}
            }
        });
    }

    /// Columns of a row, those of blocks that are zero included.
    pub(super) fn columns(&self, row: usize) -> impl Iterator<Item = u32> {
        let subset = self.subset;
        let row = subset.map_or(row, |subset| subset.rows[row] as usize);
        let pattern = self.fixed.pattern;
        let columns = pattern.columns[pattern.row(row)].iter();
        let columns = columns.map(move |&column| match subset {
            Some(subset) => subset.number[column as usize],
            None => column,
        });
        columns.filter(|&column| column != DROPPED)
    }

    /// The block at a row and a column, zero if there is none.
    pub(super) fn block(&self, row: usize, column: u32) -> DMat3 {
        let outer = |row: usize| self.subset.map_or(row, |subset| subset.rows[row] as usize);
        let (at, other) = (outer(row), outer(column as usize));
        let place = self.fixed.pattern.place(at, other);
        let own = place.map_or(DMat3::ZERO, |place| self.fixed.block(at, place));
        let mut added = self.added_to(row);
        let added = added.find(|(column, _)| *column as usize == other);
        added.map_or(own, |(_, added)| own + *added)
    }

    fn added_to(&self, row: usize) -> impl Iterator<Item = (u32, &'a DMat3)> + use<'a> {
        let found = self.interface.and_then(|interface| {
            let index = interface.pattern.rows.binary_search(&(row as u32)).ok()?;
            Some((interface, index))
        });
        found
            .into_iter()
            .flat_map(|(interface, index)| interface.row(index))
    }
}
