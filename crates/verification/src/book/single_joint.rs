//! One inclined joint in a column: the joint of OpenGeoSys whose walls would overlap.

use kluft_chart::{Axis, Chart, Series};
use kluft_solver::Discretisation;
use lie_core::ClosureKind;

use crate::oracles::closed_aperture;
use crate::report::{Effort, Finding, Study, Table, digits, largest};
use crate::scenes;

pub const PAGE: Study = Study {
    name: "single-joint",
    title: "Single inclined joint, logarithmic law",
    subject: "uniform stress through the law of T. Nagel, 2017; problem of the OpenGeoSys test \
              `single_joint_negative_aperture`",
    run,
};

const CLOSED_FORM: &str = "
The stress is uniform, -7 kPa upright, and the jump is rigid. With the dip d, b0 = 1e-5 m, K_n0 =
1e8 Pa/m, K_s = 1e12 Pa/m:

    normal traction   -7000 cos²d
    slip              7000 sin d cos d / K_s
    aperture          x b0   where   K_n0 b0 (1 + ln²x)(1 - x) = 7000 cos²d     1.987915e-6 m at 50 degrees";

const DIPS: [f64; 5] = [20.0, 30.0, 40.0, 50.0, 60.0];
const LOAD: f64 = 7e3;

/// A dip and what came of it.
struct Case {
    dip: f64,
    unknowns: usize,
    aperture: f64,
    exact: f64,
    linear: f64,
    /// Of aperture, slip and normal traction, the largest of all facet points.
    errors: [f64; 3],
}

fn case(dip: f64) -> Case {
    let mut problem = scenes::scene_file("inclined-joint", &[("dip", dip), ("h", 0.2)]);
    // The scene has a cutoff as the other program needs it; the closed form stays above.
    problem.fractures[0].law.closure.kind = ClosureKind::Logarithmic { cutoff: Some(1e-7) };
    let solution = scenes::solve(&problem);
    let (sin, cos) = dip.to_radians().sin_cos();
    let (normal, slip) = (-LOAD * cos * cos, LOAD * sin * cos / 1e12);
    let exact = 1e-5 * closed_aperture(-normal / 1e3);
    let points = || solution.facet_points.iter();
    let errors = [
        largest(points().map(|point| (point.aperture / exact - 1.0).abs())),
        largest(points().map(|point| (point.slip.length() / slip - 1.0).abs())),
        largest(points().map(|point| (point.normal_traction / normal - 1.0).abs())),
    ];
    Case {
        dip,
        unknowns: Discretisation::of(&problem)
            .expect("supported")
            .unknown_count(),
        aperture: solution.facet_points[0].aperture,
        exact,
        linear: 1e-5 + normal / 1e8,
        errors,
    }
}

fn table(cases: &[Case]) -> Table {
    let mut table = Table::new(&[
        "dip (degrees)",
        "unknowns",
        "aperture, closed form (m)",
        "aperture, Kluft (m)",
        "error",
        "slip error",
        "normal traction error",
        "aperture with constant stiffness (m)",
    ]);
    for case in cases {
        let [aperture, slip, traction] = case.errors.map(|error| format!("{error:.0e}"));
        table.push([
            case.dip.to_string(),
            case.unknowns.to_string(),
            format!("{:.9e}", case.exact),
            format!("{:.9e}", case.aperture),
            aperture,
            slip,
            traction,
            format!("{:.4e}", case.linear),
        ]);
    }
    table
}

fn chart(cases: &[Case]) -> Chart {
    let curve = |of: fn(&Case) -> f64| {
        let points = cases.iter().map(|case| (case.dip, 1e6 * of(case)));
        points.collect()
    };
    Chart {
        series: vec![
            Series::line("closed form", curve(|case| case.exact)),
            Series::scatter("Kluft", curve(|case| case.aperture)),
            Series::line("constant stiffness", curve(|case| case.linear)),
        ],
        ..Chart::new(
            "Inclined joint under 7 kPa: aperture over the dip",
            Axis::linear("dip (degrees)"),
            Axis::linear("aperture (10⁻⁶ m)"),
        )
    }
}

const PROBLEM: &str = "A column of 1 m by 1 m by 2 m, E = 170 MPa and nu = 0.22, in plane strain \
    under 7 kPa, cut by one joint of dip 20 to 60 degrees (`geometries/inclined-joint`).";

fn run(_: Effort) -> Finding {
    let cases = DIPS.map(case);
    let worst = largest(cases.iter().flat_map(|case| case.errors));
    let unknowns = cases.iter().map(|case| case.unknowns).max().unwrap_or(0);
    let overlapping = cases.iter().filter(|case| case.linear < 0.0).count();
    Finding::new([format!("everything {worst:.0e}"), unknowns.to_string()])
        .text(PROBLEM)
        .closed_form(CLOSED_FORM, PAGE.subject)
        .chart("single-joint", chart(&cases))
        .table(table(&cases))
        .shows(format!(
            "Apertures, slips and tractions of all facet points follow the closed form to \
             {worst:.0e} on a mesh of arbitrary tetrahedra. A constant stiffness would push the \
             walls through each other at {overlapping} of {} dips, by {} of the aperture without \
             load at the flattest; the logarithmic law leaves {} of it.",
            cases.len(),
            digits(-cases[0].linear / 1e-5),
            digits(cases[0].aperture / 1e-5),
        ))
}
