//! The table of the logarithmic law, by simulation.

use kluft_chart::{Axis, Chart, Series};
use kluft_solver::Discretisation;

use crate::oracles::{LOG_LAW_TABLE, closed_aperture};
use crate::report::{Effort, Finding, Study, Table, largest};
use crate::scenes::closing::column;
use crate::scenes::{self, EXACT};

pub const PAGE: Study = Study {
    name: "log-law",
    title: "Logarithmic closure law",
    subject: "T. Nagel, One-sided incompressibility constraint for fracture models, 2017; inverted \
              by bisection",
    run,
};

const CLOSED_FORM: &str = "
With x = b/b0 the aperture under the closing load q K_n0 b0 and the tangent of the law:

    (1 + ln²x) (1 - x) = q          K/K_n0 = 1 + ln²x - 2 (1 - x) ln x / x";

/// Relative change of the load for the secant.
const STEP: f64 = 1e-5;

/// Load, aperture over `b0`, its closed form, and the secant over the tangent.
struct Case {
    q: f64,
    x: f64,
    exact: f64,
    secant: f64,
    tangent: f64,
    error: f64,
}

fn case(q: f64) -> Case {
    let solution = scenes::solve(&column(EXACT, q));
    let further = scenes::solve(&column(EXACT, q * (1.0 + STEP)));
    let exact = closed_aperture(q);
    let (found, after) = (&solution.facet_points, &further.facet_points);
    let error = largest(
        found
            .iter()
            .map(|point| (point.aperture / 1e-4 / exact - 1.0).abs()),
    );
    let ln = exact.ln();
    Case {
        q,
        x: found[0].aperture / 1e-4,
        exact,
        secant: q * STEP / ((found[0].aperture - after[0].aperture) / 1e-4),
        tangent: 1.0 + ln * ln - 2.0 * (1.0 - exact) * ln / exact,
        error,
    }
}

fn table(cases: &[Case]) -> Table {
    let mut table = Table::new(&[
        "load / (K_n0 b0)",
        "aperture / b0, closed form",
        "aperture / b0, Kluft",
        "largest error",
        "tangent / K_n0, closed form",
        "secant over 1e-5 of the load, Kluft",
    ]);
    for case in cases {
        table.push([
            case.q.to_string(),
            format!("{:.9e}", case.exact),
            format!("{:.9e}", case.x),
            format!("{:.0e}", case.error),
            format!("{:.4e}", case.tangent),
            format!("{:.4e}", case.secant),
        ]);
    }
    table
}

fn chart(cases: &[Case]) -> Chart {
    let exponents = (-16..=16).map(|i| 10.0_f64.powf(f64::from(i) / 8.0));
    let closed_form = exponents.map(|q| (q, closed_aperture(q)));
    let points = cases.iter().map(|case| (case.q, case.x));
    Chart {
        series: vec![
            Series::line("closed form", closed_form.collect()),
            Series::scatter("Kluft", points.collect()),
        ],
        ..Chart::new(
            "Logarithmic law: aperture over the load",
            Axis::logarithmic("load / (K_n0 b0)"),
            Axis::logarithmic("aperture / b0"),
        )
    }
}

const PROBLEM: &str = "A column of rock of 1 m by 1 m by 2 m with a level joint (b0 = 0.1 mm, K_n0 \
    = 50 GPa/m) under ten loads, from a hundredth of K_n0 b0 to a hundred times as much; one load \
    step each.";

fn run(_: Effort) -> Finding {
    let cases = LOG_LAW_TABLE.map(|(q, ..)| case(q));
    let worst = largest(cases.iter().map(|case| case.error));
    let slopes = cases.iter().map(|case| case.secant / case.tangent - 1.0);
    let slopes = largest(slopes.map(f64::abs));
    let last = &cases[cases.len() - 1];
    let unknowns = Discretisation::of(&column(EXACT, 1.0)).expect("supported");
    let unknowns = unknowns.unknown_count();
    Finding::new([format!("aperture {worst:.0e}"), unknowns.to_string()])
        .text(PROBLEM)
        .closed_form(CLOSED_FORM, PAGE.subject)
        .chart("log-law", chart(&cases))
        .table(table(&cases))
        .shows(format!(
            "In one load step the joint closes to {:.2e} of its aperture, under {} times K_n0 b0; \
             at all loads the aperture follows the law to {worst:.0e}, and secants over 1e-5 of \
             the load the law's tangent to {slopes:.0e}. No wall overlaps.",
            last.x, last.q
        ))
}
