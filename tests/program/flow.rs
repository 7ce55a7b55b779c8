//! Flow in fractures: rates, pressures and fields beside closed forms, and what is refused.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::harness::{Workshop, files, kluft, summary, without_times};
use crate::read_back::read_back;

/// What stands in `sources.csv` behind its head: source, pressure and rate.
pub fn sources(folder: &Path) -> Vec<(String, f64, f64)> {
    let text = fs::read_to_string(folder.join("sources.csv")).expect("sources.csv");
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("step,time,source,pressure,rate,volume"));
    let number = |text: &str| text.parse::<f64>().expect("a number");
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        assert_eq!(cells.len(), 6, "{line}");
        (cells[2].to_owned(), number(cells[3]), number(cells[4]))
    };
    lines.map(row).collect()
}

fn is_close(found: f64, expected: f64, tolerance: f64) {
    let error = (found - expected).abs();
    assert!(error <= tolerance * expected.abs(), "{found} {expected}");
}

/// The transmissivities of the star, and its rates: `q = T (p - sum T p / sum T)`.
pub fn star() -> [(&'static str, f64, f64); 4] {
    let ends = [
        ("left", 1e-4, 3e5),
        ("right", 2e-4, 1e5),
        ("front", 0.5e-4, 0.0),
        ("back", 1.5e-4, 2e5),
    ];
    let conducts = |width: f64| width.powi(3) / 12e-3;
    let whole: f64 = ends.iter().map(|(_, width, _)| conducts(*width)).sum();
    let sum: f64 = ends.iter().map(|(_, width, p)| conducts(*width) * p).sum();
    is_close(sum / whole, 1.42e5, 1e-12);
    ends.map(|(side, width, p)| (side, p, conducts(width) * (p - sum / whole)))
}

/// The pressures and rates of the star, by the names of its sides.
pub fn check_star(out: &Path) {
    let rows = sources(out);
    assert_eq!(rows.len(), 4);
    for (side, pressure, rate) in star() {
        let name = format!("[boundary.{side}]");
        let row = rows.iter().find(|row| row.0 == name).expect("a row");
        is_close(row.1, pressure, 1e-14);
        is_close(row.2, rate, 1e-11);
    }
}

#[test]
fn a_star_of_joints_has_its_rates() {
    let workshop = Workshop::new("flow-star", &[]);
    let one = workshop.solve("one", &["--threads", "1"]);
    let two = workshop.solve("two", &["--threads", "2"]);
    let (mut ones, mut twos) = (files(&one), files(&two));
    let names: Vec<&str> = ones.keys().map(String::as_str).collect();
    let promised = [
        "fractures.pvd",
        "fractures_0001.vtu",
        "history.csv",
        "mesh.msh",
        "report.html",
        "results.vtm",
        "resume.bin",
        "rock.pvd",
        "rock_0001.vtu",
        "sources.csv",
        "summary.json",
    ];
    assert_eq!(names, promised);
    // Checkpoints say how long the run took.
    assert!(ones.remove("resume.bin").is_some() && twos.remove("resume.bin").is_some());
    without_times(&mut ones);
    without_times(&mut twos);
    assert_eq!(ones, twos);
    check_star(&one);
    let said = summary(&one);
    let flow = &said["steps"][0]["flow"];
    assert!(
        flow["mass_error"].as_f64().expect("a share") < 1e-12,
        "{flow}"
    );
    assert_eq!(said["flow"]["networks"].as_array().map(Vec::len), Some(1));
    let fractures = read_back(&one.join("fractures_0001.vtu"));
    let range = |field: &Value| ["min", "max"].map(|end| field[end][0].as_f64().expect("a number"));
    let [low, high] = range(&fractures["point_data"]["pressure"]);
    assert_eq!((low, high), (0.0, 3e5));
    let [low, high] = range(&fractures["cell_data"]["transmissivity"]);
    is_close(low, 0.125e-12 / 12.0, 1e-13);
    is_close(high, 8e-12 / 12.0, 1e-13);
}

#[test]
fn standing_water_stands() {
    let out = Workshop::new("standing-water", &[("h = 0.5", "h = 0.3")]);
    let out = out.solve("out", &[]);
    let said = summary(&out);
    let fractures = said["flow"]["fractures"].as_array().expect("fractures");
    let of = |name: &str| {
        fractures
            .iter()
            .find(|f| f["name"] == name)
            .expect("a fracture")
    };
    let number = |value: &Value| value.as_f64().expect("a number");
    is_close(number(&of("joint")["pressure"]["max"]), 9.81e4, 1e-13);
    is_close(number(&of("bed")["pressure"]["mean"]), 5.886e4, 1e-13);
    // e = 2500 / 8^2.5 um, and b_h^3 = e^3 + r^3.
    let rough: f64 = 2500e-6 / 8_f64.powf(2.5);
    let expected = (rough.powi(3) + 1e-18).cbrt();
    is_close(
        number(&of("bed")["hydraulic_aperture"]["mean"]),
        expected,
        1e-12,
    );
    for fracture in fractures {
        // What a head of 1 m in 10 m would drive in the joint is some 6e-7 m2/s.
        assert!(number(&fracture["flux_max"]) < 1e-20, "{fracture}");
    }
    assert_eq!(said["steps"][0]["flow"]["mass_error"], 0.0);
}

/// What makes the rock of the star elastic, and holds it.
const ELASTIC: [(&str, &str); 5] = [
    (
        "[fluid]",
        "[rock.default]\nyoung_modulus = 25e9\npoisson_ratio = 0.25\n\n[fluid]",
    ),
    (
        "hydraulic_aperture = 1e-4",
        "hydraulic_aperture = 1e-4\naperture = 1e-4\nnormal_stiffness = 1e11\nshear_stiffness = 5e10\nclosure = \"logarithmic\"",
    ),
    (
        "hydraulic_aperture = 2e-4",
        "hydraulic_aperture = 2e-4\naperture = 1e-4\nnormal_stiffness = 1e11\nshear_stiffness = 5e10\nclosure = \"logarithmic\"",
    ),
    (
        "hydraulic_aperture = 0.5e-4",
        "hydraulic_aperture = 0.5e-4\naperture = 1e-4\nnormal_stiffness = 1e11\nshear_stiffness = 5e10\nclosure = \"logarithmic\"",
    ),
    (
        "hydraulic_aperture = 1.5e-4",
        "hydraulic_aperture = 1.5e-4\naperture = 1e-4\nnormal_stiffness = 1e11\nshear_stiffness = 5e10\nclosure = \"logarithmic\"",
    ),
];

fn elastic(more: &[(&str, &str)]) -> Workshop {
    let held = [
        (
            "fluid_pressure = 3e5",
            "fluid_pressure = 3e5\nsymmetry = true",
        ),
        (
            "fluid_pressure = 1e5",
            "fluid_pressure = 1e5\nsymmetry = true",
        ),
        (
            "fluid_pressure = 0.0",
            "fluid_pressure = 0.0\nsymmetry = true",
        ),
        (
            "fluid_pressure = 2e5",
            "fluid_pressure = 2e5\nsymmetry = true",
        ),
        (
            "[boundary.left]",
            "[[fixed_point]]\nat = [0, 0, 0]\ndisplacement = { z = 0.0 }\n\n[boundary.left]",
        ),
        ("h = 0.2", "h = 0.4"),
    ];
    let edits: Vec<(&str, &str)> = ELASTIC
        .into_iter()
        .chain(held)
        .chain(more.iter().copied())
        .collect();
    Workshop::new("flow-star", &edits)
}

/// At constant hydraulic apertures the flow is that of rigid rock, and pushes the walls as a given
/// pressure does.
#[test]
fn the_fluid_pushes_the_walls_of_joints() {
    let workshop = elastic(&[]);
    check_star(&workshop.solve("out", &[]));
    let even = [
        ("fluid_pressure = 3e5", "fluid_pressure = 2e5"),
        ("fluid_pressure = 1e5", "fluid_pressure = 2e5"),
        ("fluid_pressure = 0.0", "fluid_pressure = 2e5"),
    ];
    let text = fs::read_to_string(workshop.scene()).expect("the scene");
    let flowing = even
        .iter()
        .fold(text.clone(), |text, (from, to)| text.replace(from, to));
    // The same pressure given to each fracture, without a fluid.
    let given = text
        .lines()
        .filter(|line| !line.contains("fluid") && !line.contains("viscosity"))
        .map(|line| match line.starts_with("hydraulic_aperture") {
            true => "fluid_pressure = 2e5",
            false => line,
        })
        .collect::<Vec<_>>()
        .join("\n");
    let means = |name: &str, text: &str| {
        fs::write(workshop.scene(), text).expect("written");
        let said = summary(&workshop.solve(name, &[]));
        ["west", "east", "south", "north"].map(|fracture| {
            let aperture = &said["fractures"][fracture]["aperture"]["mean"];
            aperture.as_f64().expect("a number")
        })
    };
    let (flowing, given) = (means("flowing", &flowing), means("given", &given));
    for (flowing, given) in flowing.into_iter().zip(given) {
        assert!(given > 1.000_5e-4, "{given}");
        is_close(flowing, given, 1e-11);
    }
}

#[test]
fn sources_are_told_at_the_end_of_every_load_step() {
    let steps = ("[mesh]", "[load]\nsteps = [0.5, 1.0]\n\n[mesh]");
    let rows = sources(&elastic(&[steps]).solve("out", &[]));
    assert_eq!(rows.len(), 8);
    for (half, full) in rows[..4].iter().zip(&rows[4..]) {
        assert_eq!(half.0, full.0);
        is_close(half.1, 0.5 * full.1, 1e-14);
        is_close(half.2, 0.5 * full.2, 1e-11);
    }
}

#[test]
fn an_inspection_tells_what_connects() {
    let workshop = Workshop::new(
        "flow-star",
        &[
            ("hydraulic_aperture = 2e-4", "sealed = true"),
            ("[boundary.right]\nfluid_pressure = 1e5\n\n", ""),
        ],
    );
    let scene = workshop.scene();
    let run = kluft(&["inspect".as_ref(), scene.as_os_str()]);
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
    let flat = run.out.split_whitespace().collect::<Vec<_>>().join(" ");
    for said in [
        "unknown pressures, 1 network",
        "west, south, north (",
        "driven by [boundary.back], [boundary.front], [boundary.left]",
        "solver direct, chosen, predicted: ",
        "entries in the factor",
    ] {
        assert!(flat.contains(said), "{said}: {}", run.out);
    }
    let text = fs::read_to_string(&scene).expect("the scene");
    let parts = text.split("\n\n");
    let idle: Vec<&str> = parts
        .filter(|part| !part.contains("fluid_pressure"))
        .collect();
    fs::write(&scene, idle.join("\n\n")).expect("written");
    let run = kluft(&["inspect".as_ref(), scene.as_os_str()]);
    assert_eq!(run.code, Some(2));
    for said in [
        "fractures `north`, `south`, `west`: nothing drives a flow",
        "add fluid_pressure to a [boundary.NAME]",
    ] {
        assert!(run.err.contains(said), "{said}: {}", run.err);
    }
}

/// In time the star fills, and comes to its steady rates; what has entered and not left is stored.
#[test]
fn a_compressible_fluid_takes_its_time_in_rigid_rock() {
    let timed = [
        (
            "viscosity = 1e-3",
            "viscosity = 1e-3\ncompressibility = 4.5e-10",
        ),
        (
            "[boundary.left]",
            "[load]\ntimes = [1e-5, 1e-4, 1]\n\n[boundary.left]",
        ),
    ];
    let workshop = Workshop::new("flow-star", &timed);
    let one = workshop.solve("one", &["--threads", "1"]);
    let said = summary(&one);
    let steps = said["steps"].as_array().expect("steps");
    let number = |step: usize, key: &str| steps[step]["flow"][key].as_f64().expect("a number");
    for (index, step) in steps.iter().enumerate() {
        assert!(number(index, "mass_error") <= 1e-10, "{step}");
    }
    assert!(number(0, "stored") > 10.0 * number(2, "inflow"));
    assert!(number(2, "stored").abs() < 1e-6 * number(2, "inflow"));
    let rows = sources(&one);
    for (side, _, rate) in star() {
        let name = format!("[boundary.{side}]");
        let row = rows.iter().rfind(|row| row.0 == name).expect("a row");
        is_close(row.2, rate, 1e-6);
    }
    let two = workshop.solve("two", &["--threads", "2"]);
    assert_eq!(sources(&one), sources(&two));
    // Without a pressure anywhere it fills, and is inspected as it runs.
    let closed = [
        timed[0],
        timed[1],
        ("fluid_pressure = 3e5", "fluid_inflow = 1e-9"),
        ("[boundary.right]\nfluid_pressure = 1e5\n", ""),
        ("[boundary.front]\nfluid_pressure = 0.0\n", ""),
        ("[boundary.back]\nfluid_pressure = 2e5", ""),
    ];
    let workshop = Workshop::new("flow-star", &closed);
    let said = summary(&workshop.solve("out", &[]));
    let last = &said["steps"][2]["flow"];
    is_close(last["stored"].as_f64().expect("a number"), 1e-9, 1e-9);
    let scene = workshop.scene();
    let run = kluft(&["inspect".as_ref(), scene.as_os_str()]);
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
}
