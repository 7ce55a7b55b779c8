//! Places whose values are written down.

use crate::dimension::Dimension;
use crate::range::Range;
use crate::table::{Key, KeySection, Kind, Need, quantity};

const fn position(
    name: &'static str,
    need: Need,
    example: &'static str,
    says: &'static str,
) -> Key {
    Key {
        name,
        kind: Kind::Vector(quantity(Dimension::Length, Range::Finite)),
        need,
        example,
        says,
    }
}

/// What stands for points.
const POINTLESS: &str = "the other is given, or all of a surface is meant";

/// A probe.
pub static PROBE: KeySection = KeySection {
    pattern: "[probe.NAME]",
    says: "Points or surfaces whose values `probes.csv` has after each load step, in rock or on fractures",
    keys: &[
        position(
            "at",
            Need::Unless(POINTLESS),
            "[0.5, 0.5, 2.0]",
            "One point",
        ),
        position(
            "from",
            Need::Unless(POINTLESS),
            "[0, 0, 0]",
            "Where a line begins",
        ),
        position(
            "to",
            Need::Without("required with `from`"),
            "[10, 0, 0]",
            "Where it ends",
        ),
        Key {
            name: "count",
            kind: Kind::Whole(Range::Within(2.0, 10_000.0)),
            need: Need::Default("11"),
            example: "21",
            says: "Points on the line, both ends included",
        },
        position(
            "across",
            Need::Without("a line"),
            "[0, 0, 5]",
            "Vector by which the last of `rows` lines is moved from the first: a plane",
        ),
        Key {
            name: "rows",
            kind: Kind::Whole(Range::Within(2.0, 10_000.0)),
            need: Need::Default("11"),
            example: "6",
            says: "Lines of a plane",
        },
        Key {
            name: "fracture",
            kind: Kind::Text,
            need: Need::Without("in the rock"),
            example: "\"fault\"",
            says: "The fracture whose nearest nodes are taken, with aperture, jump and tractions, and with `[fluid]` pressure and hydraulic aperture; without points, their mean by area over all of it",
        },
        Key {
            name: "boundary",
            kind: Kind::Text,
            need: Need::Without("in the rock"),
            example: "\"wall\"",
            says: "The part of the outer surface over which displacement, stress and strain are averaged by area",
        },
        Key {
            name: "mean",
            kind: Kind::Flag,
            need: Need::Default("false"),
            example: "true",
            says: "Whether the mean of the points is written instead of each; over a whole surface it always is",
        },
    ],
    also: None,
};
