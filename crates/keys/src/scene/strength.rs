//! How far strength can be reduced.

use crate::dimension::Dimension;
use crate::range::Range;
use crate::table::{Key, KeySection, Kind, Need, number};

/// Friction and cohesion reduced until blocks move.
pub static STRENGTH_REDUCTION: KeySection = KeySection {
    pattern: "[strength_reduction]",
    says: "Friction and cohesion divided by a growing factor until blocks move: the factor of safety",
    keys: &[
        Key {
            name: "fractures",
            kind: Kind::Texts,
            need: Need::Without("all that have friction"),
            example: "[\"left_plane\", \"right_plane\"]",
            says: "Fractures whose strength is reduced",
        },
        Key {
            name: "accuracy",
            kind: number(Dimension::One, Range::Within(1e-6, 0.5)),
            need: Need::Default("0.01"),
            example: "0.001",
            says: "Largest difference between the last stable and the first failing factor, as a share of the former",
        },
        Key {
            name: "most",
            kind: number(Dimension::One, Range::Within(1.0, 1e6)),
            need: Need::Default("10"),
            example: "3",
            says: "Factor at which the search ends, if nothing has moved by then",
        },
    ],
    also: None,
};
