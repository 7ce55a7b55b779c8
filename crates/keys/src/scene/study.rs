//! What `kluft study` sweeps.

use crate::dimension::Dimension;
use crate::range::Range;
use crate::scene::{CLOSURES, FACETS, FRACTURE, SOLVERS};
use crate::table::{FREE, Key, KeySection, Kind, Need, number, quantity};

const AS_THE_SCENE: Need = Need::Without("as in the scene");

/// What `kluft study` sweeps.
pub static STUDY: KeySection = KeySection {
    pattern: "[study]",
    says: "What `kluft study` sweeps: all combinations; what is left out stays as in the scene",
    keys: &[
        Key {
            name: "meshes",
            kind: Kind::Tables(&FREE),
            need: AS_THE_SCENE,
            example: "[{ h = 0.2 }, { h = 0.1 }]",
            says: "Tables of mesh parameters",
        },
        Key {
            name: "tolerances",
            kind: Kind::Numbers(quantity(Dimension::One, Range::Between(0.0, 1.0))),
            need: AS_THE_SCENE,
            example: "[0.05, 0.01]",
            says: "Tolerances of meshes that follow the estimated error, instead of `meshes`",
        },
        Key {
            name: "refinements",
            kind: Kind::Numbers(quantity(Dimension::One, Range::Within(0.0, 5.0))),
            need: AS_THE_SCENE,
            example: "[0, 1, 2]",
            says: "How many times the cells of the one mesh of the scene are divided, instead of `meshes`",
        },
        Key {
            name: "orders",
            kind: Kind::Numbers(quantity(Dimension::One, Range::Within(1.0, 2.0))),
            need: AS_THE_SCENE,
            example: "[1, 2]",
            says: "Orders of the elements",
        },
        Key {
            name: "quarter_points",
            kind: Kind::Flags,
            need: AS_THE_SCENE,
            example: "[true, false]",
            says: "Whether cells of order 2 at crack fronts are quarter-point elements",
        },
        Key {
            name: "closures",
            kind: Kind::TablesOrWords(&CLOSURE, &CLOSURES),
            need: AS_THE_SCENE,
            example: "[\"logarithmic\", { label = \"cut\", cutoff_aperture = 1e-6 }]",
            says: "Names of closure laws, or tables of keys of all fractures",
        },
        Key {
            name: "values",
            kind: Kind::Sweeps(&SERIES),
            need: Need::Without("none"),
            example: "{ normal_stiffness = [1e9, 1e10] }",
            says: "Numbers of all fractures that have the key; `\"NAME.key\"` is of one fracture, `\"boundary.NAME.pressure\"` a load, `\"fluid.viscosity\"` of the fluid, `\"source.NAME.rate\"` of a source",
        },
        Key {
            name: "facets",
            kind: Kind::Choices(&FACETS),
            need: AS_THE_SCENE,
            example: "[\"nodal\", \"gauss\"]",
            says: "Names as under `[solver]`",
        },
        Key {
            name: "solvers",
            kind: Kind::Choices(&SOLVERS),
            need: AS_THE_SCENE,
            example: "[\"direct\", \"iterative\"]",
            says: "Names as `linear` under `[solver]`",
        },
        Key {
            name: "measure",
            kind: Kind::Text,
            need: Need::Without("the first with an error"),
            example: "\"opening_l2\"",
            says: "What is charted, a name among the `measures` of `summary.json`",
        },
        Key {
            name: "fracture",
            kind: Kind::Text,
            need: Need::Without("the first with an error"),
            example: "\"joint\"",
            says: "The fracture on which it is measured",
        },
        Key {
            name: "reference",
            kind: Kind::Text,
            need: Need::Without("each its own"),
            example: "\"logarithmic\"",
            says: "Label of the closure whose limit serves all",
        },
    ],
    also: None,
};

/// Keys of all fractures under a label.
pub static CLOSURE: KeySection = KeySection {
    pattern: "an entry of closures",
    says: "Keys of `[fracture.NAME]` for all fractures; `false` removes one",
    keys: &[Key {
        name: "label",
        kind: Kind::Text,
        need: Need::Without("the keys themselves"),
        example: "\"cut at 1 um\"",
        says: "What tables and charts call it",
    }],
    also: Some(&FRACTURE),
};

/// Numbers whose logarithms lie evenly.
pub static SERIES: KeySection = KeySection {
    pattern: "a series of values",
    says: "Numbers whose logarithms lie evenly, in the place of a list",
    keys: &[
        Key {
            name: "from",
            kind: number(Dimension::OfKey, Range::Positive),
            need: Need::Required,
            example: "1e8",
            says: "The first",
        },
        Key {
            name: "to",
            kind: number(Dimension::OfKey, Range::Positive),
            need: Need::Required,
            example: "1e12",
            says: "The last",
        },
        Key {
            name: "count",
            kind: number(Dimension::One, Range::Within(2.0, 1000.0)),
            need: Need::Required,
            example: "9",
            says: "How many there are",
        },
    ],
    also: None,
};
