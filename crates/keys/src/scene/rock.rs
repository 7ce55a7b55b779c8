//! Rocks.

use super::field::{FIELD, varied, watched_varied};
use crate::dimension::Dimension;
use crate::plausible::Plausible;
use crate::range::Range;
use crate::table::{Key, KeySection, Kind, Need, Quantity, quantity};

static YOUNG: Plausible = Plausible {
    low: 1e6,
    high: 1e12,
    usual: (1e8, 3e11),
    units: &["GPa", "MPa", "kPa"],
};

static POISSON: Plausible = Plausible {
    low: 0.0,
    high: 0.49,
    usual: (0.0, 0.5),
    units: &[],
};

static DENSITY: Plausible = Plausible {
    low: 500.0,
    high: 8000.0,
    usual: (1000.0, 5000.0),
    units: &["g/cm3"],
};

const MODULUS: Quantity = Quantity {
    dimension: Dimension::Stress,
    range: Range::Within(1.0, 1e15),
    plausible: Some(&YOUNG),
};

/// A rock.
pub static ROCK: KeySection = KeySection {
    pattern: "[rock.NAME]",
    says: "The physical volume NAME; `[rock.default]` serves all volumes not named",
    keys: &[
        Key {
            name: "young_modulus",
            kind: watched_varied(Dimension::Stress, Range::Within(1.0, 1e15), &YOUNG),
            need: Need::Unless(
                "there are `young_moduli`, or `[fluid]`: all rock without it is rigid",
            ),
            example: "50e9",
            says: "Young's modulus E; with `normal_young_modulus` that in the plane of isotropy",
        },
        Key {
            name: "poisson_ratio",
            kind: watched_varied(Dimension::One, Range::Between(-1.0, 0.5), &POISSON),
            need: Need::Unless("there are `poisson_ratios`, or the rock is rigid"),
            example: "0.25",
            says: "Poisson's ratio nu; with `normal_poisson_ratio` that in the plane of isotropy",
        },
        Key {
            name: "normal_young_modulus",
            kind: Kind::NumberOr(MODULUS, &FIELD),
            need: Need::Without("the same in all directions"),
            example: "20e9",
            says: "Young's modulus E' across the plane of isotropy (bedding, schistosity)",
        },
        Key {
            name: "normal_poisson_ratio",
            kind: varied(Dimension::One, Range::Finite),
            need: Need::Without("required with `normal_young_modulus`"),
            example: "0.15",
            says: "Poisson's ratio nu': a stress s across the plane strains it by -nu' s/E'; nu'^2 < (E'/E) (1 - nu)/2",
        },
        Key {
            name: "normal_shear_modulus",
            kind: Kind::NumberOr(MODULUS, &FIELD),
            need: Need::Without("required with `normal_young_modulus`"),
            example: "9e9",
            says: "Shear modulus G' across the plane of isotropy",
        },
        Key {
            name: "young_moduli",
            kind: Kind::VectorOr(MODULUS, &FIELD),
            need: Need::Without("`young_modulus`"),
            example: "[60e9, 45e9, 20e9]",
            says: "Young's moduli E1, E2, E3 of orthotropic rock: 1 down the dip, 2 along the strike, 3 across the plane; without dip x, y, z",
        },
        Key {
            name: "poisson_ratios",
            kind: Kind::VectorOr(quantity(Dimension::One, Range::Finite), &FIELD),
            need: Need::Without("required with `young_moduli`"),
            example: "[0.25, 0.2, 0.3]",
            says: "Poisson's ratios nu12, nu23, nu13: a stress s along i strains j by -nu_ij s/E_i",
        },
        Key {
            name: "shear_moduli",
            kind: Kind::VectorOr(MODULUS, &FIELD),
            need: Need::Without("required with `young_moduli`"),
            example: "[20e9, 9e9, 9e9]",
            says: "Shear moduli G12, G23, G13",
        },
        Key {
            name: "dip",
            kind: varied(Dimension::Angle, Range::Within(0.0, 90.0)),
            need: Need::Default("0"),
            example: "60",
            says: "Angle between the plane of isotropy, or of the axes 1 and 2, and the horizontal",
        },
        Key {
            name: "dip_direction",
            kind: varied(Dimension::Angle, Range::Finite),
            need: Need::Default("90"),
            example: "135",
            says: "Direction towards which that plane falls, clockwise from north (y)",
        },
        Key {
            name: "density",
            kind: watched_varied(Dimension::Density, Range::NotNegative, &DENSITY),
            need: Need::Default("0"),
            example: "2700",
            says: "Mass per volume; required where gravity acts",
        },
    ],
    also: None,
};
