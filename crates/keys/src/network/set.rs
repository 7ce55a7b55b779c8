//! Sets of fractures.

use super::shared::{DIP, DIP_DIRECTION, SEED, SIDES};
use crate::dimension::Dimension;
use crate::range::Range;
use crate::scene;
use crate::table::{Key, KeySection, Kind, Need, number};

/// A set of fractures.
pub static FRACTURE_SET: KeySection = KeySection {
    pattern: "[fracture_set.NAME]",
    says: "A set of fractures: keys of `[fracture.NAME]` in a scene, and a list or a random set",
    keys: &[
        Key {
            name: "list",
            kind: Kind::Path,
            need: Need::Without("no list"),
            example: "\"steep.csv\"",
            says: "A list of fractures (CSV), relative to the description",
        },
        Key {
            name: "orientation",
            kind: Kind::Table(&ORIENTATION),
            need: Need::Unless("the set is not random"),
            example: "{ dip = 60, dip_direction = 135, kappa = 20 }",
            says: "Orientations of a random set",
        },
        Key {
            name: "size",
            kind: Kind::Table(&SIZE),
            need: Need::Unless("the set is not random"),
            example: "{ law = \"power\", exponent = 2.5, min = 0.5, max = 5.0 }",
            says: "Sizes of a random set: radius, or half the longer side",
        },
        Key {
            name: "p32",
            kind: number(Dimension::PerLength, Range::Positive),
            need: Need::Or("count"),
            example: "0.5",
            says: "Area of the fractures in the domain per volume of it",
        },
        Key {
            name: "count",
            kind: Kind::Whole(Range::Positive),
            need: Need::Or("p32"),
            example: "100",
            says: "Number of fractures that reach the domain",
        },
        Key {
            name: "shape",
            kind: Kind::Choice("shape", &["disc", "rectangle"]),
            need: Need::Default("\"disc\""),
            example: "\"rectangle\"",
            says: "Shape of the fractures",
        },
        SIDES,
        Key {
            name: "aspect",
            kind: number(Dimension::One, Range::Positive),
            need: Need::Default("1.0"),
            example: "2.0",
            says: "Longer side of a rectangle over the shorter one",
        },
        Key {
            need: Need::Without("that of the description"),
            says: "Seed of this set",
            ..SEED
        },
        Key {
            name: "hydraulic_aperture_law",
            kind: Kind::Table(&APERTURE_LAW),
            need: Need::Without("`hydraulic_aperture` or `aperture`, the same for all"),
            example: "{ coefficient = 1e-5, exponent = 0.5 }",
            says: "Hydraulic aperture of each fracture by its size; needs `[fluid]` and a physical surface for each fracture",
        },
    ],
    also: Some(&scene::FRACTURE),
};

/// Orientations that scatter about a mean.
pub static ORIENTATION: KeySection = KeySection {
    pattern: "[fracture_set.NAME.orientation]",
    says: "Orientations that scatter about a mean (Fisher)",
    keys: &[
        DIP,
        DIP_DIRECTION,
        Key {
            name: "kappa",
            kind: number(Dimension::One, Range::NotNegative),
            need: Need::Required,
            example: "20",
            says: "Concentration about the mean; 0 is no preference",
        },
    ],
    also: None,
};

const fn size(name: &'static str, need: &'static str, says: &'static str) -> Key {
    Key {
        name,
        kind: number(Dimension::Length, Range::Positive),
        need: Need::Unless(need),
        example: "1.0",
        says,
    }
}

/// How wide fractures are by their size.
pub static APERTURE_LAW: KeySection = KeySection {
    pattern: "[fracture_set.NAME.hydraulic_aperture_law]",
    says: "Hydraulic aperture `coefficient r^exponent` by the radius r of a disc of the same area",
    keys: &[
        Key {
            name: "coefficient",
            kind: number(Dimension::Length, Range::Positive),
            need: Need::Required,
            example: "1e-5",
            says: "Hydraulic aperture at a radius of 1 m; the size is that before the fracture is cut",
        },
        Key {
            name: "exponent",
            kind: number(Dimension::One, Range::Finite),
            need: Need::Required,
            example: "0.5",
            says: "Exponent of the radius",
        },
    ],
    also: None,
};

/// How sizes are distributed.
pub static SIZE: KeySection = KeySection {
    pattern: "[fracture_set.NAME.size]",
    says: "How sizes are distributed",
    keys: &[
        Key {
            name: "law",
            kind: Kind::Choice("law", &["constant", "power", "lognormal"]),
            need: Need::Required,
            example: "\"power\"",
            says: "All alike, a power law, or a lognormal distribution",
        },
        size("radius", "the law is not constant", "Size of all"),
        Key {
            name: "exponent",
            kind: number(Dimension::One, Range::Finite),
            need: Need::Unless("the law is no power"),
            example: "2.5",
            says: "Exponent a of a power law, whose density goes as size^-a",
        },
        size("min", "the law is constant", "Smallest size"),
        size("max", "the law is constant", "Largest size"),
        size(
            "mean",
            "the law is not lognormal",
            "Mean without the bounds",
        ),
        size(
            "sd",
            "the law is not lognormal",
            "Standard deviation without the bounds",
        ),
    ],
    also: None,
};
