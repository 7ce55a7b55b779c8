//! Griffith's crack: the size of the box, and of the cells.

use kluft_chart::{Axis, Chart, Series};

use super::charts::half_circle;
use super::scene::{self, Outcome};
use crate::report::{Effort, Finding, Study, Table, percent, slope};

pub const PAGE: Study = Study {
    name: "line-crack",
    title: "Line crack under pressure",
    subject: "A. A. Griffith, Phil. Trans. R. Soc. A 221, 1921; I. N. Sneddon, Proc. R. Soc. A \
              187, 1946",
    run,
};

const CLOSED_FORM: &str = "
With E = 25 GPa, nu = 0.25, p = 2 MPa, a = 1 m, in an unbounded plate in plane strain:

    opening   w(x) = 4 (1 - nu²) p / E sqrt(a² - x²)     3.000000e-4 m in the middle
    front     K_I = p sqrt(pi a)                         3.544908 MPa sqrt(m)";

/// Half the sides of the plates (m).
const HALVES: [f64; 5] = [5.0, 10.0, 20.0, 40.0, 60.0];
/// Sizes of cells at the fronts (m).
const SIZES: [f64; 4] = [0.16, 0.08, 0.04, 0.02];

/// A slice of a plate whose corners are at `half`.
pub fn plate(h: f64, half: f64, more: &str) -> Outcome {
    let mesh = format!(
        "parameters = {{ h = {h}, half = {half}, h_far = {} }}\n{more}",
        half / 5.0
    );
    let from = ["[-20.0, 0.0, -20.0]", "[20.0, 0.0, -20.0]"];
    let to = [
        format!("[{:?}, 0.0, {:?}]", -half, -half),
        format!("[{half:?}, 0.0, {:?}]", -half),
    ];
    // The slice is flat: a direct solver takes a third of the time.
    let solver = "[solver]\nlinear = \"direct\"\n\n[oracle.crack]";
    scene::run(
        "line-crack",
        &mesh,
        &[
            (from[0], &to[0]),
            (from[1], &to[1]),
            ("[oracle.crack]", solver),
        ],
    )
}

fn table(cases: &[(f64, f64, Outcome)]) -> Table {
    let mut table = Table::new(&[
        "half the side (m)",
        "h (m)",
        "unknowns",
        "opening, L2",
        "middle (m)",
        "error",
        "volume error",
        "K_I (Pa sqrt(m))",
        "K_I error",
    ]);
    for (half, h, outcome) in cases {
        table.push([
            half.to_string(),
            h.to_string(),
            outcome.unknowns().to_string(),
            percent(outcome.error("opening_l2")),
            format!("{:.5e}", outcome.value("centre_opening")),
            percent(outcome.error("centre_opening")),
            percent(outcome.error("volume")),
            format!("{:.5e}", outcome.value("stress_intensity")),
            percent(outcome.error("stress_intensity")),
        ]);
    }
    table
}

fn over_half(cases: &[(f64, f64, Outcome)], name: &str, measure: &str) -> Series {
    let points = cases
        .iter()
        .map(|(half, _, found)| (*half, found.error(measure)));
    Series::line(name, points.collect())
}

fn charts(boxes: &[(f64, f64, Outcome)]) -> Vec<(&'static str, Chart)> {
    let profile = |outcome: &Outcome| {
        let nodes = outcome.facet_nodes();
        let points = nodes
            .iter()
            .map(|(x, result)| (x.x.abs(), 1e4 * result.opening));
        scene::thinned(points.collect(), 1.0, 26)
    };
    let last = &boxes.last().expect("plates").2;
    let measures = [
        ("opening, L2", "opening_l2"),
        ("volume", "volume"),
        ("K_I", "stress_intensity"),
    ];
    vec![
        (
            "line-crack-box",
            Chart {
                series: measures.map(|(name, of)| over_half(boxes, name, of)).into(),
                ..Chart::new(
                    "Line crack: what the size of the plate does",
                    Axis::logarithmic("half the side of the plate (half-lengths of the crack)"),
                    Axis::logarithmic("error (relative)"),
                )
            },
        ),
        (
            "line-crack-profile",
            Chart {
                series: vec![
                    Series::line("closed form", half_circle(3.0)),
                    Series::scatter("Kluft", profile(last)),
                ],
                ..Chart::new(
                    "Line crack: opening from the middle to the front",
                    Axis::linear("distance from the middle (m)"),
                    Axis::linear("opening (10⁻⁴ m)"),
                )
            },
        ),
    ]
}

const PROBLEM: &str = "A crack of half-length 1 m, opened by a fluid pressure of 2 MPa, crosses a \
    slice of a square plate in plane strain, free of traction (`geometries/line-crack`): one layer \
    of second-order prisms with quarter points, cells of h at the fronts that grow by 0.15 m a \
    metre.";

fn run(_: Effort) -> Finding {
    let (fine, wide) = (SIZES[3], HALVES[4]);
    let case = |half: f64, h: f64| (half, h, plate(h, half, "order = 2"));
    let boxes: Vec<_> = HALVES.map(|half| case(half, fine)).into();
    let sizes = SIZES[..3].iter().map(|&h| case(wide, h));
    let all: Vec<_> = boxes.into_iter().chain(sizes).collect();
    let boxes = &all[..HALVES.len()];
    let widest = &boxes[4].2;
    let opening = percent(widest.error("opening_l2"));
    let front = percent(widest.error("stress_intensity"));
    let unknowns = all.iter().map(|case| case.2.unknowns()).max();
    let reached = format!("opening in L2 {opening}, K_I {front}");
    Finding::new([reached, unknowns.expect("cases").to_string()])
        .text(PROBLEM)
        .closed_form(CLOSED_FORM, PAGE.subject)
        .charts(charts(boxes))
        .table(table(&all))
        .shows(shows(boxes, &all[HALVES.len()].2))
}

/// What plates of all sizes show, and the largest one with the coarsest cells.
fn shows(boxes: &[(f64, f64, Outcome)], coarse: &Outcome) -> String {
    let middle = |place: usize| percent(boxes[place].2.error("centre_opening"));
    let at = |place: usize| (boxes[place].0, boxes[place].2.error("volume"));
    let (fine, widest) = (boxes[4].1, &boxes[4].2);
    [
        format!(
            "A plate is not unbounded: with a half side of 20 half-lengths the opening in the \
             middle is {} off, with 60 {}; from 5 to 10 half-lengths the error of the volume falls \
             with power {:.2} of the side.",
            middle(2),
            middle(4),
            slope(at(0), at(1)),
        ),
        format!(
            "In the largest plate the opening is {} off in L2 and K_I {}, with quarter points and \
             h = {fine} m at the fronts; with h = {} m the opening is {} off in L2.",
            percent(widest.error("opening_l2")),
            percent(widest.error("stress_intensity")),
            SIZES[0],
            percent(coarse.error("opening_l2")),
        ),
    ]
    .join(" ")
}
