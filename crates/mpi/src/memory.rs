//! Memory that the solver on ranks takes, predicted before any of it is taken.

/// PETSc's operator and the copy of it while it is made: a block, its column, and both again.
const OF_BLOCK: usize = 2 * (72 + 8) + 72 + 4;
/// Prolongator, next level, its levels below, vectors and the room to make them, for each row.
const OF_ROW: usize = 6_000;

/// Bytes for `rows` block rows with `blocks` blocks, on all ranks together.
pub fn solver_bytes(rows: usize, blocks: usize) -> usize {
    OF_BLOCK * blocks + OF_ROW * rows
}
