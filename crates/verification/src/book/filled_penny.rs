//! A crack that is filled with a given volume of a fluid that does not give way.

use crate::report::{Effort, Finding, Study, largest, percent};

use super::refinement::{Refinement, Shown};
use super::scene::{self, Outcome};

pub const PAGE: Study = Study {
    name: "filled-penny",
    title: "A crack filled with a given volume",
    subject: "I. N. Sneddon, Proceedings of the Royal Society A 187, 1946",
    run,
};

const CLOSED_FORM: &str = "
A free crack, the disc r < a = 1 m in unbounded rock, E = 25 GPa, nu = 0.25, into which V = 4e-4 m3 flow:

    pressure   p = 3 E V/(16 (1 - nu^2) a^3)                 2.000000e6 Pa
    opening    3 V/(2 pi a^2) sqrt(1 - r^2/a^2)              1.909859e-4 m at the centre";

/// In place of the pressure that the scene gives: a borehole that fills the crack in 1e4 s.
const FILLED: [(&str, &str); 1] = [(
    "closure = \"linear\"\nfluid_pressure = 2e6\n",
    "closure = \"linear\"\n\n[fluid]\nviscosity = 1e-3\n\n[[source]]\nat = [0.0, 0.0, 0.0]\n\
     radius = 1e-3\nrate = 4e-8\nhistory = [[0, 1], [1e4, 1]]\n\n[load]\ntimes = [1e4]\n",
)];

const PRESSURE: f64 = 2e6;

fn filled(size: f64, quarter_points: bool) -> Outcome {
    let sizes = format!("h = {size}, h_disc = {}, grow = 0.5", 3.0 * size);
    let mesh = format!("parameters = {{ {sizes} }}\norder = 2\nquarter_points = {quarter_points}");
    scene::run_edited("penny", &mesh, &FILLED)
}

/// Errors of the pressure, the opening in L2 and the volume.
fn errors(outcome: &Outcome) -> [f64; 3] {
    [
        (outcome.value("mean_pressure") / PRESSURE - 1.0).abs(),
        outcome.error("opening_l2"),
        outcome.error("volume"),
    ]
}

fn mass_error(outcome: &Outcome) -> f64 {
    let steps = outcome.summary["steps"].as_array().into_iter().flatten();
    largest(steps.filter_map(|step| step["flow"]["mass_error"].as_f64()))
}

/// Largest difference of two pressures, as a share of the mean.
fn unevenness(outcome: &Outcome) -> f64 {
    let pressure = &outcome.summary["flow"]["fractures"][0]["pressure"];
    let of = |name: &str| pressure[name].as_f64().expect("a pressure");
    (of("max") - of("min")) / of("mean")
}

const SHOWN: Shown = Shown {
    file: "filled-penny",
    title: "A crack filled with a given volume: errors over the size of cells",
    size: "size of cells at the front (m)",
    rate: Some(1.0),
};

const PROBLEM: &str = "The scene `geometries/penny` with water from a borehole in place of a given \
    pressure: only the rock resists, and nothing tells the pressure but the balance of the fluid. \
    Tetrahedra of second order, pressures at their corners.";

fn run(effort: Effort) -> Finding {
    let sizes: &[f64] = match effort {
        Effort::Quick => &[0.4, 0.2],
        Effort::Full => &[0.4, 0.2, 0.1, 0.05],
    };
    let mut all = Vec::new();
    let mut refinements = Vec::new();
    for (quarter_points, name) in [(true, "quarter points"), (false, "no quarter points")] {
        let found = sizes
            .iter()
            .map(|&size| (size, filled(size, quarter_points)));
        let found: Vec<_> = found.collect();
        for (which, quantity) in ["pressure", "opening"].into_iter().enumerate() {
            let errors = found
                .iter()
                .map(|(size, case)| (*size, errors(case)[which]));
            refinements.push(Refinement::of(format!("{quantity}, {name}"), errors));
        }
        all.extend(found.into_iter().map(|(_, case)| case));
    }
    let unknowns = all.iter().map(Outcome::unknowns).max().unwrap_or(0);
    let page = Finding::new([
        format!("pressure {}", percent(refinements[0].finest())),
        unknowns.to_string(),
    ])
    .text(PROBLEM)
    .closed_form(CLOSED_FORM, PAGE.subject);
    SHOWN.on(page, &refinements).shows(format!(
        "The crack takes up the volume to {:.0e}. Its pressure is {} off with quarter points and {} \
         without on the finest mesh, as far as the crack is too stiff; it is even to {:.0e}, which is \
         what drives the last of the fluid to the front. Nodes miss {:.0e} of what moves at most.",
        largest(all.iter().map(|case| errors(case)[2])),
        percent(refinements[0].finest()),
        percent(refinements[2].finest()),
        largest(all.iter().map(unevenness)),
        largest(all.iter().map(mass_error))
    ))
}
