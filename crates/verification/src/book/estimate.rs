//! What a run says of its own error, beside the true one.

use std::f64::consts::PI;

use kluft_chart::{Axis, Chart, Series};

use super::scene::{self, Outcome};
use crate::oracles::spherical_joint::Exact;
use crate::report::{Effort, Finding, Study, Table, digits, percent};
use crate::scenes::{EXACT, ROCK};

pub const PAGE: Study = Study {
    name: "estimate",
    title: "Error estimate",
    subject: "the closed forms of the studies; of a crack under a pressure p, |e|² = p (V - \
              V_h) in the energy norm",
    run,
};

const CLOSED_FORM: &str = "
With e the error, u the solution, V the volume in closed form and V_h that of the mesh: |u_h|² = p
V_h, so the estimated share s = |e|/|u_h| of `summary.json` should be

    s = sqrt((V - V_h)/V_h)        effectivity: the estimate over this

and the mean opening (of cracks that slide, the mean slip) is off by the difference of the means.
`aperture_uncertainty` and `slip_uncertainty` are the estimate times 2, or times 3 where cells
without quarter points follow a crack front; the effectivity of the mean is without these factors.";

/// A run beside what is true.
struct Case {
    name: String,
    unknowns: usize,
    /// Estimate over truth in the energy norm, where it is known.
    energy: Option<f64>,
    /// True and stated error of the mean jump (m), and the mean itself.
    mean: [f64; 3],
    /// Factor of safety in what is stated.
    safety: f64,
}

impl Case {
    fn holds(&self) -> bool {
        self.mean[1] >= self.mean[0]
    }

    fn effectivity(&self) -> f64 {
        self.mean[1] / self.safety / self.mean[0]
    }
}

/// A crack under pressure: what its mean opening should be, and the volume.
fn pressurised(name: String, outcome: &Outcome, mean: f64, safety: f64) -> Case {
    let (volume, exact) = (outcome.value("volume"), outcome.exact("volume"));
    let share = outcome.summary["stress_error"].as_f64().unwrap_or(f64::NAN);
    let missing = exact - volume;
    // What the finite body adds to the volume hides errors below it.
    let energy = (missing > 2e-3 * exact).then(|| share * (volume / missing).sqrt());
    let found = outcome.of_fracture(&["aperture", "mean"]).expect("a mean") - 1e-5;
    Case {
        name,
        unknowns: outcome.unknowns(),
        energy,
        mean: [
            (found - mean).abs(),
            outcome
                .of_fracture(&["aperture_uncertainty"])
                .unwrap_or(f64::NAN),
            mean,
        ],
        safety,
    }
}

fn discs() -> Vec<Case> {
    let mean = 4.0e-4 / PI;
    let sizes = |h: f64| {
        format!(
            "parameters = {{ h = {h}, h_disc = {}, grow = 0.5 }}",
            2.0 * h
        )
    };
    let mut cases = Vec::new();
    for h in [0.2, 0.1] {
        for (kind, more, safety) in [
            ("order 1", "order = 1", 3.0),
            ("order 2, plain", "order = 2\nquarter_points = false", 3.0),
            ("order 2, quarter points", "order = 2", 2.0),
        ] {
            let outcome = scene::run("penny", &format!("{}\n{more}", sizes(h)));
            cases.push(pressurised(
                format!("disc, {kind}, h = {h} m"),
                &outcome,
                mean,
                safety,
            ));
        }
    }
    cases
}

fn lines() -> Vec<Case> {
    let mean = PI / 4.0 * 3.0e-4;
    let mut cases = Vec::new();
    for (kind, more, safety) in [
        ("order 1", "order = 1", 3.0),
        ("order 2, plain", "order = 2\nquarter_points = false", 3.0),
        ("order 2, quarter points", "order = 2", 2.0),
    ] {
        let mesh =
            format!("dimension = 2\nparameters = {{ h = 0.08, half = 60, h_far = 12 }}\n{more}");
        let outcome = scene::run("plates", &mesh);
        cases.push(pressurised(format!("line, {kind}"), &outcome, mean, safety));
    }
    cases
}

/// A crack that slides: mean slip from the slips at its nodes.
fn sliding(scene_name: &str, name: &str, mesh: &str, mean: f64) -> Case {
    let outcome = scene::run(scene_name, mesh);
    Case {
        name: name.to_owned(),
        unknowns: outcome.unknowns(),
        energy: None,
        mean: [
            (outcome.mean_slip() - mean).abs(),
            outcome
                .of_fracture(&["slip_uncertainty"])
                .unwrap_or(f64::NAN),
            mean,
        ],
        safety: 2.0,
    }
}

fn spheres() -> Vec<Case> {
    let exact = Exact::of(EXACT, ROCK).opening();
    let case = |(order, h): (u32, f64)| {
        let mesh = format!("parameters = {{ h = {h} }}\norder = {order}");
        let outcome = scene::run("sphere", &mesh);
        let found = outcome.of_fracture(&["aperture", "mean"]).expect("a mean") - 1e-4;
        Case {
            name: format!("sphere, order {order}, h = {h} m"),
            unknowns: outcome.unknowns(),
            energy: None,
            mean: [
                (found - exact).abs(),
                outcome
                    .of_fracture(&["aperture_uncertainty"])
                    .unwrap_or(f64::NAN),
                exact.abs(),
            ],
            safety: 2.0,
        }
    };
    [(1, 0.35), (1, 0.25), (2, 0.5)].map(case).into()
}

fn cases() -> Vec<Case> {
    let mut cases = discs();
    cases.extend(lines());
    cases.push(sliding(
        "inclined-crack",
        "line with friction",
        "dimension = 2\nparameters = { h = 0.08 }\norder = 2",
        PI / 4.0 * 3.807_850e-3,
    ));
    cases.push(sliding(
        "inclined-penny",
        "disc with friction",
        "parameters = { h = 0.12, h_disc = 0.3, grow = 0.6 }\norder = 2",
        2.0 / 3.0 * 2.770_460e-3,
    ));
    cases.extend(spheres());
    cases
}

fn table(cases: &[Case]) -> Table {
    let mut table = Table::new(&[
        "case",
        "unknowns",
        "effectivity in energy",
        "error of the mean jump",
        "stated uncertainty",
        "effectivity of the mean",
        "contains the truth",
    ]);
    for case in cases {
        let [error, stated, mean] = case.mean;
        table.push([
            case.name.clone(),
            case.unknowns.to_string(),
            case.energy
                .map_or(String::new(), |value| format!("{value:.2}")),
            percent(error / mean),
            percent(stated / mean),
            format!("{:.2}", case.effectivity()),
            if case.holds() { "yes" } else { "no" }.to_owned(),
        ]);
    }
    table
}

fn range(values: impl Iterator<Item = f64>) -> String {
    let (low, high) = values.fold((f64::INFINITY, 0.0_f64), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    format!("{low:.2} to {high:.2}")
}

/// True and stated error of the mean of a case, over the mean.
fn shares(case: &Case) -> (f64, f64) {
    let [error, stated, mean] = case.mean;
    (error / mean, stated / mean)
}

fn chart(cases: &[Case]) -> Chart {
    let groups = ["disc", "line", "sphere"];
    let series = groups.map(|group| {
        let own = cases.iter().filter(|case| case.name.starts_with(group));
        Series::scatter(group, own.map(shares).collect())
    });
    let ends = cases.iter().map(|case| shares(case).0);
    let (low, high) = ends.fold((f64::INFINITY, 0.0_f64), |(a, b), x| (a.min(x), b.max(x)));
    let equal = Series::line("as stated", vec![(low, low), (high, high)]);
    Chart {
        series: std::iter::once(equal).chain(series).collect(),
        ..Chart::new(
            "Mean opening or slip: stated uncertainty over the true error",
            Axis::logarithmic("true error of the mean (relative)"),
            Axis::logarithmic("stated uncertainty (relative)"),
        )
    }
}

/// Names the cases whose uncertainty does not contain the truth.
fn misses(cases: &[Case]) -> String {
    let missed = cases.iter().filter(|case| !case.holds());
    let name = |case: &Case| {
        let [error, stated, _] = case.mean;
        let share = digits(stated / error);
        format!("{} (states {share} of the true error)", case.name)
    };
    let names: Vec<String> = missed.map(name).collect();
    if names.is_empty() {
        return String::new();
    }
    format!(
        "It does not on: {}. Where facets stand for a curved surface that is an error too, and \
         none that the stress shows.",
        names.join("; ")
    )
}

const PROBLEM: &str = "Every run estimates the error of its stress in the energy norm, and what \
    the mean aperture and slip of each fracture may be off. Here are both beside the truth, on \
    cracks under pressure, cracks that slide, and a closed joint on a sphere.";

fn run(_: Effort) -> Finding {
    let cases = cases();
    let held = cases.iter().filter(|case| case.holds()).count();
    let held = format!("the truth in {held} of {} cases", cases.len());
    let energies = range(cases.iter().filter_map(|case| case.energy));
    let means = range(cases.iter().map(Case::effectivity));
    let misses = misses(&cases);
    let unknowns = cases.iter().map(|case| case.unknowns).max().unwrap_or(0);
    let reached = format!("the uncertainty contains {held}; energy {energies} times the error");
    Finding::new([reached, unknowns.to_string()])
        .text(PROBLEM)
        .closed_form(CLOSED_FORM, PAGE.subject)
        .chart("estimate", chart(&cases))
        .table(table(&cases))
        .shows(format!(
            "In the energy norm the estimate is {energies} times the true error; of the mean jump, \
             without the factor of safety, {means} times. The stated uncertainty contains {held}. \
             {misses} The closed forms of cracks are for unbounded rock, and what the size of the \
             body adds counts as error here."
        ))
}
