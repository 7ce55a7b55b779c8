//! Values that are possible but hardly meant: the run goes on, and says which unit they look like.

use std::fs;

use serde_json::Value;

use crate::harness::{edited, kluft, scratch};

const SCENE: &str = include_str!("bad_input/base.toml");
const MESH: &str = include_str!("bad_input/base.msh");

/// What a command warns of on the scene with these edits, as its JSON file has it.
fn warnings(command: &str, file: &str, edits: &[(&str, &str)]) -> Vec<String> {
    warnings_on(MESH, command, file, edits)
}

/// The same on another mesh.
fn warnings_on(mesh: &str, command: &str, file: &str, edits: &[(&str, &str)]) -> Vec<String> {
    let report = report(mesh, command, file, edits);
    let warnings = report["warnings"].as_array().expect("warnings").iter();
    warnings
        .map(|warning| warning.as_str().expect("a text").to_owned())
        .collect()
}

/// What a command reports of the scene with these edits.
fn report(mesh: &str, command: &str, file: &str, edits: &[(&str, &str)]) -> Value {
    let folder = scratch();
    let scene = folder.path().join("scene.toml");
    fs::write(&scene, edited(SCENE, edits)).expect("a scene");
    fs::write(folder.path().join("base.msh"), mesh).expect("a mesh");
    let run = kluft(&[command.as_ref(), scene.as_os_str()]);
    assert_eq!(run.code, Some(0), "{}", run.err);
    let text = fs::read_to_string(folder.path().join("out").join(file)).expect("a report");
    serde_json::from_str(&text).expect("JSON")
}

/// One warning that says all `parts` and can be silenced by `name`.
fn assert_silenced_by(name: &str, parts: &[&str], edits: &[(&str, &str)]) {
    let is_told = |warning: &String| parts.iter().all(|part| warning.contains(part));
    let found = warnings("run", "summary.json", edits);
    let told: Vec<&String> = found.iter().filter(|warning| is_told(warning)).collect();
    assert_eq!(told.len(), 1, "{parts:?}: {found:#?}");
    let key = format!("silence = [\"{name}\"]");
    assert!(told[0].contains(&key), "{key}: {}", told[0]);
    let silence = format!("[warnings]\n{key}\n\n[boundary.bottom]");
    let edits = [edits, &[("[boundary.bottom]", silence.as_str())]].concat();
    let rest = warnings("run", "summary.json", &edits);
    assert_eq!(rest.len() + 1, found.len(), "{rest:#?}");
    assert!(!rest.iter().any(is_told), "{rest:#?}");
}

#[test]
fn values_that_are_hardly_meant_are_warned_of_and_solved() {
    let edits = [
        ("young_modulus = 1e9", "young_modulus = 40"),
        ("aperture = 1e-4", "aperture = 3"),
        ("normal_stiffness = 1e10", "normal_stiffness = \"20 GPa/m\""),
    ];
    for (command, file) in [("run", "summary.json"), ("inspect", "inspect.json")] {
        let found = warnings(command, file, &edits);
        for parts in [
            ["scene.toml:7: `young_modulus` = 40", "40 GPa = 4e10 Pa"],
            [
                "scene.toml:11: `aperture` = 3 in [fracture.joint]",
                "3 mm = 0.003 m",
            ],
            ["the aperture of `joint`, 3 m, is larger", "its facets"],
        ] {
            let is_told = |warning: &String| parts.iter().all(|part| warning.contains(part));
            assert!(found.iter().any(is_told), "{parts:?}: {found:#?}");
        }
    }
}

#[test]
fn common_values_raise_no_doubt() {
    assert_eq!(warnings("run", "summary.json", &[]), Vec::<String>::new());
}

#[test]
fn every_warning_of_a_result_is_silenced_by_its_key() {
    assert_silenced_by(
        "values",
        &["`young_modulus` = 40"],
        &[("young_modulus = 1e9", "young_modulus = 40")],
    );
    assert_silenced_by(
        "large_displacements",
        &[
            "moves by up to",
            "in a body of 2.000e0 m",
            "displacements for small",
        ],
        &[("young_modulus = 1e9", "young_modulus = 5e4")],
    );
    assert_silenced_by(
        "wide_apertures",
        &[
            "the aperture of `joint` grows to",
            "on a facet of 1.138e0 m",
        ],
        &[
            ("normal_stiffness = 1e10", "normal_stiffness = 2e4"),
            ("[0, 0, -1e5]", "[0, 0, 1e5]"),
        ],
    );
    assert_silenced_by(
        "overlapping_walls",
        &["the walls of `joint` overlap"],
        &[("normal_stiffness = 1e10", "normal_stiffness = 2e8")],
    );
    assert_silenced_by(
        "idle_histories",
        &[
            "the history of [boundary.top] has the factor 0",
            "never acts",
        ],
        &[(
            "traction = [0, 0, -1e5]",
            "traction = [0, 0, -1e5]\nhistory = [[10, 0], [20, 1]]\n\n[load]\ntimes = [1, 2]",
        )],
    );
    assert_silenced_by(
        "body_size",
        &[
            "the body is 2.0000e0 m long",
            "out of proportion",
            "looks like km",
        ],
        &[("aperture = 1e-4", "aperture = 0.25")],
    );
}

/// The node on top is the only one that nothing holds. The pressure that is missing acts on it with
/// a third of the triangle below, 0.5 m2; the section of the box is (1 m 1 m 2 m)^(2/3).
#[test]
fn an_initial_stress_out_of_balance_is_told_with_its_force() {
    let stress = "[initial_stress]\nxx = -1e5\nyy = -1e5\nzz = -1e5\n\n[boundary.top]";
    let pressure = |size: &'static str| {
        [
            ("[boundary.top]", stress),
            ("traction = [0, 0, -1e5]", size),
        ]
    };
    let (force, share) = (0.5e5 * 0.5 / 3.0, 0.25 / 3.0 / 4_f64.cbrt());
    let (force, share) = (format!("{force:.3e} N"), format!("{:.0} %", 100.0 * share));
    assert_silenced_by(
        "initial_stress",
        &["the initial stress is out of balance", &force, &share],
        &pressure("pressure = 0.5e5"),
    );
    let balanced = warnings("run", "summary.json", &pressure("pressure = 1e5"));
    assert_eq!(balanced, Vec::<String>::new());
}

#[test]
fn surfaces_without_a_name_become_no_joints_where_others_have_names() {
    let edits = [("[fracture.joint]", "[fracture.default]")];
    let nameless = edited(MESH, &[("5\n1 5", "4\n1 5"), ("2 1 \"joint\"\n", "")]);
    for (command, file) in [("run", "summary.json"), ("inspect", "inspect.json")] {
        let found = warnings_on(&nameless, command, file, &edits);
        let parts = [
            "without a name, 1, stay welded",
            "[fracture.1]",
            "unnamed_surfaces",
        ];
        let is_told = |warning: &String| parts.iter().all(|part| warning.contains(part));
        assert!(found.iter().any(is_told), "{found:#?}");
    }
    let report = report(&nameless, "run", "summary.json", &edits);
    assert_eq!(
        report["fractures"].as_object().map(|all| all.len()),
        Some(0)
    );
}

#[test]
fn in_a_mesh_without_names_numbers_serve() {
    let (head, rest) = MESH.split_once("$PhysicalNames").expect("names");
    let (_, rest) = rest.split_once("$EndPhysicalNames\n").expect("names");
    let edits = [
        ("[fracture.joint]", "[fracture.default]"),
        ("[rock.rock]", "[rock.default]"),
        ("[boundary.top]", "[boundary.2]"),
        ("[boundary.bottom]", "[boundary.3]"),
    ];
    // What the scene names by its place is no name of the mesh.
    let placed = ("[boundary.bottom]", "[boundary.low]\nwhere = \"x = min\"");
    for bottom in [edits[3], placed] {
        let edits = [&edits[..3], &[bottom]].concat();
        let report = report(&format!("{head}{rest}"), "run", "summary.json", &edits);
        let fractures = report["fractures"].as_object().expect("fractures");
        assert_eq!(fractures.keys().collect::<Vec<_>>(), ["1"]);
        assert_eq!(report["warnings"].as_array().map(Vec::len), Some(0));
    }
}

#[test]
fn a_second_group_on_a_fracture_is_not_called_welded() {
    let edits = [
        ("5\n1 5", "6\n2 6 \"twin\"\n1 5"),
        ("1 0 0 0 1 1 0 1 1 0", "1 0 0 0 1 1 0 2 1 6 0"),
    ];
    let mesh = edited(MESH, &edits);
    let inspected = report(&mesh, "inspect", "inspect.json", &[]);
    let groups = inspected["groups"].as_array().expect("groups");
    let twin = groups.iter().find(|group| group["name"] == "twin");
    assert_eq!(twin.expect("a group")["role"], "on fracture");
    let report = report(&mesh, "run", "summary.json", &[]);
    let decisions = report["decisions"].as_array().expect("decisions").iter();
    let told: Vec<&str> = decisions.filter_map(Value::as_str).collect();
    let of_twin: Vec<&&str> = told.iter().filter(|text| text.contains("twin")).collect();
    assert_eq!(of_twin.len(), 1, "{told:#?}");
    assert!(of_twin[0].contains("part of a fracture"), "{}", of_twin[0]);
}
