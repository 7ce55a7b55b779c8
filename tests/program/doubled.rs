//! Meshes in which rock touches without sharing nodes: volumes that were not fragmented, and what
//! gmsh's plugin Crack leaves.

use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::Value;
use tempfile::TempDir;

use crate::harness::{Run, kluft, scratch, summary};

/// A cube with a crack that ends inside, whole and split by gmsh.
const CRACK: &str = r#"
SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 1, 1, 1}; s = news; Rectangle(s) = {0, 0, 0.5, 0.5, 1};
BooleanFragments{ Volume{1}; Delete; }{ Surface{s}; Delete; }
e = 1e-4;
Physical Volume("rock", 1) = Volume{:};
f() = Surface In BoundingBox{-e, -e, 0.5-e, 0.5+e, 1+e, 0.5+e};
b() = Surface In BoundingBox{-e, -e, 1-e, 1+e, 1+e, 1+e};
c() = Surface In BoundingBox{-e, -e, -e, 1+e, 1+e, e};
Physical Surface("joint", 12) = f();
Physical Surface("top", 13) = b(); Physical Surface("bottom", 14) = c();
Mesh.MeshSizeMax = 0.3; Mesh.MshFileVersion = 4.1;
Mesh 3;
Save "whole.msh";
Plugin(Crack).Dimension = 2; Plugin(Crack).PhysicalGroup = 12; Plugin(Crack).Run;
Save "cracked.msh";
"#;

/// Two boxes side by side, `shared` or not; hexahedra (`matching`) or tetrahedra as they come.
const BOXES: &str = r#"
SetFactory("OpenCASCADE");
DefineConstant[ shared = 0, matching = 1 ];
Box(1) = {0, 0, 0, 0.5, 1, 1}; Box(2) = {0.5, 0, 0, 0.5, 1, 1};
If (shared)
  BooleanFragments{ Volume{1}; Delete; }{ Volume{2}; Delete; }
EndIf
If (matching)
  Transfinite Curve{:} = 4; Transfinite Surface{:}; Transfinite Volume{:}; Recombine Surface{:};
EndIf
Mesh.MeshSizeMax = 0.4; e = 1e-5;
Physical Volume("one") = {1}; Physical Volume("two") = {2};
c() = Surface In BoundingBox{-e, -e, -e, 1+e, 1+e, e};
d() = Surface In BoundingBox{-e, -e, -e, e, 1+e, 1+e};
Physical Surface("bottom") = c(); Physical Surface("left") = d();
"#;

const ROCK: &str = "[rock.default]\nyoung_modulus = 50e9\npoisson_ratio = 0.25\n";
const LAW: &str = "aperture = 1e-4\nnormal_stiffness = 1e11\nshear_stiffness = 1e10\n";
const HELD: &str = "[boundary.bottom]\ndisplacement = { x = 0.0, y = 0.0, z = 0.0 }\n";

/// A folder with scenes.
struct Bench(TempDir);

impl Bench {
    fn new(geometry: (&str, &str)) -> Self {
        let folder = scratch();
        fs::write(folder.path().join(geometry.0), geometry.1).expect("a geometry");
        Self(folder)
    }

    fn cracked() -> Self {
        let bench = Self::new(("crack.geo", CRACK));
        let gmsh = std::env::var("KLUFT_GMSH").unwrap_or_else(|_| "gmsh".into());
        let mut command = Command::new(gmsh);
        let output = command
            .args(["crack.geo", "-"])
            .current_dir(bench.path())
            .output();
        assert!(output.expect("gmsh starts").status.success());
        bench
    }

    fn path(&self) -> &Path {
        self.0.path()
    }

    fn call(&self, command: &str, name: &str, scene: &str) -> Run {
        let file = self.path().join(format!("{name}.toml"));
        fs::write(&file, scene).expect("a scene");
        let out = self.path().join(name);
        kluft(&[
            command.as_ref(),
            file.as_os_str(),
            "--out".as_ref(),
            out.as_os_str(),
        ])
    }

    /// The summary of a scene that must run.
    fn solved(&self, name: &str, scene: &str) -> Value {
        let run = self.call("run", name, scene);
        assert_eq!((run.code, run.err.as_str()), (Some(0), ""), "{name}");
        summary(&self.path().join(name))
    }

    /// What is said of a scene that must be refused.
    fn refused(&self, name: &str, scene: &str, says: &[&str]) {
        let run = self.call("run", name, scene);
        assert_eq!(run.code, Some(2), "{name}: {}", run.err);
        for text in says {
            assert!(run.err.contains(text), "no {text:?} in\n{}", run.err);
        }
    }
}

fn crack_scene(mesh: &str, fracture: &str) -> String {
    let loads = "[boundary.top]\ntraction = [1e6, 0, -7e6]\n";
    format!("[mesh]\n{mesh}\n{ROCK}{fracture}\n{HELD}{loads}")
}

/// Numbers of a fracture that must be the same to rounding.
fn measures(summary: &Value, fracture: &str) -> Vec<f64> {
    let fracture = &summary["fractures"][fracture];
    let numbers = [
        &fracture["facets"],
        &fracture["area"],
        &fracture["aperture"]["min"],
        &fracture["aperture"]["mean"],
        &fracture["aperture"]["max"],
        &fracture["normal_traction"]["min"],
        &fracture["normal_traction"]["mean"],
        &fracture["slip_max"],
    ];
    let numbers = numbers.map(|value| value.as_f64().unwrap_or_else(|| panic!("{fracture}")));
    numbers.to_vec()
}

#[track_caller]
fn assert_same(found: &[f64], expected: &[f64]) {
    for (a, b) in found.iter().zip(expected) {
        // Cells stand in another order, so sums are rounded in another way.
        assert!(
            (a - b).abs() <= 1e-10 * b.abs(),
            "{found:?}, not {expected:?}"
        );
    }
}

#[test]
fn what_gmsh_cracked_gives_the_apertures_of_the_whole_mesh() {
    let bench = Bench::cracked();
    let joint = format!("[fracture.joint]\n{LAW}");
    let whole = bench.solved("whole", &crack_scene("file = \"whole.msh\"", &joint));
    let whole = measures(&whole, "joint");
    let welded = "file = \"cracked.msh\"\nweld = true";
    let welded = bench.solved("welded", &crack_scene(welded, &joint));
    assert_same(&measures(&welded, "joint"), &whole);
    let taken = format!("[fracture.crack]\nbetween = [\"rock\", \"rock\"]\n{LAW}");
    let taken = bench.solved("taken", &crack_scene("file = \"cracked.msh\"", &taken));
    assert_same(&measures(&taken, "crack"), &whole);
    let decisions = taken["decisions"].to_string();
    assert!(
        decisions.contains("crack: 50 facets where nodes within `rock`"),
        "{decisions}"
    );
}

#[test]
fn a_cracked_mesh_is_refined_as_the_whole_one() {
    let bench = Bench::cracked();
    let joint = format!("[fracture.joint]\n{LAW}");
    let solved = |name: &str, mesh: &str, fracture: &str| {
        let mesh = format!("{mesh}\nrefine = 1");
        let summary = bench.solved(name, &crack_scene(&mesh, fracture));
        let decisions = summary["decisions"].to_string();
        let divided = "each cell divided into 8, once: ";
        assert!(decisions.contains(divided), "{decisions}");
        summary
    };
    let whole = solved("whole", "file = \"whole.msh\"", &joint);
    assert_eq!(whole["fractures"]["joint"]["facets"], 200);
    let welded = solved("welded", "file = \"cracked.msh\"\nweld = true", &joint);
    assert_eq!(welded["mesh"], whole["mesh"]);
    assert_same(&measures(&welded, "joint"), &measures(&whole, "joint"));
    let taken = format!("[fracture.crack]\nbetween = [\"rock\", \"rock\"]\n{LAW}");
    let taken = solved("taken", "file = \"cracked.msh\"", &taken);
    assert_eq!(taken["mesh"], whole["mesh"]);
    assert_same(&measures(&taken, "crack"), &measures(&whole, "joint"));
}

#[test]
fn what_gmsh_cracked_is_refused_without_a_word_in_the_scene() {
    let bench = Bench::cracked();
    let mesh = "file = \"cracked.msh\"";
    let touching = [
        "physical volume `rock`: ",
        "(physical surface `joint`)",
        "over 0.500000 m2",
        "nodes are doubled",
        "`weld = true`",
        "between = [",
    ];
    let default = format!("[fracture.default]\n{LAW}");
    bench.refused("default", &crack_scene(mesh, &default), &touching);
    let joint = format!("[fracture.joint]\n{LAW}");
    bench.refused("named", &crack_scene(mesh, &joint), &touching);
    bench.refused(
        "named",
        &crack_scene(mesh, &joint),
        &[
            "2 defects",
            "fracture `joint`, facet",
            "add `weld = true` to [mesh]",
        ],
    );
    let again = format!("[fracture.joint]\nbetween = [\"rock\", \"rok\"]\n{LAW}");
    bench.refused(
        "again",
        &crack_scene(mesh, &again),
        &[
            "has a physical surface `joint` already",
            "did you mean `rock`?",
        ],
    );
    let whole = format!("[fracture.x]\nbetween = [\"rock\", \"rock\"]\n{LAW}");
    bench.refused(
        "nothing",
        &crack_scene("file = \"whole.msh\"", &whole),
        &["no faces within `rock` lie on one another"],
    );
}

fn boxes_scene(parameters: &str, mesh: &str, fracture: &str) -> String {
    let loads = "[boundary.left]\npressure = 5e6\n";
    format!(
        "[mesh]\ngeometry = \"boxes.geo\"\nparameters = {{ {parameters} }}\n{mesh}\n{ROCK}{fracture}\n{HELD}{loads}"
    )
}

#[test]
fn boxes_that_were_not_fragmented_hold_together_once_welded() {
    let bench = Bench::new(("boxes.geo", BOXES));
    let says = [
        "physical volumes `one` and `two`: 18 outer faces",
        "over 1.000000 m2",
        "weld = true",
    ];
    bench.refused("apart", &boxes_scene("shared = 0", "", ""), &says);
    let energy = |name: &str, parameters: &str, mesh: &str| {
        let summary = bench.solved(name, &boxes_scene(parameters, mesh, ""));
        let measures = summary["measures"].as_array().expect("measures");
        let energy = measures.iter().find(|measure| measure["name"] == "energy");
        let energy = energy.and_then(|measure| measure["value"].as_f64());
        let nodes = summary["mesh"]["nodes"].as_f64();
        [nodes, energy].map(|value| value.unwrap_or_else(|| panic!("{summary}")))
    };
    let whole = energy("whole", "shared = 1", "");
    assert_same(&energy("welded", "shared = 0", "weld = true"), &whole);
}

#[test]
fn the_surface_between_two_volumes_is_a_fracture_whether_fragmented_or_not() {
    let bench = Bench::new(("boxes.geo", BOXES));
    let fracture = format!("[fracture.contact]\nbetween = [\"one\", \"two\"]\n{LAW}");
    let shared = bench.solved("shared", &boxes_scene("shared = 1", "", &fracture));
    let doubled = bench.solved("doubled", &boxes_scene("shared = 0", "", &fracture));
    assert_eq!(shared["fractures"]["contact"]["facets"], 9);
    assert_same(
        &measures(&doubled, "contact"),
        &measures(&shared, "contact"),
    );
}

#[test]
fn boxes_whose_nodes_do_not_match_are_refused_whatever_the_scene_says() {
    let bench = Bench::new(("boxes.geo", BOXES));
    let says = [
        "their nodes do not match",
        "BooleanFragments",
        "neither `weld = true`",
    ];
    for (name, mesh) in [("apart", ""), ("welded", "weld = true")] {
        bench.refused(name, &boxes_scene("matching = 0", mesh, ""), &says);
    }
}

#[test]
fn an_inspection_tells_where_nodes_are_doubled() {
    let bench = Bench::cracked();
    let mesh = bench.path().join("cracked.msh");
    let run = kluft(&["inspect".as_ref(), mesh.as_os_str()]);
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
    for text in [
        "`rock` on `joint`: 100 faces, 0.500000 m2",
        "nodes are doubled",
        "weld = true",
    ] {
        assert!(run.out.contains(text), "no {text:?} in\n{}", run.out);
    }
    let bench = Bench::new(("boxes.geo", BOXES));
    let scene = boxes_scene("shared = 0", "", "");
    let run = bench.call("inspect", "apart", &scene);
    assert_eq!(run.code, Some(2));
    assert!(run.out.contains("`one` and `two`: 18 faces"), "{}", run.out);
    let mesh = bench.path().join("apart/mesh.msh");
    let run = kluft(&["inspect".as_ref(), mesh.as_os_str()]);
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
    assert!(
        run.out.contains("2 parts of rock that share no faces"),
        "{}",
        run.out
    );
    assert!(!run.out.contains("fractures cut free"), "{}", run.out);
}
