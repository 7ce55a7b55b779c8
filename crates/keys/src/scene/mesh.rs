//! Where the mesh comes from.

use crate::dimension::Dimension;
use crate::range::Range;
use crate::table::{Key, KeySection, Kind, Need, number};

/// Where the mesh comes from.
pub static MESH: KeySection = KeySection {
    pattern: "[mesh]",
    says: "Where the mesh comes from: a gmsh geometry or a mesh file, relative to the scene",
    keys: &[
        Key {
            name: "geometry",
            kind: Kind::Path,
            need: Need::Or("file"),
            example: "\"block.geo\"",
            says: "gmsh geometry, meshed on every run",
        },
        Key {
            name: "file",
            kind: Kind::Path,
            need: Need::Or("geometry"),
            example: "\"block.msh\"",
            says: "gmsh mesh, MSH 4.1; gmsh converts older versions",
        },
        Key {
            name: "parameters",
            kind: Kind::FreeNumbers,
            need: Need::Default("{}"),
            example: "{ h = 0.1 }",
            says: "Plain numbers handed to gmsh, `{ h = 0.1 }` as `-setnumber h 0.1`; with `geometry` only",
        },
        Key {
            name: "order",
            kind: Kind::Whole(Range::Within(1.0, 2.0)),
            need: Need::Default("1"),
            example: "2",
            says: "Order of the elements; with `geometry` only",
        },
        Key {
            name: "dimension",
            kind: Kind::Whole(Range::Within(2.0, 3.0)),
            need: Need::Default("3"),
            example: "2",
            says: "2 meshes surfaces alone: those of a plane are a scene in plane strain, whose fractures are lines; others are the fractures and outer faces of rigid rock; with `geometry` only",
        },
        Key {
            name: "scale",
            kind: number(Dimension::One, Range::Positive),
            need: Need::Default("1"),
            example: "1000",
            says: "Metres that one unit of the coordinates of the mesh is: 1000 for kilometres; not with `adapt`",
        },
        Key {
            name: "quarter_points",
            kind: Kind::Flag,
            need: Need::Default("true"),
            example: "false",
            says: "Whether cells of order 2 at crack fronts follow the square root of the distance",
        },
        Key {
            name: "weld",
            kind: Kind::Flag,
            need: Need::Default("false"),
            example: "true",
            says: "Whether nodes at one place become one node; without it rock that touches without sharing nodes is refused",
        },
        Key {
            name: "refine",
            kind: Kind::Whole(Range::Within(0.0, 5.0)),
            need: Need::Default("0"),
            example: "2",
            says: "How many times each cell is divided into eight, in a mesh of the plane into four, fractures and groups with it; not with `adapt`",
        },
        Key {
            name: "adapt",
            kind: Kind::Table(&ADAPT),
            need: Need::Without("one mesh, as the geometry says"),
            example: "{ tolerance = 0.01 }",
            says: "Meshes until the estimated error is below a tolerance; with `geometry` only",
        },
    ],
    also: None,
};

/// A mesh that follows the estimated error.
pub static ADAPT: KeySection = KeySection {
    pattern: "[mesh.adapt]",
    says: "How far a mesh follows the estimated error",
    keys: &[
        Key {
            name: "tolerance",
            kind: number(Dimension::One, Range::Between(0.0, 1.0)),
            need: Need::Required,
            example: "0.01",
            says: "Largest estimated error of the mean jump of a fracture, as a share of it",
        },
        Key {
            name: "max_unknowns",
            kind: number(Dimension::One, Range::Positive),
            need: Need::Default("1e6"),
            example: "5e5",
            says: "Unknowns beyond which no mesh goes",
        },
        Key {
            name: "by",
            kind: Kind::Choice("way to a finer mesh", &["meshing", "bisection"]),
            need: Need::Default("\"meshing\""),
            example: "\"bisection\"",
            says: "Whether gmsh makes each mesh anew, with sizes by the error, or tetrahedra of the first mesh, triangles of one of the plane, are cut in two where it asks for that, which starts no gmsh; surfaces stay as the first mesh has them",
        },
        Key {
            name: "max_rounds",
            kind: number(Dimension::One, Range::Positive),
            need: Need::Default("8"),
            example: "5",
            says: "Most meshes",
        },
    ],
    also: None,
};
