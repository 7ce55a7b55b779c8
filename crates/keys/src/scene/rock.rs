//! Rocks.

use super::field::watched_varied;
use crate::dimension::Dimension;
use crate::plausible::Plausible;
use crate::range::Range;
use crate::table::{Key, KeySection, Need};

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

/// A rock.
pub static ROCK: KeySection = KeySection {
    pattern: "[rock.NAME]",
    says: "The physical volume NAME; `[rock.default]` serves all volumes not named",
    keys: &[
        Key {
            name: "young_modulus",
            kind: watched_varied(Dimension::Stress, Range::Within(1.0, 1e15), &YOUNG),
            need: Need::Unless("there is `[fluid]`: all rock without it is rigid"),
            example: "50e9",
            says: "Young's modulus E",
        },
        Key {
            name: "poisson_ratio",
            kind: watched_varied(Dimension::One, Range::Between(-1.0, 0.5), &POISSON),
            need: Need::Unless("the rock is rigid"),
            example: "0.25",
            says: "Poisson's ratio nu",
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
