//! What is asked of the solver.

use crate::dimension::Dimension;
use crate::range::Range;
use crate::table::{Key, KeySection, Kind, Need, number};

/// Names of the linear solvers.
pub const SOLVERS: [&str; 3] = ["direct", "condensed", "iterative"];
/// Names of the rules by which fractures are integrated over their facets.
pub const FACETS: [&str; 2] = ["nodal", "gauss"];

/// What is asked of the solver.
pub static SOLVER: KeySection = KeySection {
    pattern: "[solver]",
    says: "What is asked of the solver, only to overrule the program",
    keys: &[
        Key {
            name: "linear",
            kind: Kind::Choice("linear solver", &SOLVERS),
            need: Need::Without("the cheapest"),
            example: "\"direct\"",
            says: "The linear solver; without it the program chooses",
        },
        Key {
            name: "memory_limit",
            kind: number(Dimension::Memory, Range::Positive),
            need: Need::Without("what is free"),
            example: "8e9",
            says: "Memory that the linear solver may take",
        },
        Key {
            name: "path_accuracy",
            kind: number(Dimension::One, Range::Between(0.0, 1.0)),
            need: Need::Default("1e-3"),
            example: "1e-4",
            says: "Largest difference between a part of the way in one go and in two, against the largest jump",
        },
        Key {
            name: "time_accuracy",
            kind: number(Dimension::One, Range::Positive),
            need: Need::Default("1e-2"),
            example: "1e-3",
            says: "Largest difference between a step in time in one go and in two, of jumps and pressures of a flow against the largest; from 1 on steps are taken as they are given",
        },
        Key {
            name: "facets",
            kind: Kind::Choice("facet rule", &FACETS),
            need: Need::Default("\"nodal\""),
            example: "\"gauss\"",
            says: "Where fractures are evaluated: at nodes, or for comparison at Gauss points",
        },
    ],
    also: None,
};
