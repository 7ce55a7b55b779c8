//! Blocks of a row as the shim takes them: all their numbers line by line.

use crate::answers::PetscFailure;

/// Most blocks of a row that the shim takes at once.
const MOST_AT_ONCE: usize = 256;

/// Hands over blocks of a row in the order of their columns, all numbers line by line, no more at
/// once than the shim takes.
pub(crate) fn in_lines<const N: usize>(
    blocks: &mut [(i64, [[f64; N]; N])],
    mut hand_over: impl FnMut(&[i64], &[f64]) -> Result<(), PetscFailure>,
) -> Result<(), PetscFailure> {
    blocks.sort_unstable_by_key(|(column, _)| *column);
    blocks.chunks(MOST_AT_ONCE).try_for_each(|some| {
        let columns: Vec<i64> = some.iter().map(|(column, _)| *column).collect();
        let line = |line: usize| some.iter().flat_map(move |(_, block)| block[line]);
        let lines: Vec<f64> = (0..N).flat_map(line).collect();
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
