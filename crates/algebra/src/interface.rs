//! A matrix that is the sum of a large fixed one and of blocks that change, as those of an
//! interface do.

use glam::{DMat3, DVec3};
use rayon::prelude::*;

use crate::block_rows::BlockRows;
use crate::lists::Lists;
use crate::vectors::add_at;

/// Where an interface adds blocks to a matrix.
#[derive(Debug, Clone, Copy)]
pub struct InterfacePattern<'a> {
    /// Rows that it adds to, ascending.
    pub rows: &'a [u32],
    /// For each of them the columns, ascending; the fixed matrix has blocks there too.
    pub columns: &'a Lists,
}

/// What an interface adds to a matrix.
#[derive(Debug, Clone, Copy)]
pub struct InterfaceBlocks<'a> {
    /// Where.
    pub pattern: InterfacePattern<'a>,
    /// The blocks, one for each of the columns.
    pub blocks: &'a [DMat3],
}

impl<'a> InterfaceBlocks<'a> {
    /// Columns and blocks of one of its rows.
    pub fn row(&self, index: usize) -> impl Iterator<Item = (u32, &'a DMat3)> + use<'a> {
        let lists = self.pattern.columns;
        let range = lists.offset[index]..lists.offset[index + 1];
        let columns = lists.entries[range.clone()].iter().copied();
        columns.zip(&self.blocks[range])
    }

    /// The product with `vector`, for each of its rows.
    pub fn products(&self, vector: &[DVec3]) -> Vec<DVec3> {
        let rows = (0..self.pattern.rows.len()).into_par_iter();
        rows.map(|index| self.product(index, vector)).collect()
    }

    fn product(&self, index: usize, vector: &[DVec3]) -> DVec3 {
        let blocks = self.row(index);
        blocks
            .map(|(column, block)| *block * vector[column as usize])
            .sum()
    }

    /// Adds the product with `vector` to `product`.
    pub fn add_product(&self, vector: &[DVec3], product: &mut [DVec3]) {
        add_at(
            self.pattern.rows,
            |index| self.product(index, vector),
            product,
        );
    }
}

/// What stays of such a sum: the fixed matrix, and where the interface adds to it.
#[derive(Debug, Clone, Copy)]
pub struct FixedPart<'a> {
    /// The fixed matrix.
    pub matrix: BlockRows<'a>,
    /// Where the interface adds blocks.
    pub interface: InterfacePattern<'a>,
    /// The diagonal blocks of the fixed matrix in these rows, if it is not there as a whole.
    pub diagonal: Option<&'a [DMat3]>,
}

impl<'a> FixedPart<'a> {
    /// The diagonal block of the fixed matrix in row `index` of the interface.
    pub fn diagonal(&self, index: usize) -> DMat3 {
        match self.diagonal {
            Some(blocks) => blocks[index],
            None => self.matrix.diagonal(self.interface.rows[index] as usize),
        }
    }

    /// `product = (matrix + blocks) vector`.
    ///
    /// # Panics
    /// If `vector` or `product` has not one entry for each block row.
    pub fn multiply(&self, blocks: &[DMat3], vector: &[DVec3], product: &mut [DVec3]) {
        self.matrix.multiply(vector, product);
        let pattern = self.interface;
        InterfaceBlocks { pattern, blocks }.add_product(vector, product);
    }

    /// Entries `rows`, ascending, of that product, to the same bits.
    pub fn products(&self, blocks: &[DMat3], rows: &[u32], vector: &[DVec3]) -> Vec<DVec3> {
        let pattern = self.interface;
        let added = InterfaceBlocks { pattern, blocks };
        let mut products = self.matrix.products(rows, vector);
        let pairs = products.par_iter_mut().zip(rows);
        pairs.for_each(|(product, row)| {
            if let Ok(index) = pattern.rows.binary_search(row) {
                *product += added.product(index, vector);
            }
        });
        products
    }

    /// Where the blocks of the interface belong in the matrix: block row and number of the block in
    /// it.
    ///
    /// # Panics
    /// If the fixed matrix has no block somewhere.
    pub fn places(&self) -> Vec<(usize, usize)> {
        let place = |row: usize, column: u32| {
            let place = self.matrix.pattern.place(row, column as usize);
            (row, place.expect("the fixed matrix has a block there"))
        };
        let InterfacePattern { rows, columns } = self.interface;
        let rows = rows.iter().enumerate();
        rows.flat_map(|(index, &row)| {
            let columns = columns.of(index).iter();
            columns.map(move |&column| place(row as usize, column))
        })
        .collect()
    }

    /// The blocks of the sum that the interface has a part in: block row, number of the block in
    /// it, and the block. `places` are [`Self::places`].
    pub fn blocks(
        &self,
        places: &[(usize, usize)],
        blocks: &[DMat3],
    ) -> impl Iterator<Item = (usize, usize, DMat3)> {
        places.iter().zip(blocks).map(|(&(row, place), block)| {
            let sum = self.matrix.block(row, place) + *block;
            (row, place, sum)
        })
    }
}
