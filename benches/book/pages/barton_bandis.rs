//! The hyperbolic closure law.

use kluft_chart::{Axis, Chart, Series};
use kluft_solver::{Discretisation, Problem};
use lie_core::{Closure, ClosureKind};

use super::{Found, Page};
use crate::closing::column;
use crate::scenes;
use crate::studies::{Table, largest};

pub const PAGE: Page = Page {
    name: "barton-bandis",
    title: "Barton-Bandis closure",
    oracle: "S. C. Bandis, A. C. Lumsden, N. R. Barton, Int. J. Rock Mech. Min. Sci. 20, 1983",
    closed_form: "
With the initial stiffness K_ni = 10 GPa/m and the largest closure v_m = 0.2 mm, s the compression:

    closure   v = v_m s/(s + K_ni v_m)       half of v_m under K_ni v_m = 2 MPa
    tangent   K = K_ni (1 - s/(s + K_ni v_m))^-2       40 GPa/m there",
    run,
};

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

fn run() -> Found {
    let mut table = Table::new(&[
        "compression (MPa)",
        "closure, closed form (m)",
        "closure, Kluft (m)",
        "largest error of the aperture",
        "tangent, closed form (Pa/m)",
        "secant over 1e-5 of the load, Kluft (Pa/m)",
    ]);
    let (mut points, mut errors, mut slopes) = (Vec::new(), Vec::new(), Vec::new());
    for mega in LOADS {
        let load = 1e6 * mega;
        let found = scenes::solve(&problem(load)).facet_points;
        let after = scenes::solve(&problem(load * (1.0 + STEP))).facet_points;
        let exact = MOST - closure_of(load);
        let error = largest(
            found
                .iter()
                .map(|point| (point.aperture / exact - 1.0).abs()),
        );
        let secant = load * STEP / (found[0].aperture - after[0].aperture);
        let tangent = STIFFNESS * (1.0 - load / (load + STIFFNESS * MOST)).powi(-2);
        table.push([
            mega.to_string(),
            format!("{:.9e}", closure_of(load)),
            format!("{:.9e}", -found[0].opening),
            format!("{error:.0e}"),
            format!("{tangent:.4e}"),
            format!("{secant:.4e}"),
        ]);
        points.push((mega, -found[0].opening / MOST));
        errors.push(error);
        slopes.push((secant / tangent - 1.0).abs());
    }
    let curve = (-14..=28).map(|i| 10.0_f64.powf(f64::from(i) / 8.0));
    let worst = largest(errors);
    Found {
        problem: "A column of rock of 1 m by 1 m by 2 m with a level hyperbolic joint (b0 = v_m) under nine loads over five decades, one load \
                  step each."
            .to_owned(),
        reached: format!("aperture {worst:.0e}"),
        unknowns: Discretisation::of(&problem(1e6)).expect("supported").unknown_count(),
        shows: format!(
            "The aperture that is left follows the law to {worst:.0e} at all loads, the secants its tangent to {:.0e}; under {} MPa the \
             walls are {:.6} of the way together, and never meet.",
            largest(slopes),
            LOADS[LOADS.len() - 1],
            points[points.len() - 1].1,
        ),
        charts: vec![(
            "barton-bandis",
            Chart {
                series: vec![
                    Series::line("closed form", curve.map(|mega| (mega, closure_of(1e6 * mega) / MOST)).collect()),
                    Series::scatter("Kluft", points),
                ],
                ..Chart::new(
                    "Barton-Bandis: closure over the compression",
                    Axis::logarithmic("compression (MPa)"),
                    Axis::linear("closure / largest closure"),
                )
            },
        )],
        tables: vec![("barton-bandis", table)],
    }
}
