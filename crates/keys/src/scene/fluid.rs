//! What flows in fractures, and where it is driven.

use super::field::{FIELD, varied, watched_varied};
use super::shared::{GROWS_ONCE, INITIAL, INITIAL_GRADIENT};
use crate::dimension::Dimension;
use crate::plausible::Plausible;
use crate::range::Range;
use crate::table::{Key, KeySection, Kind, Need, number, quantity, watched};

static VISCOSITY: Plausible = Plausible {
    low: 1e-6,
    high: 10.0,
    usual: (1e-5, 1e-1),
    units: &["mPa s"],
};

static FLUID_DENSITY: Plausible = Plausible {
    low: 0.1,
    high: 3000.0,
    usual: (500.0, 2000.0),
    units: &["g/cm3"],
};

static WELL_RADIUS: Plausible = Plausible {
    low: 1e-3,
    high: 10.0,
    usual: (0.02, 1.0),
    units: &["mm", "cm"],
};

/// A fluid that flows in the fractures.
pub static FLUID: KeySection = KeySection {
    pattern: "[fluid]",
    says: "A fluid that flows in the fractures; without this section nothing flows",
    keys: &[
        Key {
            name: "viscosity",
            kind: watched(Dimension::Viscosity, Range::Positive, &VISCOSITY),
            need: Need::Required,
            example: "1e-3",
            says: "Viscosity mu; a fracture conducts b_h^3 / (12 mu)",
        },
        Key {
            name: "density",
            kind: watched(Dimension::Density, Range::Positive, &FLUID_DENSITY),
            need: Need::Unless("there is no gravity"),
            example: "1000",
            says: "Mass per volume",
        },
        Key {
            name: "compressibility",
            kind: watched(Dimension::PerStress, Range::NotNegative, &COMPRESSIBILITY),
            need: Need::Default("0"),
            example: "4.5e-10",
            says: "Relative change of density with pressure c; counts where the flow takes time, which in rigid rock it does only if the fluid is compressible",
        },
        Key {
            name: "initial_pressure",
            kind: Kind::NumberOr(quantity(Dimension::Stress, INITIAL), &INITIAL_PROFILE),
            need: Need::Default("0"),
            example: "10e6",
            says: "Pressure before any load, in balance with `[initial_stress]`, which is total: constant, linear in the elevation, or any value that varies but not with time",
        },
        Key {
            name: "isolated",
            kind: Kind::Choice(
                "treatment of isolated networks",
                &["refuse", "inactive", "undrained"],
            ),
            need: Need::Default("\"refuse\""),
            example: "\"inactive\"",
            says: "Networks of fractures that no pressure and no rate acts on are refused, or left out of the flow; or, undrained, in steady flow between walls that move, they keep the fluid that they hold, and so do those whose rates add up to zero",
        },
        Key {
            name: "equivalent_permeability",
            kind: Kind::Flag,
            need: Need::Default("false"),
            example: "true",
            says: "Whether the permeability tensor of the whole body is computed, by linear pressures on all of its outer surface; in rock that deforms, before the loads and after each load step",
        },
    ],
    also: None,
};

static COMPRESSIBILITY: Plausible = Plausible {
    low: 1e-12,
    high: 1e-4,
    usual: (1e-10, 1e-8),
    units: &["1/MPa", "1/GPa"],
};

/// A borehole.
pub static SOURCE: KeySection = KeySection {
    pattern: "[[source]]",
    says: "A borehole, a line within fractures or a whole fracture, by its rate or its pressure",
    keys: &[
        Key {
            name: "name",
            kind: Kind::Text,
            need: Need::Without("source number 1, 2, ..."),
            example: "\"injector\"",
            says: "What messages and results call it",
        },
        Key {
            name: "at",
            kind: Kind::Vector(quantity(Dimension::Length, Range::Finite)),
            need: Need::Unless("there is `from`, `fracture`, `curve` or `points`"),
            example: "[0.0, 0.0, 0.0]",
            says: "Where it is; the nearest node of a fracture is taken, and the run names it if it lies elsewhere",
        },
        Key {
            name: "from",
            kind: Kind::Vector(quantity(Dimension::Length, Range::Finite)),
            need: Need::Without("`at`"),
            example: "[0.0, 0.0, 0.0]",
            says: "Where a borehole begins that is open to every fracture it crosses; its `pressure` is that here, and hydrostatic along it",
        },
        Key {
            name: "to",
            kind: Kind::Vector(quantity(Dimension::Length, Range::Finite)),
            need: Need::Unless("there is no `from`"),
            example: "[0.0, 0.0, -10.0]",
            says: "Where it ends",
        },
        Key {
            name: "fracture",
            kind: Kind::Text,
            need: Need::Without("`at`"),
            example: "\"fault\"",
            says: "The fracture all of which it feeds, a rate by area times transmissivity; no borehole, and without `radius`",
        },
        Key {
            name: "curve",
            kind: Kind::Text,
            need: Need::Without("`at`"),
            example: "\"slot\"",
            says: "The physical curve of the mesh that it feeds where it lies within fractures, a rate by length times transmissivity; without `radius`",
        },
        Key {
            name: "points",
            kind: Kind::Points(quantity(Dimension::Length, Range::Finite)),
            need: Need::Without("`at`"),
            example: "[[0, 0, 0], [1, 0, 0], [1, 1, 0]]",
            says: "Such a line by its points, straight between them; its rate needs no edges along it, its pressure does",
        },
        Key {
            name: "rate",
            kind: varied(Dimension::VolumeRate, Range::Finite),
            need: Need::Or("pressure"),
            example: "1e-3",
            says: "What flows in; negative where it flows out; one that varies does so with time alone",
        },
        Key {
            name: "pressure",
            kind: Kind::NumberOr(quantity(Dimension::Stress, INITIAL), &SOURCE_PROFILE),
            need: Need::Or("rate"),
            example: "12e6",
            says: "Pressure of the fluid at its wall: constant, linear in the elevation, or any value that varies with time or from place to place; in a borehole `from` and `to` a number is that where it begins, and the fluid in it rests",
        },
        Key {
            name: "radius",
            kind: watched(Dimension::Length, Range::Positive, &WELL_RADIUS),
            need: Need::Unless("there is `fracture`, `curve` or `points`"),
            example: "0.1",
            says: "Its radius, small beside the facets around it; the pressure at its wall depends on it",
        },
        Key {
            name: "history",
            kind: Kind::History,
            need: GROWS_ONCE,
            example: "[[0, 0], [1, 1]]",
            says: "Factor on its rate or pressure at times",
        },
    ],
    also: None,
};

/// A pressure on a boundary that is linear in the elevation, or varies otherwise.
pub static FLUID_PROFILE: KeySection = profile("[boundary.NAME.fluid_pressure]");

/// A pressure of a source that is linear in the elevation, or varies otherwise.
pub static SOURCE_PROFILE: KeySection = profile("[source.pressure]");

/// A pressure before any load that is linear in the elevation, or varies otherwise.
pub static INITIAL_PROFILE: KeySection = profile("[fluid.initial_pressure]");

const fn profile(pattern: &'static str) -> KeySection {
    KeySection {
        pattern,
        says: "Pressure `value + per_metre (z - at)`, or one that varies",
        keys: &PROFILE_KEYS,
        also: Some(&FIELD),
    }
}

static PROFILE_KEYS: [Key; 4] = [
    Key {
        name: "value",
        kind: number(Dimension::Stress, INITIAL),
        need: Need::Or("water_table"),
        example: "1e6",
        says: "Pressure at the elevation `at`",
    },
    Key {
        name: "per_metre",
        kind: number(Dimension::StressPerLength, INITIAL_GRADIENT),
        need: Need::Default("0"),
        example: "-9810",
        says: "Increase with the elevation",
    },
    Key {
        name: "at",
        kind: number(Dimension::Length, Range::Finite),
        need: Need::Default("0"),
        example: "0.0",
        says: "Elevation of `value`, positive upwards",
    },
    Key {
        name: "water_table",
        kind: number(Dimension::Length, Range::Finite),
        need: Need::Or("value"),
        example: "350.0",
        says: "Instead: elevation below which a fluid at rest has this pressure, by `density` and gravity; 0 there, negative above",
    },
];

/// Where fractures meet a part of the outer surface.
pub(super) const BOUNDARY_PRESSURE: Key = Key {
    name: "fluid_pressure",
    kind: Kind::NumberOr(quantity(Dimension::Stress, INITIAL), &FLUID_PROFILE),
    need: Need::Without("closed to the fluid"),
    example: "1e6",
    says: "Pressure of the fluid where fractures meet the surface: constant, linear in the elevation, or any value that varies with time or from place to place",
};

/// What enters the fractures through a part of the outer surface.
pub(super) const BOUNDARY_INFLOW: Key = Key {
    name: "fluid_inflow",
    kind: varied(Dimension::VolumeRate, Range::Finite),
    need: Need::Without("closed to the fluid"),
    example: "1e-3",
    says: "What flows into the fractures that meet the surface, in all, shared by length times transmissivity; one that varies does so with time alone; instead of `fluid_pressure`",
};

/// How a fracture conducts.
pub(super) const HYDRAULIC_APERTURE: Key = Key {
    name: "hydraulic_aperture",
    kind: varied(Dimension::Length, Range::Positive),
    need: Need::Without("follows the walls; in rigid rock they stay at `aperture`"),
    example: "1e-4",
    says: "Aperture b_h that the fluid sees, whatever the walls do; needs `[fluid]`",
};

/// What closed walls leave open.
pub(super) const RESIDUAL_HYDRAULIC_APERTURE: Key = Key {
    name: "residual_hydraulic_aperture",
    kind: varied(Dimension::Length, Range::NotNegative),
    need: Need::Default("0"),
    example: "1e-6",
    says: "Hydraulic aperture r that closed walls leave, b_h^3 = e^3 + r^3; where there is no `hydraulic_aperture`",
};

/// How rough walls are, by a factor.
pub(super) const ROUGHNESS: Key = Key {
    name: "roughness",
    kind: varied(Dimension::One, Range::Within(1.0, 1e6)),
    need: Need::Default("1"),
    example: "1.5",
    says: "Factor f by which rough walls lower the transmissivity, e^3 = b^3 / f",
};

/// How rough walls are, by Barton's coefficient.
pub(super) const JOINT_ROUGHNESS: Key = Key {
    name: "joint_roughness",
    kind: varied(Dimension::One, Range::Within(0.0, 20.0)),
    need: Need::Without("`roughness`"),
    example: "8",
    says: "Barton's coefficient JRC instead: e = b^2 / JRC^2.5 in micrometres, at most b",
};

/// Whether a fracture conducts at all.
pub(super) const SEALED: Key = Key {
    name: "sealed",
    kind: Kind::Flag,
    need: Need::Default("false"),
    example: "true",
    says: "Whether nothing flows in it; fractures that cross it stay connected",
};

static LEAKOFF_COEFFICIENT: Plausible = Plausible {
    low: 1e-10,
    high: 1e-2,
    usual: (1e-8, 1e-3),
    units: &[],
};

/// What the rock beside a fracture takes up.
pub(super) const LEAKOFF: Key = Key {
    name: "leakoff",
    kind: watched_varied(Dimension::Leakoff, Range::NotNegative, &LEAKOFF_COEFFICIENT),
    need: Need::Default("0"),
    example: "1e-5",
    says: "Carter's coefficient C (m/s^0.5): through each wall fluid leaks off into the rock with the velocity C / sqrt(t - t_0); where the flow takes time",
};

/// Since when it does.
pub(super) const EXPOSED_AT: Key = Key {
    name: "exposed_at",
    kind: number(Dimension::Time, Range::Finite),
    need: Need::Default("0"),
    example: "-3600",
    says: "Time t_0 at which the walls first meet the fluid that leaks off, in seconds; beside `leakoff`",
};
