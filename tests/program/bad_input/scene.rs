//! Scene files that are wrong in themselves.

use super::{Case, SOUND, judge_all};

#[test]
fn defects_of_the_scene_are_named() {
    judge_all(CASES);
}

pub(super) const CASES: &[Case] = &[
    Case {
        name: "empty scene",
        files: &[("scene.toml", "")],
        defects: 2,
        says: &[
            "scene.toml:1: there is no [mesh] in the scene",
            "add a section [mesh]",
            "there is no [rock] in the scene",
            "add a section [rock.default]",
        ],
        ..SOUND
    },
    Case {
        name: "missing key",
        scene: &[("poisson_ratio = 0.25\n", "")],
        says: &[
            "scene.toml:6: `poisson_ratio` is missing in [rock.rock]",
            "add `poisson_ratio = 0.25`",
        ],
        ..SOUND
    },
    Case {
        name: "misspelt key",
        scene: &[("shear_stiffness", "shear_stifness")],
        says: &[
            "scene.toml:13: unknown key `shear_stifness` in [fracture.joint]",
            "did you mean `shear_stiffness`?",
        ],
        ..SOUND
    },
    Case {
        name: "volumes of a default fracture, and three of them",
        scene: &[(
            "[boundary.top]",
            "between = [\"rock\", \"rock\", \"rock\"]\n[fracture.default]\nbetween = [\"rock\", \"rock\"]\n\
             aperture = 1e-4\nnormal_stiffness = 1e10\nshear_stiffness = 1e10\n[boundary.top]",
        )],
        defects: 2,
        says: &[
            "scene.toml:15: `between` in [fracture.joint] is no pair of names",
            "write two names in brackets",
            "scene.toml:17: [fracture.default] serves surfaces that the mesh has",
            "give the fracture between these volumes a name",
        ],
        ..SOUND
    },
    Case {
        name: "unknown facet rule",
        scene: &[(
            "[fracture.joint]",
            "[solver]\nfacets = \"gaus\"\n[fracture.joint]",
        )],
        says: &[
            "unknown facet rule \"gaus\"",
            "write \"nodal\" (the default)",
        ],
        ..SOUND
    },
    Case {
        name: "key unlike any other",
        scene: &[("[boundary.top]", "[boundary.top]\nqqq = 1")],
        says: &[
            "scene.toml:16: unknown key `qqq`",
            "known keys: displacement, far_field, fluid_inflow, fluid_pressure, history, pressure, shear_spring, spring, symmetry, traction, where",
        ],
        ..SOUND
    },
    Case {
        name: "closed forms that say nothing, or nothing known",
        scene: &[(
            "[fracture.joint]",
            "[oracle.a]\nform = \"penny\"\ncentre = [0, 0, 0]\nradius = 1\n[oracle.b]\nform = \"disc\"\n[oracle.c]\nform = \"line\"\npressure = 1e6\ncentre = [0, 0, 0]\nhalf_length = 1\nalong = [0, 0, 0]\n[fracture.joint]",
        )],
        defects: 3,
        says: &[
            "the closed form says nothing",
            "give at least one of `pressure`, `stress_drop` (Pa) and `normal_traction`",
            "unknown closed form \"disc\"",
            "`along` has no direction",
        ],
        ..SOUND
    },
    Case {
        name: "an adaptive mesh from a file, to no tolerance",
        scene: &[(
            "file = \"base.msh\"",
            "file = \"base.msh\"\nadapt = { tolerance = 0.01 }",
        )],
        says: &["`adapt` has no effect on a mesh file", "give the geometry"],
        ..SOUND
    },
    Case {
        name: "an adaptive mesh without a tolerance",
        scene: &[(
            "file = \"base.msh\"",
            "geometry = \"base.geo\"\nadapt = { rounds = 3 }",
        )],
        defects: 2,
        says: &[
            "`tolerance` is missing in [mesh.adapt]",
            "unknown key `rounds` in [mesh.adapt]",
        ],
        ..SOUND
    },
    Case {
        name: "unknown linear solver",
        scene: &[(
            "[fracture.joint]",
            "[solver]\nlinear = \"lu\"\n[fracture.joint]",
        )],
        says: &[
            "unknown linear solver \"lu\"",
            "write \"direct\", \"condensed\" or \"iterative\"",
        ],
        ..SOUND
    },
    Case {
        name: "too little memory",
        scene: &[(
            "[fracture.joint]",
            "[solver]\nmemory_limit = 10\n[fracture.joint]",
        )],
        says: &["[solver]: the iterative solver needs", "mesh coarser"],
        ..SOUND
    },
    Case {
        name: "misspelt section",
        scene: &[("[fracture.joint]", "[fractur.joint]")],
        says: &[
            "scene.toml:10: unknown key `fractur` in the scene",
            "did you mean `fracture`?",
        ],
        ..SOUND
    },
    Case {
        name: "misspelt required section",
        scene: &[("[rock.rock]", "[rok.rock]")],
        says: &[
            "scene.toml:6: unknown key `rok` in the scene",
            "did you mean `rock`?",
        ],
        ..SOUND
    },
    Case {
        name: "misspelt closure",
        scene: &[(
            "aperture = 1e-4",
            "aperture = 1e-4\nclosure = \"logaritmic\"",
        )],
        says: &[
            "scene.toml:12: unknown closure law \"logaritmic\"",
            "did you mean \"logarithmic\"?",
        ],
        ..SOUND
    },
    Case {
        name: "number in quotes",
        scene: &[("young_modulus = 1e9", "young_modulus = \"1e9\"")],
        says: &[
            "scene.toml:7: `young_modulus` in [rock.rock] is of type string",
            "write a number",
        ],
        ..SOUND
    },
    Case {
        name: "flag that is a number",
        scene: &[("traction = [0, 0, -1e5]", "symmetry = 1")],
        says: &[
            "scene.toml:16: `symmetry` in [boundary.top] is of type integer",
            "write true or false",
        ],
        ..SOUND
    },
    Case {
        name: "section that is a value",
        scene: &[("[mesh]\nfile = \"base.msh\"", "mesh = \"base.msh\"")],
        says: &[
            "scene.toml:3: `mesh` in the scene is of type string",
            "a section: [mesh]",
        ],
        ..SOUND
    },
    Case {
        name: "section without a name",
        scene: &[("[rock.rock]", "[rock]")],
        defects: 2,
        says: &[
            "scene.toml:7: `young_modulus` stands directly in [rock]",
            "[rock.NAME] or [rock.default]",
        ],
        ..SOUND
    },
    Case {
        name: "single brackets where a list is meant",
        scene: &[(
            "[boundary.top]",
            "[fixed_point]\nat = [0, 0, 0]\n\n[boundary.top]",
        )],
        says: &[
            "scene.toml:15: `fixed_point` in the scene is of type table",
            "[[fixed_point]] in double brackets",
        ],
        ..SOUND
    },
    Case {
        name: "two components",
        scene: &[("[0, 0, -1e5]", "[0, -1e5]")],
        says: &[
            "scene.toml:16: `traction` in [boundary.top] has not three components",
            "write [x, y, z]",
        ],
        ..SOUND
    },
    Case {
        name: "TOML syntax",
        scene: &[("young_modulus = 1e9", "young_modulus 1e9")],
        says: &[
            "scene.toml:7: key with no value",
            "correct the TOML syntax of this line",
        ],
        ..SOUND
    },
    Case {
        name: "several TOML errors",
        scene: &[
            ("file = \"base.msh\"", "file = base.msh"),
            ("young_modulus = 1e9", "young_modulus 1e9"),
        ],
        defects: 2,
        says: &["scene.toml:4: ", "scene.toml:7: key with no value"],
        ..SOUND
    },
    Case {
        name: "open bracket",
        scene: &[("[0, 0, -1e5]", "[0, 0, -1e5")],
        defects: 2,
        says: &[
            "scene.toml:18: missing comma between array elements",
            "close the bracket that is open above it",
        ],
        ..SOUND
    },
    Case {
        name: "key twice",
        scene: &[("aperture = 1e-4", "aperture = 1e-4\naperture = 1e-3")],
        says: &[
            "scene.toml:12: the key `aperture` stands twice: it is in line 11 already",
            "keep one of them",
        ],
        ..SOUND
    },
    Case {
        name: "several at once",
        scene: &[
            ("young_modulus = 1e9", "young_modulus = -1e9"),
            ("aperture = 1e-4\n", ""),
            ("normal_stiffness", "normal_stiffnes"),
            ("[0, 0, -1e5]", "7"),
        ],
        defects: 4,
        says: &[
            "scene.toml:7: `young_modulus` = -1000000000",
            "scene.toml:10: `aperture` is missing",
            "scene.toml:11: unknown key `normal_stiffnes`",
            "scene.toml:15: `traction` in [boundary.top] is of type integer",
        ],
        ..SOUND
    },
    Case {
        name: "not a number",
        scene: &[("aperture = 1e-4", "aperture = nan")],
        says: &[
            "scene.toml:11: `aperture` = NaN in [fracture.joint]",
            "finite number greater than 0",
        ],
        ..SOUND
    },
    Case {
        name: "infinite",
        scene: &[("-1e5", "-inf")],
        says: &[
            "scene.toml:16: `traction` = -inf in [boundary.top]",
            "must be a finite number",
        ],
        ..SOUND
    },
    Case {
        name: "finite in decimals, infinite in binary",
        scene: &[("young_modulus = 1e9", "young_modulus = 1e999")],
        says: &[
            "scene.toml:7: `young_modulus` = inf",
            "must be from 1 to 1e15",
        ],
        ..SOUND
    },
    Case {
        name: "negative stiffness",
        scene: &[("normal_stiffness = 1e10", "normal_stiffness = -1e10")],
        says: &[
            "scene.toml:12: `normal_stiffness` = -10000000000",
            "0 or greater",
        ],
        ..SOUND
    },
    Case {
        name: "negative aperture",
        scene: &[("aperture = 1e-4", "aperture = -1e-4")],
        says: &["scene.toml:11: `aperture` = -0.0001", "greater than 0"],
        ..SOUND
    },
    Case {
        name: "no stiffness of the rock",
        scene: &[("young_modulus = 1e9", "young_modulus = 0")],
        says: &[
            "scene.toml:7: `young_modulus` = 0",
            "must be from 1 to 1e15",
        ],
        ..SOUND
    },
    Case {
        name: "incompressible",
        scene: &[("poisson_ratio = 0.25", "poisson_ratio = 0.5")],
        says: &[
            "scene.toml:8: `poisson_ratio` = 0.5",
            "more than -1 and less than 0.5",
        ],
        ..SOUND
    },
    Case {
        name: "cutoff above the aperture",
        scene: &[(
            "aperture = 1e-4",
            "aperture = 1e-4\nclosure = \"logarithmic\"\ncutoff_aperture = 2e-4",
        )],
        says: &[
            "scene.toml:13: cutoff_aperture 0.0002 is above the aperture 0.0001",
            "between 0 and the aperture",
        ],
        ..SOUND
    },
    Case {
        name: "largest closure of a logarithmic law",
        scene: &[(
            "aperture = 1e-4",
            "aperture = 1e-4\nclosure = \"logarithmic\"\nmax_closure = 1e-5",
        )],
        says: &[
            "scene.toml:13: a logarithmic closure has no max_closure",
            "closure = \"hyperbolic\"",
        ],
        ..SOUND
    },
    Case {
        name: "contact with a stiffness",
        scene: &[(
            "aperture = 1e-4",
            "aperture = 1e-4\nclosure = \"contact\"\nfriction_angle = 30",
        )],
        says: &[
            "scene.toml:14: contact has no normal_stiffness",
            "choose another closure",
        ],
        ..SOUND
    },
    Case {
        name: "cohesion without friction",
        scene: &[("aperture = 1e-4", "aperture = 1e-4\ncohesion = 1e6")],
        says: &[
            "scene.toml:12: cohesion is given, but no friction_angle",
            "friction_angle = 30",
        ],
        ..SOUND
    },
    Case {
        name: "more dilation than friction",
        scene: &[(
            "aperture = 1e-4",
            "aperture = 1e-4\nfriction_angle = 20\ndilation_angle = 30",
        )],
        says: &[
            "scene.toml:13: a dilation_angle of 30 is above the friction_angle of 20",
            "sliding would give energy",
        ],
        ..SOUND
    },
    Case {
        name: "strength without energy",
        scene: &[("aperture = 1e-4", "aperture = 1e-4\ntensile_strength = 1e6")],
        says: &[
            "scene.toml:12: tensile_strength is given, but not fracture_energy",
            "fracture_energy = 100",
        ],
        ..SOUND
    },
    Case {
        name: "a bond too brittle for its stiffness",
        scene: &[(
            "aperture = 1e-4",
            "aperture = 1e-4\ntensile_strength = 1e9\nfracture_energy = 1e-6",
        )],
        says: &[
            "scene.toml:13: 0.000001 J/m^2 is not more than the",
            "above tensile_strength^2 / (2 normal_stiffness)",
        ],
        ..SOUND
    },
    Case {
        name: "cutoff of a linear law",
        scene: &[("aperture = 1e-4", "aperture = 1e-4\ncutoff_aperture = 1e-6")],
        says: &[
            "scene.toml:12: a linear closure has no cutoff",
            "remove cutoff_aperture or write closure",
        ],
        ..SOUND
    },
    Case {
        name: "third order",
        scene: &[("[mesh]", "[mesh]\norder = 3")],
        says: &[
            "scene.toml:4: elements of order 3 are not supported",
            "write order = 1",
        ],
        ..SOUND
    },
    Case {
        name: "geometry and file",
        scene: &[("[mesh]", "[mesh]\ngeometry = \"base.geo\"")],
        says: &[
            "scene.toml:5: both `geometry` and `file` are given",
            "keep one of them",
        ],
        ..SOUND
    },
    Case {
        name: "neither geometry nor file",
        scene: &[("file = \"base.msh\"", "")],
        says: &[
            "scene.toml:3: `geometry` is missing in [mesh]",
            "`file = \"block.msh\"`",
        ],
        ..SOUND
    },
    Case {
        name: "path that is empty",
        scene: &[("base.msh", "")],
        says: &["scene.toml:4: `file` is empty", "name the file"],
        ..SOUND
    },
    Case {
        name: "parameters of a file",
        scene: &[("[mesh]", "[mesh]\nparameters = { h = 0.1 }")],
        says: &[
            "scene.toml:4: `parameters` has no effect on a mesh file",
            "remove it",
        ],
        ..SOUND
    },
    Case {
        name: "traction and pressure",
        scene: &[(
            "traction = [0, 0, -1e5]",
            "traction = [0, 0, -1e5]\npressure = 1e5",
        )],
        says: &[
            "scene.toml:17: both traction and pressure are given",
            "keep one",
        ],
        ..SOUND
    },
    Case {
        name: "condition that says nothing",
        scene: &[("traction = [0, 0, -1e5]\n", "")],
        says: &[
            "scene.toml:15: [boundary.top] says nothing",
            "add traction, pressure, displacement, symmetry, spring, far_field or fluid_pressure",
        ],
        ..SOUND
    },
];
