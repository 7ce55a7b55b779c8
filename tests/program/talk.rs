//! What the program says, to whom, and what it keeps when it fails.

use serde_json::json;

use crate::harness::{KLUFT, Run, Workshop, command, files, summary};
use crate::read_back::read_back;

const STEPS: (&str, &str) = ("[mesh]", "[load]\nsteps = [0.25, 0.5, 1.0]\n\n[mesh]");

fn times(found: &serde_json::Value) -> Vec<f64> {
    let steps = found["steps"].as_array().expect("steps");
    steps
        .iter()
        .map(|step| step["time"].as_f64().expect("a time"))
        .collect()
}

#[test]
fn every_load_step_is_an_entry_of_the_collections() {
    let workshop = Workshop::new("inclined-joint", &[STEPS]);
    let out = workshop.solve("out", &[]);
    let (found, said) = (read_back(&out), summary(&out));
    assert_eq!(times(&found["rock"]), [1.0, 2.0, 3.0]);
    assert_eq!(times(&found["fractures"]), [1.0, 2.0, 3.0]);
    let steps = said["steps"].as_array().expect("steps");
    let loads: Vec<&serde_json::Value> = steps.iter().map(|step| &step["load"]).collect();
    assert_eq!(loads, [&json!(0.25), &json!(0.5), &json!(1.0)]);
    assert!(steps.iter().all(|step| step["converged"] == json!(true)));
    assert_eq!(
        files(&out).len(),
        14,
        "three steps, the mesh, two collections, the last step in one, a summary, a page, a history, \
         a checkpoint"
    );
}

/// Loads that no number holds: a law without a cutoff at 1e8 times its stiffness times aperture.
const ABSURD: [(&str, &str); 2] = [
    ("cutoff_aperture = 1e-7\n", ""),
    (
        "traction = [0.0, 0.0, -7e3]",
        "traction = [0.0, 0.0, -1e11]",
    ),
];

#[test]
fn a_step_that_cannot_converge_leaves_the_ones_before() {
    let steps = ("[mesh]", "[load]\nsteps = [1e-9, 1e-8, 1.0]\n\n[mesh]");
    let workshop = Workshop::new("inclined-joint", &[ABSURD[0], ABSURD[1], steps]);
    let run = workshop.run("out", &[]);
    assert_eq!((run.code, run.out.as_str()), (Some(1), ""), "{}", run.err);
    for text in [
        "not converged: step 3 (load 1)",
        "fracture `joint`, facet at node ",
        "no longer finite",
        "units",
    ] {
        assert!(run.err.contains(text), "{text}: {}", run.err);
    }
    let out = workshop.path("out");
    assert_eq!(times(&read_back(&out)["rock"]), [1.0, 2.0]);
    let said = summary(&out);
    let converged: Vec<_> = said["steps"]
        .as_array()
        .expect("steps")
        .iter()
        .map(|s| &s["converged"])
        .collect();
    assert_eq!(converged, [&json!(true), &json!(true), &json!(false)]);
    assert_eq!(
        files(&out).len(),
        12,
        "two steps, the mesh, two collections, the last step in one, a summary, a page, a history, \
         a checkpoint"
    );
}

#[test]
fn a_failure_in_the_first_step_leaves_no_results_of_another_run() {
    let workshop = Workshop::new("inclined-joint", &[STEPS]);
    workshop.solve("out", &[]);
    let absurd = Workshop::new("inclined-joint", &ABSURD);
    std::fs::copy(absurd.scene(), workshop.scene()).expect("the scene is replaced");
    assert_eq!(workshop.run("out", &[]).code, Some(1));
    let left: Vec<String> = files(&workshop.path("out")).into_keys().collect();
    let grids = left
        .iter()
        .filter(|name| name.ends_with(".vtu") || name.ends_with(".pvd"));
    assert_eq!(
        grids.collect::<Vec<_>>(),
        Vec::<&String>::new(),
        "beside the summary of the failure"
    );
}

#[test]
fn fewer_steps_leave_no_grids_of_a_run_with_more() {
    let workshop = Workshop::new("inclined-joint", &[STEPS]);
    workshop.solve("out", &[]);
    let single = Workshop::new("inclined-joint", &[]);
    std::fs::copy(single.scene(), workshop.scene()).expect("the scene is replaced");
    let left: Vec<String> = files(&workshop.solve("out", &[])).into_keys().collect();
    assert!(
        !left
            .iter()
            .any(|name| name.contains("_0002") || name.contains("_0003")),
        "{left:?}"
    );
}

fn assert_report(text: &str) {
    for part in [
        "Inclined joint, closing under 7 kPa",
        "read ",
        "enriched ",
        "decided ",
        "closure of joint is nonlinear",
        "step 1 of 1, load 1",
        "aperture min / mean / max [m]",
        "\njoint         104",
        "took ",
        "rock.pvd and ",
    ] {
        let on_one_line = text.replace("\r", "").replace("\n           ", " ");
        let is_said = text.contains(part) || on_one_line.contains(part);
        assert!(is_said, "{part:?} is not in\n{text}");
    }
}

#[test]
fn verbose_reports_without_a_terminal() {
    let workshop = Workshop::new("inclined-joint", &[]);
    let run = workshop.run("out", &["-v"]);
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
    assert_report(&run.out);
    for part in ["  iteration  force balance", "          1  "] {
        assert!(run.out.contains(part), "{part:?} is not in\n{}", run.out);
    }
    assert!(!run.out.contains("-0.0000"), "{}", run.out);
    assert!(
        !run.out.contains('\x1b'),
        "control sequences in a file:\n{}",
        run.out
    );
}

#[test]
fn the_summary_has_no_negative_zeros() {
    let workshop = Workshop::new("inclined-joint", &[]);
    let out = workshop.solve("out", &[]);
    let text = std::fs::read_to_string(out.join("summary.json")).expect("summary.json");
    let mut numbers = text.split([' ', ',', '\n']);
    assert!(numbers.all(|number| number != "-0.0"), "{text}");
}

/// Runs under a pseudo-terminal; none where `script` of util-linux is not installed.
fn on_a_terminal(workshop: &Workshop, flags: &str) -> Option<Run> {
    let (scene, out) = (workshop.scene(), workshop.path("out"));
    let program = KLUFT;
    let line = format!(
        "'{program}' run '{}' --out '{}' {flags}",
        scene.display(),
        out.display()
    );
    let output = command("script")
        .args(["-qec", &line, "/dev/null"])
        .env("TERM", "xterm")
        .output();
    let run: Run = output.ok()?.into();
    Some(Run {
        out: run.out.replace("\r\n", "\n"),
        ..run
    })
}

#[test]
fn a_terminal_gets_the_report() {
    let workshop = Workshop::new("inclined-joint", &[]);
    let Some(run) = on_a_terminal(&workshop, "") else {
        return;
    };
    assert_eq!(run.code, Some(0), "{}{}", run.out, run.err);
    assert_report(&run.out);
}

#[test]
fn quiet_is_quiet_on_a_terminal_too() {
    let workshop = Workshop::new("inclined-joint", &[]);
    let Some(run) = on_a_terminal(&workshop, "--quiet") else {
        return;
    };
    assert_eq!((run.code, run.out.as_str()), (Some(0), ""));
}

#[test]
fn quiet_still_tells_errors() {
    let workshop = Workshop::new("inclined-joint", &[("young_modulus", "young_modulas")]);
    let run = workshop.run("out", &["--quiet"]);
    assert_eq!((run.code, run.out.as_str()), (Some(2), ""));
    assert!(
        run.err.contains("did you mean `young_modulus`?"),
        "{}",
        run.err
    );
}
