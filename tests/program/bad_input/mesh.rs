//! Mesh files that are damaged, or whose parts do not fit together.

use super::{Case, FOLDER, MISSING, SOUND, judge_all};

#[test]
fn defects_of_the_mesh_are_named() {
    judge_all(CASES);
}

/// `base.msh` with one facet more in the joint.
const TENTH_ELEMENT: (&str, &str) = ("5 10 101 302", "5 11 101 303");

/// One cell in the place of two; what its nodes are does not matter.
const TWENTY_NODES: &str =
    "3 1 29 1\n301 11 12 13 14 11 12 13 14 11 12 13 14 11 12 13 14 11 12 13 14\n";

pub(super) const CASES: &[Case] = &[
    Case {
        name: "no file",
        files: &[("base.msh", MISSING)],
        says: &["base.msh: cannot be read", "check the path"],
        ..SOUND
    },
    Case {
        name: "folder",
        files: &[("base.msh", FOLDER)],
        says: &["base.msh: cannot be read", "irectory", "check the path"],
        ..SOUND
    },
    Case {
        name: "empty file",
        files: &[("base.msh", "")],
        says: &["base.msh: the file is empty", "gmsh GEO -3 -format msh41"],
        ..SOUND
    },
    Case {
        name: "garbage",
        files: &[("base.msh", "solid ascii\nfacet normal 0 0 1\n")],
        says: &[
            "base.msh: this is not a gmsh mesh",
            "gmsh GEO -3 -format msh41",
        ],
        ..SOUND
    },
    Case {
        name: "truncated section",
        mesh: &[("302 11 13 12 15\n$EndElements\n", "302 11 1")],
        says: &[
            "base.msh, line 34: the section $Elements has no $EndElements",
            "write it again",
        ],
        ..SOUND
    },
    Case {
        name: "truncated numbers",
        mesh: &[("302 11 13 12 15\n", "302 11 1\n")],
        says: &[
            "base.msh, line 50: the section ends where the node tag of an element should be",
            "write it again",
        ],
        ..SOUND
    },
    Case {
        name: "old version without gmsh",
        files: &[("base.msh", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n")],
        environment: &[("KLUFT_GMSH", "/nonexistent")],
        says: &[
            "/nonexistent: the program gmsh is not found",
            "apt-get install gmsh",
            "KLUFT_GMSH",
        ],
        ..SOUND
    },
    Case {
        name: "one tag, two nodes",
        mesh: &[("\n12\n13\n", "\n11\n13\n")],
        defects: 2,
        says: &[
            "base.msh, nodes 11: the tag stands for more than one node",
            "give every node its own tag",
        ],
        ..SOUND
    },
    Case {
        name: "unknown node",
        mesh: &[("302 11 13 12 15", "302 11 13 12 99")],
        says: &[
            "base.msh, elements 302",
            "nodes that are not there: 99",
            "write it again",
        ],
        ..SOUND
    },
    Case {
        name: "an older version that gmsh cannot read",
        mesh: &[("4.1 0 8", "2.2 0 8")],
        defects: 2,
        says: &["base.msh: gmsh: ", "write the mesh file again"],
        ..SOUND
    },
    Case {
        name: "coordinate that is no number",
        mesh: &[("\n1 0 0\n", "\nnan 0 0\n")],
        says: &[
            "base.msh, nodes 12: a coordinate is infinite or not a number",
            "correct the geometry",
        ],
        ..SOUND
    },
    Case {
        name: "no cells",
        mesh: &[
            ("5 10 101 302", "4 8 101 223"),
            ("3 1 4 2\n301 11 12 13 14\n302 11 13 12 15\n", ""),
        ],
        says: &[
            "base.msh: nothing to solve",
            "no cells of dimension 3",
            "Physical Volume",
            "gmsh -3",
        ],
        ..SOUND
    },
    Case {
        name: "elements of third order",
        mesh: &[
            ("5 10 101 302", "5 9 101 301"),
            ("3 1 4 2\n301 11 12 13 14\n302 11 13 12 15\n", TWENTY_NODES),
        ],
        says: &[
            "base.msh, ",
            "1 elements are of gmsh type 29 (Tet20), which cannot be used here",
            "Mesh.ElementOrder = 1",
        ],
        ..SOUND
    },
    Case {
        name: "inverted cell",
        mesh: &[("302 11 13 12 15", "302 11 12 13 15")],
        says: &["base.msh, cell 302: the cell is inside out", "gmsh's order"],
        ..SOUND
    },
    Case {
        name: "cell without volume",
        mesh: &[("\n0 0 -1\n", "\n0.3 0.3 0\n")],
        says: &[
            "base.msh, cell 302: the cell has no volume",
            "Mesh.Optimize",
        ],
        ..SOUND
    },
    Case {
        name: "overlapping cells",
        mesh: &[
            ("\n0 0 -1\n", "\n0.1 0.1 0.5\n"),
            ("302 11 13 12 15", "302 11 12 13 15"),
        ],
        says: &[
            "base.msh, cell 301: the cell overlaps its neighbour",
            "BooleanFragments",
        ],
        ..SOUND
    },
    Case {
        name: "cell twice",
        mesh: &[TENTH_ELEMENT, ("3 1 4 2\n", "3 1 4 3\n303 11 12 13 14\n")],
        defects: 2,
        says: &[
            "a face is shared by more than two cells",
            "cell 303: the cell overlaps its neighbour or stands in the file twice",
            "remove the copy",
        ],
        ..SOUND
    },
    Case {
        name: "facet twice",
        mesh: &[TENTH_ELEMENT, ("2 1 2 1\n", "2 1 2 2\n202 12 11 13\n")],
        says: &[
            "fracture `joint`, facet 201: the facet stands in the file twice",
            "remove the copy",
        ],
        ..SOUND
    },
    Case {
        name: "facet of a condition twice",
        mesh: &[TENTH_ELEMENT, ("2 2 2 3\n", "2 2 2 4\n214 12 11 14\n")],
        says: &[
            "boundary `top`, facet 211",
            "would be loaded twice",
            "remove the copy",
        ],
        ..SOUND
    },
    Case {
        name: "fracture that no cell touches",
        mesh: &[("201 11 12 13", "201 11 14 15")],
        says: &[
            "fracture `joint`, facet 201: the facet is not a face of any cell",
            "not embedded",
            "BooleanFragments",
        ],
        ..SOUND
    },
    Case {
        name: "fracture outside",
        scene: &[
            ("[fracture.joint]", "[fracture.top]"),
            ("[boundary.top]\ntraction = [0, 0, -1e5]\n", ""),
        ],
        says: &[
            "fracture `top`, facet 211, 212, 213: the facet lies on the outer boundary",
            "must lie inside the rock",
        ],
        ..SOUND
    },
    Case {
        name: "condition inside",
        scene: &[
            (
                "[fracture.joint]\naperture = 1e-4\nnormal_stiffness = 1e10\nshear_stiffness = 1e10\n",
                "",
            ),
            ("[boundary.top]", "[boundary.joint]"),
        ],
        says: &[
            "boundary `joint`, facet 201: the facet lies inside the rock",
            "[fracture] entry",
        ],
        ..SOUND
    },
    Case {
        name: "condition on outer and inner faces",
        scene: &[
            (
                "[fracture.joint]\naperture = 1e-4\nnormal_stiffness = 1e10\nshear_stiffness = 1e10\n",
                "",
            ),
            ("[boundary.top]", "[boundary.joint]"),
        ],
        mesh: &[("2 0 0 0 1 1 1 1 2 0", "2 0 0 0 1 1 1 2 1 2 0")],
        says: &[
            "boundary `joint`, facet 201: the group mixes 3 facets of the outer surface with 1 inside",
            "a physical group of their own",
        ],
        ..SOUND
    },
    Case {
        name: "two fractures on one surface",
        scene: &[(
            "[boundary.top]",
            "[fracture.twin]\naperture = 1e-4\nnormal_stiffness = 1e10\nshear_stiffness = 1e10\n[boundary.top]",
        )],
        mesh: &[
            ("5\n1 5", "6\n2 6 \"twin\"\n1 5"),
            ("1 0 0 0 1 1 0 1 1 0", "1 0 0 0 1 1 0 2 1 6 0"),
        ],
        says: &[
            "all its facets belong to fracture `",
            "several physical groups hold one surface",
            "let one group hold the surface",
        ],
        ..SOUND
    },
    Case {
        name: "condition that no cell touches",
        mesh: &[("211 11 12 14", "211 11 14 15")],
        says: &[
            "boundary `top`, facet 211: the facet is not a face of any cell",
            "mesh volume and surface together",
        ],
        ..SOUND
    },
    Case {
        name: "group without facets",
        mesh: &[
            ("5 10 101 302", "4 9 101 302"),
            ("2 1 2 1\n201 11 12 13\n", ""),
        ],
        says: &[
            "physical surface `joint`: the group holds no facets",
            "still exist after fragments",
        ],
        ..SOUND
    },
];
