//! Short forms of the suites of the soak that run in this process; those of the real program are in
//! `tests/program/soak.rs`, and damaged meshes have a process of their own.

use kluft_verification::report::{Effort, Finding};
use kluft_verification::soak::{Asked, materials, mutated_scenes};

/// Every case must hold, and outcomes must be of more than one class.
fn hold(finding: &Finding) {
    assert!(finding.misses.is_empty(), "{:#?}", finding.misses);
    let classes = &finding.first_table().rows;
    assert!(classes.len() > 1, "{classes:?}");
}

#[test]
fn random_materials_have_one_answer() {
    hold(&materials::run(&Asked::of(Effort::Quick)));
}

#[test]
fn damaged_scenes_are_refused_or_make_sense() {
    hold(&mutated_scenes::run(&Asked::of(Effort::Quick)));
}
