//! A core that floats in a spherical joint.

use kluft_chart::{Axis, Chart, Series};
use kluft_solver::Discretisation;

use crate::oracles::spherical_joint::{Exact, errors, sphere};
use crate::report::{Effort, Finding, Study, Table, percent, slope};
use crate::scenes::{self, EXACT, ROCK};

pub const PAGE: Study = Study {
    name: "spherical-joint",
    title: "Spherical joint around a core",
    subject: "G. Lame's hollow sphere, in equilibrium with the law of the joint",
    run,
};

const CLOSED_FORM: &str = "
With E = 25 GPa, nu = 0.25, radii a = 1 m and b = 2 m, p = 10 MPa outside, b0 = 0.1 mm, K_n0 = 50
GPa/m, K_s = 0, r the radius:

    core     u = -q r (1 - 2 nu)/E
    shell    u = C r + D/r²        D = (q - p)/(4 G (1/a³ - 1/b³))        C = (4 G D/b³ - p)/(3 K)
    joint    u_shell(a) - u_core(a) = w        q = K_n0 b0 (1 + ln²x)(1 - x),   x = 1 + w/b0

which bisection solves: q = 8.635892 MPa, w = -7.015410e-5 m.";

struct Case {
    order: u32,
    h: f64,
    unknowns: usize,
    /// Of traction, opening, core and shell.
    errors: [f64; 4],
}

fn case(order: u32, h: f64, exact: &Exact) -> Case {
    let problem = sphere(EXACT, ROCK, h, order);
    let solution = scenes::solve(&problem);
    Case {
        order,
        h,
        unknowns: Discretisation::of(&problem)
            .expect("supported")
            .unknown_count(),
        errors: errors(&problem, &solution, exact).0,
    }
}

/// Order and size (m) of the cells of the meshes.
const MESHES: [(u32, f64); 7] = [
    (1, 0.35),
    (1, 0.25),
    (1, 0.177),
    (2, 0.7),
    (2, 0.5),
    (2, 0.35),
    (2, 0.25),
];

fn table(cases: &[Case]) -> Table {
    let mut table = Table::new(&[
        "order of the cells",
        "h (m)",
        "unknowns",
        "traction, mean",
        "opening, mean",
        "displacement of the core, L2",
        "of the shell, L2",
    ]);
    for case in cases {
        let [traction, opening, core, shell] = case.errors.map(percent);
        table.push([
            case.order.to_string(),
            case.h.to_string(),
            case.unknowns.to_string(),
            traction,
            opening,
            core,
            shell,
        ]);
    }
    table
}

/// Places of the opening and of the displacements of core and shell among the errors.
const MEASURES: [(&str, usize); 3] = [("opening", 1), ("core", 2), ("shell", 3)];

/// An error over the cell size, of cells of an order.
fn curve(cases: &[Case], order: u32, which: usize) -> Vec<(f64, f64)> {
    let own = cases.iter().filter(|case| case.order == order);
    own.map(|case| (case.h, case.errors[which])).collect()
}

fn chart(cases: &[Case]) -> Chart {
    let series = [1, 2].into_iter().flat_map(|order| {
        MEASURES.map(|(name, which)| {
            Series::line(format!("{name}, order {order}"), curve(cases, order, which))
        })
    });
    Chart {
        series: series.collect(),
        ..Chart::new(
            "Spherical joint: errors over the cell size",
            Axis::logarithmic("cell size (m)"),
            Axis::logarithmic("error (relative)"),
        )
    }
}

/// Observed orders of opening, core and shell, from the coarsest to the finest mesh.
fn observed(cases: &[Case], order: u32) -> [String; 3] {
    MEASURES.map(|(_, which)| {
        let curve = curve(cases, order, which);
        format!("{:.2}", slope(curve[0], curve[curve.len() - 1]))
    })
}

const PROBLEM: &str = "A ball of rock in a shell, between them a closed joint with the logarithmic \
    law and without shear stiffness; a pressure of 10 MPa acts outside (`geometries/sphere`). \
    Nothing but the joint holds the core, and rigid motions are taken away before displacements \
    are compared.";

fn run(_: Effort) -> Finding {
    let exact = Exact::of(EXACT, ROCK);
    let cases = MESHES.map(|(order, h)| case(order, h, &exact));
    let finest = &cases[cases.len() - 1];
    let [traction, opening, ..] = finest.errors.map(percent);
    let reached = format!("mean opening {opening}, traction {traction}");
    let unknowns = cases.iter().map(|case| case.unknowns).max().unwrap_or(0);
    let [first, second] = [1, 2].map(|order| observed(&cases, order));
    let text = format!(
        "Flat facets approach the sphere with second order. Observed orders of cells of order 1, \
         from the coarsest to the finest mesh: {} for the opening, {} for the core, {} for the \
         shell. Cells of order 2, whose faces are curved, reach {}, {} and {}, and a mean opening \
         within {opening} with {} unknowns.",
        first[0], first[1], first[2], second[0], second[1], second[2], finest.unknowns,
    );
    Finding::new([reached, unknowns.to_string()])
        .text(PROBLEM)
        .closed_form(CLOSED_FORM, PAGE.subject)
        .chart("spherical-joint", chart(&cases))
        .table(table(&cases))
        .shows(text)
}
