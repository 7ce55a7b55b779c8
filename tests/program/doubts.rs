//! Values that are possible but hardly meant: the run goes on, and says which unit they look like.

use std::fs;

use serde_json::Value;

use crate::harness::{edited, kluft, scratch};

const SCENE: &str = include_str!("bad_input/base.toml");
const MESH: &str = include_str!("bad_input/base.msh");

/// What a command warns of on the scene with these edits, as its JSON file has it.
fn warnings(command: &str, file: &str, edits: &[(&str, &str)]) -> Vec<String> {
    let folder = scratch();
    let scene = folder.path().join("scene.toml");
    fs::write(&scene, edited(SCENE, edits)).expect("a scene");
    fs::write(folder.path().join("base.msh"), MESH).expect("a mesh");
    let run = kluft(&[command.as_ref(), scene.as_os_str()]);
    assert_eq!(run.code, Some(0), "{}", run.err);
    let text = fs::read_to_string(folder.path().join("out").join(file)).expect("a report");
    let report: Value = serde_json::from_str(&text).expect("JSON");
    let warnings = report["warnings"].as_array().expect("warnings").iter();
    warnings
        .map(|warning| warning.as_str().expect("a text").to_owned())
        .collect()
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
