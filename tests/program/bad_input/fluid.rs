//! Fluids that cannot flow as the scene says.

use super::{Case, SOUND, judge_all};

#[test]
fn defects_of_fluids_are_named() {
    judge_all(CASES);
}

/// The joint conducts, and a borehole goes through its first node.
const FLOWING: (&str, &str) = (
    "[boundary.top]",
    "hydraulic_aperture = 1e-4\n[fluid]\nviscosity = 1e-3\n[[source]]\nat = [0, 0, 0]\nradius = 0.01\n\
     pressure = 1e5\n[boundary.top]",
);

pub(super) const CASES: &[Case] = &[
    Case {
        name: "keys of a fluid without one",
        scene: &[(
            "[boundary.top]",
            "roughness = 2\n[[source]]\nat = [0, 0, 0]\nradius = 0.1\nrate = 1\n[boundary.top]\nfluid_pressure = 1e5",
        )],
        defects: 3,
        says: &[
            "scene.toml:15: `roughness` is given, but there is no [fluid]",
            "`rate` is given, but there is no [fluid]",
            "`fluid_pressure` is given, but there is no [fluid]",
            "add [fluid] with viscosity",
        ],
        ..SOUND
    },
    Case {
        name: "no pressure and no source",
        scene: &[(
            "[boundary.top]",
            "[fluid]\nviscosity = 1e-3\n[boundary.top]",
        )],
        says: &[
            "fracture `joint`: nothing drives a flow, and no pressure is given",
            "a [[source]] with pressure, or sealed = true",
        ],
        ..SOUND
    },
    Case {
        name: "rates that do not add up",
        scene: &[(
            "[boundary.top]",
            "hydraulic_aperture = 1e-4\n[fluid]\nviscosity = 1e-3\n\
             [[source]]\nat = [0, 0, 0]\nradius = 0.01\nrate = 3e-4\n\
             [[source]]\nat = [1, 0, 0]\nradius = 0.01\nrate = -1e-4\n[boundary.top]",
        )],
        says: &[
            "fracture `joint`",
            "the rates add up to 2.000000e-4 m3/s",
            "no steady state",
        ],
        ..SOUND
    },
    Case {
        name: "a borehole that hits nothing",
        scene: &[FLOWING, ("at = [0, 0, 0]", "at = [0, 0, 5]")],
        says: &[
            "hits no fracture that conducts",
            "the nearest such is node 11",
        ],
        ..SOUND
    },
    Case {
        name: "a borehole wider than its facets",
        scene: &[FLOWING, ("radius = 0.01", "radius = 0.5")],
        says: &[
            "[[source]] number 1: its radius of 0.5 m",
            "mesh coarser there",
        ],
        ..SOUND
    },
    Case {
        name: "gravity without a density of the fluid, and two pressures",
        scene: &[
            FLOWING,
            ("[mesh]", "[body]\ngravity = [0, 0, -9.81]\n[mesh]"),
            (
                "poisson_ratio = 0.25",
                "poisson_ratio = 0.25\ndensity = 2700",
            ),
            ("pressure = 1e5", "pressure = 1e5\nrate = 1e-3"),
        ],
        defects: 2,
        says: &[
            "`density` is missing in [fluid]",
            "both pressure and rate are given",
        ],
        ..SOUND
    },
    Case {
        name: "a viscosity in other units, and keys that exclude each other",
        scene: &[
            FLOWING,
            ("viscosity = 1e-3", "viscosity = \"1 MPa\""),
            (
                "hydraulic_aperture = 1e-4",
                "hydraulic_aperture = 1e-4\nroughness = 2",
            ),
        ],
        defects: 2,
        says: &[
            "`MPa` is the unit of a stress",
            "a viscosity in Pa s, mPa s",
            "`roughness` has no effect beside hydraulic_aperture",
        ],
        ..SOUND
    },
    Case {
        name: "loads, supports and laws in rigid rock",
        scene: &[FLOWING, ("young_modulus = 1e9\npoisson_ratio = 0.25\n", "")],
        defects: 4,
        says: &[
            "`normal_stiffness` has no effect in [fracture.joint]",
            "`shear_stiffness` has no effect in [fracture.joint]",
            "`traction` has no effect in [boundary.top]",
            "`displacement` has no effect in [boundary.bottom]",
        ],
        ..SOUND
    },
    Case {
        name: "everything sealed",
        scene: &[FLOWING, ("hydraulic_aperture = 1e-4", "sealed = true")],
        says: &["[fluid]: there is a fluid, but no fracture that conducts it"],
        ..SOUND
    },
];
