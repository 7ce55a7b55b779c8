//! What acts on faces, nodes and the whole rock.

use super::field::{FIELD, varied};
use super::fluid::{BOUNDARY_INFLOW, BOUNDARY_PRESSURE};
use super::shared::{GROWS_ONCE, INITIAL, INITIAL_GRADIENT};
use crate::dimension::Dimension;
use crate::plausible::Plausible;
use crate::range::Range;
use crate::table::{Key, KeySection, Kind, Need, Quantity, number, quantity};

static GRAVITY: Plausible = Plausible {
    low: 9.7,
    high: 9.9,
    usual: (9.7, 9.9),
    units: &["cm/s2", "mm/s2"],
};

/// A part of the outer surface.
pub static BOUNDARY: KeySection = KeySection {
    pattern: "[boundary.NAME]",
    says: "Surface NAME, or outer faces at a place; load, support, fluid may act together",
    keys: &[
        Key {
            name: "where",
            kind: Kind::Text,
            need: Need::Without("the physical surface of that name"),
            example: "\"z = max\"",
            says: "Where its faces lie, for meshes whose outer faces have no names: comparisons of expressions in x, y, z, all of which hold, such as `x > 1, x < 3, z = max`",
        },
        Key {
            name: "traction",
            kind: Kind::VectorOr(quantity(Dimension::Stress, Range::Finite), &FIELD),
            need: Need::Without("none"),
            example: "[0, 0, -7e6]",
            says: "Force per area in global axes",
        },
        Key {
            name: "pressure",
            kind: varied(Dimension::Stress, Range::Finite),
            need: Need::Without("none"),
            example: "7e6",
            says: "Force per area along the inward normal, instead of `traction`",
        },
        Key {
            name: "displacement",
            kind: Kind::Table(&DISPLACEMENT),
            need: Need::Without("free"),
            example: "{ z = 0.0 }",
            says: "Prescribed components; those not named are free",
        },
        Key {
            name: "symmetry",
            kind: Kind::Flag,
            need: Need::Default("false"),
            example: "true",
            says: "No displacement along the normal, a roller on any plane; instead of `displacement`",
        },
        Key {
            name: "spring",
            kind: varied(Dimension::StressPerLength, Range::NotNegative),
            need: Need::Without("none"),
            example: "1e9",
            says: "Stiffness of springs against displacement of the surface, an elastic bed",
        },
        Key {
            name: "shear_spring",
            kind: varied(Dimension::StressPerLength, Range::NotNegative),
            need: Need::Without("that of `spring`"),
            example: "5e8",
            says: "Stiffness of the springs along the surface; `spring` is that along its normal then",
        },
        Key {
            name: "far_field",
            kind: Kind::Vector(quantity(Dimension::Length, Range::Finite)),
            need: Need::Without("none"),
            example: "[0.0, 0.0, 0.0]",
            says: "Springs as stiff as unbounded rock outside, going by the distance from this centre of what happens inside; instead of `spring`",
        },
        BOUNDARY_PRESSURE,
        BOUNDARY_INFLOW,
        Key {
            name: "history",
            kind: Kind::History,
            need: GROWS_ONCE,
            example: "[[0, 0], [1, 1]]",
            says: "Factor on its load, its displacement and its fluid at times",
        },
    ],
    also: None,
};

/// Prescribed components of a displacement.
pub static DISPLACEMENT: KeySection = KeySection {
    pattern: "displacement",
    says: "Prescribed components of a displacement, at least one",
    keys: &[
        component("x", "Along x"),
        component("y", "Along y"),
        component("z", "Along z"),
    ],
    also: None,
};

const fn component(name: &'static str, says: &'static str) -> Key {
    Key {
        name,
        kind: varied(Dimension::Length, Range::Finite),
        need: Need::Without("free"),
        example: "0.0",
        says,
    }
}

/// A node held by itself.
pub static FIXED_POINT: KeySection = KeySection {
    pattern: "[[fixed_point]]",
    says: "One node held by itself, to remove rigid motions",
    keys: &[
        Key {
            name: "at",
            kind: Kind::Vector(quantity(Dimension::Length, Range::Finite)),
            need: Need::Required,
            example: "[0.0, 0.0, 0.0]",
            says: "Where it is; the nearest node is taken, and the run names it if it lies elsewhere",
        },
        Key {
            name: "displacement",
            kind: Kind::Table(&DISPLACEMENT),
            need: Need::Required,
            example: "{ x = 0.0 }",
            says: "Prescribed components; they hold the blocks on all sides of the node",
        },
        Key {
            name: "history",
            kind: Kind::History,
            need: GROWS_ONCE,
            example: "[[0, 0], [1, 1]]",
            says: "Factor on its displacement at times",
        },
    ],
    also: None,
};

/// What acts in all of the rock.
pub static BODY: KeySection = KeySection {
    pattern: "[body]",
    says: "What acts in all of the rock",
    keys: &[
        Key {
            name: "gravity",
            kind: Kind::Vector(Quantity {
                plausible: Some(&GRAVITY),
                ..quantity(Dimension::Acceleration, Range::Finite)
            }),
            need: Need::Required,
            example: "[0, 0, -9.81]",
            says: "Acceleration of gravity",
        },
        Key {
            name: "history",
            kind: Kind::History,
            need: GROWS_ONCE,
            example: "[[0, 0], [1, 1]]",
            says: "Factor on gravity at times",
        },
    ],
    also: None,
};

/// Stress before any load.
pub static INITIAL_STRESS: KeySection = KeySection {
    pattern: "[initial_stress]",
    says: "Stress that rock and fractures are in equilibrium with before any load",
    keys: &[
        stress("xx"),
        stress("yy"),
        stress("zz"),
        stress("xy"),
        stress("yz"),
        stress("xz"),
    ],
    also: None,
};

const fn stress(name: &'static str) -> Key {
    Key {
        name,
        kind: Kind::NumberOr(quantity(Dimension::Stress, INITIAL), &PROFILE),
        need: Need::Default("0"),
        example: "-10e6",
        says: "Component of the stress, tension positive: constant, linear in the elevation, or any value that varies but not with time",
    }
}

/// A component that is linear in the elevation.
pub static PROFILE: KeySection = KeySection {
    pattern: "[initial_stress.XX]",
    says: "A component `value + per_metre (z - at)`, or one that varies otherwise",
    keys: &[
        Key {
            name: "value",
            kind: number(Dimension::Stress, INITIAL),
            need: Need::Required,
            example: "-10e6",
            says: "Stress at the elevation `at`",
        },
        Key {
            name: "per_metre",
            kind: number(Dimension::StressPerLength, INITIAL_GRADIENT),
            need: Need::Default("0"),
            example: "27e3",
            says: "Increase with the elevation",
        },
        Key {
            name: "at",
            kind: number(Dimension::Length, Range::Finite),
            need: Need::Default("0"),
            example: "0.0",
            says: "Elevation of `value`, positive upwards",
        },
    ],
    also: Some(&FIELD),
};
