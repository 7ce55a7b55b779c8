//! Keys that several sections have.

use crate::dimension::Dimension;
use crate::range::Range;
use crate::table::{Key, Kind, Need, number};

/// The seed of random numbers.
pub(crate) const SEED: Key = Key {
    name: "seed",
    kind: Kind::Whole(Range::Within(0.0, 9007199254740992.0)),
    need: Need::Default("0"),
    example: "1",
    says: "Seed of all random sets",
};

/// Corners of a disc or an ellipse.
pub(crate) const SIDES: Key = Key {
    name: "sides",
    kind: Kind::Whole(Range::Within(3.0, 100.0)),
    need: Need::Default("12"),
    example: "16",
    says: "Corners of a disc or an ellipse",
};

/// Dip of a plane.
pub(crate) const DIP: Key = Key {
    name: "dip",
    kind: number(Dimension::Angle, Range::Within(0.0, 90.0)),
    need: Need::Required,
    example: "60",
    says: "Angle between the plane and the horizontal",
};

/// Direction of the dip.
pub(crate) const DIP_DIRECTION: Key = Key {
    name: "dip_direction",
    kind: number(Dimension::Angle, Range::Finite),
    need: Need::Required,
    example: "135",
    says: "Direction towards which the plane falls, clockwise from north",
};
