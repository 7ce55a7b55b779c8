//! A fracture given by itself.

use super::shared::{DIP, DIP_DIRECTION, SIDES};
use crate::dimension::Dimension;
use crate::range::Range;
use crate::table::{Key, KeySection, Kind, Need, number, quantity};

const NOT_OF_A_POLYGON: Need = Need::Unless("the shape is `\"polygon\"`");

/// A fracture given by itself.
pub static FRACTURE: KeySection = KeySection {
    pattern: "[[fracture]]",
    says: "A fracture given by itself: its shape, and where it lies",
    keys: &[
        NAME,
        Key {
            name: "set",
            kind: Kind::Text,
            need: Need::Required,
            example: "\"NAME\"",
            says: "The set that it belongs to, `[fracture_set.NAME]`",
        },
        SHAPE,
        Key {
            name: "centre",
            kind: Kind::Vector(quantity(Dimension::Length, Range::Finite)),
            need: NOT_OF_A_POLYGON,
            example: "[5, 5, 5]",
            says: "Its centre",
        },
        Key {
            need: NOT_OF_A_POLYGON,
            ..DIP
        },
        Key {
            need: NOT_OF_A_POLYGON,
            ..DIP_DIRECTION
        },
        RADIUS,
        SEMI_MAJOR,
        SEMI_MINOR,
        LENGTH,
        WIDTH,
        ROTATION,
        SIDES,
        Key {
            name: "points",
            kind: Kind::Points(quantity(Dimension::Length, Range::Finite)),
            need: Need::Unless("the shape is no polygon"),
            example: "[[0, 0, 0], [1, 0, 0], [0, 1, 0]]",
            says: "Corners of a convex polygon, three or more",
        },
    ],
    also: None,
};

pub(crate) const NAME: Key = Key {
    name: "name",
    kind: Kind::Text,
    need: Need::Required,
    example: "\"fault-1\"",
    says: "Its name, and that of its physical surface",
};

pub(crate) const SHAPE: Key = Key {
    name: "shape",
    kind: Kind::Choice("shape", &["disc", "ellipse", "rectangle", "polygon"]),
    need: Need::Required,
    example: "\"disc\"",
    says: "Its shape",
};

const fn length(name: &'static str, need: &'static str, says: &'static str) -> Key {
    Key {
        name,
        kind: number(Dimension::Length, Range::Positive),
        need: Need::Unless(need),
        example: "2.0",
        says,
    }
}

pub(crate) const RADIUS: Key = length("radius", "the shape is no disc", "Radius of a disc");
pub(crate) const SEMI_MAJOR: Key = length(
    "semi_major",
    "the shape is no ellipse",
    "Half of the first axis of an ellipse",
);
pub(crate) const SEMI_MINOR: Key = length(
    "semi_minor",
    "the shape is no ellipse",
    "Half of the second axis of an ellipse",
);
pub(crate) const LENGTH: Key = length(
    "length",
    "the shape is no rectangle",
    "First side of a rectangle",
);
pub(crate) const WIDTH: Key = length(
    "width",
    "the shape is no rectangle",
    "Second side of a rectangle",
);

pub(crate) const ROTATION: Key = Key {
    name: "rotation",
    kind: number(Dimension::Angle, Range::Finite),
    need: Need::Default("0"),
    example: "45",
    says: "Angle from the strike to the first side or axis, towards the dip",
};
