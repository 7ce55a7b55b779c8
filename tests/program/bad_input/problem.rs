//! Scenes that do not fit their mesh, and problems without a solution.

use super::{Case, SOUND, judge_all};

#[test]
fn defects_of_the_problem_are_named() {
    judge_all(CASES);
}

const JOINT: &str =
    "[fracture.joint]\naperture = 1e-4\nnormal_stiffness = 1e10\nshear_stiffness = 1e10\n";
const FROM_GEOMETRY: (&str, &str) = ("file = \"base.msh\"", "geometry = \"base.geo\"");
const TOP: &str = "[boundary.top]\ntraction = [0, 0, -1e5]\n";
const HELD: &str = "[boundary.bottom]\ndisplacement = { x = 0.0, y = 0.0, z = 0.0 }\n";

pub(super) const CASES: &[Case] = &[
    Case {
        name: "unknown volume",
        scene: &[("[rock.rock]", "[rock.rok]")],
        says: &[
            "scene.toml:6 [rock.rok]: the mesh has no physical volume `rok`",
            "did you mean `rock`?",
        ],
        ..SOUND
    },
    Case {
        name: "unknown fracture",
        scene: &[("[fracture.joint]", "[fracture.jiont]")],
        says: &[
            "scene.toml:10 [fracture.jiont]: the mesh has no physical surface `jiont`",
            "did you mean `joint`?",
        ],
        ..SOUND
    },
    Case {
        name: "closed form of an unknown fracture",
        scene: &[(
            "[fracture.joint]",
            "[oracle.jiont]\nform = \"uniform\"\nopening = 1.0\n[fracture.joint]",
        )],
        says: &[
            "[oracle.jiont]: `jiont` is no fracture of the mesh",
            "did you mean `joint`?",
        ],
        ..SOUND
    },
    Case {
        name: "unknown boundary",
        scene: &[("[boundary.bottom]", "[boundary.botom]")],
        says: &[
            "scene.toml:18 [boundary.botom]: the mesh has no physical surface `botom`",
            "did you mean `bottom`?",
        ],
        ..SOUND
    },
    Case {
        name: "name unlike any other",
        scene: &[("[boundary.bottom]", "[boundary.west]")],
        says: &[
            "no physical surface `west`",
            "physical surfaces of the mesh: joint, top, bottom",
        ],
        ..SOUND
    },
    Case {
        name: "several names at once",
        scene: &[
            ("[rock.rock]", "[rock.rok]"),
            ("[fracture.joint]", "[fracture.jiont]"),
            ("[boundary.bottom]", "[boundary.botom]"),
        ],
        defects: 3,
        says: &["`rok`", "`jiont`", "`botom`"],
        ..SOUND
    },
    Case {
        name: "fracture that is a curve",
        scene: &[("[fracture.joint]", "[fracture.seam]")],
        says: &[
            "scene.toml:10 [fracture.seam]: `seam` is a physical curve of the mesh",
            "Physical Surface(\"seam\")",
        ],
        ..SOUND
    },
    Case {
        name: "fracture that is a volume",
        scene: &[("[fracture.joint]", "[fracture.rock]")],
        says: &[
            "scene.toml:10 [fracture.rock]: `rock` is a physical volume of the mesh",
            "Physical Surface(\"rock\")",
        ],
        ..SOUND
    },
    Case {
        name: "mesh without any surface",
        scene: &[FROM_GEOMETRY, (TOP, ""), (HELD, "")],
        files: &[("base.geo", include_str!("base.geo"))],
        says: &[
            "scene.toml:10 [fracture.joint]: the mesh has no physical surface `joint`",
            "the mesh has none at all",
            "Physical Surface(\"joint\")",
        ],
        ..SOUND
    },
    Case {
        name: "condition on a volume",
        scene: &[("[boundary.bottom]", "[boundary.rock]")],
        says: &[
            "scene.toml:18 [boundary.rock]: `rock` is a physical volume of the mesh",
            "Physical Surface(\"rock\")",
        ],
        ..SOUND
    },
    Case {
        name: "fracture and condition",
        scene: &[("[boundary.top]", "[boundary.joint]")],
        says: &[
            "scene.toml:15 [boundary.joint]: surface `joint` is both a fracture and a boundary",
            "remove one",
        ],
        ..SOUND
    },
    Case {
        name: "volume without rock",
        mesh: &[("3 4 \"rock\"", "3 4 \"granite\"")],
        scene: &[(
            "[rock.rock]",
            "[rock.default]\nyoung_modulus = 1e9\npoisson_ratio = 0.2\n[rock.rock]",
        )],
        says: &[
            "scene.toml:9 [rock.rock]: the mesh has no physical volume `rock`",
            "granite",
        ],
        ..SOUND
    },
    Case {
        name: "gravity without density",
        scene: &[("[mesh]", "[body]\ngravity = [0, 0, -9.81]\n\n[mesh]")],
        says: &[
            "scene.toml:9 [rock.rock]: gravity acts, but this rock has no density",
            "add `density = 2700`",
        ],
        ..SOUND
    },
    Case {
        name: "fixed point outside the rock",
        scene: &[(
            HELD,
            "[[fixed_point]]\nat = [5, 0, 0]\ndisplacement = { x = 0.0, y = 0.0, z = 0.0 }\n",
        )],
        says: &[
            "scene.toml:18 [[fixed_point]] number 1: (5, 0, 0) is outside the rock",
            "the nearest node is 12 at (1.0",
        ],
        ..SOUND
    },
    Case {
        name: "nothing held",
        scene: &[(HELD, "")],
        says: &[
            "the rock between (0.0000, 0.0000, -1.0000) and (1.0000, 1.0000, 1.0000): nothing holds it",
            "translation along x, translation along y, translation along z",
            "rotation about x, rotation about y, rotation about z",
            "add a [boundary.NAME] with displacement",
        ],
        ..SOUND
    },
    Case {
        name: "rotation left free",
        scene: &[(
            HELD,
            "[[fixed_point]]\nat = [0, 0, 0]\ndisplacement = { x = 0.0, y = 0.0, z = 0.0 }\n\
                    [[fixed_point]]\nat = [0, 1, 0]\ndisplacement = { x = 0.0, z = 0.0 }\n",
        )],
        says: &["nothing holds it: rotation about y", "[[fixed_point]]"],
        ..SOUND
    },
    Case {
        name: "block cut free",
        scene: &[
            ("normal_stiffness = 1e10", "normal_stiffness = 0"),
            ("shear_stiffness = 1e10", "shear_stiffness = 0"),
        ],
        says: &[
            "the rock between (0.0000, 0.0000, 0.0000) and (1.0000, 1.0000, 1.0000): nothing holds it",
            "rotation about z",
            "stiffness on the fractures",
        ],
        ..SOUND
    },
    Case {
        name: "block that slides away",
        scene: &[("shear_stiffness = 1e10", "shear_stiffness = 0")],
        says: &[
            "nothing holds it: translation along x, translation along y, rotation about z is free",
        ],
        ..SOUND
    },
    Case {
        name: "conditions that contradict at an edge",
        scene: &[
            (JOINT, ""),
            ("traction = [0, 0, -1e5]", "displacement = { z = -1e-3 }"),
        ],
        says: &[
            "node 11: `",
            "`top`",
            "`bottom`",
            "different displacements along (0.000, 0.000, 1.000)",
            "same value",
        ],
        ..SOUND
    },
    Case {
        name: "fixed point that contradicts a condition",
        scene: &[(
            "[boundary.top]",
            "[[fixed_point]]\nat = [0, 0, -1]\ndisplacement = { z = 1e-3 }\n\n[boundary.top]",
        )],
        says: &[
            "node 15: `bottom` and `[[fixed_point]] number 1` prescribe different displacements",
            "same value",
        ],
        ..SOUND
    },
];
