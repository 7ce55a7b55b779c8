//! Values that vary as they cannot.

use super::{Case, FOLDER, SOUND, judge_all};

#[test]
fn defects_of_values_that_vary_are_named() {
    judge_all(CASES);
}

const STIFFNESS: &str = "normal_stiffness = 1e10";

pub(super) const CASES: &[Case] = &[
    Case {
        name: "nothing, too much, and no numbers",
        scene: &[
            (STIFFNESS, "normal_stiffness = {}"),
            (
                "shear_stiffness = 1e10",
                "shear_stiffness = { expression = \"1e10\", table = [[0, 1]] }",
            ),
            (
                "aperture = 1e-4",
                "aperture = { table = [[0, 1e-4], [0, 2e-4]], over = \"z\" }",
            ),
            (
                "traction = [0, 0, -1e5]",
                "traction = [0, { expression = \"1e5 * q\" }, { table = [[0, \"a\"]], over = \"x\" }]",
            ),
        ],
        defects: 6,
        says: &[
            "scene.toml:11: the table has two values at one coordinate",
            "scene.toml:12: [fracture.joint.normal_stiffness] says no value",
            "scene.toml:13: both `table` and `expression` are given",
            "scene.toml:16: the expression has unknown names: `q`",
            "write numbers, x, y, z, depth, time",
        ],
        ..SOUND
    },
    Case {
        name: "keys without effect, and a table over nothing",
        scene: &[
            (
                STIFFNESS,
                "normal_stiffness = { expression = \"1e10\", method = \"linear\" }",
            ),
            ("aperture = 1e-4", "aperture = { table = [[0, 1e-4]] }"),
        ],
        defects: 2,
        says: &[
            "`method` has no effect in [fracture.joint.normal_stiffness]",
            "the table says not what it is over",
        ],
        ..SOUND
    },
    Case {
        name: "files that are missing, a folder, without a column, and with bad rows",
        scene: &[
            (
                STIFFNESS,
                "normal_stiffness = { file = \"no.csv\", column = \"kn\" }",
            ),
            (
                "shear_stiffness = 1e10",
                "shear_stiffness = { file = \"there\", column = \"ks\" }",
            ),
            (
                "aperture = 1e-4",
                "aperture = { file = \"scan.csv\", column = \"b\", unit = \"GPa\" }",
            ),
            (
                "traction = [0, 0, -1e5]",
                "pressure = { file = \"scan.csv\", column = \"kn\" }",
            ),
        ],
        files: &[("there", FOLDER), ("scan.csv", "x,y,kn\n0,0,1\n1,0,nan\n")],
        defects: 4,
        says: &[
            "no.csv`: cannot be read",
            "there`: cannot be read: is a directory",
            "\"GPa\" is no unit of a length",
            "scan.csv`: line 3: `nan` is no finite number",
        ],
        ..SOUND
    },
    Case {
        name: "time where nothing moves",
        scene: &[
            (
                STIFFNESS,
                "normal_stiffness = { expression = \"1e10 * time\" }",
            ),
            (
                "traction = [0, 0, -1e5]",
                "pressure = { table = [[0, 0], [1, 1e5]], over = \"time\" }",
            ),
        ],
        defects: 2,
        says: &[
            "`normal_stiffness` does not change with time",
            "the value depends on time, but the load steps have no times",
        ],
        ..SOUND
    },
    Case {
        name: "values out of range, out of reach, and none",
        scene: &[
            (
                STIFFNESS,
                "normal_stiffness = { expression = \"1e10 * (x - 0.4)\" }",
            ),
            (
                "shear_stiffness = 1e10",
                "shear_stiffness = { file = \"scan.csv\", column = \"ks\", method = \"linear\" }",
            ),
            (
                "aperture = 1e-4",
                "aperture = { file = \"scan.csv\", column = \"b\", reach = 0.2 }",
            ),
            (
                "traction = [0, 0, -1e5]",
                "pressure = { table = [[0.2, 0], [0.6, 1e5]], over = \"z\" }",
            ),
        ],
        files: &[(
            "scan.csv",
            "x,y,ks,b\n0,0,1e10,1e-4\n0.3,0,1e10,1e-4\n0,0.3,1e10,1e-4\n",
        )],
        defects: 4,
        says: &[
            "[fracture.joint.normal_stiffness]: `normal_stiffness` from `1e10 * (x - 0.4)`: the value -1.",
            "must be a finite number, 0 or greater, at (0.25",
            "`shear_stiffness` from 3 samples of `scan.csv`: there are no samples around at (0.",
            "the nearest sample is 2.5495e-1 m away",
            "`pressure` from a table over z from 0.2 to 0.6: there is no row at (",
            "and at ",
            "beyond = \"nearest\"",
        ],
        ..SOUND
    },
    Case {
        name: "parameters that refuse one another",
        scene: &[(
            "aperture = 1e-4",
            "closure = \"logarithmic\"\ncutoff_aperture = 1e-5\n\
             aperture = { expression = \"3e-5 * x\" }",
        )],
        says: &["cutoff_aperture 1e-5 is above the aperture 7.5"],
        ..SOUND
    },
    Case {
        name: "a closed form of a law that varies",
        scene: &[
            (
                STIFFNESS,
                "normal_stiffness = { expression = \"1e10 * (1 + x)\" }",
            ),
            (
                "[boundary.top]",
                "[oracle.joint]\nform = \"column\"\npressure = 1e5\n[boundary.top]",
            ),
        ],
        says: &["a closed form has one law"],
        ..SOUND
    },
];
