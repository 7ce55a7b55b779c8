//! `study.html`: everything about a study on one page that needs no other file.

use std::fmt::Write;

use super::answer;
use super::assess::Assessment;
use super::charts::{NamedChart, subject};
use super::point::{Numbers, PointRecord};
use super::under_way::Study;
use super::words::{duration, memory, percent};
use crate::printing::lines;

const STYLE: &str = include_str!("page.css");

/// The page; each chart comes with its SVG.
pub(super) fn page(study: &Study, found: &Assessment, charts: &[(&NamedChart, String)]) -> String {
    let title = escaped(&study.title);
    let mut page = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n\
         <title>Accuracy against cost: {title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n\
         <h1>Accuracy against cost: {title}</h1>\n"
    );
    page += &lead(study, found);
    for (named, svg) in charts {
        let title = escaped(&named.chart.title);
        let svg = svg.trim_start_matches(|c| c != '<');
        let svg = svg.replacen(
            "<svg ",
            &format!("<svg role=\"img\" aria-label=\"{title}\" "),
            1,
        );
        let left = named.left_out.as_deref().unwrap_or_default();
        let _ = write!(
            page,
            "<figure>\n{svg}\n<figcaption class=\"soft\">{left}</figcaption>\n</figure>\n"
        );
    }
    page += &numbers(study, found);
    page += &failures(study);
    page += &circumstances(study);
    page + "</body>\n</html>\n"
}

/// Text in which nothing is markup, and nothing commands who prints the page.
pub(super) fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in lines(text).chars() {
        match c {
            '&' => out += "&amp;",
            '<' => out += "&lt;",
            '>' => out += "&gt;",
            '"' => out += "&quot;",
            '\'' => out += "&#39;",
            c => out.push(c),
        }
    }
    out
}

/// What was measured against what, and what came out.
fn lead(study: &Study, found: &Assessment) -> String {
    let mut out = String::new();
    let solved = study
        .records
        .iter()
        .flatten()
        .filter(|r| r.numbers().is_some())
        .count();
    let count = study.records.len();
    let compared = found
        .target
        .as_ref()
        .is_some_and(|target| target.is_compared);
    let has_errors = found.verdicts.iter().any(|verdict| verdict.error.is_some());
    let against = match (compared, has_errors) {
        (true, _) => "Errors are against the closed form that the scene names.".to_owned(),
        (_, true) => "The scene names no closed form; errors are against the value that finer and finer \
            meshes approach (Richardson extrapolation), and mean nothing below its uncertainty, the grey band."
            .to_owned(),
        _ => format!("There are no errors: {}.", escaped(&answer::no_errors(study, found))),
    };
    let _ = writeln!(
        out,
        "<p>Measured: <strong>{}</strong>. {solved} of {count} settings were solved. {against}</p>",
        escaped(&subject(found))
    );
    if !found.references.is_empty() {
        let items = found.references.iter();
        let items: String = items
            .map(|r| format!("<li>{}</li>\n", escaped(&r.in_words())))
            .collect();
        let _ = write!(out, "<ul>\n{items}</ul>\n");
    }
    if let Some(labels) = &found.identical_meshes {
        let text = escaped(&answer::identical_meshes(labels));
        let _ = writeln!(out, "<p class=\"failed\">{text}.</p>");
    }
    if has_errors {
        out += "<p class=\"soft\">A number beside a line is its slope: error ~ (wall time or unknowns) to that power, \
            by least squares through its last three points. Wall time is that of a whole run, gmsh included. \
            The wide grey line joins the settings that no other beats in time and error.</p>\n";
    }
    out
}

fn numbers(study: &Study, found: &Assessment) -> String {
    let plan = &study.plan;
    let told: Vec<usize> = (0..plan.dimensions.len())
        .filter(|&i| plan.dimensions[i].choices.len() > 1)
        .collect();
    let mut head: String = told
        .iter()
        .map(|&i| format!("<th>{}</th>", escaped(&plan.dimensions[i].name)))
        .collect();
    let fixed = [
        "cells",
        "unknowns",
        "of jumps",
        "Newton",
        "linear",
        "wall time",
        "of it gmsh",
        "memory",
        "value",
        "error",
    ];
    head.extend(fixed.map(|name| format!("<th class=\"number\">{name}</th>")));
    let front = study.front(found);
    let mut rows = String::new();
    for (i, setting) in plan.settings.iter().enumerate() {
        let labels = told
            .iter()
            .map(|&d| format!("<td>{}</td>", escaped(plan.label(setting, d))));
        let is_best = front.contains(&i);
        let class = if is_best { " class=\"best\"" } else { "" };
        let record = study.records[i].as_ref();
        let cells = match (record.and_then(PointRecord::numbers), record) {
            (Some(numbers), _) => cells(numbers, found, i),
            (None, Some(_)) => no_cells("failed", fixed.len()),
            (None, None) => no_cells("not run", fixed.len()),
        };
        let _ = writeln!(
            rows,
            "<tr{class}>{}{cells}</tr>",
            labels.collect::<String>()
        );
    }
    format!(
        "<h2>Numbers</h2>\n<p class=\"soft\">Cheapest first, as predicted; shaded: beaten by none in both time and \
         error. <code>study.csv</code> has every measure.</p>\n\
         <div class=\"wide\"><table>\n<thead><tr>{head}</tr></thead>\n<tbody>\n{rows}</tbody>\n</table></div>\n"
    )
}

fn no_cells(why: &str, count: usize) -> String {
    format!("<td class=\"failed\" colspan=\"{count}\">{why}</td>")
}

fn cells(numbers: &Numbers, found: &Assessment, index: usize) -> String {
    let verdict = found.verdicts[index];
    let unsure = match verdict.uncertainty {
        0.0 => String::new(),
        share => format!(" ± {}", percent(share)),
    };
    let texts = [
        numbers.cells.to_string(),
        numbers.unknowns.to_string(),
        numbers.jump_unknowns.to_string(),
        numbers.newton_iterations.to_string(),
        numbers.linear_iterations.to_string(),
        duration(numbers.seconds),
        duration(numbers.meshing_seconds),
        memory(numbers.peak_memory_bytes as f64),
        verdict
            .value
            .map_or_else(|| "–".into(), |value| format!("{value:.6e}")),
        verdict
            .error
            .map_or_else(|| "–".into(), |error| percent(error) + &unsure),
    ];
    texts
        .iter()
        .map(|text| format!("<td class=\"number\">{text}</td>"))
        .collect()
}

fn failures(study: &Study) -> String {
    let failed = study.records.iter().enumerate();
    let failed = failed.filter_map(|(i, record)| Some((i, record.as_ref()?.failure()?)));
    let rows = failed.map(|(i, why)| {
        let name = escaped(&study.name(i));
        format!(
            "<tr><td>{name}</td><td class=\"failed\">{}</td></tr>\n",
            escaped(why)
        )
    });
    let rows: String = rows.collect();
    if rows.is_empty() {
        return rows;
    }
    format!("<h2>Settings that failed</h2>\n<div class=\"wide\"><table>\n{rows}</table></div>\n")
}

/// Scene and machine.
fn circumstances(study: &Study) -> String {
    let machine = &study.machine;
    let bytes = machine
        .memory_bytes
        .map_or_else(|| "unknown".into(), |bytes| memory(bytes as f64));
    format!(
        "<h2>Machine</h2>\n<p>{}, {} cores, {bytes} of memory; {} threads a run. Kluft {}, gmsh {}.</p>\n\
         <h2>Scene</h2>\n<pre>{}</pre>\n",
        escaped(&machine.processor),
        machine.cores,
        study.runner.threads,
        env!("CARGO_PKG_VERSION"),
        escaped(&machine.gmsh),
        escaped(&study.text)
    )
}
