//! `history.csv`: forces balance, means follow closed forms, blocks move as they should.

use std::collections::BTreeMap;
use std::path::Path;

use crate::harness::Workshop;

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
