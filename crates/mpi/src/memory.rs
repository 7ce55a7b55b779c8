//! Memory that the solver on ranks takes, predicted before any of it is taken.

/// A block of the finest level, in single precision, and its column.
const OF_BLOCK: usize = 36 + 4;
/// Prolongator, levels below and vectors, for each row.
const OF_ROW: usize = 1_300;
/// The second level, which every rank has while levels are made, and states of facets, for each
/// row.
const OF_ROW_ON_EACH: usize = 1_500;

/// Bytes for `rows` block rows with `blocks` blocks on each of so many ranks.
pub fn solver_bytes(rows: usize, blocks: usize, ranks: usize) -> usize {
    let divided = OF_BLOCK * blocks + OF_ROW * rows;
    OF_ROW_ON_EACH * rows + divided.div_ceil(ranks)
}
