//! What the program writes, read back and compared with what it says it wrote.

use std::collections::BTreeMap;
use std::path::Path;

use serde_json::{Value, json};

use crate::harness::{Workshop, files, kluft, root, scratch, summary};
use crate::read_back::read_back;

/// What is expected of a scene.
struct Expected {
    geometry: &'static str,
    edits: &'static [(&'static str, &'static str)],
    /// Volume of the rock (m^3).
    volume: f64,
    /// Stress of every cell in ParaView's order (Pa), where it is uniform.
    stress: Option<[f64; 6]>,
}

#[test]
fn one_joint() {
    check(&Expected {
        geometry: "inclined-joint",
        edits: &[],
        volume: 2.0,
        stress: Some([0.0, -1540.0, -7000.0, 0.0, 0.0, 0.0]),
    });
}

#[test]
fn a_joint_that_ends_on_another() {
    check(&Expected {
        geometry: "t-junction",
        edits: &[],
        volume: 1.0,
        stress: Some([-5e6, 0.0, -10e6, 0.0, 0.0, 0.0]),
    });
}

#[test]
fn six_joints() {
    check(&Expected {
        geometry: "closing-blocks",
        edits: &[("parameters = { h = 0.2,", "parameters = { h = 0.5,")],
        volume: 24.0,
        stress: None,
    });
}

#[test]
fn errors_against_a_closed_form_are_in_the_summary() {
    let workshop = Workshop::new("inclined-joint", &[("h = 0.2", "h = 0.4")]);
    let said = summary(&workshop.solve("out", &[]));
    let measures = said["measures"].as_array().expect("measures");
    let of = |name: &str| {
        let found = measures.iter().find(|measure| measure["name"] == name);
        found.unwrap_or_else(|| panic!("{name}")).clone()
    };
    for name in [
        "opening_l2",
        "opening_max",
        "slip_max",
        "normal_traction_l2",
    ] {
        let error = of(name)["error"].as_f64().expect("an error");
        assert!(error < 1e-9, "{name} {error}");
    }
    let mean = said["fractures"]["joint"]["aperture"]["mean"].as_f64();
    assert_eq!(of("mean_aperture")["value"].as_f64(), mean);
    assert_eq!(of("volume")["fracture"], "joint");
}

/// Segedin (1951), Eshelby (1957): a closed disc that slides against friction, on 78 thousand
/// unknowns.
#[test]
fn an_inclined_penny_slips_as_its_closed_form() {
    let (scene, out) = (
        root().join("geometries/inclined-penny/scene.toml"),
        scratch(),
    );
    let run = kluft(&[
        "run".as_ref(),
        scene.as_os_str(),
        "--out".as_ref(),
        out.path().as_os_str(),
    ]);
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
    let said = summary(out.path());
    let measures = said["measures"].as_array().expect("measures");
    for (name, most) in [("slip_max_inside", 0.01), ("slip_l2_inside", 0.005)] {
        let found = measures.iter().find(|measure| measure["name"] == name);
        let error = found.and_then(|found| found["error"].as_f64()).expect(name);
        assert!(error < most, "{name} {error}");
    }
}

fn check(expected: &Expected) {
    let workshop = Workshop::new(expected.geometry, expected.edits);
    let one = workshop.solve("one", &["--threads", "1"]);
    let two = workshop.solve("two", &["--threads", "2"]);
    check_alike(&one, &two);
    let names: Vec<String> = files(&one).into_keys().collect();
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
        "summary.json",
    ];
    assert_eq!(names, promised, "files of a run with one step");
    let (found, said) = (read_back(&one), summary(&one));
    check_rock(&found["rock"]["steps"][0], &said, expected);
    check_fractures(&found["fractures"]["steps"][0], &said, &one);
}

/// Threads change how long a run takes, and nothing else.
fn check_alike(one: &Path, two: &Path) {
    let (mut ones, mut twos) = (files(one), files(two));
    for files in [&mut ones, &mut twos] {
        // They hold seconds.
        for name in ["summary.json", "resume.bin", "report.html"] {
            assert!(files.remove(name).is_some(), "{name}");
        }
    }
    let differing = ones
        .iter()
        .filter(|(name, content)| twos.get(*name) != Some(content));
    assert_eq!(
        differing.map(|(name, _)| name).collect::<Vec<_>>(),
        Vec::<&String>::new()
    );
    assert_eq!(ones.len(), twos.len());
    let timeless = |folder: &Path| {
        let mut summary = summary(folder);
        for key in [
            "seconds",
            "peak_memory_bytes",
            "predicted_memory_bytes",
            "threads",
            // When it began, and into which folder.
            "provenance",
        ] {
            let gone = summary.as_object_mut().expect("an object").remove(key);
            assert!(gone.is_some(), "{key}");
        }
        summary
    };
    assert_eq!(timeless(one), timeless(two));
    assert_eq!(
        (&summary(one)["threads"], &summary(two)["threads"]),
        (&json!(1), &json!(2))
    );
}

fn check_rock(found: &Value, said: &Value, expected: &Expected) {
    let count = |value: &Value| {
        value
            .as_u64()
            .unwrap_or_else(|| panic!("{value} is no count"))
    };
    let copies = count(&said["unknowns"]["jump"]) / 3;
    assert!(copies > 0);
    assert_eq!(
        count(&found["number_of_points"]),
        count(&said["mesh"]["nodes"]) + copies
    );
    assert_eq!(count(&found["duplicate_points"]), copies);
    assert_eq!(found["number_of_cells"], said["mesh"]["cells"]);
    assert_eq!(
        found["cell_types"],
        json!({ "tetra": said["mesh"]["cells"] })
    );
    assert!(number(&found["min_cell_measure"]) > 0.0);
    close(
        &found["total_measure"],
        &json!(expected.volume),
        1e-12,
        "volume",
    );
    check_finite(
        found,
        &["displacement", "node"],
        &["principal_stress", "rock", "stress", "stress_error"],
    );
    if let Some(stress) = expected.stress {
        check_stress(&found["cell_data"]["stress"], stress);
    }
}

fn check_stress(found: &Value, expected: [f64; 6]) {
    let scale = expected
        .iter()
        .fold(0.0, |largest: f64, value| largest.max(value.abs()));
    for bound in ["min", "max"] {
        for (component, wanted) in expected.iter().enumerate() {
            let error = (number(&found[bound][component]) - wanted).abs() / scale;
            assert!(
                error < 1e-8,
                "stress {component}: {bound} off by {error:e} of the largest"
            );
        }
    }
}

/// The arrays are there under these names, without anything that is no number.
fn check_finite(found: &Value, points: &[&str], cells: &[&str]) {
    for (kind, names) in [("point_data", points), ("cell_data", cells)] {
        let arrays = found[kind].as_object().expect("arrays");
        assert_eq!(arrays.keys().collect::<Vec<_>>(), names, "{kind}");
        for (name, array) in arrays {
            assert_eq!(
                (&array["any_nan"], &array["any_infinite"]),
                (&json!(false), &json!(false)),
                "{name}"
            );
        }
    }
}

fn check_fractures(found: &Value, said: &Value, folder: &Path) {
    let points = [
        "aperture",
        "jump",
        "normal_traction",
        "opening",
        "slip",
        "slip_tendency",
        "state",
        "traction",
    ];
    check_finite(
        found,
        &points,
        &["aperture_uncertainty", "fracture", "normal"],
    );
    let names = names_in_order(folder, said);
    assert_eq!(
        found["fractures"].as_object().expect("fractures").len(),
        names.len()
    );
    for (number, name) in names.iter().enumerate() {
        check_fracture(
            &found["fractures"][number.to_string()],
            &said["fractures"][name],
            name,
        );
    }
    assert_eq!(found["number_of_cells"], said["mesh"]["fracture_facets"]);
    let walls = &found["walls"];
    let (largest, mismatch) = (&walls["largest_jump"], &walls["largest_mismatch"]);
    assert!(number(largest) > 0.0);
    assert!(
        number(mismatch) <= 1e-14 * number(largest),
        "jump against the walls' displacements: {mismatch} of {largest}"
    );
}

/// Names of the fractures as they stand in the file, which is the order of their ids.
fn names_in_order(folder: &Path, said: &Value) -> Vec<String> {
    let text = std::fs::read_to_string(folder.join("summary.json")).expect("summary.json");
    let text = &text[text.find("\"fractures\": {").expect("the fractures")..];
    let names = said["fractures"].as_object().expect("fractures").keys();
    let by_place: BTreeMap<usize, String> = names
        .map(|name| {
            (
                text.find(&format!("\"{name}\": {{")).expect("the name"),
                name.clone(),
            )
        })
        .collect();
    by_place.into_values().collect()
}

fn check_fracture(found: &Value, said: &Value, name: &str) {
    assert_eq!(found["facets"], said["facets"], "facets of {name}");
    for key in ["area", "slip_max", "open_area", "below_cutoff_area"] {
        close(&found[key], &said[key], 1e-12, &format!("{key} of {name}"));
    }
    for key in ["aperture", "normal_traction"] {
        for bound in ["min", "mean", "max"] {
            close(
                &found[key][bound],
                &said[key][bound],
                1e-12,
                &format!("{bound} {key} of {name}"),
            );
        }
    }
    assert!(number(&said["aperture"]["min"]) > 0.0, "walls of {name}");
    assert_eq!(said["overlap_area"], json!(0.0), "{name}");
}

fn number(value: &Value) -> f64 {
    value
        .as_f64()
        .unwrap_or_else(|| panic!("{value} is no number"))
}

fn close(found: &Value, wanted: &Value, tolerance: f64, what: &str) {
    let (found, wanted) = (number(found), number(wanted));
    let scale = found.abs().max(wanted.abs());
    assert!(
        (found - wanted).abs() <= tolerance * scale,
        "{what}: {found} and {wanted}"
    );
}
