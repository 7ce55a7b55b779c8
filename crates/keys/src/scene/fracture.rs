//! Fractures.

use super::field::{varied, watched_varied};
use super::fluid::{
    EXPOSED_AT, HYDRAULIC_APERTURE, JOINT_ROUGHNESS, LEAKOFF, RESIDUAL_HYDRAULIC_APERTURE,
    ROUGHNESS, SEALED,
};
use crate::dimension::Dimension;
use crate::plausible::Plausible;
use crate::range::Range;
use crate::table::{Key, KeySection, Kind, Need};

/// Names of the closure laws.
pub const CLOSURES: [&str; 4] = ["linear", "logarithmic", "hyperbolic", "contact"];

static APERTURE: Plausible = Plausible {
    low: 1e-8,
    high: 0.1,
    usual: (1e-6, 1e-2),
    units: &["mm", "um"],
};

static NORMAL_STIFFNESS: Plausible = Plausible {
    low: 1e6,
    high: 1e15,
    usual: (1e8, 1e13),
    units: &["GPa/m", "MPa/m"],
};

static FRICTION: Plausible = Plausible {
    low: 1.0,
    high: 60.0,
    usual: (5.0, 60.0),
    units: &["rad"],
};

/// A fracture.
pub static FRACTURE: KeySection = KeySection {
    pattern: "[fracture.NAME]",
    says: "The physical surface NAME; `[fracture.default]` serves all inner surfaces not named",
    keys: &[
        Key {
            name: "aperture",
            kind: watched_varied(Dimension::Length, Range::NotNegative, &APERTURE),
            need: Need::Unless("the rock is rigid and there is a `hydraulic_aperture`"),
            example: "1e-4",
            says: "Aperture b0 without load, greater than 0; contact allows 0",
        },
        Key {
            name: "normal_stiffness",
            kind: watched_varied(
                Dimension::StressPerLength,
                Range::NotNegative,
                &NORMAL_STIFFNESS,
            ),
            need: Need::Unless(
                "the closure is `\"contact\"`, which has none, or the rock is rigid",
            ),
            example: "1e11",
            says: "Stiffness K_n0 at b0; 0 is a free crack, whose walls may overlap",
        },
        Key {
            name: "shear_stiffness",
            kind: varied(Dimension::StressPerLength, Range::NotNegative),
            need: Need::Unless(
                "there is friction (nothing moves before it slides) or contact, or the rock is rigid",
            ),
            example: "1e10",
            says: "Stiffness K_s, constant",
        },
        Key {
            name: "closure",
            kind: Kind::Choice("closure law", &CLOSURES),
            need: Need::Default("\"linear\""),
            example: "\"logarithmic\"",
            says: "Law of the normal traction; under the linear one walls may overlap",
        },
        Key {
            name: "cutoff_aperture",
            kind: varied(Dimension::Length, Range::Positive),
            need: Need::Without("none: exact"),
            example: "1e-6",
            says: "Aperture b_cut below which the stiffness goes on linearly, at most b0; logarithmic only",
        },
        Key {
            name: "max_closure",
            kind: varied(Dimension::Length, Range::Positive),
            need: Need::Without("`aperture`"),
            example: "8e-5",
            says: "Closure v_m that no load reaches, at most b0; hyperbolic only",
        },
        Key {
            name: "tension_cutoff",
            kind: Kind::Flag,
            need: Need::Default("false"),
            example: "true",
            says: "Whether an open fracture carries nothing",
        },
        Key {
            name: "tensile_strength",
            kind: varied(Dimension::Stress, Range::Positive),
            need: Need::Without("no bond"),
            example: "1e6",
            says: "Strength of a bond that breaks in tension, together with `fracture_energy`",
        },
        Key {
            name: "fracture_energy",
            kind: varied(Dimension::EnergyPerArea, Range::Positive),
            need: Need::Without("no bond"),
            example: "100",
            says: "Energy that breaks the bond, more than strength^2 / (2 K_n0)",
        },
        Key {
            name: "friction_angle",
            kind: watched_varied(Dimension::Angle, Range::Within(0.0, 89.0), &FRICTION),
            need: Need::Without("none: elastic"),
            example: "30",
            says: "Angle phi of friction; the shear traction is at most c - tan(phi) sigma_n",
        },
        Key {
            name: "cohesion",
            kind: varied(Dimension::Stress, Range::NotNegative),
            need: Need::Default("0"),
            example: "1e5",
            says: "Cohesion c; lost where tension is cut off and the fracture opens, and as a bond breaks",
        },
        Key {
            name: "dilation_angle",
            kind: varied(Dimension::Angle, Range::Within(0.0, 89.0)),
            need: Need::Default("0"),
            example: "5",
            says: "Opening per slip beyond the elastic slip; at most the friction angle",
        },
        Key {
            name: "between",
            kind: Kind::Pair,
            need: Need::Without("the physical surface NAME"),
            example: "[\"left\", \"right\"]",
            says: "Physical volumes whose common surface is the fracture, nodes shared or doubled; one name twice for the doubled faces within it",
        },
        Key {
            name: "fluid_pressure",
            kind: varied(Dimension::Stress, Range::Finite),
            need: Need::Default("0"),
            example: "2e6",
            says: "Pressure on both walls, opening; with `[fluid]` given all over the fracture",
        },
        HYDRAULIC_APERTURE,
        RESIDUAL_HYDRAULIC_APERTURE,
        ROUGHNESS,
        JOINT_ROUGHNESS,
        SEALED,
        LEAKOFF,
        EXPOSED_AT,
        Key {
            name: "history",
            kind: Kind::History,
            need: Need::Without("grows once"),
            example: "[[0, 0], [1, 1]]",
            says: "Factor on the fluid pressure at times",
        },
    ],
    also: None,
};
