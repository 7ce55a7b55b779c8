//! Values that no rock has, and what stands twice or in quotes.

use super::{Case, SOUND, judge_all};

#[test]
fn defects_of_values_are_named() {
    judge_all(CASES);
}

pub(super) const CASES: &[Case] = &[
    Case {
        name: "section twice",
        scene: &[(
            "[boundary.bottom]",
            "[fracture.joint]\naperture = 1e-3\n\n[boundary.bottom]",
        )],
        says: &[
            "scene.toml:18: the section [fracture.joint] stands twice: it is in line 10 already",
            "under one head",
        ],
        ..SOUND
    },
    Case {
        name: "an integer of many digits",
        scene: &[("aperture = 1e-4", "aperture = 99999999999999999999999999")],
        says: &[
            "scene.toml:11: `aperture` in [fracture.joint] is too large a number",
            "an exponent",
        ],
        ..SOUND
    },
    Case {
        name: "rock beyond all rocks",
        scene: &[("young_modulus = 1e9", "young_modulus = 1e300")],
        says: &[
            "scene.toml:7: `young_modulus` = 1e300 in",
            "must be from 1 to 1e15",
        ],
        ..SOUND
    },
    Case {
        name: "numbers without all their digits",
        scene: &[
            ("young_modulus = 1e9", "young_modulus = 1e-310"),
            ("normal_stiffness = 1e10", "normal_stiffness = 1e-310"),
        ],
        defects: 2,
        says: &["scene.toml:7: `young_modulus` = ", "is too small a number"],
        ..SOUND
    },
    Case {
        name: "initial stress beyond all strength",
        scene: &[(
            "[boundary.top]",
            "[initial_stress]\nxx = -1e15\nzz = { value = -1e6, per_metre = 1e12 }\n[boundary.top]",
        )],
        defects: 2,
        says: &[
            "scene.toml:16: `xx` = -1000000000000000 in [initial_stress]",
            "xx must be from -1e12 to 1e12",
            "per_metre must be from -1e9 to 1e9",
        ],
        ..SOUND
    },
    Case {
        name: "names that are not bare",
        scene: &[("[boundary.top]", "[boundary.\".side x0\"]")],
        says: &[
            "the mesh has no physical surface `.side x0`",
            "[boundary.\".side x0\"]",
        ],
        ..SOUND
    },
];
