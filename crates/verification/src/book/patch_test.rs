//! A uniform stress through an inclined joint, whatever mesh, numbering and law.

use kluft_chart::{Axis, Chart, Series};
use kluft_mesh::Draft;
use kluft_solver::Discretisation;
use lie_core::ClosureKind;

use crate::report::{Effort, Finding, Study, Table, largest};
use crate::scenes::uniform_stress::{errors, uniform, with_wavy_facets};
use crate::scenes::{self, EXACT, joint};

pub const PAGE: Study = Study {
    name: "patch-test",
    title: "Patch test with a joint",
    subject: "uniform stress: equilibrium, and the law of the joint inverted by hand",
    run,
};

const CLOSED_FORM: &str = "
Under tractions of one stress on all faces the displacement is affine on both sides, and the jump is
rigid:

    stress     (-4, -6, -9, 1, 0.7, -0.5) MPa as xx, yy, zz, xy, yz, xz, everywhere
    traction   t = sigma n        normal jump   the law's opening under n.t        slip   (t - n (n.t)) / K_s";

/// A mesh, a law, and what came of them.
struct Case {
    dip: f64,
    order: u32,
    numbering: &'static str,
    law: &'static str,
    unknowns: usize,
    /// Of stress, traction, aperture and jump.
    errors: [f64; 4],
}

/// The meshes of a dip and an order, by what was done to their files.
fn drafts(dip: f64, order: u32) -> Vec<(&'static str, Draft)> {
    let draft = scenes::geometry_of_order("inclined-joint", &[("dip", dip), ("h", 0.3)], order);
    let mut drafts = vec![("as gmsh has it", draft.clone())];
    // Both know three nodes a facet and four a cell.
    if order == 1 {
        let turned = with_wavy_facets(draft.clone());
        drafts.push(("every other facet turned", turned));
        drafts.push(("shuffled", scenes::shuffled(&draft, 7)));
    }
    drafts
}

fn cases() -> Vec<Case> {
    let hyperbolic = ClosureKind::Hyperbolic { max_closure: 9e-5 };
    let laws = [
        ("linear", ClosureKind::Linear),
        ("logarithmic", EXACT),
        ("hyperbolic", hyperbolic),
    ];
    let mut cases = Vec::new();
    for (dip, order) in [(20.0, 1), (50.0, 1), (20.0, 2), (50.0, 2)] {
        for (numbering, draft) in drafts(dip, order) {
            for (law, kind) in laws {
                let problem = uniform(draft.clone(), joint(kind));
                let discretisation = Discretisation::of(&problem).expect("supported");
                cases.push(Case {
                    dip,
                    order,
                    numbering,
                    law,
                    unknowns: discretisation.unknown_count(),
                    errors: errors(&problem),
                });
            }
        }
    }
    cases
}

fn table(cases: &[Case]) -> Table {
    let mut table = Table::new(&[
        "dip (degrees)",
        "order",
        "numbering",
        "law",
        "unknowns",
        "stress",
        "traction",
        "aperture",
        "jump",
    ]);
    for case in cases {
        let [stress, traction, aperture, jump] = case.errors.map(|error| format!("{error:.0e}"));
        table.push([
            case.dip.to_string(),
            case.order.to_string(),
            case.numbering.to_owned(),
            case.law.to_owned(),
            case.unknowns.to_string(),
            stress,
            traction,
            aperture,
            jump,
        ]);
    }
    table
}

const PROBLEM: &str = "A column of 1 m by 1 m by 2 m of arbitrary tetrahedra, cut by a joint of \
    dip 20 or 50 degrees, under the tractions of a full stress tensor on all faces; meshes of both \
    orders, and of order 1 also with every other facet turned around in the file and with all \
    nodes, cells and facets in another order; three laws.";

fn run(_: Effort) -> Finding {
    let cases = cases();
    let worst = largest(cases.iter().flat_map(|case| case.errors));
    let unknowns = cases.iter().map(|case| case.unknowns).max().unwrap_or(0);
    Finding::new([format!("everything {worst:.0e}"), unknowns.to_string()])
        .text(PROBLEM)
        .closed_form(CLOSED_FORM, PAGE.subject)
        .chart("patch-test", chart(&cases))
        .table(table(&cases))
        .shows(format!(
            "In all {} cases stress, traction, aperture and jump are exact: the largest error \
             anywhere is {worst:.0e}, which is what Newton's method leaves. Neither the order of a \
             file nor the side from which it lists a facet matters.",
            cases.len()
        ))
}

fn chart(cases: &[Case]) -> Chart {
    let names = ["stress", "traction", "aperture", "jump"];
    let series = names.iter().enumerate().map(|(which, name)| {
        let points = cases.iter().enumerate();
        Series::scatter(
            *name,
            points
                .map(|(number, case)| (number as f64 + 1.0, case.errors[which]))
                .collect(),
        )
    });
    Chart {
        series: series.collect(),
        ..Chart::new(
            "Patch test with a joint: largest errors",
            Axis::linear("case (row of the table)"),
            Axis::logarithmic("error (relative)").from(1e-17),
        )
    }
}
