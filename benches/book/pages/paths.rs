//! Opening, closing, and the way there: cycles, and the number of load steps.

use super::{Found, Page};
use crate::studies::{Effort, Finding, cycles, increments, opening, steps};

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
    let [opened, cycled, stepped, incremented] = findings;
    Found {
        problem: "The studies of the stability map on joints without tension that open and close for 20 cycles, blocks that float in between, \
                  junctions and jointed blocks loaded and unloaded for 20 cycles, the same load in 1 to 100 steps, and the law against its \
                  incremental form."
            .to_owned(),
        reached: format!("cycles: {}; steps: {}", cycled.ours, stepped.ours),
        unknowns: 0,
        charts: [&opened, &cycled, &stepped, &incremented]
            .into_iter()
            .flat_map(|finding| finding.charts.clone())
            .map(|(name, chart)| (file_of(name), chart))
            .collect(),
        shows,
        tables: vec![
            ("paths-opening", opened.table),
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
