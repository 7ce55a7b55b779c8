//! No scene with a fluid loses or makes any.

use std::fs;

use crate::harness::{Workshop, root, summary};

/// Largest share of what moves in a step that may be missing, but for what rounding explains where
/// next to nothing moves any more.
const TOLERANCE: f64 = 1e-10;

/// What makes each scene with a fluid small.
const SMALL: [(&str, &[(&str, &str)]); 7] = [
    ("filling-joint", &[]),
    ("flow-star", &[]),
    (
        "injection",
        &[
            ("h = 1.5, h_joint = 0.6", "h = 2.5, h_joint = 1.2"),
            (
                "times = [1, 3, 10, 20, 40, 60, 61, 65, 75, 100, 150, 300]",
                "times = [3, 60, 61, 300]",
            ),
        ],
    ),
    (
        "network-flow",
        &[(
            "h = 1.0, h_fracture = 0.4, h_intersection = 0.3",
            "h = 2.0, h_fracture = 1.5, h_intersection = 1.5",
        )],
    ),
    ("pressurised-fault", &[("h = 0.02, half", "h = 0.16, half")]),
    (
        "shear-stimulation",
        &[
            ("h = 1.5, h_joint = 0.6", "h = 2.5, h_joint = 1.2"),
            (
                "times = [1, 5, 20, 40, 60, 80, 100, 120, 140, 160, 180, 200, 220, 240, 260, 280, 300]",
                "times = [1, 20, 80, 300]",
            ),
        ],
    ),
    ("standing-water", &[]),
];

#[test]
fn no_step_of_any_scene_loses_mass() {
    let folders = fs::read_dir(root().join("geometries")).expect("geometries");
    for folder in folders {
        let folder = folder.expect("an entry").path();
        let Ok(scene) = fs::read_to_string(folder.join("scene.toml")) else {
            continue;
        };
        if !scene.contains("\n[fluid]\n") {
            continue;
        }
        let name = folder.file_name().expect("a name").to_string_lossy();
        let small = SMALL.iter().find(|(own, _)| *own == name);
        let (_, edits) = small.unwrap_or_else(|| panic!("{name} is not made small here"));
        let workshop = Workshop::new(&name, edits);
        let run = workshop.run("out", &["-q"]);
        assert_eq!(run.code, Some(0), "{name}: {}", run.err);
        let said = summary(&workshop.path("out"));
        let steps = said["steps"].as_array().expect("steps");
        assert!(!steps.is_empty(), "{name}");
        for step in steps {
            let share = |key: &str| step["flow"][key].as_f64().expect("a share");
            let explained = share("mass_rounding");
            assert!(
                share("mass_error") <= f64::max(TOLERANCE, explained),
                "{name}: {step}"
            );
        }
    }
}
