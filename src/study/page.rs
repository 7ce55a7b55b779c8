//! `study.html`: everything about a study on one page that needs no other file.

use kluft_report::{Page, Table};
use kluft_run::memory;

use super::answer;
use super::assess::Assessment;
use super::charts::{NamedChart, subject};
use super::point::{Numbers, PointRecord};
use super::under_way::Study;
use super::words::{duration, percent};

/// Columns of every setting, all of numbers.
const COLUMNS: [&str; 10] = [
    "cells#",
    "unknowns#",
    "of jumps#",
    "Newton#",
    "linear#",
    "wall time#",
    "of it gmsh#",
    "memory#",
    "value#",
    "error#",
];

/// Errors that users want most often.
const WANTED: [f64; 3] = [0.05, 0.02, 0.01];
const NOTHING: [&str; 3] = ["–"; 3];

/// What such pages are known by.
const MAKER: &str = "Kluft study";

/// The page; each chart comes with its SVG.
pub(super) fn page(study: &Study, found: &Assessment, charts: &[(&NamedChart, String)]) -> String {
    let mut page = Page::new(&format!("Accuracy against cost: {}", study.title), MAKER);
    lead(&mut page, study, found);
    cheapest(&mut page, study, found);
    for (named, svg) in charts {
        let left_out = named.left_out.as_deref().unwrap_or_default();
        let narrow = named.chart.narrow_svg();
        page.chart(&named.chart.title, [svg, &narrow], left_out);
    }
    numbers(&mut page, study, found);
    failures(&mut page, study);
    circumstances(&mut page, study);
    page.into_html()
}

/// What was measured against what, and what came out.
fn lead(page: &mut Page, study: &Study, found: &Assessment) {
    let records = study.records.iter().flatten();
    let solved = records.filter(|record| record.numbers().is_some()).count();
    let count = study.records.len();
    let target = found.target.as_ref();
    let compared = target.is_some_and(|target| target.is_compared);
    let has_errors = found.verdicts.iter().any(|verdict| verdict.error.is_some());
    let against = match (compared, has_errors) {
        (true, _) => "Errors are against the closed form that the scene names.".to_owned(),
        (_, true) => "The scene names no closed form; errors are against the value that finer and \
            finer meshes approach (Richardson extrapolation), and mean nothing below its \
            uncertainty, the grey band."
            .to_owned(),
        _ => format!("There are no errors: {}.", answer::no_errors(study, found)),
    };
    let subject = subject(found);
    page.text(&format!(
        "Measured: {subject}. {solved} of {count} settings were solved. {against}"
    ));
    if let Some(text) = answer::instead(found) {
        page.warning(&format!("{text}."));
    }
    let references: Vec<String> = found.references.iter().map(|r| r.in_words()).collect();
    page.list(references.iter().map(String::as_str));
    if let Some(labels) = &found.identical_meshes {
        page.warning(&format!("{}.", answer::identical_meshes(labels)));
    }
    if has_errors {
        page.remark(
            "A number beside a line is its slope: error ~ (wall time or unknowns) to that power, \
             by least squares through its last three points. Wall time is that of a whole run, \
             gmsh included. The wide grey line joins the settings that no other beats in time and \
             error.",
        );
    }
}

/// What a user of the page asks first: how to be so accurate at the least cost.
fn cheapest(page: &mut Page, study: &Study, found: &Assessment) {
    if found.verdicts.iter().all(|verdict| verdict.error.is_none()) {
        return;
    }
    let mut table = Table::new(&[
        "wanted",
        "cheapest setting",
        "wall time#",
        "memory#",
        "error#",
    ]);
    for tolerance in WANTED {
        let wanted = format!("{} or less", percent(tolerance));
        let best = answer::cheapest(study, found, tolerance);
        let numbers = best.and_then(|i| Some((i, study.records[i].as_ref()?.numbers()?)));
        match numbers {
            Some((i, numbers)) => {
                let [.., seconds, _, memory, _, error] = cells(numbers, found, i);
                table.row(&[&wanted, &study.name(i)], &[seconds, memory, error]);
            }
            None => table.row(
                &[&wanted, "none of these settings"],
                &NOTHING.map(String::from),
            ),
        }
    }
    page.heading("Cheapest setting for an error");
    page.table(&table);
}

fn numbers(page: &mut Page, study: &Study, found: &Assessment) {
    let plan = &study.plan;
    let dimensions = plan.dimensions.iter().enumerate();
    let swept = dimensions.filter(|(_, dimension)| dimension.choices.len() > 1);
    let (told, names): (Vec<usize>, Vec<&str>) = swept
        .map(|(number, dimension)| (number, dimension.name.as_str()))
        .unzip();
    let mut table = Table::new(&[&names[..], &COLUMNS].concat());
    let front = study.front(found);
    for (i, setting) in plan.settings.iter().enumerate() {
        let labels: Vec<&str> = told.iter().map(|&d| plan.label(setting, d)).collect();
        let record = study.records[i].as_ref();
        match (record.and_then(PointRecord::numbers), record) {
            (Some(numbers), _) if front.contains(&i) => {
                table.best_row(&labels, &cells(numbers, found, i));
            }
            (Some(numbers), _) => table.row(&labels, &cells(numbers, found, i)),
            (None, Some(_)) => table.failed_row(&labels, "failed", COLUMNS.len()),
            (None, None) => table.failed_row(&labels, "not run", COLUMNS.len()),
        }
    }
    page.heading("Numbers");
    page.remark(
        "Cheapest first, as predicted; shaded: beaten by none in both time and error. `study.csv` \
         has every measure.",
    );
    page.table(&table);
}

fn cells(numbers: &Numbers, found: &Assessment, index: usize) -> [String; COLUMNS.len()] {
    let verdict = found.verdicts[index];
    let unsure = match verdict.uncertainty {
        0.0 => String::new(),
        share => format!(" ± {}", percent(share)),
    };
    [
        numbers.cells.to_string(),
        numbers.unknowns.to_string(),
        numbers.jump_unknowns.to_string(),
        numbers.newton_iterations.to_string(),
        numbers.linear_iterations.to_string(),
        duration(numbers.seconds),
        duration(numbers.meshing_seconds),
        memory::in_words(numbers.peak_memory_bytes as usize),
        verdict
            .value
            .map_or_else(|| "–".into(), |value| format!("{value:.6e}")),
        verdict
            .error
            .map_or_else(|| "–".into(), |error| percent(error) + &unsure),
    ]
}

fn failures(page: &mut Page, study: &Study) {
    let failed = study.records.iter().enumerate();
    let failed = failed.filter_map(|(i, record)| Some((i, record.as_ref()?.failure()?)));
    let mut table = Table::new(&["setting", "why"]);
    let mut count = 0;
    for (i, why) in failed {
        table.failed_row(&[&study.name(i)], why, 1);
        count += 1;
    }
    if count > 0 {
        page.heading("Settings that failed");
        page.table(&table);
    }
}

/// Scene and machine.
fn circumstances(page: &mut Page, study: &Study) {
    let machine = &study.machine;
    let bytes = machine.memory_bytes;
    let bytes = bytes.map_or_else(|| "unknown".into(), memory::in_words);
    page.heading("Machine");
    page.text(&format!(
        "{}, {} cores, {bytes} of memory; {} threads a run. Kluft {}, gmsh {}.",
        machine.processor,
        machine.cores,
        study.runner.threads,
        env!("CARGO_PKG_VERSION"),
        study.runner.gmsh_version.as_deref().unwrap_or("unknown")
    ));
    page.folded("Scene", &study.text);
}
