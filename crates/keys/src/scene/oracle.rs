//! Closed forms to compare fractures with.

use crate::dimension::Dimension;
use crate::range::Range;
use crate::table::{Key, KeySection, Kind, Need, number, quantity};

/// Names of the closed forms.
pub const FORMS: [&str; 5] = ["penny", "line", "uniform", "column", "sphere"];

/// The closed form of a fracture.
pub static ORACLE: KeySection = KeySection {
    pattern: "[oracle.NAME]",
    says: "A closed form to compare the fracture NAME with",
    keys: &[
        Key {
            name: "form",
            kind: Kind::Choice("closed form", &FORMS),
            need: Need::Required,
            example: "\"penny\"",
            says: "A disc (penny) or a strip in plane strain (line) in unbounded rock, a uniform jump, a joint that carries a pressure (column), or one between core and shell (sphere)",
        },
        Key {
            name: "centre",
            kind: Kind::Vector(quantity(Dimension::Length, Range::Finite)),
            need: Need::Unless("the form is neither penny nor line"),
            example: "[0, 0, 0]",
            says: "Centre of a penny, or a point of the middle of a line",
        },
        Key {
            name: "radius",
            kind: number(Dimension::Length, Range::Positive),
            need: Need::Unless("the form is neither penny nor sphere"),
            example: "1.0",
            says: "Radius of a penny, or of the joint in a sphere",
        },
        Key {
            name: "outer_radius",
            kind: number(Dimension::Length, Range::Positive),
            need: Need::Unless("the form is no sphere"),
            example: "2.0",
            says: "Radius of the shell around the joint of a sphere",
        },
        Key {
            name: "along",
            kind: Kind::Vector(quantity(Dimension::One, Range::Finite)),
            need: Need::Unless("the form is no line"),
            example: "[1, 0, 0]",
            says: "Direction from the middle of a line to its front",
        },
        Key {
            name: "half_length",
            kind: number(Dimension::Length, Range::Positive),
            need: Need::Unless("the form is no line"),
            example: "1.0",
            says: "Half the length of a line",
        },
        Key {
            name: "pressure",
            kind: number(Dimension::Stress, Range::Finite),
            need: Need::Without("not compared"),
            example: "2e6",
            says: "Pressure that opens a penny or line; that closes a column (without fluid pressure), or acts outside of a sphere, required there",
        },
        Key {
            name: "stress_drop",
            kind: number(Dimension::Stress, Range::Finite),
            need: Need::Without("not compared"),
            example: "1e6",
            says: "Stress drop that shears a penny or line",
        },
        Key {
            name: "opening",
            kind: number(Dimension::Length, Range::Finite),
            need: Need::Without("not compared"),
            example: "1e-5",
            says: "Opening of a uniform jump",
        },
        Key {
            name: "slip",
            kind: number(Dimension::Length, Range::Finite),
            need: Need::Without("not compared"),
            example: "1e-5",
            says: "Magnitude of the slip of a uniform jump",
        },
        Key {
            name: "normal_traction",
            kind: number(Dimension::Stress, Range::Finite),
            need: Need::Without("not compared"),
            example: "-1e6",
            says: "Normal traction everywhere, tension positive",
        },
        Key {
            name: "ring",
            kind: number(Dimension::One, Range::Between(0.0, 1.0)),
            need: Need::Default("0.1"),
            example: "0.2",
            says: "Share of the radius next to the front that measures \"inside\" leave out",
        },
    ],
    also: None,
};
