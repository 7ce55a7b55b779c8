//! Opening, closing, and the way there: cycles, and the number of load steps.

use kluft_solver::Discretisation;

use crate::report::{Effort, Finding, Study, Table, largest};
use crate::stability::{cycles, entry, increments, most, opening, steps};

pub const PAGE: Study = Study {
    name: "paths",
    title: "Opening, closing and the way there",
    subject: "laws with a potential: no hysteresis, no influence of the steps; a joint in series \
              with rock",
    run,
};

const CLOSED_FORM: &str = "
Without friction the traction is a function of the aperture, so the same loads give the same state
whatever came before, and one step leads where a hundred do. A column with a level joint, moved by z
at its top, H = 2 m high:

    opening w and traction t   of   w(t) + t H/E = z   in compression,   w = z and t = 0   once open without tension";

/// Unknowns of the largest scene.
fn unknowns(effort: Effort) -> usize {
    let scenes = [steps::problems(effort), cycles::problems(effort)];
    let counts = scenes.iter().flatten().map(|(_, problem)| {
        let discretisation = Discretisation::of(problem).expect("supported");
        discretisation.unknown_count()
    });
    counts.max().unwrap_or(0)
}

/// The numbers of a column in the rows that a test of their second entry takes; what failed is not
/// a number.
fn numbers(finding: &Finding, column: &str, rows: fn(&str) -> bool) -> Vec<f64> {
    let table = finding.first_table();
    let place = table.column(column);
    let own = table.rows.iter().filter(|row| rows(&row[1]));
    own.map(|row| row[place].parse().unwrap_or(f64::NAN))
        .collect()
}

/// What a row of the summary is made of.
struct Row<'a> {
    study: &'static str,
    compared_with: &'static str,
    finding: &'a Finding,
    /// Columns with the iterations and the differences.
    columns: [&'static str; 2],
    /// Which cases it takes.
    cases: fn(&str) -> bool,
}

const NEWTON: &str = "most Newton iterations of a step";
const FORM: &str = "error against the closed form";

fn rows([opened, cycled, stepped, _]: &[Finding; 4]) -> [Row<'_>; 5] {
    let row = |names: [&'static str; 2], finding, columns, cases| Row {
        study: names[0],
        compared_with: names[1],
        finding,
        columns,
        cases,
    };
    let all = |_: &str| true;
    let cycles = |case: &str| case.ends_with("cycles");
    let floats = |case: &str| case.starts_with("floating");
    let first = [NEWTON, "hysteresis"];
    let form = [NEWTON, FORM];
    let once = ["most of a step", "difference from one step"];
    [
        row(["opening and closing", "closed form"], opened, form, cycles),
        row(
            ["opening and closing", "first cycle"],
            opened,
            first,
            cycles,
        ),
        row(["floating block", "its weight"], opened, form, floats),
        row(["loading and unloading", "first cycle"], cycled, first, all),
        row(["1 to 100 load steps", "one step"], stepped, once, all),
    ]
}

/// What each study of runs compares, in how many cases, and how far apart they are at most.
fn summary(findings: &[Finding; 4]) -> Table {
    let mut table = Table::new(&[
        "study",
        "compared with",
        "cases",
        NEWTON,
        "largest difference (relative)",
    ]);
    for row in rows(findings) {
        let of = |column| numbers(row.finding, column, row.cases);
        let [counts, differences] = row.columns.map(of);
        let converged = |count: f64| count.is_finite().then_some(count as usize);
        table.push([
            row.study.to_owned(),
            row.compared_with.to_owned(),
            differences.len().to_string(),
            entry(most(counts.into_iter().map(converged))),
            format!("{:.2e}", largest(differences)),
        ]);
    }
    table
}

const PROBLEM: &str = "The studies of the stability map on joints without tension that open and \
    close for 20 cycles, blocks that float in between, junctions and jointed blocks loaded and \
    unloaded for 20 cycles, the same load in 1 to 100 steps, and the law against its incremental \
    form.";

/// Files of the tables of the studies.
const FILES: [&str; 4] = [
    "paths-opening",
    "paths-cycles",
    "paths-steps",
    "paths-increments",
];

fn run(effort: Effort) -> Finding {
    let studies = [
        opening::STUDY,
        cycles::STUDY,
        steps::STUDY,
        increments::STUDY,
    ];
    let findings = studies.map(|study| (study.run)(effort));
    let [_, cycled, stepped, _] = &findings;
    // The second entry of a study's summary is how the program fares.
    let reached = format!(
        "cycles: {}; steps: {}",
        cycled.summary[1], stepped.summary[1]
    );
    let charts = findings.iter().flat_map(Finding::all_charts);
    let charts = charts.map(|(name, chart)| (file_of(name), chart.clone()));
    let mut page = Finding::new([reached, unknowns(effort).to_string()])
        .text(PROBLEM)
        .closed_form(CLOSED_FORM, PAGE.subject)
        .charts(charts)
        .table(summary(&findings));
    for (name, finding) in FILES.into_iter().zip(&findings) {
        page = page.table_in(name, finding.first_table().clone());
    }
    page.shows(what_they_say(&findings))
}

fn what_they_say(findings: &[Finding]) -> String {
    let misses = findings.iter().flat_map(|finding| finding.misses.clone());
    let misses: Vec<String> = misses.collect();
    let held = if misses.is_empty() {
        "Every case held.".to_owned()
    } else {
        format!("Not all held: {}.", misses.join("; "))
    };
    let texts = findings.iter().flat_map(Finding::texts);
    texts
        .chain([held.as_str()])
        .collect::<Vec<&str>>()
        .join(" ")
}

/// Name of a study's chart among the pages.
fn file_of(name: &str) -> &'static str {
    match name {
        "floating" => "paths-floating",
        "opening" => "paths-opening",
        "cycles" => "paths-cycles",
        "steps" => "paths-steps",
        "steps-agreement" => "paths-agreement",
        _ => "paths-increments",
    }
}
