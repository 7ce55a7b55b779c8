//! Values that vary in space and time.

use crate::dimension::Dimension;
use crate::plausible::Plausible;
use crate::range::Range;
use crate::table::{Key, KeySection, Kind, Need, Quantity, number, quantity};

/// Names of what a table may be over; an expression has them as variables.
pub const COORDINATES: [&str; 5] = ["x", "y", "z", "depth", "time"];

/// A key that holds a number, or a value that varies.
pub(super) const fn varied(dimension: Dimension, range: Range) -> Kind {
    Kind::NumberOr(quantity(dimension, range), &FIELD)
}

/// A key that holds a number whose unlikely values raise doubts, or a value that varies.
pub(super) const fn watched_varied(
    dimension: Dimension,
    range: Range,
    plausible: &'static Plausible,
) -> Kind {
    let plausible = Some(plausible);
    let quantity = Quantity {
        dimension,
        range,
        plausible,
    };
    Kind::NumberOr(quantity, &FIELD)
}

/// A value that varies.
pub static FIELD: KeySection = KeySection {
    pattern: "a value that varies",
    says: "Keys in braces in the place of a number: `table`, `expression` or `file`",
    keys: &[
        Key {
            name: "table",
            kind: Kind::Rows,
            need: Need::Without("`expression` or `file`"),
            example: "[[0, 1e9], [500, 4e9]]",
            says: "Rows `[coordinate, value]` with linear values between, in any order",
        },
        Key {
            name: "over",
            kind: Kind::Choice("coordinate", &COORDINATES),
            need: Need::Without("required with `table`"),
            example: "\"depth\"",
            says: "What the rows of the table are over; the time is that of the load steps",
        },
        Key {
            name: "ground",
            kind: number(Dimension::Length, Range::Finite),
            need: Need::Default("0"),
            example: "350",
            says: "Elevation z of the ground: the depth is `ground` - z",
        },
        Key {
            name: "expression",
            kind: Kind::Text,
            need: Need::Without("`table` or `file`"),
            example: "\"1e6 * (1 - z/100)\"",
            says: "Value by x, y, z, depth (m) and time, with + - * / ^, min(a, b), max(a, b), sqrt, exp, ln, log10, sin, cos, tan, abs, step (0 below 0, else 1) and PI",
        },
        Key {
            name: "file",
            kind: Kind::Path,
            need: Need::Without("`table` or `expression`"),
            example: "\"scan.csv\"",
            says: "CSV file of samples: columns x, y, z (m), of which those may be missing along which nothing varies; or a grid of VTK (.vtu), whose values stand at its points, or in the middle of its cells",
        },
        Key {
            name: "column",
            kind: Kind::Text,
            need: Need::Without("required with `file`"),
            example: "\"kn\"",
            says: "Column, or array of the grid, with the values",
        },
        Key {
            name: "method",
            kind: Kind::Choice("method", &["nearest", "linear"]),
            need: Need::Default("\"nearest\""),
            example: "\"linear\"",
            says: "Between samples: the nearest one, or linear along their line, in the Delaunay triangles of their plane, or on their grid",
        },
        Key {
            name: "reach",
            kind: number(Dimension::Length, Range::Positive),
            need: Need::Without("any; the run tells the largest"),
            example: "2.5",
            says: "Largest distance from a sample: a point beyond it is a gap, and refused",
        },
        Key {
            name: "beyond",
            kind: Kind::Choice("continuation", &["refuse", "nearest"]),
            need: Need::Default("\"refuse\""),
            example: "\"nearest\"",
            says: "Beyond the table or the samples between which values are linear: a defect, or the nearest value",
        },
        Key {
            name: "unit",
            kind: Kind::Text,
            need: Need::Without("SI units, angles in degrees"),
            example: "\"GPa/m\"",
            says: "Unit of the values",
        },
    ],
    also: None,
};
