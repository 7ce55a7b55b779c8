//! Fractures that meet in one point, through which fluid passes.

use std::fs;

use crate::harness::{Workshop, kluft};

/// An upright joint and a level one that touch at the middle of a cube of 2 m; with `along` the
/// level one reaches under the upright one, and they meet along a line.
const GEOMETRY: &str = r#"
SetFactory("OpenCASCADE");
DefineConstant[ from = {1, Name "from"} ];
eps = 1e-4;
Box(1) = {0, 0, 0, 2, 2, 2};
Rectangle(101) = {0, 0, 0, 1, 0.75};
Rotate {{1, 0, 0}, {0, 0, 0}, Pi / 2} { Surface{101}; }
Translate {0, 1, 0.25} { Surface{101}; }
Rectangle(102) = {from, 1, 1, 2 - from, 1};
BooleanFragments{ Volume{1}; Delete; }{ Surface{101, 102}; Delete; }
Physical Volume("rock") = Volume{:};
Physical Surface("left") = Surface In BoundingBox {-eps, -eps, -eps, eps, 2 + eps, 2 + eps};
Physical Surface("right") = Surface In BoundingBox {2 - eps, -eps, -eps, 2 + eps, 2 + eps, 2 + eps};
Physical Surface("upright") = Surface In BoundingBox {-eps, 1 - eps, -eps, 1 + eps, 1 + eps, 1 + eps};
Physical Surface("level") = Surface In BoundingBox {-eps, 1 - eps, 1 - eps, 2 + eps, 2 + eps, 1 + eps};
Mesh.MeshSizeMin = 0.3;
Mesh.MeshSizeMax = 0.3;
"#;

const SCENE: &str = r#"
[mesh]
geometry = "touching.geo"
parameters = { from = 1 }

[fluid]
viscosity = 1e-3

[fracture.default]
aperture = 1e-4

[boundary.left]
fluid_pressure = 1e5

[boundary.right]
fluid_pressure = 0.0
"#;

fn workshop(scene: &str) -> Workshop {
    let workshop = Workshop::of(scene);
    fs::write(workshop.path("touching.geo"), GEOMETRY).expect("written");
    workshop
}

#[test]
fn fluid_that_passes_through_one_node_is_warned_of() {
    let touching = workshop(SCENE);
    let scene = touching.scene();
    let inspected = kluft(&["inspect".as_ref(), scene.as_os_str()]);
    assert_eq!((inspected.code, inspected.err.as_str()), (Some(0), ""));
    let run = touching.run("out", &["-v"]);
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
    for text in [&inspected.out, &run.out] {
        let flat = text.split_whitespace().collect::<Vec<_>>().join(" ");
        for said in [
            "through the one node at (1.0000, 1.0000, 1.0000)",
            "`level`",
            "`upright`",
            "[\"point_contacts\"]",
        ] {
            assert!(flat.contains(said), "{said}: {text}");
        }
    }
    let silent = format!("{SCENE}\n[warnings]\nsilence = [\"point_contacts\"]\n");
    let meeting = SCENE.replace("from = 1", "from = 0.5");
    for scene in [silent, meeting] {
        let run = workshop(&scene).run("out", &["-v"]);
        assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
        assert!(!run.out.contains("one node"), "{}", run.out);
    }
}
