//! The hyperbolic closure law.

use kluft_chart::{Axis, Chart, Series};
use kluft_solver::{Discretisation, Problem};
use lie_core::{Closure, ClosureKind};

use crate::report::{Effort, Finding, Study, Table, largest};
use crate::scenes;
use crate::scenes::closing::column;

pub const PAGE: Study = Study {
    name: "barton-bandis",
    title: "Barton-Bandis closure",
    subject: "S. C. Bandis, A. C. Lumsden, N. R. Barton, Int. J. Rock Mech. Min. Sci. 20, 1983",
    run,
};

const CLOSED_FORM: &str = "
With the initial stiffness K_ni = 10 GPa/m and the largest closure v_m = 0.2 mm, s the compression:

    closure   v = v_m s/(s + K_ni v_m)       half of v_m under K_ni v_m = 2 MPa
    tangent   K = K_ni (1 - s/(s + K_ni v_m))^-2       40 GPa/m there";

const STIFFNESS: f64 = 10e9;
const MOST: f64 = 2e-4;
/// Compression in MPa.
const LOADS: [f64; 9] = [0.02, 0.2, 0.5, 1.0, 2.0, 5.0, 20.0, 200.0, 2000.0];
/// Relative change of the load for the secant.
const STEP: f64 = 1e-5;

fn closure_of(load: f64) -> f64 {
    MOST * load / (load + STIFFNESS * MOST)
}

fn problem(load: f64) -> Problem {
    let kind = ClosureKind::Hyperbolic { max_closure: MOST };
    // The column takes its load as a share of 5 MPa.
    let mut problem = column(kind, load / 5e6);
    problem.fractures[0].law.closure = Closure::new(MOST, STIFFNESS, kind);
    problem
}

/// A load and what came of it.
struct Case {
    /// Compression (MPa).
    mega: f64,
    /// Closure (m).
    closure: f64,
    /// Largest error of the aperture that is left (relative).
    error: f64,
    /// Tangent of the law (Pa/m).
    tangent: f64,
    /// Secant over a small change of the load (Pa/m).
    secant: f64,
}

fn case(mega: f64) -> Case {
    let load = 1e6 * mega;
    let found = scenes::solve(&problem(load)).facet_points;
    let after = scenes::solve(&problem(load * (1.0 + STEP))).facet_points;
    let exact = MOST - closure_of(load);
    let errors = found
        .iter()
        .map(|point| (point.aperture / exact - 1.0).abs());
    Case {
        mega,
        closure: -found[0].opening,
        error: largest(errors),
        tangent: STIFFNESS * (1.0 - load / (load + STIFFNESS * MOST)).powi(-2),
        secant: load * STEP / (found[0].aperture - after[0].aperture),
    }
}

fn table(cases: &[Case]) -> Table {
    let mut table = Table::new(&[
        "compression (MPa)",
        "closure, closed form (m)",
        "closure, Kluft (m)",
        "largest error of the aperture",
        "tangent, closed form (Pa/m)",
        "secant over 1e-5 of the load, Kluft (Pa/m)",
    ]);
    for case in cases {
        table.push([
            case.mega.to_string(),
            format!("{:.9e}", closure_of(1e6 * case.mega)),
            format!("{:.9e}", case.closure),
            format!("{:.0e}", case.error),
            format!("{:.4e}", case.tangent),
            format!("{:.4e}", case.secant),
        ]);
    }
    table
}

fn chart(cases: &[Case]) -> Chart {
    let curve = (-14..=28).map(|i| 10.0_f64.powf(f64::from(i) / 8.0));
    let closed_form = curve.map(|mega| (mega, closure_of(1e6 * mega) / MOST));
    let points = cases.iter().map(|case| (case.mega, case.closure / MOST));
    Chart {
        series: vec![
            Series::line("closed form", closed_form.collect()),
            Series::scatter("Kluft", points.collect()),
        ],
        ..Chart::new(
            "Barton-Bandis: closure over the compression",
            Axis::logarithmic("compression (MPa)"),
            Axis::linear("closure / largest closure"),
        )
    }
}

const PROBLEM: &str = "A column of rock of 1 m by 1 m by 2 m with a level hyperbolic joint (b0 = \
    v_m) under nine loads over five decades, one load step each.";

fn run(_: Effort) -> Finding {
    let cases = LOADS.map(case);
    let worst = largest(cases.iter().map(|case| case.error));
    let slopes = cases.iter().map(|case| case.secant / case.tangent - 1.0);
    let slopes = largest(slopes.map(f64::abs));
    let last = &cases[cases.len() - 1];
    let unknowns = Discretisation::of(&problem(1e6)).expect("supported");
    let unknowns = unknowns.unknown_count();
    Finding::new([format!("aperture {worst:.0e}"), unknowns.to_string()])
        .text(PROBLEM)
        .closed_form(CLOSED_FORM, PAGE.subject)
        .chart("barton-bandis", chart(&cases))
        .table(table(&cases))
        .shows(format!(
            "The aperture that is left follows the law to {worst:.0e} at all loads, the secants \
             its tangent to {slopes:.0e}; under {} MPa the walls are {:.6} of the way together, \
             and never meet.",
            last.mega,
            last.closure / MOST,
        ))
}
