//! Probes that hit nothing.

use super::{Case, SOUND, judge_all};

#[test]
fn defects_of_probes_are_named() {
    judge_all(CASES);
}

pub(super) const CASES: &[Case] = &[
    Case {
        name: "outside, on no fracture, and away from it",
        scene: &[(
            "[boundary.top]",
            "[probe.a]\nfrom = [0.1, 0.1, 0.1]\nto = [2, 2, 2]\n[probe.b]\nat = [0, 0, 0]\n\
             fracture = \"join\"\n[probe.c]\nat = [0, 0, 9]\nfracture = \"joint\"\n[boundary.top]",
        )],
        defects: 3,
        says: &[
            "[probe.a]: (0.48",
            "is outside the rock, and 8 more points",
            "`join` is no fracture of the mesh",
            "did you mean `joint`?",
            "(0.000000, 0.000000, 9.000000) is farther from `joint` than its facets are long",
        ],
        ..SOUND
    },
    Case {
        name: "nothing, and two things",
        scene: &[(
            "[boundary.top]",
            "[probe.a]\n[probe.b]\nat = [0, 0, 0]\nfrom = [0, 0, 0]\n[probe.c]\nfrom = [0, 0, 0]\n[boundary.top]",
        )],
        defects: 3,
        says: &[
            "`from` is missing in [probe.a]",
            "both `at` and `from` are given",
            "`to` is missing in [probe.c]",
        ],
        ..SOUND
    },
    Case {
        name: "a line and a plane without an extent",
        scene: &[(
            "[boundary.top]",
            "[probe.a]\nfrom = [0.2, 0.2, 0]\nto = [0.2, 0.2, 0]\n[probe.b]\nfrom = [0.2, 0.2, 0.1]\n\
             to = [0.4, 0.2, 0.1]\nacross = [0, 0, 0]\n[boundary.top]",
        )],
        defects: 2,
        says: &["`from` and `to` are one point", "`across` has no length"],
        ..SOUND
    },
    Case {
        name: "surfaces that are none, and points on them",
        scene: &[(
            "[boundary.top]",
            "[probe.a]\nboundary = \"top\"\nat = [0, 0, 0]\n[probe.b]\nfracture = \"joint\"\nmean = false\n\
             [boundary.top]",
        )],
        defects: 2,
        says: &[
            "both `boundary` and `at` are given",
            "a probe of a whole surface is a mean",
        ],
        ..SOUND
    },
    Case {
        name: "a surface that the mesh has not, and a fracture",
        scene: &[(
            "[boundary.top]",
            "[probe.a]\nboundary = \"tpo\"\n[probe.b]\nboundary = \"joint\"\n[boundary.top]",
        )],
        defects: 2,
        says: &[
            "`tpo`",
            "did you mean `top`?",
            "`joint` is both a fracture and a boundary",
        ],
        ..SOUND
    },
];
