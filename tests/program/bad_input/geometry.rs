//! Geometries that gmsh refuses, or that it meshes to something that cannot be solved.

use super::{Case, MISSING, SOUND, judge_all};

#[test]
fn defects_of_the_geometry_are_named() {
    judge_all(CASES);
}

const FROM_GEOMETRY: (&str, &str) = ("file = \"base.msh\"", "geometry = \"base.geo\"");
const WITH_PARAMETER: (&str, &str) = (
    "file = \"base.msh\"",
    "geometry = \"base.geo\"\nparameters = { size = 0.5 }",
);
const GEO: &str = include_str!("base.geo");
const LOOSE: &str = include_str!("loose.geo");
const STRIP: &str = include_str!("strip.geo");

pub(super) const CASES: &[Case] = &[
    Case {
        name: "no geometry",
        scene: &[FROM_GEOMETRY],
        files: &[("base.geo", MISSING)],
        says: &["base.geo: the geometry cannot be read", "check the path"],
        ..SOUND
    },
    Case {
        name: "no gmsh",
        scene: &[FROM_GEOMETRY],
        files: &[("base.geo", GEO)],
        environment: &[("KLUFT_GMSH", "/nonexistent")],
        says: &[
            "/nonexistent: the program gmsh is not found",
            "apt-get install gmsh",
            "KLUFT_GMSH",
        ],
        ..SOUND
    },
    Case {
        name: "gmsh that is no program",
        scene: &[FROM_GEOMETRY],
        files: &[("base.geo", GEO)],
        environment: &[("KLUFT_GMSH", "/dev/null")],
        says: &[
            "/dev/null: gmsh cannot be started",
            "apt-get install gmsh",
            "KLUFT_GMSH",
        ],
        ..SOUND
    },
    Case {
        name: "syntax error in the geometry",
        scene: &[FROM_GEOMETRY],
        files: &[(
            "base.geo",
            "SetFactory(\"OpenCASCADE\");\nBox(1) = {0, 0, 0, 1, 1, 1};\nBox(2) = {0, 0 0};\n",
        )],
        says: &[
            "base.geo, line 3: gmsh: syntax error",
            "correct the geometry",
        ],
        ..SOUND
    },
    Case {
        name: "unknown parameter",
        scene: &[(
            "file = \"base.msh\"",
            "geometry = \"base.geo\"\nparameters = { siz = 0.5 }",
        )],
        files: &[("base.geo", GEO)],
        says: &[
            "base.geo, parameter siz: the geometry has no `siz`",
            "did you mean `size`?",
        ],
        ..SOUND
    },
    Case {
        name: "parameter that the geometry overrides",
        scene: &[WITH_PARAMETER],
        files: &[(
            "base.geo",
            "size = 1;\nSetFactory(\"OpenCASCADE\");\nBox(1) = {0, 0, 0, size, 1, 1};\n",
        )],
        says: &[
            "base.geo, parameter size: the geometry sets it itself",
            "DefineConstant[ size = ... ]",
        ],
        ..SOUND
    },
    Case {
        name: "geometry without a volume",
        scene: &[FROM_GEOMETRY],
        files: &[(
            "base.geo",
            "SetFactory(\"OpenCASCADE\");\nRectangle(1) = {0, 0, 0, 1, 1};\n",
        )],
        says: &[
            "base.geo: the mesh that gmsh made holds no volume elements",
            "define a volume",
        ],
        ..SOUND
    },
    Case {
        name: "surface that is not embedded",
        scene: &[FROM_GEOMETRY],
        files: &[("base.geo", LOOSE)],
        says: &[
            "fracture `joint`, facet ",
            "more: the facet is not a face of any cell",
            "BooleanFragments",
        ],
        ..SOUND
    },
    Case {
        name: "surface with one side",
        scene: &[FROM_GEOMETRY],
        files: &[("base.geo", STRIP)],
        says: &[
            "fracture `joint`, the surface around facet ",
            "only one side",
            "split it into two physical surfaces",
        ],
        ..SOUND
    },
];
