//! `geometries/shear-stimulation`: joints that open under an injection, of which one slips.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use crate::harness::{Workshop, summary};

/// Closing stiffness (Pa/m), aperture without load (m), shear stiffness (Pa/m), tan of the angles
/// of friction and dilation.
const NORMAL: f64 = 5e10;
const APERTURE: f64 = 1.5e-4;
const SHEAR: f64 = 2e10;
const ANGLES: [f64; 2] = [30.0, 5.0];

/// Shear traction on the dipping joint before the injection (Pa).
fn sheared() -> f64 {
    6e6 * 3_f64.sqrt() / 4.0
}

/// Rows of a table of results of one fracture or probe.
fn rows(out: &Path, file: &str, [column, name]: [&str; 2]) -> Vec<BTreeMap<String, String>> {
    let text = fs::read_to_string(out.join(file)).expect("a table");
    let mut table = csv::Reader::from_reader(text.as_bytes());
    let rows = table.deserialize().collect::<Result<Vec<_>, _>>();
    let rows: Vec<BTreeMap<String, String>> = rows.expect("a table");
    rows.into_iter().filter(|row| row[column] == name).collect()
}

fn number(row: &BTreeMap<String, String>, column: &str) -> f64 {
    row[column].parse().unwrap_or_else(|_| panic!("{column}"))
}

/// The aperture `x b0` at which `(1 + ln^2 x) (1 - x) Kn b0` is a compression (Pa), by bisection.
fn pressed(compression: f64) -> f64 {
    let carries = |x: f64| (1.0 + x.ln().powi(2)) * (1.0 - x) * NORMAL * APERTURE;
    let (mut low, mut high) = (1e-6, 1.0);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        match carries(middle) > compression {
            true => low = middle,
            false => high = middle,
        }
    }
    low * APERTURE
}

/// Walls slide where the pressure is above 3 MPa, whatever steps lead there: an effective
/// compression below `tau_0 / tan(30 degrees)`. Joints that open change the stress around by a few
/// percent.
#[test]
fn an_injection_makes_the_critical_joint_slip_and_it_alone() {
    let edits = [
        ("h = 1.5, h_joint = 0.6", "h = 2.5, h_joint = 1.2"),
        (
            "times = [1, 5, 20, 40, 60, 80, 100, 120, 140, 160, 180, 200, 220, 240, 260, 280, 300]",
            "times = [1, 5, 20, 60, 80, 100, 200, 300]",
        ),
    ];
    let workshop = Workshop::new("shear-stimulation", &edits);
    let out = workshop.solve("out", &[]);
    let said = summary(&out);
    let steps = said["steps"].as_array().expect("steps");
    assert_eq!(steps.len(), 8);
    for step in steps {
        let error = step["flow"]["mass_error"].as_f64().expect("a share");
        assert!(error <= 1e-10, "{step}");
    }
    let friction = ANGLES[0].to_radians().tan();
    let critical = sheared() / friction;
    let dipping = rows(&out, "history.csv", ["name", "dipping"]);
    let area = number(&dipping[0], "area");
    let mut conducts = 0.0;
    for row in &dipping {
        let compression = -number(row, "normal_traction_max");
        let slides = number(row, "sliding_area");
        match compression {
            held if held > 1.03 * critical => assert_eq!(slides, 0.0, "{row:?}"),
            freed if freed < 0.97 * critical => assert!(slides > 0.5 * area, "{row:?}"),
            _ => {}
        }
        let aperture = number(row, "aperture_mean");
        assert!(aperture > conducts, "{row:?}");
        conducts = aperture;
    }
    assert!(number(&dipping[7], "slip_max") > 1e-4);
    for name in ["bed", "steep"] {
        let all = rows(&out, "history.csv", ["name", name]);
        assert!(
            all.iter().all(|row| number(row, "sliding_area") == 0.0),
            "{name}"
        );
    }
    opens_by_its_slip(&out, friction);
}

/// In the middle of the joint friction is at its limit, and the aperture is that of the law and the
/// dilation.
fn opens_by_its_slip(out: &Path, friction: f64) {
    let middle = rows(out, "probes.csv", ["probe", "middle"]);
    let last = middle.last().expect("a row");
    let compression = -number(last, "normal_traction");
    let shear = number(last, "shear_traction");
    assert!(
        (shear / compression / friction - 1.0).abs() < 1e-6,
        "{last:?}"
    );
    let elastic = (shear - sheared()) / SHEAR;
    let dilated = ANGLES[1].to_radians().tan() * (number(last, "slip") - elastic);
    let expected = pressed(compression) + dilated;
    assert!(dilated > 0.05 * expected);
    let found = number(last, "aperture");
    assert!((found / expected - 1.0).abs() < 1e-4, "{found} {expected}");
}
