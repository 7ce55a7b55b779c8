//! The columns of a list of fractures.

use super::fracture::{LENGTH, NAME, RADIUS, ROTATION, SEMI_MAJOR, SEMI_MINOR, SHAPE, WIDTH};
use super::shared::{DIP, DIP_DIRECTION, SIDES};
use crate::dimension::Dimension;
use crate::range::Range;
use crate::table::{Key, KeySection, Kind, Need, number};

const NOT_OF_A_POLYGON: Need = Need::Unless("the shape is `polygon`");

/// The columns of a list.
pub static LIST: KeySection = KeySection {
    pattern: "",
    says: "One line for each fracture, a column for each key; values are plain numbers and words",
    keys: &[
        Key {
            need: Need::Without("the set with a number"),
            example: "fault-1",
            ..NAME
        },
        Key {
            name: "set",
            kind: Kind::Text,
            need: Need::Without("that of the list"),
            example: "steep",
            says: "The set that it belongs to",
        },
        Key {
            example: "disc",
            ..SHAPE
        },
        coordinate("x", "Centre, towards the east"),
        coordinate("y", "Centre, towards the north"),
        coordinate("z", "Centre, upwards"),
        Key {
            need: NOT_OF_A_POLYGON,
            ..DIP
        },
        Key {
            kind: number(Dimension::Angle, Range::Within(-360.0, 360.0)),
            need: Need::Unless("the shape is `polygon` or there is a `strike`"),
            says: "Direction in which it dips, clockwise from north; `dipdir` and `azimuth` mean the same",
            ..DIP_DIRECTION
        },
        Key {
            name: "trend",
            kind: number(Dimension::Angle, Range::Within(-360.0, 360.0)),
            need: Need::Without("dip and dip direction"),
            example: "45",
            says: "Where the normal runs to, clockwise from north; with `plunge` instead of the dip",
        },
        Key {
            name: "plunge",
            kind: number(Dimension::Angle, Range::Within(0.0, 90.0)),
            need: Need::Without("dip and dip direction"),
            example: "35",
            says: "How far the normal runs below the horizontal",
        },
        part(
            "normal_x",
            "Part of the normal towards the east, instead of the dip",
        ),
        part("normal_y", "Part of the normal towards the north"),
        part("normal_z", "Part of the normal upwards"),
        Key {
            name: "strike",
            kind: number(Dimension::Angle, Range::Within(-360.0, 360.0)),
            need: Need::Without("the dip direction"),
            example: "45",
            says: "In the place of the dip direction: the direction of the horizontal in the plane with the dip on its right, clockwise from north",
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
            kind: Kind::Text,
            need: Need::Unless("the shape is no polygon"),
            example: "0 0 5; 4 0 5; 4 4 5.5",
            says: "Corners of a convex polygon in metres, three or more",
        },
        Key {
            name: "comment",
            kind: Kind::Text,
            need: Need::Without("nothing"),
            example: "from the tunnel map",
            says: "Whatever is worth noting; it is not read",
        },
    ],
    also: None,
};

const fn part(name: &'static str, says: &'static str) -> Key {
    Key {
        name,
        kind: number(Dimension::One, Range::Finite),
        need: Need::Without("dip and dip direction"),
        example: "0.6",
        says,
    }
}

const fn coordinate(name: &'static str, says: &'static str) -> Key {
    Key {
        name,
        kind: number(Dimension::Length, Range::Finite),
        need: NOT_OF_A_POLYGON,
        example: "5",
        says,
    }
}
