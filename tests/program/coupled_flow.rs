//! Flow that follows the walls of fractures, beside closed forms and mechanics alone.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::harness::{Workshop, files, kluft, summary};

fn is_close(found: f64, expected: f64, tolerance: f64) {
    let error = (found - expected).abs();
    assert!(error <= tolerance * expected.abs(), "{found} {expected}");
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

/// What has entered through the only source at the end of the last load step (m^3).
fn entered(folder: &Path) -> f64 {
    let text = fs::read_to_string(folder.join("sources.csv")).expect("sources.csv");
    let last = text
        .lines()
        .last()
        .and_then(|line| line.split(',').next_back());
    last.and_then(|cell| cell.parse().ok()).expect("a number")
}

/// The similarity solution of a joint that fills (Wijesinghe 1986), step by step as given and as
/// the program divides the steps.
#[test]
fn a_joint_that_fills_takes_up_what_the_closed_form_says() {
    let workshop = Workshop::new("filling-joint", &[]);
    let out = workshop.solve("out", &[]);
    is_close(entered(&out), 1.868_300e-5, 3e-3);
    let said = summary(&out);
    let steps = said["steps"].as_array().expect("steps");
    for step in steps {
        assert!(number(&step["flow"]["mass_error"]) <= 1e-10, "{step}");
    }
    let kept = number(&steps[9]["flow"]["stored"]) / number(&steps[9]["flow"]["inflow"]);
    is_close(kept, 1.0, 1e-9);
    let coarse = Workshop::new(
        "filling-joint",
        &[("[load]", "[solver]\ntime_accuracy = 1\n\n[load]")],
    );
    let coarse = coarse.solve("out", &[]);
    let error = |folder: &Path| (entered(folder) / 1.868_300e-5 - 1.0).abs();
    assert!(
        error(&coarse) > 2.0 * error(&out),
        "{} {}",
        error(&coarse),
        error(&out)
    );
}

/// A fault in contact slips by what its water takes from friction, in one step and in twenty.
#[test]
fn a_pressurised_fault_slips_by_its_closed_form() {
    let twenty: Vec<String> = (1..=20)
        .map(|n| format!("{}", f64::from(n) / 20.0))
        .collect();
    let twenty = format!("steps = [{}]", twenty.join(", "));
    for steps in ["steps = [1]", &twenty] {
        let edits = [("h = 0.02, half", "h = 0.16, half"), ("steps = [1]", steps)];
        let said = summary(&Workshop::new("pressurised-fault", &edits).solve("out", &[]));
        let measures = said["measures"].as_array().expect("measures");
        let slip = measures.iter().find(|own| own["name"] == "slip_l2");
        let error = number(&slip.expect("a measure")["error"]);
        assert!(error < 0.01, "{steps}: {error}");
    }
}

/// What a borehole feeds into three joints is in them or has left through the level one.
#[test]
fn an_injection_into_three_joints_loses_nothing() {
    let edits = [
        ("h = 1.5, h_joint = 0.6", "h = 2.5, h_joint = 1.2"),
        (
            "times = [1, 3, 10, 20, 40, 60, 61, 65, 75, 100, 150, 300]",
            "times = [10, 30, 60]",
        ),
    ];
    let workshop = Workshop::new("injection", &edits);
    let out = workshop.solve("out", &[]);
    let said = summary(&out);
    let steps = said["steps"].as_array().expect("steps");
    for step in steps {
        assert!(number(&step["flow"]["mass_error"]) <= 1e-10, "{step}");
    }
    let sources = steps[2]["flow"]["sources"].as_array().expect("sources");
    let of = |name: &str| {
        let found = sources.iter().find(|source| source["name"] == name);
        found.expect("a source")
    };
    let entered = number(&of("well")["volume"]);
    is_close(entered, 6e-3, 1e-12);
    assert!(number(&of("well")["pressure"]) > 4e6);
    let left = -number(&of("[boundary.right]")["volume"]);
    assert!(left > 0.5 * entered && left < entered, "{left}");
    // All joints have opened.
    let fractures = said["flow"]["fractures"].as_array().expect("fractures");
    for fracture in fractures {
        assert!(number(&fracture["pressure"]["mean"]) > 3.05e6, "{fracture}");
    }
}

/// A joint whose fluid has left again takes its steps as they are.
#[test]
fn nothing_is_divided_where_nothing_moves_any_more() {
    let edits = [
        (
            "viscosity = 1e-3",
            "viscosity = 1e-3\ninitial_pressure = 3e6",
        ),
        (
            "fluid_pressure = 0.9e6\nhistory = [[0, 1], [100, 1]]",
            "fluid_pressure = 3e6\nhistory = [[0, 1.3], [10, 1.3], [20, 1], [2e9, 1]]",
        ),
        (
            "times = [10, 20, 30, 40, 50, 60, 70, 80, 90, 100]",
            "times = [10, 20, 1e9, 2e9]",
        ),
    ];
    let said = summary(&Workshop::new("filling-joint", &edits).solve("out", &[]));
    let steps = said["steps"].as_array().expect("steps");
    let parts = steps[3]["substeps"].as_array().expect("parts");
    assert!(parts.len() <= 3, "{}", steps[3]);
}

#[test]
fn a_filling_joint_is_the_same_on_any_threads() {
    let short = (
        "times = [10, 20, 30, 40, 50, 60, 70, 80, 90, 100]",
        "times = [10, 20, 30]",
    );
    let workshop = Workshop::new("filling-joint", &[short]);
    let one = workshop.solve("one", &["--threads", "1"]);
    let two = workshop.solve("two", &["--threads", "2"]);
    let (mut ones, mut twos) = (files(&one), files(&two));
    for name in ["summary.json", "resume.bin", "report.html"] {
        assert!(
            ones.remove(name).is_some() && twos.remove(name).is_some(),
            "{name}"
        );
    }
    assert_eq!(ones, twos);
}

/// A pressure given all over a crack in contact, which slides against friction, does to it what the
/// same pressure does without a fluid.
#[test]
fn friction_slips_by_the_pressure_of_the_fluid() {
    let slip = |name: &str, edits: &[(&str, &str)]| {
        let coarse = [
            ("parameters = { h = 0.02", "parameters = { h = 0.16"),
            ("order = 2", "order = 1"),
        ];
        let edits: Vec<_> = coarse.iter().chain(edits).copied().collect();
        let workshop = Workshop::new("inclined-crack", &edits);
        let said = summary(&workshop.solve(name, &[]));
        let crack = &said["fractures"]["crack"];
        [&crack["slip_max"], &crack["normal_traction"]["mean"]].map(number)
    };
    let angle = "friction_angle = 30.0";
    let given = slip(
        "given",
        &[(angle, "friction_angle = 30.0\nfluid_pressure = 5e6")],
    );
    let flowing = [
        (
            angle,
            "friction_angle = 30.0\nfluid_pressure = 5e6\nresidual_hydraulic_aperture = 1e-6",
        ),
        ("[rock.rock]", "[fluid]\nviscosity = 1e-3\n\n[rock.rock]"),
    ];
    let flowing = slip("flowing", &flowing);
    for (flowing, given) in flowing.into_iter().zip(given) {
        is_close(flowing, given, 1e-8);
    }
}

#[test]
fn contact_that_leaves_nothing_open_is_refused() {
    let fluid = ("[rock.rock]", "[fluid]\nviscosity = 1e-3\n\n[rock.rock]");
    let pressed = (
        "friction_angle = 30.0",
        "friction_angle = 30.0\nfluid_pressure = 5e6",
    );
    let workshop = Workshop::new("inclined-crack", &[fluid, pressed]);
    let scene = workshop.scene();
    let run = kluft(&["run".as_ref(), scene.as_os_str()]);
    assert_eq!(run.code, Some(2), "{}", run.err);
    for said in ["fracture `crack`", "residual_hydraulic_aperture"] {
        assert!(run.err.contains(said), "{said}: {}", run.err);
    }
}

/// Fluid that enters where nothing leaves has a state at each time, though none that is steady; and
/// pressures cost what mechanics alone does not.
#[test]
fn an_inspection_knows_what_a_flow_in_time_asks_for() {
    let seconds = |edits: &[(&str, &str)]| {
        let workshop = Workshop::new("filling-joint", edits);
        let (scene, out) = (workshop.scene(), workshop.path("look"));
        let [command, to] = ["inspect", "--out"].map(AsRef::as_ref);
        let run = kluft(&[command, scene.as_os_str(), to, out.as_os_str()]);
        assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
        let text = fs::read_to_string(out.join("inspect.json")).expect("inspect.json");
        let said: Value = serde_json::from_str(&text).expect("JSON");
        let solvers = said["solvers"].as_array().expect("solvers");
        let direct = solvers.iter().find(|solver| solver["name"] == "direct");
        number(&direct.expect("a direct solver")["seconds"])
    };
    let filled = seconds(&[("fluid_pressure = 0.9e6", "fluid_inflow = 1e-7")]);
    let dry = [
        ("[fluid]\nviscosity = 1e-3\n\n", ""),
        ("fluid_pressure = 0.9e6", "pressure = 0.9e6"),
    ];
    assert!(filled > 3.0 * seconds(&dry), "{filled}");
}

#[test]
fn time_steps_that_no_division_makes_short_enough_are_told() {
    let times = "times = [10, 20, 30, 40, 50, 60, 70, 80, 90, 100]";
    let coarse = [
        ("first = 0.1", "first = 1.0"),
        (times, "times = [10, 1e4]"),
        ("[[0, 1], [100, 1]]", "[[0, 1], [1e4, 1]]"),
    ];
    let strict = ("[load]", "[solver]\ntime_accuracy = 1e-5\n\n[load]");
    let silent = (
        "[load]",
        "[warnings]\nsilence = [\"long_time_steps\"]\n\n[load]",
    );
    let warned = |edits: &[(&str, &str)]| {
        let workshop = Workshop::new("filling-joint", edits);
        let said = summary(&workshop.solve("out", &[]));
        said["warnings"]
            .to_string()
            .contains("[\\\"long_time_steps\\\"]")
    };
    let [a, b, c] = coarse;
    assert!(warned(&[a, b, c, strict]));
    assert!(!warned(&[a, b, c, silent, strict]));
    assert!(!warned(&[
        a,
        ("[load]", "[solver]\ntime_accuracy = 0.1\n\n[load]")
    ]));
}

/// A joint through the whole body conducts as the cube of its aperture, before it is pressed and
/// after: `x = 0.4240128` by its law.
#[test]
fn a_joint_that_closes_conducts_by_the_cube_of_its_aperture() {
    let asked = (
        "[boundary.left]",
        "[fluid]\nviscosity = 1e-3\nequivalent_permeability = true\n\n[boundary.left]",
    );
    let workshop = Workshop::new("pressed-joint", &[("h = 0.3", "h = 0.6"), asked]);
    let said = summary(&workshop.solve("out", &[]));
    let principal = |tensor: &Value| number(&tensor["principal"][0]["value"]);
    let found = &said["permeability"];
    is_close(principal(found), principal(&found["through_going"]), 1e-9);
    is_close(
        principal(&found["loaded"]) / principal(found),
        0.424_012_8_f64.powi(3),
        1e-6,
    );
    let scene = workshop.scene();
    let run = kluft(&["inspect".as_ref(), scene.as_os_str()]);
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
}

/// `D = b^3 K_n / (12 mu)` is 8.3e-3 m2/s, facets are some 0.6 m long and the joint is 25 m.
#[test]
fn times_that_make_no_sense_are_warned_of_with_the_unit_they_look_like() {
    let times = "times = [10, 20, 30, 40, 50, 60, 70, 80, 90, 100]";
    let told = |edits: &[(&str, &str)]| {
        let workshop = Workshop::new("filling-joint", edits);
        let run = kluft(&["inspect".as_ref(), workshop.scene().as_os_str()]);
        assert_eq!(run.code, Some(0), "{}", run.err);
        let text = fs::read_to_string(workshop.path("out").join("inspect.json"));
        let out: Value = serde_json::from_str(&text.expect("a report")).expect("JSON");
        let warnings = out["warnings"].as_array().expect("warnings").iter();
        let texts = warnings.filter_map(Value::as_str);
        let own = texts.filter(|text| text.contains("[\"fluid_times\"]"));
        own.collect::<Vec<_>>().join("\n")
    };
    assert_eq!(told(&[]), "");
    let said = told(&[(times, "times = [1e-3, 2e-3]")]);
    assert!(
        said.contains("nothing flows; times are in seconds, and look like hours"),
        "{said}"
    );
    let said = told(&[
        (times, "times = [10]"),
        ("viscosity = 1e-3", "viscosity = 5"),
    ]);
    assert!(
        said.contains("looks like mPa s: 5 mPa s = 0.005 Pa s"),
        "{said}"
    );
    let said = told(&[(times, "times = [1e13, 2e13]")]);
    assert!(
        said.contains("steady at the end of each; steps in place of times"),
        "{said}"
    );
    let silence = "[warnings]\nsilence = [\"fluid_times\"]\n\n[load]";
    assert_eq!(
        told(&[(times, "times = [1e-3, 2e-3]"), ("[load]", silence)]),
        ""
    );
}

/// A joint that water cannot leave keeps it: water that does not give way carries all of a load,
/// and one that does `(1 + c p) (b_0 - (sigma - p)/K_n) = b_0`.
#[test]
fn an_undrained_joint_carries_its_load_by_its_water() {
    let times = "times = [10, 20, 30, 40, 50, 60, 70, 80, 90, 100]";
    let closed = [
        (
            "[boundary.inlet]\nfluid_pressure = 0.9e6\nhistory = [[0, 1], [100, 1]]",
            "[boundary.top]\npressure = 4e5",
        ),
        (times, "steps = [0.5, 1]"),
    ];
    for (fluid, compressibility) in [
        ("viscosity = 1e-3\nisolated = \"undrained\"", 0.0),
        (
            "viscosity = 1e-3\nisolated = \"undrained\"\ncompressibility = 4e-7",
            4e-7,
        ),
    ] {
        let edits = [closed[0], closed[1], ("viscosity = 1e-3", fluid)];
        let said = summary(&Workshop::new("filling-joint", &edits).solve("out", &[]));
        let half = 0.5 * (compressibility * (1e6 - 4e5) + 1.0);
        let pressure: f64 = 4e5 / (half + f64::sqrt(half * half + compressibility * 4e5));
        let found = &said["flow"]["fractures"][0]["pressure"];
        is_close(number(&found["min"]), pressure, 1e-6);
        is_close(number(&found["max"]), pressure, 1e-6);
        let decided = said["decisions"].to_string();
        assert!(
            decided.contains("1 of 1 networks are undrained"),
            "{decided}"
        );
    }
    let refused = Workshop::new("filling-joint", &closed).run("out", &[]);
    assert_eq!(refused.code, Some(2));
    assert!(
        refused.err.contains("\"undrained\" lets those"),
        "{}",
        refused.err
    );
    let rigid = (
        "viscosity = 1e-3",
        "viscosity = 1e-3\nisolated = \"undrained\"",
    );
    let refused = Workshop::new("flow-star", &[rigid]).run("out", &[]);
    assert_eq!(refused.code, Some(2));
    assert!(refused.err.contains("the rock is rigid"), "{}", refused.err);
}

/// What leaks off from a joint is told, and is Carter's `4 A C sqrt(t)`; a steady flow has none.
#[test]
fn what_leaks_off_is_in_the_balance() {
    let leaking = (
        "normal_stiffness = 1e11",
        "normal_stiffness = 1e11\nleakoff = 2e-8",
    );
    let coarse = ("first = 0.1", "first = 1.0");
    let workshop = Workshop::new("filling-joint", &[leaking, coarse]);
    let out = workshop.solve("out", &[]);
    let text = fs::read_to_string(out.join("sources.csv")).expect("sources.csv");
    let last = text
        .lines()
        .rfind(|line| line.contains("leak-off from joint"));
    let lost = last.and_then(|line| line.split(',').next_back());
    let lost: f64 = lost.and_then(|cell| cell.parse().ok()).expect("a number");
    // The joint is 25 m long and 1 m wide.
    is_close(lost, -4.0 * 25.0 * 2e-8 * 10.0, 1e-9);
    let said = summary(&out);
    for step in said["steps"].as_array().expect("steps") {
        let flow = &step["flow"];
        assert!(number(&flow["mass_error"]) <= 1e-10, "{step}");
        let kept = number(&flow["inflow"]) - number(&flow["outflow"]);
        let moved = number(&flow["inflow"]).max(number(&flow["outflow"]));
        assert!(
            (number(&flow["stored"]) - kept).abs() <= 1e-9 * moved,
            "{step}"
        );
    }
    let steady = (
        "times = [10, 20, 30, 40, 50, 60, 70, 80, 90, 100]",
        "steps = [1]",
    );
    let history = ("\nhistory = [[0, 1], [100, 1]]", "");
    let refused = Workshop::new("filling-joint", &[leaking, steady, history]).run("out", &[]);
    assert_eq!(refused.code, Some(2));
    assert!(
        refused.err.contains("the flow is steady"),
        "{}",
        refused.err
    );
}
