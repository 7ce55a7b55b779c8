//! Where a symmetric matrix of 3x3 blocks has blocks, and which of them are stored.

use std::ops::Range;

use rayon::prelude::*;

use crate::lists::sum_up;

/// Rows of a run, the work of one task; fixed, so that no result depends on the number of threads.
pub(crate) const ROWS_PER_RUN: usize = 2048;

/// Where a square matrix of 3x3 blocks has blocks; both triangles are listed.
///
/// Of a symmetric matrix it suffices to store a block or its transpose. Rows are divided into runs,
/// and of the blocks between two rows of one run those left of the diagonal are not stored; blocks
/// that lead out of a run are stored in each of the rows. So a run is the work of one task, which
/// adds to its own rows alone, and nearly half of the bytes are spared.
#[derive(Debug, Clone)]
pub struct BlockPattern {
    /// Start of each block row; one entry more than there are rows.
    pub row_offset: Vec<usize>,
    /// Column of each block, ascending in each row.
    pub columns: Vec<u32>,
    halves: Option<Halves>,
}

/// The rows whose blocks are stored once.
#[derive(Debug, Clone)]
struct Halves {
    rows: Range<usize>,
    /// Start of the stored blocks of each row; one entry more than there are rows.
    offset: Vec<usize>,
    spans: Vec<Span>,
}

/// Parts of a row, as numbers of its blocks. The columns left of the diagonal within the run are
/// those from `run` to `right`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Span {
    /// The first column within the run.
    pub(crate) run: usize,
    /// The first column whose row stores the block: it is mirrored here.
    pub(crate) mirrored: usize,
    /// The first column from the diagonal on.
    pub(crate) right: usize,
    /// The first column behind those in whose rows this row's blocks are mirrored.
    pub(crate) end: usize,
}

impl BlockPattern {
    /// A pattern all of whose blocks are stored: start of each row and the end, and column of each
    /// block, ascending in each row.
    pub fn new(row_offset: Vec<usize>, columns: Vec<u32>) -> Self {
        Self {
            row_offset,
            columns,
            halves: None,
        }
    }

    /// The same, of a symmetric matrix, where the blocks between these rows are stored once.
    pub fn halved(self, rows: Range<usize>) -> Self {
        let spans = (0..self.rows()).into_par_iter();
        let spans: Vec<Span> = spans.map(|row| self.span_within(&rows, row)).collect();
        let lengths = spans.iter().enumerate();
        let lengths = lengths.map(|(row, span)| self.row(row).len() + span.mirrored - span.right);
        let mut offset: Vec<usize> = std::iter::once(0).chain(lengths).collect();
        sum_up(&mut offset);
        Self {
            halves: Some(Halves {
                rows,
                offset,
                spans,
            }),
            ..self
        }
    }

    /// The parts of a row, the blocks between `rows` being stored once.
    fn span_within(&self, rows: &Range<usize>, row: usize) -> Span {
        let run = row - row % ROWS_PER_RUN;
        let columns = &self.columns[self.row(row)];
        let before = |end: usize| columns.partition_point(|&column| (column as usize) < end);
        let right = before(row);
        let [mirrored, end] = match rows.contains(&row) {
            true => [rows.start.max(run), rows.end.min(run + ROWS_PER_RUN)].map(before),
            false => [right; 2],
        };
        Span {
            run: before(run),
            mirrored,
            right,
            end,
        }
    }

    /// Number of block rows.
    pub fn rows(&self) -> usize {
        self.row_offset.len() - 1
    }

    /// Range of the blocks of a row.
    pub fn row(&self, row: usize) -> Range<usize> {
        self.row_offset[row]..self.row_offset[row + 1]
    }

    /// Range of the stored blocks of a row.
    pub fn stored(&self, row: usize) -> Range<usize> {
        match &self.halves {
            Some(halves) => halves.offset[row]..halves.offset[row + 1],
            None => self.row(row),
        }
    }

    /// Number of stored blocks.
    pub fn stored_count(&self) -> usize {
        self.stored_offset(self.rows())
    }

    /// Number of stored blocks in the rows before one.
    pub fn stored_offset(&self, row: usize) -> usize {
        match &self.halves {
            Some(halves) => halves.offset[row],
            None => self.row_offset[row],
        }
    }

    /// Numbers of the blocks of a row that are stored, in the order of storage.
    pub fn stored_places(&self, row: usize) -> impl Iterator<Item = usize> + use<> {
        let span = self.span(row);
        (0..span.mirrored).chain(span.right..self.row(row).len())
    }

    /// Where block number `place` of a row is stored, if it is.
    pub fn address(&self, row: usize, place: usize) -> Option<usize> {
        let start = self.stored_offset(row);
        let span = self.span(row);
        match place {
            _ if place < span.mirrored => Some(start + place),
            _ if place >= span.right => Some(start + span.mirrored + place - span.right),
            _ => None,
        }
    }

    /// Where the block at `row`, `column` is stored, which stands left of the diagonal and is
    /// mirrored there.
    pub(crate) fn mirror(&self, row: usize, column: usize) -> Option<usize> {
        let span = self.span(column);
        let start = self.row_offset[column];
        let columns = &self.columns[start + span.right..start + span.end];
        let place = columns.binary_search(&(row as u32)).ok()?;
        Some(self.stored_offset(column) + span.mirrored + place)
    }

    /// Number of a column among the blocks of a row, if it has one there.
    pub(crate) fn place(&self, row: usize, column: usize) -> Option<usize> {
        self.columns[self.row(row)]
            .binary_search(&(column as u32))
            .ok()
    }

    pub(crate) fn span(&self, row: usize) -> Span {
        let halves = self.halves.as_ref();
        halves.map_or_else(
            || self.span_within(&(0..0), row),
            |halves| halves.spans[row],
        )
    }

    /// Whether all rows of a run are stored once.
    pub(crate) fn is_halved(&self, run: &Range<usize>) -> bool {
        let halves = self.halves.as_ref();
        halves.is_some_and(|halves| halves.rows.start <= run.start && run.end <= halves.rows.end)
    }
}
