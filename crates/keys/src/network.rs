//! The keys of a network description, and the columns of a list of fractures.

mod fracture;
mod list;
mod set;
mod shared;

pub use fracture::FRACTURE;
pub use list::LIST;
pub use set::{FRACTURE_SET, ORIENTATION, SIZE};

use shared::SEED;

use crate::dimension::Dimension;
use crate::range::Range;
use crate::scene;
use crate::table::{Key, KeySection, Kind, Need, number, quantity};

/// The top of a description.
pub static ROOT: KeySection = KeySection {
    pattern: "",
    says: "The top of a description; sections of a scene go into the scene that is made",
    keys: &[
        Key {
            need: Need::Default("\"Fracture network\""),
            says: "What the scene is called",
            ..scene::TITLE
        },
        SEED,
        Key {
            name: "domain",
            kind: Kind::Table(&DOMAIN),
            need: Need::Unless("`--domain` is given"),
            example: "[domain]",
            says: "The box of rock",
        },
        Key {
            name: "mesh",
            kind: Kind::Table(&MESH),
            need: Need::Unless("`--h` is given"),
            example: "[mesh]",
            says: "Cell sizes, and what is too small for them",
        },
        Key {
            name: "fracture_set",
            kind: Kind::Named(&FRACTURE_SET),
            need: Need::Required,
            example: "[fracture_set.NAME]",
            says: "Sets of fractures, at least one",
        },
        Key {
            name: "fracture",
            kind: Kind::Listed(&FRACTURE),
            need: Need::Without("none"),
            example: "[[fracture]]",
            says: "Fractures given one by one",
        },
        scene::ROCKS,
        Key {
            need: Need::Without("10 MPa on top, rollers; in rigid rock closed"),
            says: "Conditions by physical surface: `top`, `bottom`, `left`, `right`, `front`, `back`",
            ..scene::BOUNDARIES
        },
        scene::FIXED_POINTS,
        scene::BODIES,
        scene::FLUIDS,
        scene::SOURCES,
        scene::INITIAL_STRESSES,
        scene::LOADS,
        scene::SOLVING,
    ],
    also: None,
};

/// The box of rock.
pub static DOMAIN: KeySection = KeySection {
    pattern: "[domain]",
    says: "The box of rock; x is east, y is north, z is up",
    keys: &[
        Key {
            name: "low",
            kind: Kind::Vector(quantity(Dimension::Length, Range::Finite)),
            need: Need::Required,
            example: "[0, 0, 0]",
            says: "Its lowest corner",
        },
        Key {
            name: "high",
            kind: Kind::Vector(quantity(Dimension::Length, Range::Finite)),
            need: Need::Required,
            example: "[10, 10, 10]",
            says: "Its highest corner",
        },
        Key {
            name: "geometry",
            kind: Kind::Path,
            need: Need::Without("the box"),
            example: "\"tunnel.geo\"",
            says: "A gmsh geometry by OpenCASCADE, relative to the description, whose volumes are the rock inside the box: cavities, slopes, topography",
        },
    ],
    also: None,
};

/// Cell sizes, and what is too small for them.
pub static MESH: KeySection = KeySection {
    pattern: "[mesh]",
    says: "Cell sizes, and what is too small for them",
    keys: &[
        Key {
            name: "h",
            kind: number(Dimension::Length, Range::Positive),
            need: Need::Unless("`--h` is given"),
            example: "0.5",
            says: "Cell size away from fractures",
        },
        Key {
            name: "h_fracture",
            kind: number(Dimension::Length, Range::Positive),
            need: Need::Without("h / 2"),
            example: "0.25",
            says: "Cell size on fractures",
        },
        Key {
            name: "h_intersection",
            kind: number(Dimension::Length, Range::Positive),
            need: Need::Without("`h_fracture`"),
            example: "0.2",
            says: "Cell size where fractures meet",
        },
        Key {
            name: "growth",
            kind: number(Dimension::One, Range::Positive),
            need: Need::Default("0.5"),
            example: "0.3",
            says: "Growth of the cell size per metre of distance",
        },
        Key {
            name: "small",
            kind: number(Dimension::One, Range::NotNegative),
            need: Need::Default("0.2"),
            example: "0.1",
            says: "Share of `h_fracture` below which a feature is too small",
        },
        Key {
            name: "small_angle",
            kind: number(Dimension::Angle, Range::NotNegative),
            need: Need::Default("10"),
            example: "5",
            says: "Angle between fractures below which it is too small",
        },
        Key {
            name: "mend",
            kind: Kind::Flag,
            need: Need::Default("true"),
            example: "false",
            says: "Whether corners move onto what they nearly touch",
        },
    ],
    also: None,
};
