//! Folders never hold results, meshes or statements of two runs.

use std::fs;

use serde_json::Value;

use crate::harness::{Workshop, files, kluft, summary};
use crate::resume::{kill_at, resume_without_gmsh};

/// Two boxes on one another.
const BOXES: &str = r#"
SetFactory("OpenCASCADE");
DefineConstant[ h = 0.5 ];
Box(1) = {0, 0, 0, 1, 1, 0.5}; Box(2) = {0, 0, 0.5, 1, 1, 0.5};
BooleanFragments{ Volume{1}; Delete; }{ Volume{2}; Delete; }
Mesh.MeshSizeMax = h; Mesh.MeshSizeMin = h;
Physical Volume("rock") = {1, 2};
e = 1e-4;
j() = Surface In BoundingBox{-e, -e, 0.5-e, 1+e, 1+e, 0.5+e}; Physical Surface("joint") = j();
t() = Surface In BoundingBox{-e, -e, 1-e, 1+e, 1+e, 1+e}; Physical Surface("top") = t();
b() = Surface In BoundingBox{-e, -e, -e, 1+e, 1+e, e}; Physical Surface("bottom") = b();
"#;

const ADAPTED: &str = "adapt = { tolerance = 0.01, max_unknowns = 3e3, max_rounds = 3 }";

/// The boxes under a traction, kN/m2, along the joint and across it.
fn scene(mesh: &str, traction: [f64; 2], steps: usize) -> String {
    let [along, across] = traction.map(|value| 1e3 * value);
    format!(
        "[mesh]\ngeometry = \"boxes.geo\"\n{mesh}\n\
         [rock.rock]\nyoung_modulus = 50e9\npoisson_ratio = 0.25\n\
         [fracture.joint]\naperture = 1e-3\nnormal_stiffness = 2e10\nshear_stiffness = 1e10\n\
         friction_angle = 30\n\
         [boundary.bottom]\ndisplacement = {{ x = 0, y = 0, z = 0 }}\n\
         [boundary.top]\ntraction = [{along}, 0, {across}]\n\
         [[load.phase]]\nname = \"pressing\"\nuntil = 1.0\nsteps = {steps}\n"
    )
}

fn workshop(scene: &str) -> Workshop {
    let workshop = Workshop::of(scene);
    fs::write(workshop.path("boxes.geo"), BOXES).expect("a geometry");
    workshop
}

fn decisions(said: &Value) -> Vec<&str> {
    let decisions = said["decisions"].as_array().expect("decisions");
    decisions.iter().filter_map(Value::as_str).collect()
}

/// The block slides off on the first mesh of a search already.
#[test]
fn a_search_that_fails_leaves_nothing_of_the_run_before() {
    let pressed = scene("", [0.0, -1e3], 2);
    let workshop = workshop(&pressed);
    workshop.solve("out", &[]);
    let pushed = scene(ADAPTED, [2e3, -1e3], 2);
    fs::write(workshop.scene(), pushed).expect("a scene");
    let run = workshop.run("out", &[]);
    assert_eq!(run.code, Some(1), "{}", run.err);
    assert!(!run.out.contains("rock.pvd"), "{}", run.out);
    let left = files(&workshop.path("out"));
    for name in [
        "rock_0001.vtu",
        "rock.pvd",
        "results.vtm",
        "history.csv",
        "resume.bin",
    ] {
        assert!(!left.contains_key(name), "{name}");
    }
    let said = summary(&workshop.path("out"));
    assert_eq!(said["steps"], Value::Array(Vec::new()));
    fs::write(workshop.scene(), pressed).expect("a scene");
    let run = workshop.run("out", &["--resume", "-v"]);
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
    assert!(run.out.contains("from the beginning"), "{}", run.out);
}

/// What is said of the linear solver is of the mesh that results are of, also after an
/// interruption, and that mesh stays where an inspection asks gmsh for the first one.
#[test]
fn what_is_said_of_an_adapted_mesh_is_said_of_the_last_one() {
    let workshop = workshop(&scene(ADAPTED, [1e2, -1e3], 12));
    let out = workshop.solve("out", &[]);
    let said = summary(&out);
    let of_solver = |said: &str| said.starts_with("linear solver: ");
    let told = decisions(&said);
    assert_eq!(
        told.iter().filter(|text| of_solver(text)).count(),
        1,
        "{told:?}"
    );
    let mesh = fs::read(out.join("mesh.msh")).expect("a mesh");
    let file = workshop.scene();
    let inspected = kluft(&[
        "inspect".as_ref(),
        file.as_os_str(),
        "--out".as_ref(),
        out.as_os_str(),
    ]);
    assert_eq!((inspected.code, inspected.err.as_str()), (Some(0), ""));
    assert!(mesh == fs::read(out.join("mesh.msh")).expect("a mesh"));
    fs::rename(&out, workshop.path("whole")).expect("renamed");
    kill_at(&workshop, "resume.bin");
    let run = resume_without_gmsh(&workshop, "out");
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
    let resumed = summary(&out);
    assert_eq!(decisions(&resumed), told);
    assert_eq!(resumed["provenance"]["gmsh"], said["provenance"]["gmsh"]);
    let unknowns = |said: &Value| -> Vec<Value> {
        let meshes = said["meshes"].as_array().expect("meshes").iter();
        meshes.map(|mesh| mesh["unknowns"].clone()).collect()
    };
    assert_eq!(unknowns(&resumed), unknowns(&said));
    // A file of the last mesh is the same to the choice of a solver.
    let of_file =
        scene("", [1e2, -1e3], 12).replace("geometry = \"boxes.geo\"", "file = \"m.msh\"");
    fs::write(workshop.path("m.msh"), mesh).expect("a mesh");
    fs::write(workshop.scene(), of_file).expect("a scene");
    let alone = summary(&workshop.solve("alone", &[]));
    let alone = decisions(&alone);
    let first = told.iter().find(|text| of_solver(text)).expect("a solver");
    assert!(alone.contains(first), "{first}: {alone:?}");
}

/// Units and names go with the grids of every stage of a body.
#[test]
fn grids_of_stages_tell_their_units() {
    let stages = "[[load.phase]]\nname = \"digging\"\nuntil = 2.0\nremove = [\"lid\"]\n";
    let workshop = workshop(&(scene("", [0.0, 0.0], 1) + stages));
    let geometry = BOXES.replace(
        "Physical Volume(\"rock\") = {1, 2};",
        "Physical Volume(\"rock\") = {1}; Physical Volume(\"lid\") = {2};",
    );
    fs::write(workshop.path("boxes.geo"), geometry).expect("a geometry");
    let text = fs::read_to_string(workshop.scene()).expect("a scene");
    fs::write(
        workshop.scene(),
        text.replace("[rock.rock]", "[rock.default]"),
    )
    .expect("a scene");
    let out = workshop.solve("out", &[]);
    for name in ["rock_0001.vtu", "rock_0002.vtu"] {
        let grid = fs::read(out.join(name)).expect("a grid");
        let grid = String::from_utf8_lossy(&grid);
        assert!(grid.contains("unit of displacement: m"), "{name}");
    }
}
