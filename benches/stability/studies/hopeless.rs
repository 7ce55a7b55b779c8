//! Scenes without a solution, by the program itself: how it ends, and what it says.

use std::fs;
use std::path::Path;
use std::process::Command;

use super::{Effort, Finding, Study, Table};

pub const STUDY: Study = Study {
    name: "hopeless",
    title: "Scenes without a solution",
    sweep: "blocks that nothing holds: pulled off, sliding down, between two open joints",
    run,
};

/// A column cut by a joint that dips by 50 degrees; `fracture` and `load` are lines of the scene.
struct Scene {
    name: &'static str,
    fracture: &'static str,
    load: &'static str,
}

const SCENES: [Scene; 6] = [
    Scene {
        name: "pulled off, no tension",
        fracture: "normal_stiffness = 50e9\nshear_stiffness = 20e9\ntension_cutoff = true",
        load: "traction = [0.0, 0.0, 1e6]",
    },
    Scene {
        name: "pulled off between rollers, contact",
        fracture: "closure = \"contact\"",
        load: "traction = [0.0, 0.0, 1e6]\n[boundary.left]\nsymmetry = true\n[boundary.right]\nsymmetry = true\n\
               [boundary.front]\nsymmetry = true",
    },
    Scene {
        name: "sliding down, contact without friction",
        fracture: "closure = \"contact\"",
        load: "traction = [0.0, 0.0, -5e6]",
    },
    Scene {
        name: "pulled off, logarithmic without tension",
        fracture: "closure = \"logarithmic\"\nnormal_stiffness = 50e9\nshear_stiffness = 20e9\ntension_cutoff = true",
        load: "traction = [0.0, 0.0, 1e6]",
    },
    Scene {
        name: "sliding down, friction angle below the dip",
        fracture: "normal_stiffness = 50e9\nshear_stiffness = 20e9\nfriction_angle = 30",
        load: "traction = [0.0, 0.0, -5e6]",
    },
    Scene {
        name: "sliding down, contact, friction angle below the dip",
        fracture: "closure = \"contact\"\nfriction_angle = 30",
        load: "traction = [0.0, 0.0, -5e6]",
    },
];

/// What must hold: the message names the fracture or one of the blocks.
const NAMES: [&str; 2] = ["joint", "block"];

fn text(scene: &Scene) -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let geometry = root.join("geometries/inclined-joint/inclined-joint.geo");
    format!(
        "[mesh]\ngeometry = \"{}\"\nparameters = {{ h = 0.4, dip = 50 }}\n\
         [rock.default]\nyoung_modulus = 25e9\npoisson_ratio = 0.25\n\
         [fracture.joint]\naperture = 1e-4\n{}\n[boundary.top]\n{}\n\
         [boundary.bottom]\ndisplacement = {{ x = 0.0, y = 0.0, z = 0.0 }}\n",
        geometry.display(),
        scene.fracture,
        scene.load
    )
}

/// Exit code and error message of the program.
fn run_program(scene: &Scene) -> (Option<i32>, String) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("scene.toml");
    fs::write(&file, text(scene)).expect("a writable folder");
    let mut command = Command::new(env!("CARGO_BIN_EXE_kluft"));
    let output = command
        .arg("run")
        .arg(&file)
        .output()
        .expect("the program starts");
    let message = String::from_utf8_lossy(&output.stderr);
    let message = message.replace(&*folder.path().to_string_lossy(), "");
    (
        output.status.code(),
        message.split_whitespace().collect::<Vec<_>>().join(" "),
    )
}

fn run(effort: Effort) -> Finding {
    let scenes = if effort == Effort::Quick {
        &SCENES[..3]
    } else {
        &SCENES[..]
    };
    let mut table = Table::new(&["scene", "exit code", "message"]);
    let mut misses = Vec::new();
    let mut held = 0;
    for scene in scenes {
        let (code, message) = run_program(scene);
        let names = NAMES.iter().any(|name| message.contains(name));
        let fits = code == Some(1) && names;
        let code = code.map_or("signal".to_owned(), |code| code.to_string());
        if fits {
            held += 1;
        } else {
            misses.push(format!("{}: exit code {code}: {message}", scene.name));
        }
        table.push([scene.name.to_owned(), code, message]);
    }
    let all = scenes.len();
    Finding {
        breaks: "an iteration that goes on for ever, or results that look like some".to_owned(),
        ours: format!("{held} of {all} scenes end with the block or fracture named"),
        paragraph: format!(
            "A block that is pulled off a joint without tension, or slides down a joint steeper than its friction, has \
             no equilibrium. Kluft says which block moves how, and which fracture lets it go, in {held} of {all} such scenes \
             (a column cut by a joint that dips by 50 degrees, run by the program itself): with exit code 1, after as \
             much of the load as could be carried."
        ),
        charts: Vec::new(),
        table,
        misses,
    }
}
