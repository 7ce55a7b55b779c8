//! `kluft inspect`: what it says of scenes whose fractures are known, and of wrong input.

use std::f64::consts::PI;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use crate::harness::{Run, Workshop, edited, files, kluft, scratch, summary};
use crate::read_back::read_back;

const SCENE: &str = include_str!("bad_input/base.toml");
const MESH: &str = include_str!("bad_input/base.msh");

fn inspect(input: &Path, out: &Path, flags: &[&str]) -> Run {
    let mut arguments = vec![
        "inspect".into(),
        input.to_owned(),
        "--out".into(),
        out.to_owned(),
    ];
    arguments.extend(flags.iter().map(PathBuf::from));
    kluft(&arguments)
}

/// The report of a sound scene, which must be the same on the output and in `inspect.json`.
fn report(workshop: &Workshop) -> Value {
    let out = workshop.path("out");
    let run = inspect(&workshop.scene(), &out, &["--json"]);
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
    let kept = fs::read_to_string(out.join("inspect.json")).expect("inspect.json");
    assert_eq!(run.out, kept);
    serde_json::from_str(&run.out).expect("JSON")
}

fn named<'a>(list: &'a Value, name: &str) -> &'a Value {
    let entries = list.as_array().expect("a list");
    let found = entries
        .iter()
        .find(|entry| entry["name"] == name || entry["fracture"] == name);
    found.unwrap_or_else(|| panic!("no {name} in {list}"))
}

fn number(value: &Value) -> f64 {
    value
        .as_f64()
        .unwrap_or_else(|| panic!("{value} is no number"))
}

#[track_caller]
fn assert_near(value: &Value, expected: f64, tolerance: f64) {
    let error = (number(value) - expected).abs();
    assert!(error <= tolerance, "{value} instead of {expected}");
}

/// Every key of the report, and what kind of value it has.
#[test]
fn the_json_has_its_keys() {
    let report = report(&Workshop::new("t-junction", &[]));
    let keys: Vec<&str> = report
        .as_object()
        .expect("an object")
        .keys()
        .map(String::as_str)
        .collect();
    let mut expected = vec![
        "kluft",
        "input",
        "title",
        "mesh",
        "groups",
        "doubled_surfaces",
        "fractures",
        "contacts",
        "decisions",
        "unresolved_patches",
        "blocks",
        "cells",
        "unknowns",
        "solvers",
        "walls",
        "warnings",
        "defects",
        "seconds",
    ];
    expected.sort_unstable();
    let mut sorted = keys.clone();
    sorted.sort_unstable();
    assert_eq!(sorted, expected);
    for key in [
        "groups",
        "fractures",
        "contacts",
        "blocks",
        "solvers",
        "walls",
    ] {
        assert!(
            report[key].as_array().is_some_and(|list| !list.is_empty()),
            "{key}"
        );
    }
    for key in [
        "warnings",
        "defects",
        "unresolved_patches",
        "doubled_surfaces",
    ] {
        assert!(report[key].is_array(), "{key}");
    }
    assert_eq!(report["title"], "A joint ending on another, both closing");
    assert_eq!(report["mesh"]["bounds"][1], json!([1.0, 1.0, 1.0]));
}

#[test]
fn a_t_is_found_with_its_roles_and_blocks() {
    let report = report(&Workshop::new("t-junction", &[]));
    let roles = |name: &str| {
        report["groups"]
            .as_array()
            .map(|_| named(&report["groups"], name)["role"].clone())
    };
    for (name, role) in [
        ("rock", "rock"),
        ("through", "fracture"),
        ("top", "boundary"),
        ("back", "free"),
    ] {
        assert_eq!(roles(name), Some(json!(role)), "{name}");
    }
    let through = named(&report["fractures"], "through");
    assert_near(&through["area"], 1.0, 1e-12);
    assert_near(&through["trace_length"], 4.0, 1e-12);
    assert_near(&through["dip"], 0.0, 1e-9);
    assert_eq!(through["tip_edges"], 0);
    let abutting = named(&report["fractures"], "abutting");
    assert_near(&abutting["area"], 0.5, 1e-12);
    assert_near(&abutting["dip"], 90.0, 1e-9);
    assert_near(&abutting["trace_length"], 2.0, 1e-12);
    let contact = &report["contacts"][0];
    assert_eq!(contact["kind"], "second ends on first");
    assert_near(&contact["second_ends_length"], 1.0, 1e-12);
    assert_near(&contact["smallest_angle"], 90.0, 1e-9);
    let volumes = report["blocks"].as_array().expect("blocks").iter();
    let mut volumes: Vec<f64> = volumes.map(|block| number(&block["volume"])).collect();
    volumes.sort_by(f64::total_cmp);
    for (volume, expected) in volumes.iter().zip([0.25, 0.25, 0.5]) {
        assert!((volume - expected).abs() < 1e-12, "{volumes:?}");
    }
    assert_eq!(named(&report["walls"], "through")["overlap"], "never");
}

/// The counts of an inspection are those of the run.
#[test]
fn the_unknowns_are_those_of_the_run() {
    let workshop = Workshop::new("three-planes", &[("h = 0.15", "h = 0.3")]);
    let report = report(&workshop);
    let said = summary(&workshop.solve("out", &[]));
    assert_eq!(report["unknowns"]["total"], said["unknowns"]["total"]);
    assert_eq!(report["unknowns"]["jumps"], said["unknowns"]["jump"]);
    assert_eq!(report["mesh"]["cells"], said["mesh"]["cells"]);
    assert_eq!(report["unknowns"]["junction_nodes"]["8+"], 1);
    assert_eq!(report["blocks"].as_array().map(Vec::len), Some(8));
    let volumes = report["blocks"].as_array().expect("blocks").iter();
    assert!((volumes.map(|b| number(&b["volume"])).sum::<f64>() - 1.0).abs() < 1e-12);
    let solvers = report["solvers"].as_array().expect("solvers");
    let names: Vec<_> = solvers.iter().map(|solver| &solver["name"]).collect();
    assert_eq!(
        names,
        [&json!("iterative"), &json!("direct"), &json!("condensed")]
    );
    let chosen = solvers.iter().filter(|solver| solver["is_chosen"] == true);
    assert_eq!(chosen.count(), 1);
    for solver in solvers {
        assert_eq!(solver["is_prediction"], true);
        assert!(number(&solver["memory_bytes"]) > 8.0 * number(&solver["factor_entries"]));
    }
    let fractures = report["fractures"].as_array().expect("fractures");
    assert_eq!(fractures.len(), 3);
    for fracture in fractures {
        assert_eq!(fracture["junction_nodes"]["8+"], 1, "{}", fracture["name"]);
        assert_near(&fracture["area"], 1.0, 1e-12);
    }
}

/// A disc of radius 1 in a large block: its rim is all tip.
#[test]
fn a_penny_has_a_tip_all_around() {
    let report = report(&Workshop::new(
        "penny",
        &[(
            "parameters = { h = 0.06, grow = 0.4, half = 10 }\norder = 2",
            "parameters = { h = 0.4 }",
        )],
    ));
    let penny = named(&report["fractures"], "penny");
    // Chords of a circle cut into 12 or more edges are at most 2 % shorter, the polygon 5 %
    // smaller.
    assert_near(&penny["tip_length"], 2.0 * PI, 0.02 * 2.0 * PI);
    assert_near(&penny["area"], PI, 0.05 * PI);
    assert_eq!(
        (&penny["trace_edges"], &penny["closed"]),
        (&json!(0), &json!(false))
    );
    assert_near(&penny["deviation"], 0.0, 1e-6);
    assert_eq!(report["blocks"].as_array().map(Vec::len), Some(1));
    assert_eq!(named(&report["walls"], "penny")["law"], "free crack");
    assert_eq!(named(&report["walls"], "penny")["overlap"], "no");
}

/// Dips and dip directions of `closing-blocks.geo`: a plane that dips by `dips` towards +x (90
/// degrees) and is turned by `turns` against the clock.
#[test]
fn the_joints_of_a_block_lie_as_they_were_drawn() {
    let workshop = Workshop::new("closing-blocks", &[]);
    let report = report(&workshop);
    for (name, dip, direction) in [
        ("fault", 65.0, 78.0),
        ("bedding", 12.0, 70.0),
        ("cross", 82.0, 352.0),
        ("keystone", 40.0, 265.0),
        ("toe", 78.0, 96.0),
        ("lens", 62.0, 98.0),
    ] {
        let fracture = named(&report["fractures"], name);
        assert_near(&fracture["dip"], dip, 1e-6);
        assert_near(&fracture["dip_direction"], direction, 1e-6);
        assert_eq!(
            number(&fracture["tip_length"]) > 0.0,
            name == "lens",
            "{name}"
        );
    }
    let kinds: Vec<(&Value, &Value)> = report["contacts"]
        .as_array()
        .expect("contacts")
        .iter()
        .map(|contact| (&contact["fractures"], &contact["kind"]))
        .collect();
    for (pair, kind) in [
        (["fault", "bedding"], "crosses"),
        (["fault", "keystone"], "second ends on first"),
        (["bedding", "toe"], "second ends on first"),
    ] {
        assert!(
            kinds.contains(&(&json!(pair), &json!(kind))),
            "{pair:?}: {kinds:?}"
        );
    }
    let volumes = report["blocks"].as_array().expect("blocks").iter();
    assert!((volumes.map(|b| number(&b["volume"])).sum::<f64>() - 24.0).abs() < 1e-9);
}

#[test]
fn the_findings_open_in_vtk() {
    let workshop = Workshop::new("t-junction", &[]);
    let report = report(&workshop);
    let found = read_back(&workshop.path("out/inspect.vtu"));
    let facets = report["fractures"].as_array().expect("fractures").iter();
    let facets: f64 = facets.map(|fracture| number(&fracture["facets"])).sum();
    assert_near(&found["cell_types"]["triangle"], facets, 0.0);
    assert!(number(&found["cell_types"]["tetra"]) >= 10.0);
    assert!(number(&found["min_cell_measure"]) > 0.0);
    assert_eq!(found["point_data"]["sectors"]["max"], json!([3.0]));
    for (field, range) in [
        ("fracture", [-1.0, 1.0]),
        ("block_minus", [0.0, 2.0]),
        ("unresolved_patch", [-1.0, -1.0]),
    ] {
        let data = &found["cell_data"][field];
        assert_eq!(
            (&data["min"], &data["max"]),
            (&json!([range[0]]), &json!([range[1]])),
            "{field}"
        );
    }
    let worst = &report["cells"]["worst"][0]["quality"];
    assert_near(
        &found["cell_data"]["quality"]["min"][0],
        number(worst),
        1e-12,
    );
}

#[test]
fn the_text_names_what_there_is() {
    let folder = scratch();
    fs::write(folder.path().join("scene.toml"), SCENE).expect("a scene");
    fs::write(folder.path().join("base.msh"), MESH).expect("a mesh");
    let run = inspect(
        &folder.path().join("scene.toml"),
        &folder.path().join("out"),
        &[],
    );
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
    for text in [
        "Two cells with a joint between",
        "fracture   joint",
        "[rock.rock]",
        "traction (0, 0, -100000) Pa",
        "predicted",
        "do they pass through each other?",
    ] {
        assert!(run.out.contains(text), "{text}:\n{}", run.out);
    }
    let left: Vec<String> = files(&folder.path().join("out")).into_keys().collect();
    assert_eq!(left, ["inspect.json", "inspect.vtu"]);
}

#[test]
fn roles_of_a_mesh_alone_are_guessed() {
    let folder = scratch();
    let mesh = folder.path().join("base.msh");
    fs::write(&mesh, MESH).expect("a mesh");
    let run = kluft(&["inspect".as_ref(), mesh.as_os_str(), "--json".as_ref()]);
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
    let report: Value = serde_json::from_str(&run.out).expect("JSON");
    for (name, role) in [("joint", "fracture"), ("top", "boundary"), ("rock", "rock")] {
        assert_eq!(named(&report["groups"], name)["role"], role, "{name}");
    }
    assert_eq!(
        (&report["title"], &report["walls"]),
        (&Value::Null, &json!([]))
    );
    assert_eq!(report["blocks"][0]["supported"], Value::Null);
    assert_eq!(report["unknowns"]["without_held"], false);
    assert!(folder.path().join("out/inspect.vtu").exists());
}

/// The joint meets at K_n0 b0 = 1e10 x 1e-4 Pa.
#[test]
fn walls_that_the_loads_would_push_through_each_other_are_named() {
    for (load, verdict) in [("0.9e6", "no"), ("1.1e6", "yes")] {
        let folder = scratch();
        let scene = edited(
            SCENE,
            &[("traction = [0, 0, -1e5]", &format!("pressure = {load}"))],
        );
        fs::write(folder.path().join("scene.toml"), scene).expect("a scene");
        fs::write(folder.path().join("base.msh"), MESH).expect("a mesh");
        let scene = folder.path().join("scene.toml");
        let run = inspect(&scene, &folder.path().join("out"), &["--json"]);
        let report: Value = serde_json::from_str(&run.out).expect("JSON");
        let wall = named(&report["walls"], "joint");
        assert_near(&wall["limit"], 1e6, 1e-6);
        assert_eq!(wall["overlap"], verdict, "{wall}");
        let warned = run.out.contains("the walls of `joint` meet at");
        assert_eq!(warned, verdict == "yes");
    }
}

/// Groups are told even where the mesh cannot be used.
#[test]
fn wrong_input_is_refused_after_what_could_be_seen() {
    let folder = scratch();
    let scene = folder.path().join("scene.toml");
    fs::write(folder.path().join("base.msh"), MESH).expect("a mesh");
    let out = folder.path().join("out");
    for (edit, said, role) in [
        (
            ("[fracture.joint]", "[fracture.jont]"),
            "did you mean `joint`?",
            "unknown",
        ),
        (
            ("[fracture.joint]", "[fracture.top]"),
            "both a fracture and a boundary",
            "unknown",
        ),
        (
            (
                "[boundary.bottom]\ndisplacement = { x = 0.0, y = 0.0, z = 0.0 }",
                "",
            ),
            "nothing holds it",
            "fracture",
        ),
    ] {
        fs::write(&scene, edited(SCENE, &[edit])).expect("a scene");
        let run = inspect(&scene, &out, &["--json"]);
        assert_eq!(run.code, Some(2), "{}", run.err);
        assert!(run.err.contains(said), "{said}: {}", run.err);
        let report: Value = serde_json::from_str(&run.out).expect("JSON");
        assert_eq!(named(&report["groups"], "joint")["role"], role);
        assert!(!report["defects"].as_array().expect("defects").is_empty());
    }
    // What `run` would refuse for the same reason.
    for (sections, said) in [
        (
            "[solver]\nmemory_limit = 1e3\n",
            "raise `memory_limit` under [solver]",
        ),
        (
            "[fluid]\nviscosity = 1e-3\n[[source]]\nfracture = \"joint\"\npressure = 1e5\n\
             [solver]\nfacets = \"gauss\"\n",
            "integrated at Gauss points, where flow cannot follow",
        ),
    ] {
        fs::write(&scene, format!("{SCENE}\n{sections}")).expect("a scene");
        let runs = inspect(&scene, &out, &[]);
        assert_eq!(runs.code, Some(2), "{}", runs.err);
        assert!(runs.err.contains(said), "{said}: {}", runs.err);
    }
    let run = kluft(&["inspect", "no/such/scene.toml"]);
    assert_eq!((run.code, run.out.as_str()), (Some(2), ""));
    assert!(run.err.contains("remedy: "), "{}", run.err);
}
