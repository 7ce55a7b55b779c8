//! Opening, closing, and the way there: cycles, and the number of load steps.

use kluft_solver::Discretisation;

use super::{Found, Page};
use crate::studies::{
    Effort, Finding, Table, cycles, entry, increments, largest, most, opening, steps,
};

pub const PAGE: Page = Page {
    name: "paths",
    title: "Opening, closing and the way there",
    oracle: "laws with a potential: no hysteresis, no influence of the steps; a joint in series with rock",
    closed_form: "
Without friction the traction is a function of the aperture, so the same loads give the same state whatever came before, and
one step leads where a hundred do. A column with a level joint, moved by z at its top, H = 2 m high:

    opening w and traction t   of   w(t) + t H/E = z   in compression,   w = z and t = 0   once open without tension",
    run,
};

/// Unknowns of the largest scene.
fn unknowns() -> usize {
    let scenes = [
        steps::problems(Effort::Full),
        cycles::problems(Effort::Full),
    ];
    let counts = scenes.iter().flatten().map(|(_, problem)| {
        let discretisation = Discretisation::of(problem).expect("supported");
        discretisation.unknown_count()
    });
    counts.max().unwrap_or(0)
}

/// The numbers of a column in the rows that a test of their second entry takes; what failed is not a number.
fn numbers(finding: &Finding, column: &str, rows: fn(&str) -> bool) -> Vec<f64> {
    let Table { head, rows: all } = &finding.table;
    let place = head.iter().position(|head| *head == column);
    let place = place.expect("a column of the study");
    let own = all.iter().filter(|row| rows(&row[1]));
    own.map(|row| row[place].parse().unwrap_or(f64::NAN))
        .collect()
}

/// What each study of runs compares, in how many cases, and how far apart they are at most.
fn summary([opened, cycled, stepped, _]: &[Finding; 4]) -> Table {
    let mut table = Table::new(&[
        "study",
        "compared with",
        "cases",
        "most Newton iterations of a step",
        "largest difference (relative)",
    ]);
    let all = |_: &str| true;
    let cycles = |case: &str| case.ends_with("cycles");
    let floats = |case: &str| case.starts_with("floating");
    let newton = "most Newton iterations of a step";
    let form = "error against the closed form";
    let steps = "most of a step";
    let first = "hysteresis";
    let once = "difference from one step";
    type Row<'a> = (
        &'a str,
        &'a str,
        &'a Finding,
        [&'a str; 2],
        fn(&str) -> bool,
    );
    let rows: [Row<'_>; 5] = [
        (
            "opening and closing",
            "closed form",
            opened,
            [newton, form],
            cycles,
        ),
        (
            "opening and closing",
            "first cycle",
            opened,
            [newton, first],
            cycles,
        ),
        (
            "floating block",
            "its weight",
            opened,
            [newton, form],
            floats,
        ),
        (
            "loading and unloading",
            "first cycle",
            cycled,
            [newton, first],
            all,
        ),
        (
            "1 to 100 load steps",
            "one step",
            stepped,
            [steps, once],
            all,
        ),
    ];
    for (study, with, finding, columns, rows) in rows {
        let [counts, differences] = columns.map(|column| numbers(finding, column, rows));
        let converged = |count: f64| count.is_finite().then_some(count as usize);
        table.push([
            study.to_owned(),
            with.to_owned(),
            differences.len().to_string(),
            entry(most(counts.into_iter().map(converged))),
            format!("{:.2e}", largest(differences)),
        ]);
    }
    table
}

fn run() -> Found {
    let findings: [Finding; 4] = [
        opening::STUDY,
        cycles::STUDY,
        steps::STUDY,
        increments::STUDY,
    ]
    .map(|study| (study.run)(Effort::Full));
    let misses: Vec<String> = findings
        .iter()
        .flat_map(|finding| finding.misses.clone())
        .collect();
    let held = match misses.is_empty() {
        true => "Every case held.".to_owned(),
        false => format!("Not all held: {}.", misses.join("; ")),
    };
    let paragraphs = findings.iter().map(|finding| finding.paragraph.as_str());
    let shows = paragraphs
        .chain([held.as_str()])
        .collect::<Vec<_>>()
        .join(" ");
    let summary = summary(&findings);
    let [opened, cycled, stepped, incremented] = findings;
    Found {
        problem: "The studies of the stability map on joints without tension that open and close for 20 cycles, blocks that float in between, \
                  junctions and jointed blocks loaded and unloaded for 20 cycles, the same load in 1 to 100 steps, and the law against its \
                  incremental form."
            .to_owned(),
        reached: format!("cycles: {}; steps: {}", cycled.ours, stepped.ours),
        unknowns: unknowns(),
        charts: [&opened, &cycled, &stepped, &incremented]
            .into_iter()
            .flat_map(|finding| finding.charts.clone())
            .map(|(name, chart)| (file_of(name), chart))
            .collect(),
        shows,
        tables: vec![
            ("paths", summary),
            ("paths-opening", opened.table),
            ("paths-cycles", cycled.table),
            ("paths-steps", stepped.table),
            ("paths-increments", incremented.table),
        ],
    }
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
