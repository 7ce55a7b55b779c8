//! Probes, against a closed form.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use crate::harness::{Workshop, kluft};

/// The rows of `probes.csv`; each maps columns to texts.
fn rows(out: &Path) -> Vec<BTreeMap<String, String>> {
    let text = fs::read_to_string(out.join("probes.csv")).expect("the probes");
    let mut table = csv::Reader::from_reader(text.as_bytes());
    let rows = table.deserialize().collect::<Result<Vec<_>, _>>();
    rows.expect("a table")
}

fn number(row: &BTreeMap<String, String>, column: &str) -> f64 {
    let text = &row[column];
    text.parse()
        .unwrap_or_else(|_| panic!("{column}: {text:?}"))
}

fn of<'a>(rows: &'a [BTreeMap<String, String>], probe: &str) -> Vec<&'a BTreeMap<String, String>> {
    let own = rows.iter().filter(|row| row["probe"] == probe);
    own.collect()
}

/// Plane strain under `stress_xx = -P - 9810 (10 - z)` alone (see the scene): `u_x` is `(1 -
/// nu^2) / E stress_xx x`, and less by the closure of 1e-4 m beyond the joint. Cells of second
/// order have it to round-off of the displacement of the far face, 2.5e-4 m.
#[test]
fn probes_have_the_displacements_of_a_closed_form() {
    let workshop = Workshop::new("water-by-depth", &[]);
    let rows = rows(&workshop.solve("out", &[]));
    let middle = of(&rows, "middle");
    assert_eq!(middle.len(), 4);
    for row in middle {
        let x = number(row, "x");
        let strain = 0.9375 / 25e9 * -(2e6 + 9810.0 * 5.0);
        let closure = if x > 1.0 { 1e-4 } else { 0.0 };
        let error = number(row, "displacement_x") - (strain * x - closure);
        assert!(error.abs() < 1e-12, "at {x}: {error:e}");
        // Means of cells of 1 m, and of stresses that differ by 9810 Pa in a metre.
        let stress = number(row, "stress_xx");
        assert!((stress + 2.049_05e6).abs() < 9810.0, "{stress}");
        assert!((number(row, "strain_xx") / strain - 1.0).abs() < 5e-3);
        let [low, high] = ["principal_min", "principal_max"].map(|column| number(row, column));
        assert!(
            (low / stress - 1.0).abs() < 1e-9 && high.abs() < 1.0,
            "{low} {high}"
        );
        assert_eq!(row["aperture"], "");
    }
    let joint = of(&rows, "joint");
    assert_eq!(joint.len(), 6);
    for row in joint {
        assert!((number(row, "aperture") / 4e-4 - 1.0).abs() < 1e-9);
        assert!((number(row, "normal_traction") / -2e6 - 1.0).abs() < 1e-9);
        assert!((number(row, "jump_x").abs() / 1e-4 - 1.0).abs() < 1e-9);
        assert_eq!(row["stress_xx"], "");
    }
}

/// A mean is that of the points; each load step has its rows, and a resumed run the same bytes.
#[test]
fn means_and_steps_of_probes() {
    let edits = [
        ("count = 4", "count = 4\nmean = true"),
        ("[mesh]", "[load]\nsteps = [0.5, 1.0]\n[mesh]"),
    ];
    let workshop = Workshop::new("water-by-depth", &edits);
    let out = workshop.solve("out", &[]);
    let all = rows(&out);
    let middle = of(&all, "middle");
    assert_eq!(middle.len(), 2);
    let strain = 0.9375 / 25e9 * -(2e6 + 9810.0 * 5.0);
    for (row, load) in middle.into_iter().zip([0.5, 1.0]) {
        assert_eq!(row["point"], "mean");
        let error = number(row, "displacement_x") - load * (strain - 0.5e-4);
        assert!(error.abs() < 1e-12, "{error:e}");
    }
    let text = fs::read(out.join("probes.csv")).expect("the probes");
    let run = workshop.run("out", &["--resume"]);
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
    assert_eq!(fs::read(out.join("probes.csv")).expect("the probes"), text);
    // A run without probes leaves none behind.
    let scene = fs::read_to_string(workshop.scene()).expect("the scene");
    let without = scene.split("# Along the middle").next().expect("a text");
    let rest = scene.split("# The left face").nth(1).expect("a text");
    fs::write(workshop.scene(), format!("{without}# The left face{rest}")).expect("written");
    workshop.solve("out", &[]);
    assert!(!out.join("probes.csv").exists());
}

#[test]
fn an_inspection_tells_what_probes_hit() {
    let workshop = Workshop::new("water-by-depth", &[]);
    let run = kluft(&["inspect".as_ref(), workshop.scene().as_os_str()]);
    assert_eq!(run.code, Some(0), "{}", run.err);
    for text in [
        "[probe.middle]: 4 points in the rock",
        "[probe.joint]: 6 nodes of `joint`",
    ] {
        assert!(run.out.contains(text), "{text}: {}", run.out);
    }
}

/// The scene's closed form again: the right face moves by the strain under the mean stress and the
/// closure of the joint, which has 4e-4 m and -2e6 Pa everywhere.
#[test]
fn means_over_surfaces_have_the_closed_form() {
    let workshop = Workshop::new("water-by-depth", &[]);
    let rows = rows(&workshop.solve("out", &[]));
    let face = of(&rows, "face");
    assert_eq!((face.len(), face[0]["point"].as_str()), (1, "mean"));
    let strain = 0.9375 / 25e9 * -(2e6 + 9810.0 * 5.0);
    let error = number(face[0], "displacement_x") - (2.0 * strain - 1e-4);
    assert!(error.abs() < 1e-12, "{error:e}");
    // Cells behind the face have their centres where they like, and the stress 9810 Pa in a metre.
    let stress = number(face[0], "stress_xx");
    assert!((stress + 2.049_05e6).abs() < 2e3, "{stress}");
    for (axis, middle) in [("x", 2.0), ("z", 5.0)] {
        assert!((number(face[0], axis) - middle).abs() < 1e-12);
    }
    let whole = of(&rows, "whole");
    assert_eq!((whole.len(), whole[0]["point"].as_str()), (1, "mean"));
    assert!((number(whole[0], "aperture") / 4e-4 - 1.0).abs() < 1e-9);
    assert!((number(whole[0], "normal_traction") / -2e6 - 1.0).abs() < 1e-9);
    assert_eq!(whole[0]["displacement_x"], "");
    assert!(!whole[0].contains_key("pressure"), "nothing flows");
}

/// Nothing holds the upper slab down, so its top, which no condition names, rises by the mean
/// opening of the joint: the stress in the slabs has no mean (virtual work of `u_z = z`).
#[test]
fn a_free_surface_rises_by_what_a_fluid_opens() {
    let probes = "[probe.top]\nboundary = \"top\"\n[probe.joint]\nfracture = \"joint\"\n\
                  [probe.inlet]\nfracture = \"joint\"\nat = [0, 0, 0.5]\n\n[load]";
    let edits = [("[load]", probes), ("first = 0.1", "first = 1.0")];
    let rows = rows(&Workshop::new("filling-joint", &edits).solve("out", &[]));
    let pairs = of(&rows, "top").into_iter().zip(of(&rows, "joint"));
    for (top, joint) in pairs {
        let opened = number(joint, "aperture") - 1e-5;
        let rise = number(top, "displacement_z");
        assert!((rise / opened - 1.0).abs() < 1e-6, "{rise} {opened}");
        assert_eq!(
            (top["pressure"].as_str(), joint["step"].as_str()),
            ("", top["step"].as_str())
        );
        // Of a linear joint without load from outside.
        let carried = number(joint, "pressure");
        assert!((carried / (1e11 * opened) - 1.0).abs() < 1e-6, "{carried}");
    }
    let inlet = of(&rows, "inlet");
    assert_eq!(inlet.len(), 10);
    for row in inlet {
        assert!((number(row, "pressure") / 0.9e6 - 1.0).abs() < 1e-9);
        assert_eq!(row["hydraulic_aperture"], row["aperture"]);
    }
}

/// Water at rest in rigid rock: the pressure is that of the depth, linear, so its mean too.
#[test]
fn rigid_rock_has_probes_on_fractures_only() {
    let probes = "[probe.down]\nfracture = \"joint\"\nfrom = [0.06, 0.5, 10]\nto = [0.94, 0.5, 0]\n\
                  [probe.bed]\nfracture = \"bed\"\n\n[boundary.top]";
    let workshop = Workshop::new("standing-water", &[("[boundary.top]", probes)]);
    let rows = rows(&workshop.solve("out", &[]));
    let down = of(&rows, "down");
    assert_eq!(down.len(), 11);
    for row in down {
        let error = number(row, "pressure") - 9810.0 * (10.0 - number(row, "z"));
        assert!(error.abs() < 1e-3, "{error}");
        assert_eq!(number(row, "aperture"), 2e-4);
        assert_eq!(
            (row["opening"].as_str(), row["stress_xx"].as_str()),
            ("", "")
        );
    }
    let bed = of(&rows, "bed");
    assert!((number(bed[0], "pressure") - 9810.0 * 6.0).abs() < 1e-3);
    assert!((number(bed[0], "aperture") / 5e-5 - 1.0).abs() < 1e-12);
    for wrong in ["at = [0.5, 0.5, 5]", "boundary = \"top\""] {
        let probe = format!("[probe.a]\n{wrong}\n[boundary.top]");
        let run = Workshop::new("standing-water", &[("[boundary.top]", &probe)]).run("out", &[]);
        assert_eq!(run.code, Some(2));
        for said in ["[probe.a]", "rigid rock", "`fracture`"] {
            assert!(run.err.contains(said), "{said}: {}", run.err);
        }
    }
}
