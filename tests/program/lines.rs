//! Lines within fractures along which fluid is driven, beside closed forms.

use std::fs;
use std::path::Path;

use crate::harness::{Workshop, summary};

/// A joint of 2 m by 1 m half way up a block, with edges along x = 0.5 m.
const GEOMETRY: &str = r#"
SetFactory("OpenCASCADE");
eps = 1e-4;
Box(1) = {0, 0, 0, 2, 1, 1};
a = news; Rectangle(a) = {0, 0, 0.5, 0.5, 1};
b = news; Rectangle(b) = {0.5, 0, 0.5, 1.5, 1};
BooleanFragments{ Volume{1}; Delete; }{ Surface{a, b}; Delete; }
left() = Surface In BoundingBox {-eps, -eps, -eps, eps, 1 + eps, 1 + eps};
right() = Surface In BoundingBox {2 - eps, -eps, -eps, 2 + eps, 1 + eps, 1 + eps};
joint() = Surface In BoundingBox {-eps, -eps, 0.5 - eps, 2 + eps, 1 + eps, 0.5 + eps};
slot() = Curve In BoundingBox {0.5 - eps, -eps, 0.5 - eps, 0.5 + eps, 1 + eps, 0.5 + eps};
Physical Volume("rock") = Volume{:};
Physical Surface("left") = {left()};
Physical Surface("right") = {right()};
Physical Surface("joint") = {joint()};
Physical Curve("slot") = {slot()};
MeshSize{:} = 0.23;
"#;

const SCENE: &str = r#"
[mesh]
geometry = "joint.geo"

[fluid]
viscosity = 1e-3

[fracture.joint]
aperture = 1e-4

[boundary.left]
fluid_pressure = 0.0

[boundary.right]
fluid_pressure = 0.0

[[source]]
name = "line"
"#;

const TRANSMISSIVITY: f64 = 1e-12 / 12e-3;

fn workshop(source: &str) -> Workshop {
    let workshop = Workshop::of(&format!("{SCENE}{source}\n"));
    fs::write(workshop.path("joint.geo"), GEOMETRY).expect("the geometry is written");
    workshop
}

/// Rates of the left and the right side, and pressure and rate of the line.
fn solved(out: &Path) -> [f64; 4] {
    let text = fs::read_to_string(out.join("sources.csv")).expect("sources.csv");
    let of = |name: &str, column: usize| {
        let row = text.lines().find(|line| line.contains(name));
        let cell = row.and_then(|row| row.split(',').nth(column));
        cell.and_then(|cell| cell.parse().ok()).expect("a number")
    };
    let [left, right] = ["[boundary.left]", "[boundary.right]"].map(|name| of(name, 4));
    [left, right, of("line", 3), of("line", 4)]
}

fn is_close(found: f64, expected: f64, tolerance: f64) {
    let error = (found - expected).abs();
    assert!(error <= tolerance * expected.abs(), "{found} {expected}");
}

/// What enters at `x` leaves on the right by the share `x / 2`, whatever the mesh: linear functions
/// are in the space of the pressures. Along edges the pressure is exact, `q (x (2 - x)) / (2 T)`.
#[test]
fn a_line_feeds_a_joint_by_its_length() {
    let [left, right, pressure, rate] =
        solved(&workshop("curve = \"slot\"\nrate = 1e-6").solve("out", &[]));
    is_close(rate, 1e-6, 0.0);
    is_close(left, -0.75e-6, 1e-10);
    is_close(right, -0.25e-6, 1e-10);
    is_close(pressure, 1e-6 * 0.5 * 1.5 / (2.0 * TRANSMISSIVITY), 1e-10);
    let bent = "points = [[0.3, 0, 0.5], [0.7, 0.3, 0.5], [0.7, 1, 0.5]]\nrate = -2e-6";
    let [left, right, ..] = solved(&workshop(bent).solve("out", &[]));
    // Lengths 0.5 and 0.7 m, their middles at 0.5 and 0.7 m.
    let middle = (0.5 * 0.5 + 0.7 * 0.7) / 1.2;
    is_close(right, 1e-6 * middle, 1e-6);
    is_close(left + right, 2e-6, 1e-10);
}

/// A pressure of 1 kPa along edges; what of a line lies outside of fractures is told.
#[test]
fn a_line_has_its_pressure() {
    for source in [
        "curve = \"slot\"\npressure = 1e3",
        "points = [[0.5, 0, 0.5], [0.5, 1, 0.5], [0.5, 3, 0.5]]\npressure = 1e3",
    ] {
        let workshop = workshop(source);
        let out = workshop.solve("out", &[]);
        let [left, right, pressure, _] = solved(&out);
        is_close(left, -TRANSMISSIVITY * 1e3 / 0.5, 1e-10);
        is_close(right, -TRANSMISSIVITY * 1e3 / 1.5, 1e-10);
        is_close(pressure, 1e3, 0.0);
        let said = summary(&out)["decisions"].to_string();
        let is_told = said.contains("1.0000e0 m of its 3.0000e0 m lie in fractures");
        assert_eq!(is_told, source.contains("points"), "{said}");
    }
}

#[test]
fn lines_that_mean_nothing_are_refused() {
    for (source, said) in [
        ("curve = \"slit\"\nrate = 1", "did you mean `slot`?"),
        ("curve = \"slot\"\nradius = 0.1\nrate = 1", "radius"),
        (
            "points = [[0.5, 0.5, 0], [0.5, 0.5, 1]]\nrate = 1",
            "a borehole that crosses fractures has from, to and radius",
        ),
        (
            "points = [[0.3, 0, 0.5], [0.7, 1, 0.5]]\npressure = 1",
            "no node has it",
        ),
        (
            "points = [[0, 0, 0.5]]\nrate = 1",
            "the points make no line",
        ),
        (
            "points = [[0, 0, 0.5], [1, 0, 0.5]]\ncurve = \"slot\"\nrate = 1",
            "both curve and points",
        ),
    ] {
        let run = workshop(source).run("out", &[]);
        assert_eq!(run.code, Some(2), "{source}: {}", run.err);
        assert!(run.err.contains(said), "{source}: {}", run.err);
    }
}
