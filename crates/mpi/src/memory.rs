//! Memory that the solver on ranks takes, predicted before any of it is taken.

/// PETSc's stiffness of the rock: a block and its column.
const OF_BLOCK: usize = 72 + 4;
/// Inverses of clusters, prolongator, levels below, vectors and room to make them, for each row.
const OF_ROW: usize = 4_000;

/// Bytes for `rows` block rows with `blocks` blocks, on all ranks together.
pub fn solver_bytes(rows: usize, blocks: usize) -> usize {
    OF_BLOCK * blocks + OF_ROW * rows
}
