//! What a fluid is like before any load: pressures that vary, and those below a water table.

use std::fs;
use std::path::Path;

use crate::flow::sources;
use crate::harness::{Workshop, edited, summary};

fn is_close(found: f64, expected: f64, tolerance: f64) {
    let error = (found - expected).abs();
    assert!(error <= tolerance * expected.abs(), "{found} {expected}");
}

/// Water below a table 2 m above the column rests, and carries its weight.
#[test]
fn water_below_a_water_table_rests() {
    let edits = [
        ("h = 0.5", "h = 0.3"),
        (
            "fluid_pressure = 0.0",
            "fluid_pressure = { water_table = 12 }",
        ),
    ];
    let workshop = Workshop::new("standing-water", &edits);
    let said = summary(&workshop.solve("out", &[]));
    let fractures = said["flow"]["fractures"].as_array().expect("fractures");
    let joint = fractures.iter().find(|own| own["name"] == "joint");
    let joint = joint.expect("the joint");
    let number = |value: &serde_json::Value| value.as_f64().expect("a number");
    is_close(number(&joint["pressure"]["max"]), 12.0 * 9810.0, 1e-13);
    is_close(number(&joint["pressure"]["min"]), 2.0 * 9810.0, 1e-13);
    // What a head of 1 m in 10 m would drive in the joint is some 6e-7 m2/s.
    assert!(number(&joint["flux_max"]) < 1e-20, "{joint}");
}

#[test]
fn a_water_table_needs_a_level_and_a_weight() {
    let refused = |pressure: &str, gravity: &str| {
        let edits = [
            ("fluid_pressure = 0.0", pressure),
            ("gravity = [0, 0, -9.81]", gravity),
        ];
        let run = Workshop::new("standing-water", &edits).run("out", &[]);
        assert_eq!(run.code, Some(2), "{}", run.err);
        run.err
    };
    let resting = "fluid_pressure = { water_table = 12 }";
    let down = "gravity = [0, 0, -9.81]";
    let cases = [
        (
            refused(resting, "gravity = [0, 0, 0]"),
            "no gravity along z",
        ),
        (
            refused(resting, "gravity = [1, 0, -9]"),
            "gravity is not along z",
        ),
        (
            refused("fluid_pressure = \"hydrostatic\"", down),
            "{ water_table = 0.0 }",
        ),
        (
            refused("fluid_pressure = { water_table = 12, value = 3 }", down),
            "`value` has no effect beside water_table",
        ),
    ];
    for (err, said) in cases {
        assert!(err.contains(said), "{said}: {err}");
        assert!(err.contains("scene.toml:2"), "{err}");
    }
}

/// Joints of one network that nothing leaves even out to the mean of what they hold: the pressure
/// is linear in each, so that its mean is that in the middle, weighed by the apertures.
#[test]
fn pressures_of_a_closed_network_even_out_to_their_mean() {
    let scene = fs::read_to_string(crate::harness::root().join("geometries/flow-star/scene.toml"));
    let scene = scene
        .expect("the scene")
        .replace("hydraulic_aperture", "aperture");
    let head = scene.split("[boundary.left]").next().expect("a head");
    let closed = format!("{head}[load]\ntimes = [1e-3, 1e3]\n");
    let edits = [(
        "viscosity = 1e-3",
        "viscosity = 1e-3\ncompressibility = 4.5e-10\n\
         initial_pressure = { expression = \"1e5 * (1 + x + 2*y)\" }",
    )];
    let workshop = Workshop::new("flow-star", &[]);
    fs::write(workshop.scene(), edited(&closed, &edits)).expect("written");
    let said = summary(&workshop.solve("out", &[]));
    let holds = [(1.0, 3.5e5), (2.0, 4.5e5), (0.5, 3e5), (1.5, 5e5)];
    let whole: f64 = holds.iter().map(|(width, _)| width).sum();
    let mean = holds.iter().map(|(width, p)| width * p).sum::<f64>() / whole;
    for fracture in said["flow"]["fractures"].as_array().expect("fractures") {
        for end in ["min", "max"] {
            is_close(
                fracture["pressure"][end].as_f64().expect("a number"),
                mean,
                1e-9,
            );
        }
    }
}

/// A joint under a total stress of 1.8 MPa with 1 MPa at its inlet, both from the beginning, and a
/// fluid with these keys, up to these times; `more` stands before them.
fn pressed_joint(fluid: &str, more: &str, times: &str) -> Workshop {
    let stress = format!(
        "[initial_stress]\nzz = -1.8e6\n\n[boundary.top]\npressure = 1.8e6\n\
         history = [[0, 1], [100, 1]]\n\n{more}[load]"
    );
    let times = format!("times = {times}");
    let edits = [
        ("viscosity = 1e-3", fluid),
        ("fluid_pressure = 0.9e6", "fluid_pressure = 1e6"),
        ("[load]", &stress[..]),
        (
            "times = [10, 20, 30, 40, 50, 60, 70, 80, 90, 100]",
            &times[..],
        ),
    ];
    Workshop::new("filling-joint", &edits)
}

/// The least and the largest normal traction of the joint at the end (Pa).
fn tractions(out: &Path) -> [f64; 2] {
    let said = summary(out);
    let traction = &said["fractures"]["joint"]["normal_traction"];
    ["min", "max"].map(|end| traction[end].as_f64().expect("a number"))
}

/// Walls carry what a pressure of 1 MPa, and more by the square of the distance, leaves to them of
/// the stress; in a fluid too thick to flow nothing moves.
#[test]
fn walls_begin_in_balance_with_a_pressure_that_varies() {
    let fluid = "viscosity = 1e3\ninitial_pressure = { expression = \"1e6 * (1 + (x/25)^2 / 2)\" }";
    let silence = "[warnings]\nsilence = [\"fluid_times\", \"values\"]\n\n";
    let workshop = pressed_joint(fluid, silence, "[10]");
    let out = workshop.solve("out", &[]);
    let [least, largest] = tractions(&out);
    is_close(least, -0.8e6, 1e-9);
    is_close(largest, -0.3e6, 1e-7);
    let rates = sources(&out).into_iter().map(|row| row.2.abs());
    assert!(rates.fold(0.0, f64::max) < 1e-15);
}

/// Where loads and pressures are what they were from the beginning, a load step has nothing to do
/// but to find that out.
#[test]
fn a_fluid_and_walls_at_rest_are_a_solution() {
    let fluid = "viscosity = 1e-3\ninitial_pressure = 1e6";
    let workshop = pressed_joint(fluid, "", "[10, 20]");
    let out = workshop.solve("out", &[]);
    for traction in tractions(&out) {
        is_close(traction, -0.8e6, 1e-9);
    }
}
