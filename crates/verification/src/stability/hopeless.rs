//! Scenes without a solution, by the program itself: how it ends, and what it says.

use std::fs;

use kluft_run::Ending;

use crate::report::{Effort, Finding, Study, Table};
use crate::root;
use crate::scenes::run_scene_file;

/// The study.
pub const STUDY: Study = Study {
    name: "hopeless",
    title: "Scenes without a solution",
    subject: "blocks that nothing holds: pulled off, sliding down, between two open joints",
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
        load: "traction = [0.0, 0.0, 1e6]\n[boundary.left]\nsymmetry = \
               true\n[boundary.right]\nsymmetry = true\n[boundary.front]\nsymmetry = true",
    },
    Scene {
        name: "sliding down, contact without friction",
        fracture: "closure = \"contact\"",
        load: "traction = [0.0, 0.0, -5e6]",
    },
    Scene {
        name: "pulled off, logarithmic without tension",
        fracture: "closure = \"logarithmic\"\nnormal_stiffness = 50e9\nshear_stiffness = \
                   20e9\ntension_cutoff = true",
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
    let geometry = root().join("geometries/inclined-joint/inclined-joint.geo");
    format!(
        "[mesh]\ngeometry = \"{}\"\nparameters = {{ h = 0.4, dip = 50 \
         }}\n[rock.default]\nyoung_modulus = 25e9\npoisson_ratio = \
         0.25\n[fracture.joint]\naperture = \
         1e-4\n{}\n[boundary.top]\n{}\n[boundary.bottom]\ndisplacement = {{ x = 0.0, y = 0.0, z = \
         0.0 }}\n",
        geometry.display(),
        scene.fracture,
        scene.load
    )
}

/// How the program ends.
struct End {
    exit_code: u8,
    /// What it says of its failure, in one line.
    message: String,
}

fn run_program(scene: &Scene) -> End {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("scene.toml");
    fs::write(&file, text(scene)).expect("a writable folder");
    let (exit_code, message) = match run_scene_file(&file, &folder.path().join("out")) {
        Err(defects) => (
            2,
            defects.iter().map(ToString::to_string).collect::<String>(),
        ),
        Ok(outcome) => match outcome.ending {
            Ending::NotConverged(why) => (1, format!("not converged: {why}")),
            _ => (0, String::new()),
        },
    };
    let message = message.replace(&*folder.path().to_string_lossy(), "");
    End {
        exit_code,
        message: message.split_whitespace().collect::<Vec<_>>().join(" "),
    }
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
        let End { exit_code, message } = run_program(scene);
        if exit_code == 1 && NAMES.iter().any(|name| message.contains(name)) {
            held += 1;
        } else {
            misses.push(format!("{}: exit code {exit_code}: {message}", scene.name));
        }
        table.push([scene.name.to_owned(), exit_code.to_string(), message]);
    }
    let all = scenes.len();
    Finding::new([
        "an iteration that goes on for ever, or results that look like some".to_owned(),
        format!("{held} of {all} scenes end with the block or fracture named"),
    ])
    .text(format!(
        "A block that is pulled off a joint without tension, or slides down a joint steeper than \
         its friction, has no equilibrium. Kluft says which block moves how, and which fracture \
         lets it go, in {held} of {all} such scenes (a column cut by a joint that dips by 50 \
         degrees, run by the program itself): with exit code 1, after as much of the load as could \
         be carried."
    ))
    .numbers(table)
    .missing(misses)
}
