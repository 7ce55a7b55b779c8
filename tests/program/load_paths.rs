//! Load steps in time: phases, histories, and what the results say of them.

use serde_json::{Value, json};

use crate::harness::{Workshop, files, kluft, summary};
use crate::read_back::read_back;

/// Loading in two steps, unloading in one.
const PHASES: (&str, &str) = (
    "[mesh]",
    "[[load.phase]]\nname = \"loading\"\nuntil = 1.0\nsteps = 2\n\n[[load.phase]]\nname = \"unloading\"\nuntil = 3.5\n\n[mesh]",
);

const TOP: &str = "traction = [0.0, 0.0, -7e3]";

fn column<'a>(steps: &'a [Value], key: &str) -> Vec<&'a Value> {
    steps.iter().map(|step| &step[key]).collect()
}

fn times(found: &Value) -> Vec<f64> {
    let steps = found["steps"].as_array().expect("steps").iter();
    steps
        .map(|step| step["time"].as_f64().expect("a time"))
        .collect()
}

#[test]
fn phases_and_times_are_in_the_results() {
    let history = format!("{TOP}\nhistory = [[0, 0], [1, 1], [3.5, -0.25]]");
    let workshop = Workshop::new("inclined-joint", &[PHASES, (TOP, &history)]);
    let out = workshop.solve("out", &[]);
    let (found, said) = (read_back(&out), summary(&out));
    for collection in ["rock", "fractures"] {
        assert_eq!(times(&found[collection]), [0.5, 1.0, 3.5]);
    }
    let steps = said["steps"].as_array().expect("steps");
    let phases = [&json!("loading"), &json!("loading"), &json!("unloading")];
    assert_eq!(column(steps, "phase"), phases);
    assert_eq!(
        column(steps, "time"),
        [&json!(0.5), &json!(1.0), &json!(3.5)]
    );
    assert_eq!(
        column(steps, "load"),
        [&json!(0.5), &json!(1.0), &json!(-0.25)]
    );
    let joint = &said["fractures"]["joint"];
    // -0.25 times the closed form of the scene: tension, in which the law is linear.
    let traction = joint["normal_traction"]["mean"]
        .as_f64()
        .expect("a traction");
    assert!(
        (traction / (0.25 * 2892.2312) - 1.0).abs() < 1e-6,
        "{traction}"
    );
    let aperture = joint["aperture"]["mean"].as_f64().expect("an aperture");
    assert!((aperture / (1e-5 * (1.0 + 0.25 * 2.8922312)) - 1.0).abs() < 1e-6);
}

#[test]
fn the_report_names_phases_and_factors() {
    let gravity = "[body]\ngravity = [0, 0, -10]\nhistory = [[0, 0], [0.75, 1]]\n\n[mesh]";
    let edits = [
        (
            "poisson_ratio = 0.22",
            "poisson_ratio = 0.22\ndensity = 2000",
        ),
        ("[mesh]", &PHASES.1.replace("[mesh]", gravity)[..]),
    ];
    let workshop = Workshop::new("inclined-joint", &edits);
    let run = workshop.run("out", &["-v"]);
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
    for line in [
        "2 load cases, each with its own history: [boundary.top]; [body]",
        "the history of [body] has a point at time 0.75, where no load step ends",
        "step 1 of 3, phase loading, time 0.5, loads 0.5 0.66",
        "step 3 of 3, phase unloading, time 3.5, loads 1 1\n",
    ] {
        assert!(run.out.contains(line), "{line:?} is not in\n{}", run.out);
    }
    let said = summary(&workshop.path("out"));
    let steps = said["steps"].as_array().expect("steps");
    assert!(steps.iter().all(|step| step.get("load").is_none()));
}

#[test]
fn an_inspection_tells_histories_and_weighs_the_largest_factor() {
    let history = format!("{TOP}\nhistory = [[0, 0], [1, 1e3], [3.5, 0]]");
    let workshop = Workshop::new("inclined-joint", &[PHASES, (TOP, &history)]);
    let (scene, out) = (workshop.scene(), workshop.path("out"));
    let arguments = [
        "inspect".as_ref(),
        scene.as_os_str(),
        "--out".as_ref(),
        out.as_os_str(),
    ];
    let run = kluft(&arguments);
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
    // 7 kPa times 1000; the walls would meet at 31 kPa.
    for text in [
        "traction (0, 0, -7000) Pa; history of 3 points",
        "up to 7.000e6 Pa",
    ] {
        let words: Vec<&str> = run.out.split_whitespace().collect();
        assert!(
            words.join(" ").contains(text),
            "{text:?} is not in\n{}",
            run.out
        );
    }
}

/// Without a history a condition grows in the first step and stays.
#[test]
fn times_alone_repeat_the_full_load() {
    let times = ("[mesh]", "[load]\ntimes = [1.0, 3.0]\n\n[mesh]");
    let workshop = Workshop::new("inclined-joint", &[times]);
    let timed = workshop.solve("timed", &[]);
    let untimed = Workshop::new("inclined-joint", &[]);
    let plain = untimed.solve("plain", &[]);
    let (timed, said, plain) = (files(&timed), summary(&timed), files(&plain));
    assert_eq!(timed["rock_0001.vtu"], plain["rock_0001.vtu"]);
    let steps = said["steps"].as_array().expect("steps");
    assert_eq!(column(steps, "load"), [&json!(1.0), &json!(1.0)]);
    assert_eq!(column(steps, "time"), [&json!(1.0), &json!(3.0)]);
    assert!(steps.iter().all(|step| step.get("phase").is_none()));
}

#[test]
fn a_step_that_fails_is_named_by_its_phase() {
    let top = "traction = [0.0, 0.0, -1e11]\nhistory = [[1, 1e-9], [3.5, 1]]";
    let edits = [PHASES, ("cutoff_aperture = 1e-7\n", ""), (TOP, top)];
    let workshop = Workshop::new("inclined-joint", &edits);
    let run = workshop.run("out", &[]);
    assert_eq!(run.code, Some(1), "{}", run.err);
    let says = "not converged: step 3 (phase unloading, time 3.5, load 1)";
    assert!(run.err.contains(says), "{}", run.err);
}

/// Closing is smooth, so a body that is unloaded again and again returns each time, with each
/// solver. Nearly all forces are gone then, and what the fractures hold is far below them.
#[test]
fn a_body_that_is_unloaded_again_and_again_returns() {
    for solver in ["direct", "condensed", "iterative"] {
        let coarse = ("parameters = { h = 0.2", "parameters = { h = 0.4");
        let cycles = ["0.0, 0.5, 1.0, 0.5"; 4].join(", ");
        let load =
            format!("[solver]\nlinear = \"{solver}\"\n\n[load]\nsteps = [{cycles}]\n\n[mesh]");
        let edits = [coarse, ("[mesh]", &load[..])];
        let workshop = Workshop::new("closing-blocks", &edits);
        let said = summary(&workshop.solve("out", &[]));
        let steps = said["steps"].as_array().expect("steps");
        let closed = |step: &Value| {
            let aperture = &step["fractures"]["bedding"]["aperture"];
            ["min", "max"].map(|which| aperture[which].as_f64().expect("a number"))
        };
        for (number, step) in steps.iter().enumerate() {
            let first = [0, 1, 2, 1][number % 4];
            for (found, before) in closed(step).into_iter().zip(closed(&steps[first])) {
                let apart = (found - before).abs();
                assert!(apart < 1e-12, "{solver}: step {number} is {apart:e} m off");
            }
        }
    }
}
