//! The keys of a scene.

mod closure;
mod conditions;
mod field;
mod fluid;
mod fracture;
mod load;
mod mesh;
mod oracle;
mod probe;
mod rock;
mod shared;
mod solver;
mod strength;
mod study;
mod warnings;

pub use closure::{ClosureLaw, LAWS};
pub use conditions::{BODY, BOUNDARY, DISPLACEMENT, FIXED_POINT, INITIAL_STRESS, PROFILE};
pub use field::{COORDINATES, FIELD};
pub use fluid::{FLUID, FLUID_PROFILE, SOURCE};
pub use fracture::{CLOSURES, FRACTURE};
pub use load::{LOAD, PHASE};
pub use mesh::{ADAPT, MESH};
pub use oracle::{FORMS, ORACLE};
pub use probe::PROBE;
pub use rock::ROCK;
pub use solver::{FACETS, SOLVER, SOLVERS};
pub use strength::STRENGTH_REDUCTION;
pub use study::{CLOSURE, SERIES, STUDY};
pub use warnings::{SILENCED, WARNINGS};

use crate::table::{Key, KeySection, Kind, Need};

/// The top of a scene.
pub static ROOT: KeySection = KeySection {
    pattern: "",
    says: "The top of a scene, before its first section",
    keys: &[
        TITLE,
        Key {
            name: "mesh",
            kind: Kind::Table(&MESH),
            need: Need::Required,
            example: "[mesh]",
            says: "Where the mesh comes from",
        },
        Key {
            need: Need::Unless("there is `[fluid]`, and the rock is rigid"),
            ..ROCKS
        },
        Key {
            name: "fracture",
            kind: Kind::Named(&FRACTURE),
            need: Need::Without("no surface is a fracture"),
            example: "[fracture.default]",
            says: "Fractures by physical surface",
        },
        BOUNDARIES,
        FIXED_POINTS,
        BODIES,
        FLUIDS,
        SOURCES,
        INITIAL_STRESSES,
        LOADS,
        SOLVING,
        Key {
            name: "strength_reduction",
            kind: Kind::Table(&STRENGTH_REDUCTION),
            need: Need::Without("no factor of safety"),
            example: "[strength_reduction]",
            says: "How far the strength of fractures can be reduced until blocks move",
        },
        Key {
            name: "warnings",
            kind: Kind::Table(&SILENCED),
            need: Need::Without("all are told"),
            example: "[warnings]",
            says: "What is meant, however unlikely it looks",
        },
        Key {
            name: "study",
            kind: Kind::Table(&STUDY),
            need: Need::Without("cell sizes and orders are swept"),
            example: "[study]",
            says: "What `kluft study` sweeps; `kluft run` ignores it",
        },
        Key {
            name: "oracle",
            kind: Kind::Named(&ORACLE),
            need: Need::Without("nothing is compared"),
            example: "[oracle.NAME]",
            says: "Closed forms by fracture, to compare it with",
        },
        Key {
            name: "probe",
            kind: Kind::Named(&PROBE),
            need: Need::Without("none"),
            example: "[probe.NAME]",
            says: "Points whose values are written down after each load step",
        },
    ],
    also: None,
};

pub(crate) const TITLE: Key = Key {
    name: "title",
    kind: Kind::Text,
    need: Need::Default("\"untitled\""),
    example: "\"Two joints in granite\"",
    says: "What reports and `summary.json` call it",
};

pub(crate) const ROCKS: Key = Key {
    name: "rock",
    kind: Kind::Named(&ROCK),
    need: Need::Without("granite"),
    example: "[rock.default]",
    says: "Rocks by physical volume",
};

pub(crate) const BOUNDARIES: Key = Key {
    name: "boundary",
    kind: Kind::Named(&BOUNDARY),
    need: Need::Without("free"),
    example: "[boundary.top]",
    says: "Conditions by physical surface; surfaces that are not named are free",
};

pub(crate) const FLUIDS: Key = Key {
    name: "fluid",
    kind: Kind::Table(&FLUID),
    need: Need::Without("nothing flows"),
    example: "[fluid]",
    says: "A fluid that flows in the fractures",
};

pub(crate) const SOURCES: Key = Key {
    name: "source",
    kind: Kind::Listed(&SOURCE),
    need: Need::Without("none"),
    example: "[[source]]",
    says: "Boreholes",
};

pub(crate) const FIXED_POINTS: Key = Key {
    name: "fixed_point",
    kind: Kind::Listed(&FIXED_POINT),
    need: Need::Without("none"),
    example: "[[fixed_point]]",
    says: "Nodes held by themselves",
};

pub(crate) const BODIES: Key = Key {
    name: "body",
    kind: Kind::Table(&BODY),
    need: Need::Without("weightless"),
    example: "[body]",
    says: "What acts in all of the rock",
};

pub(crate) const INITIAL_STRESSES: Key = Key {
    name: "initial_stress",
    kind: Kind::Table(&INITIAL_STRESS),
    need: Need::Without("none"),
    example: "[initial_stress]",
    says: "Stress before any load",
};

pub(crate) const LOADS: Key = Key {
    name: "load",
    kind: Kind::Table(&LOAD),
    need: Need::Without("one load step"),
    example: "[load]",
    says: "Load steps",
};

pub(crate) const SOLVING: Key = Key {
    name: "solver",
    kind: Kind::Table(&SOLVER),
    need: Need::Without("the program chooses"),
    example: "[solver]",
    says: "What is asked of the solver",
};
