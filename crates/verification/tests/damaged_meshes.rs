//! Short form of the suite of damaged meshes, alone in its process: it watches the address space.

use kluft_verification::report::Effort;
use kluft_verification::soak::{Asked, mutated_meshes};

#[test]
fn damaged_meshes_are_refused_or_sound() {
    let finding = mutated_meshes::run(&Asked::of(Effort::Quick));
    assert!(finding.misses.is_empty(), "{:#?}", finding.misses);
    let classes = &finding.first_table().rows;
    assert!(classes.len() > 1, "{classes:?}");
}
