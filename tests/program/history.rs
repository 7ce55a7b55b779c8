//! `history.csv`: forces balance, means follow closed forms, blocks move as they should.

use std::collections::BTreeMap;
use std::path::Path;

use serde_json::Value;

use crate::harness::{Workshop, summary};

/// The rows of a history; each maps columns to texts.
fn rows(out: &Path) -> Vec<BTreeMap<String, String>> {
    let text = std::fs::read_to_string(out.join("history.csv")).expect("a history");
    let mut table = csv::Reader::from_reader(text.as_bytes());
    let rows = table.deserialize().collect::<Result<Vec<_>, _>>();
    rows.expect("a table")
}

fn number(row: &BTreeMap<String, String>, column: &str) -> f64 {
    let text = &row[column];
    text.parse()
        .unwrap_or_else(|_| panic!("{column}: {text:?}"))
}

fn vector(row: &BTreeMap<String, String>, quantity: &str) -> [f64; 3] {
    ["x", "y", "z"].map(|axis| number(row, &format!("{quantity}_{axis}")))
}

fn find<'a>(
    rows: &'a [BTreeMap<String, String>],
    kind: &str,
    name: &str,
) -> &'a BTreeMap<String, String> {
    let found = rows
        .iter()
        .find(|row| row["kind"] == kind && row["name"] == name);
    found.unwrap_or_else(|| panic!("no {kind} {name}"))
}

fn assert_close(found: [f64; 3], expected: [f64; 3], scale: f64) {
    for (found_one, expected_one) in found.into_iter().zip(expected) {
        let is_close = (found_one - expected_one).abs() <= 1e-6 * scale;
        assert!(is_close, "{found:?}, expected {expected:?}");
    }
}

/// A cube of 1 m under -2.5, -5 and -10 MPa: forces are stresses times 1 m^2, and the faces move as
/// the closed forms of the scene say.
#[test]
fn a_cube_of_blocks_tells_its_loads_reactions_and_motions() {
    let workshop = Workshop::new("three-planes", &[]);
    let rows = rows(&workshop.solve("out", &[]));
    let force = |name: &str| vector(find(&rows, "boundary", name), "force");
    for (name, expected) in [
        ("right", [-2.5e6, 0.0, 0.0]),
        ("left", [2.5e6, 0.0, 0.0]),
        ("back", [0.0, -5e6, 0.0]),
        ("front", [0.0, 5e6, 0.0]),
        ("top", [0.0, 0.0, -10e6]),
        ("bottom", [0.0, 0.0, 10e6]),
    ] {
        assert_close(force(name), expected, 10e6);
    }
    let moved = |name: &str| vector(find(&rows, "boundary", name), "displacement");
    assert!((moved("right")[0] - 1.022628e-5).abs() < 1e-10);
    assert!((moved("top")[2] + 3.981879e-4).abs() < 1e-10);
    let plane = find(&rows, "fracture", "z_plane");
    assert!((number(plane, "aperture_mean") - 2.681209e-5).abs() < 1e-10);
    assert!((vector(plane, "force")[2].abs() - 10e6).abs() < 10.0);
    assert_eq!(number(plane, "closed_area"), number(plane, "area"));
    let blocks: Vec<_> = rows.iter().filter(|row| row["kind"] == "block").collect();
    assert_eq!(blocks.len(), 8);
    let volume: f64 = blocks.iter().map(|row| number(row, "volume")).sum();
    assert!((volume - 1.0).abs() < 1e-12);
    assert!(blocks.iter().all(|row| number(row, "rotation") < 1e-9));
}

/// What acts on the surface carries the weight, in each load step, wherever fractures cut it, with
/// cells of either order.
#[test]
fn forces_on_the_surface_balance_the_weight() {
    for order in ["1", "2"] {
        let mesh = format!("order = {order}\nparameters = {{ h = 0.6");
        let edits = [
            (
                "[fracture.default]",
                "[body]\ngravity = [0.0, 1.0, -9.81]\n\n[load]\nsteps = [0.5, 1.0]\n\n[fracture.default]",
            ),
            (
                "poisson_ratio = 0.25",
                "poisson_ratio = 0.25\ndensity = 2700.0",
            ),
            ("parameters = { h = 0.2", &mesh),
        ];
        let workshop = Workshop::new("closing-blocks", &edits);
        let rows = rows(&workshop.solve("out", &[]));
        for (step, share) in [("1", 0.5), ("2", 1.0)] {
            let mut sum = [0.0; 3];
            for row in rows
                .iter()
                .filter(|row| row["step"] == step && row["kind"] == "boundary")
            {
                let force = vector(row, "force");
                sum = std::array::from_fn(|axis| sum[axis] + force[axis]);
            }
            let weight = share * 2700.0 * 24.0;
            assert_close(sum, [0.0, -weight, 9.81 * weight], 1e8);
        }
    }
}

/// What has entered a joint that fills is what it has opened, `A (b - b_0)`, and the similarity
/// solution (Wijesinghe 1986) has 1.8683e-5 m3; the fluid is at 0.9 MPa where it enters.
#[test]
fn a_joint_that_fills_tells_what_enters_and_its_pressures() {
    let workshop = Workshop::new("filling-joint", &[]);
    let out = workshop.solve("out", &[]);
    let all = rows(&out);
    let of_kind = |kind: &str| -> Vec<_> { all.iter().filter(|row| row["kind"] == kind).collect() };
    let (sources, joints) = (of_kind("source"), of_kind("fracture"));
    assert_eq!((sources.len(), joints.len()), (10, 10));
    for (source, joint) in sources.iter().zip(&joints) {
        assert_eq!(
            (&source["name"], &joint["name"]),
            (&"[boundary.inlet]".into(), &"joint".into())
        );
        let opened = number(joint, "area") * (number(joint, "aperture_mean") - 1e-5);
        let entered = number(source, "volume");
        assert!((entered / opened - 1.0).abs() < 1e-3, "{entered} {opened}");
        for pressure in [number(source, "pressure"), number(joint, "pressure_max")] {
            assert!((pressure / 0.9e6 - 1.0).abs() < 1e-12, "{pressure}");
        }
    }
    let entered = number(sources[9], "volume");
    assert!((entered / 1.8683e-5 - 1.0).abs() < 3e-3, "{entered}");
    let step = of_kind("step")[9];
    assert!((number(step, "inflow") / number(sources[9], "rate") - 1.0).abs() < 1e-12);
    assert!(number(step, "mass_error") < 1e-10);
    let before = std::fs::read(out.join("history.csv")).expect("a history");
    let run = workshop.run("out", &["--resume"]);
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
    assert_eq!(
        std::fs::read(out.join("history.csv")).expect("a history"),
        before
    );
}

/// The summary has the fractures of every step: the traction across `z_plane` is the load, and its
/// aperture at the end that of the scene's closed form. Beside the history nothing differs.
#[test]
fn the_summary_has_the_fractures_of_every_step() {
    let edits = [("[mesh]", "[load]\nsteps = [0.5, 1.0]\n\n[mesh]")];
    let workshop = Workshop::new("three-planes", &edits);
    let out = workshop.solve("out", &[]);
    let (rows, said) = (rows(&out), summary(&out));
    let steps = said["steps"].as_array().expect("steps");
    assert_eq!(steps.len(), 2);
    // Readers of numbers round their last digit.
    let same = |found: &Value, wanted: f64| {
        let found = found.as_f64().expect("a number");
        assert!(
            (found - wanted).abs() <= 1e-14 * wanted.abs(),
            "{found} {wanted}"
        );
    };
    for (step, load) in steps.iter().zip([0.5, 1.0]) {
        let plane = &step["fractures"]["z_plane"];
        let traction = plane["normal_traction"]["mean"].as_f64().expect("a number");
        assert!((traction / (-10e6 * load) - 1.0).abs() < 1e-9, "{plane}");
        let number_of_step = if load < 1.0 { "1" } else { "2" };
        let mut own = rows.iter();
        let row = own.find(|row| row["step"] == number_of_step && row["name"] == "z_plane");
        let row = row.expect("a row");
        for part in ["min", "mean", "max"] {
            let aperture = number(row, &format!("aperture_{part}"));
            same(&plane["aperture"][part], aperture);
        }
        same(&plane["slip_max"], number(row, "slip_max"));
        same(&plane["open_area"], number(row, "open_area"));
    }
    let aperture = &steps[1]["fractures"]["z_plane"]["aperture"]["mean"];
    assert!((aperture.as_f64().expect("a number") - 2.681209e-5).abs() < 1e-10);
}
