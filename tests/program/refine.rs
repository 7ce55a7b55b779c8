//! `[mesh] refine`: against gmsh's own refinement, a uniform stress, and what an inspection counts.

use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::Value;
use tempfile::TempDir;

use crate::harness::{Run, kluft, scratch, summary};

/// A cube with a plane joint, `through` it or ending inside, and walls with names.
const BOX: &str = r#"
SetFactory("OpenCASCADE");
DefineConstant[ through = 1 ];
Box(1) = {0, 0, 0, 1, 1, 1}; s = news; Rectangle(s) = {0, 0, 0.5, through ? 1 : 0.5, 1};
BooleanFragments{ Volume{1}; Delete; }{ Surface{s}; Delete; }
e = 1e-4;
Physical Volume("rock") = Volume{:};
a() = Surface In BoundingBox{-e, -e, 0.5-e, 1+e, 1+e, 0.5+e};
b() = Surface In BoundingBox{-e, -e, 1-e, 1+e, 1+e, 1+e};
c() = Surface In BoundingBox{-e, -e, -e, 1+e, 1+e, e};
f() = Surface In BoundingBox{-e, -e, -e, e, 1+e, 1+e};
g() = Surface In BoundingBox{1-e, -e, -e, 1+e, 1+e, 1+e};
h() = Surface In BoundingBox{-e, -e, -e, 1+e, e, 1+e};
i() = Surface In BoundingBox{-e, 1-e, -e, 1+e, 1+e, 1+e};
Physical Surface("joint") = a(); Physical Surface("top") = b(); Physical Surface("bottom") = c();
Physical Surface("west") = f(); Physical Surface("east") = g();
Physical Surface("south") = h(); Physical Surface("north") = i();
Mesh.MeshSizeMax = 0.35; Mesh.MshFileVersion = 4.1;
"#;

/// A ball, whose surface is curved.
const BALL: &str = r#"
SetFactory("OpenCASCADE");
Sphere(1) = {0, 0, 0, 1};
Physical Volume("rock") = {1}; Physical Surface("outside") = Surface{:};
Mesh.MeshSizeMax = 0.5; Mesh.MshFileVersion = 4.1;
"#;

const ROCK: &str = "[rock.default]\nyoung_modulus = 50e9\npoisson_ratio = 0.25\n";
const JOINT: &str =
    "[fracture.joint]\naperture = 1e-3\nnormal_stiffness = 1e11\nshear_stiffness = 1e10\n";
const LOADS: &str =
    "[boundary.bottom]\ndisplacement = { z = 0.0 }\n[boundary.top]\npressure = 7e6\n";
/// Walls that slide along the box.
const WALLS: &str = "[boundary.west]\ndisplacement = { x = 0.0 }\n[boundary.east]\ndisplacement = { x = 0.0 }\n[boundary.south]\ndisplacement = { y = 0.0 }\n[boundary.north]\ndisplacement = { y = 0.0 }\n";

/// A folder with a geometry, and meshes of gmsh.
struct Bench(TempDir);

impl Bench {
    fn new(geometry: &str) -> Self {
        let folder = scratch();
        fs::write(folder.path().join("body.geo"), geometry).expect("a geometry");
        Self(folder)
    }

    fn path(&self) -> &Path {
        self.0.path()
    }

    fn gmsh(&self, arguments: &[&str]) {
        let gmsh = std::env::var("KLUFT_GMSH").unwrap_or_else(|_| "gmsh".into());
        let output = Command::new(gmsh)
            .args(arguments)
            .current_dir(self.path())
            .output();
        assert!(output.expect("gmsh starts").status.success());
    }

    fn call(&self, command: &[&str], name: &str, scene: &str) -> Run {
        let file = self.path().join(format!("{name}.toml"));
        fs::write(&file, scene).expect("a scene");
        let (file, out) = (file.display().to_string(), self.path().join(name));
        let out = out.display().to_string();
        kluft(&[command, &[&file, "--out", &out]].concat())
    }

    fn solved(&self, name: &str, scene: &str) -> Value {
        let run = self.call(&["run"], name, scene);
        assert_eq!((run.code, run.err.as_str()), (Some(0), ""), "{name}");
        summary(&self.path().join(name))
    }

    fn inspected(&self, name: &str, scene: &str) -> Value {
        let run = self.call(&["inspect", "--json"], name, scene);
        assert_eq!((run.code, run.err.as_str()), (Some(0), ""), "{name}");
        serde_json::from_str(&run.out).expect("JSON")
    }
}

fn scene(mesh: &str) -> String {
    format!("[mesh]\n{mesh}\n{ROCK}{JOINT}{LOADS}{WALLS}")
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value}"))
}

/// Between sliding walls the stress across the joint is the pressure on top, on any mesh.
#[test]
fn a_uniform_stress_stays_uniform() {
    let bench = Bench::new(BOX);
    for order in [1, 2] {
        let mesh = format!("geometry = \"body.geo\"\norder = {order}\nrefine = 1");
        let summary = bench.solved(&format!("order-{order}"), &scene(&mesh));
        let joint = &summary["fractures"]["joint"];
        assert!((number(&joint["area"]) - 1.0).abs() < 1e-12);
        // A linear law opens by p / k_n, and the rock of 50 GPa rounds at 1e-12 of its strain.
        let expected = 1e-3 - 7e6 / 1e11;
        for kind in ["min", "mean", "max"] {
            let aperture = number(&joint["aperture"][kind]);
            assert!((aperture - expected).abs() < 1e-9 * expected, "{joint}");
        }
    }
}

/// gmsh divides the same mesh into as many cells, some octahedra along other diagonals: apertures
/// differ by less than half of what they differ from those of the coarse mesh.
#[test]
fn gmsh_refines_to_the_same_counts_and_nearly_the_same_apertures() {
    let bench = Bench::new(BOX);
    let coarse = "coarse.msh";
    bench.gmsh(&["body.geo", "-3", "-setnumber", "through", "0", "-o", coarse]);
    bench.gmsh(&[coarse, "-refine", "-o", "fine.msh"]);
    let held = "[boundary.bottom]\ndisplacement = { x = 0.0, y = 0.0, z = 0.0 }\n";
    let scene = |mesh: &str| {
        let loads = "[boundary.top]\ntraction = [2e6, 0, -7e6]\n";
        format!("[mesh]\n{mesh}\n{ROCK}{JOINT}{held}{loads}")
    };
    let before = bench.solved("before", &scene("file = \"coarse.msh\""));
    let own = bench.solved("own", &scene("file = \"coarse.msh\"\nrefine = 1"));
    let other = bench.solved("other", &scene("file = \"fine.msh\""));
    assert_eq!(own["mesh"], other["mesh"]);
    assert_eq!(own["unknowns"], other["unknowns"]);
    let [before, own, other] = [before, own, other].map(|summary| {
        let joint = &summary["fractures"]["joint"];
        ["mean", "min"].map(|kind| 1e-3 - number(&joint["aperture"][kind]))
    });
    for kind in 0..2 {
        let by_diagonals = (own[kind] - other[kind]).abs();
        let by_size = (own[kind] - before[kind]).abs();
        assert!(by_diagonals < 0.5 * by_size, "{before:?} {own:?} {other:?}");
    }
}

#[test]
fn an_inspection_counts_the_refined_mesh_and_its_cells_stay_good() {
    let bench = Bench::new(BOX);
    bench.gmsh(&["body.geo", "-3", "-o", "coarse.msh"]);
    let inspected = |times: u32| {
        let mesh = format!("file = \"coarse.msh\"\nrefine = {times}");
        bench.inspected(&format!("times-{times}"), &scene(&mesh))
    };
    let coarse = inspected(0);
    let quality = |found: &Value| {
        let cells = &found["cells"];
        [&cells["worst"][0]["quality"], &cells["mean_quality"]].map(number)
    };
    let [worst, mean] = quality(&coarse);
    for times in 1..=3 {
        let found = inspected(times);
        let counts =
            |found: &Value| [&found["mesh"]["cells"], &found["mesh"]["facets"]].map(number);
        let factors = [8_f64.powi(times as i32), 4_f64.powi(times as i32)];
        for ((before, after), factor) in counts(&coarse).iter().zip(counts(&found)).zip(factors) {
            assert_eq!(factor * before, after);
        }
        let [finer_worst, finer_mean] = quality(&found);
        // The inner tetrahedra are less regular: so much, and hardly more from then on.
        assert!(finer_worst > 0.75 * worst, "{finer_worst} after {worst}");
        assert!(finer_mean > 0.95 * mean, "{finer_mean} after {mean}");
    }
}

#[test]
fn the_answer_does_not_depend_on_threads() {
    let bench = Bench::new(BOX);
    bench.gmsh(&[
        "body.geo",
        "-3",
        "-setnumber",
        "through",
        "0",
        "-o",
        "coarse.msh",
    ]);
    let text = scene("file = \"coarse.msh\"\nrefine = 2");
    let solved = |threads: &str| {
        let run = bench.call(&["run", "--threads", threads], threads, &text);
        assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
        let folder = bench.path().join(threads);
        let grids = fs::read_dir(&folder).expect("results").flatten();
        let mut grids: Vec<_> = grids
            .map(|entry| entry.path())
            .filter(|path| path.extension().is_some_and(|end| end == "vtu"))
            .collect();
        grids.sort();
        assert!(!grids.is_empty());
        let bytes = grids.iter().map(|path| fs::read(path).expect("a grid"));
        bytes.collect::<Vec<_>>()
    };
    assert!(solved("1") == solved("2"), "grids differ");
}

#[test]
fn curved_surfaces_of_linear_cells_are_said_to_stay_faceted() {
    let bench = Bench::new(BALL);
    let solved = |order: i32| {
        let mesh = format!("geometry = \"body.geo\"\norder = {order}\nrefine = 1");
        let scene = format!(
            "[mesh]\n{mesh}\n{ROCK}[boundary.outside]\ndisplacement = {{ x = 1e-3, y = 0.0, z = 0.0 }}\n"
        );
        bench.solved(&format!("order-{order}"), &scene)["decisions"].to_string()
    };
    let said = solved(1);
    assert!(said.contains("`outside`: facets meet at angles"), "{said}");
    assert!(said.contains("each cell divided into 8, once: "), "{said}");
    assert!(!solved(2).contains("facets meet"));
}

/// Defects name the cells of the file, not their parts.
#[test]
fn a_broken_mesh_is_refused_in_its_own_numbers() {
    let bench = Bench::new(BOX);
    bench.gmsh(&["body.geo", "-3", "-o", "coarse.msh"]);
    let text = scene("file = \"coarse.msh\"\nrefine = 2");
    let renamed = text.replace("[fracture.joint]", "[fracture.top]");
    let renamed = renamed.replace("[boundary.top]\npressure = 7e6\n", "");
    let run = bench.call(&["run"], "outside", &renamed);
    assert_eq!(run.code, Some(2), "{}", run.err);
    let coarse = renamed.replace("refine = 2", "refine = 0");
    let coarse = bench.call(&["run"], "coarse", &coarse);
    let after_name = |text: &str| text.split_once(':').map(|(_, rest)| rest.to_owned());
    assert_eq!(
        after_name(&run.err.replace("outside", "")),
        after_name(&coarse.err.replace("coarse", ""))
    );
}
