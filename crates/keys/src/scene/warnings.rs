//! What a run does not warn of.

use crate::table::{Key, KeySection, Kind, Need};

/// Names of what a run may warn of.
pub const WARNINGS: [&str; 13] = [
    "values",
    "body_size",
    "wide_apertures",
    "large_displacements",
    "idle_histories",
    "initial_stress",
    "unnamed_surfaces",
    "overlapping_walls",
    "not_unique",
    "unresolved_path",
    "long_time_steps",
    "fluid_times",
    "point_contacts",
];

/// What a run does not warn of.
pub static SILENCED: KeySection = KeySection {
    pattern: "[warnings]",
    says: "What is possible but hardly meant is warned of; here stands what is meant",
    keys: &[Key {
        name: "silence",
        kind: Kind::Choices(&WARNINGS),
        need: Need::Default("[]"),
        example: "[\"initial_stress\"]",
        says: "Warnings that are left out; each warning ends with its name",
    }],
    also: None,
};
