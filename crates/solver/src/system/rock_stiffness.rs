//! The stiffness of rock and springs: all rows, or those that one of many ranks needs.

use std::ops::Range;

use glam::{DMat3, DVec3};
use kluft_algebra::{
    BlockMatrix, BlockPattern, BlockRows, Communicator, Division, RowOwnership, sum_up,
};

use crate::assembly::{rock, springs};
use crate::space::Space;

/// The stiffness of rock and springs over all unknowns. Apart from rows that are added it never
/// changes.
#[derive(Debug, Clone)]
pub(super) struct RockStiffness {
    division: Division,
    /// Pattern of the rows that are held, the others being empty there, while not all are held and
    /// rows may be added.
    pattern: Option<BlockPattern>,
    matrix: BlockMatrix,
    /// Diagonal blocks of the rows beside fractures, if not all rows are held.
    diagonal: Option<Vec<DMat3>>,
}

impl RockStiffness {
    /// Assembles the rows that are this rank's among those of a communicator. `beside` are the rows
    /// beside fractures, ascending.
    pub(super) fn of(space: Space<'_>, beside: &[u32], communicator: &Communicator) -> Self {
        let division = divided(space, communicator);
        if division.is_whole() {
            let all = vec![true; nodes(space)];
            let pattern = &space.pattern.blocks;
            let mut matrix = rock::rock_stiffness(space, &all, pattern);
            springs::add(space, pattern, &mut matrix);
            return Self {
                division,
                pattern: None,
                matrix,
                diagonal: None,
            };
        }
        let own = division.own();
        let is_own = |node: usize| own.contains(&(space.points.offset[node] as usize));
        let (pattern, matrix) = some(space, is_own, own.clone());
        let rows = matrix.rows(&pattern);
        let of_beside = division.of_kept(beside);
        let diagonal = of_beside.map(|index| rows.diagonal(beside[index] as usize));
        Self {
            division,
            diagonal: Some(diagonal),
            pattern: Some(pattern),
            matrix,
        }
    }

    /// Which rank makes the products with which rows.
    pub(super) fn division(&self) -> &Division {
        &self.division
    }

    /// Holds of these rows, which are those of whole nodes, too what `is_needed` of rows and
    /// columns. Returns the pattern of what is then held, which serves instead of that of all rows,
    /// unless all are held or nothing can be added any more.
    pub(super) fn add_rows(
        &mut self,
        space: Space<'_>,
        rows: &[u32],
        is_needed: impl Fn(u32, u32) -> bool,
    ) -> Option<BlockPattern> {
        let held = self.pattern.take()?;
        let mut is_new = vec![false; nodes(space)];
        for &row in rows
            .iter()
            .filter(|&&row| held.row(row as usize).is_empty())
        {
            is_new[space.points.node[row as usize] as usize] = true;
        }
        let (pattern, matrix) = some(space, |node| is_new[node], 0..0);
        let added = needed(matrix.rows(&pattern), is_needed);
        let parts = [self.matrix.rows(&held), added.1.rows(&added.0)];
        let (pattern, matrix) = joined(parts, self.division.own());
        self.matrix = matrix;
        Some(pattern)
    }

    /// The rows that are held, the others being empty; `whole` is the pattern of all.
    pub(super) fn rows<'a>(&'a self, whole: &'a BlockPattern) -> BlockRows<'a> {
        self.matrix.rows(self.held(whole))
    }

    /// Diagonal blocks of the rows beside fractures, if not all rows are held.
    pub(super) fn diagonal(&self) -> Option<&[DMat3]> {
        self.diagonal.as_deref()
    }

    /// `K y`.
    pub(super) fn times(&self, whole: &BlockPattern, vector: &[DVec3]) -> Vec<DVec3> {
        let mut product = self.matrix.times(self.held(whole), vector);
        self.division.complete(&mut product);
        product
    }

    /// `|K| |y|`, both entry by entry.
    pub(super) fn absolute_times(&self, whole: &BlockPattern, vector: &[DVec3]) -> Vec<DVec3> {
        let mut product = vec![DVec3::ZERO; vector.len()];
        self.rows(whole).multiply_absolute(vector, &mut product);
        self.division.complete(&mut product);
        product
    }

    fn held<'a>(&'a self, whole: &'a BlockPattern) -> &'a BlockPattern {
        self.pattern.as_ref().unwrap_or(whole)
    }
}

fn nodes(space: Space<'_>) -> usize {
    space.problem.mesh.nodes.len()
}

/// Rows of consecutive nodes, which lie together, with about as many blocks for each rank.
fn divided(space: Space<'_>, communicator: &Communicator) -> Division {
    let (firsts, blocks) = (&space.points.offset, &space.pattern.blocks.row_offset);
    let (ranks, all) = (communicator.size(), blocks[blocks.len() - 1]);
    let start = |rank: usize| {
        let before = |row: &u32| blocks[*row as usize] < rank * all / ranks;
        firsts[firsts.partition_point(before)] as usize
    };
    let starts = (0..ranks).map(start).chain([space.points.len()]);
    communicator.divide(RowOwnership::of_starts(starts.collect()))
}

/// The rows of some nodes and their pattern, in which the others are empty; blocks between the rows
/// `halved` are stored once.
fn some(
    space: Space<'_>,
    is_wanted: impl Fn(usize) -> bool,
    halved: Range<usize>,
) -> (BlockPattern, BlockMatrix) {
    let whole = &space.pattern.blocks;
    let is_wanted: Vec<bool> = (0..nodes(space)).map(is_wanted).collect();
    let is_held = |row: &usize| is_wanted[space.points.node[*row] as usize];
    let rows = 0..whole.rows();
    let lengths = rows.clone().map(|row| match is_held(&row) {
        true => whole.row(row).len(),
        false => 0,
    });
    let mut row_offset: Vec<usize> = std::iter::once(0).chain(lengths).collect();
    sum_up(&mut row_offset);
    let columns = rows.filter(is_held);
    let columns = columns.flat_map(|row| &whole.columns[whole.row(row)]);
    let pattern = BlockPattern::new(row_offset, columns.copied().collect()).halved(halved);
    let mut matrix = rock::rock_stiffness(space, &is_wanted, &pattern);
    springs::add(space, &pattern, &mut matrix);
    (pattern, matrix)
}

/// What is needed of rows all of whose blocks are stored, by row and column.
fn needed(
    rows: BlockRows<'_>,
    is_needed: impl Fn(u32, u32) -> bool,
) -> (BlockPattern, BlockMatrix) {
    let mut row_offset = vec![0];
    let (mut columns, mut blocks) = (Vec::new(), Vec::new());
    for row in 0..rows.rows() {
        let range = rows.pattern.row(row);
        let all = rows.pattern.columns[range.clone()].iter();
        for (&column, &block) in all.zip(&rows.blocks[range]) {
            if is_needed(row as u32, column) {
                columns.push(column);
                blocks.push(block);
            }
        }
        row_offset.push(columns.len());
    }
    (
        BlockPattern::new(row_offset, columns),
        BlockMatrix { blocks },
    )
}

/// Rows of which each is empty in one of two matrices; blocks between the rows `halved` are stored
/// once, as in the one that has them.
fn joined(parts: [BlockRows<'_>; 2], halved: Range<usize>) -> (BlockPattern, BlockMatrix) {
    let count = |of: fn(&BlockPattern) -> usize| parts.iter().map(|part| of(part.pattern)).sum();
    let mut row_offset = vec![0];
    let mut columns = Vec::with_capacity(count(|pattern| pattern.columns.len()));
    let mut blocks = Vec::with_capacity(count(BlockPattern::stored_count));
    for row in 0..parts[0].rows() {
        for part in &parts {
            columns.extend_from_slice(&part.pattern.columns[part.pattern.row(row)]);
            blocks.extend_from_slice(&part.blocks[part.pattern.stored(row)]);
        }
        row_offset.push(columns.len());
    }
    let pattern = BlockPattern::new(row_offset, columns).halved(halved);
    (pattern, BlockMatrix { blocks })
}
