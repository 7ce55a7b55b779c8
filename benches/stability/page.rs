//! Writes what the studies found: numbers, charts, and the page.
//!
//! What the page says of a study is kept in `stability/findings.json`, so that one study can be run
//! again without the others.

use std::fmt::Write as _;
use std::fs;
use std::io;
use std::path::Path;

use serde_json::{Map, Value, json};

use crate::studies::{ALL, Finding, PROMISE, PROMISE_WITH_FRICTION, Study, Table};

/// Writes the files of a study, and keeps what the page says of it.
pub fn keep(folder: &Path, study: &Study, finding: &Finding) -> io::Result<()> {
    let own = folder.join("stability");
    fs::create_dir_all(&own)?;
    fs::write(own.join(format!("{}.csv", study.name)), csv(&finding.table))?;
    for (name, chart) in &finding.charts {
        fs::write(own.join(format!("{name}.svg")), chart.svg())?;
    }
    let charts: Vec<Value> = finding
        .charts
        .iter()
        .map(|(name, chart)| json!([name, chart.title]))
        .collect();
    let mut findings = kept(folder)?;
    let entry = json!({
        "breaks": finding.breaks,
        "ours": finding.ours,
        "paragraph": finding.paragraph,
        "charts": charts,
        "misses": finding.misses,
    });
    findings.insert(study.name.to_owned(), entry);
    let text = serde_json::to_string_pretty(&findings)? + "\n";
    fs::write(own.join("findings.json"), text)
}

/// What was found before, by study.
fn kept(folder: &Path) -> io::Result<Map<String, Value>> {
    match fs::read_to_string(folder.join("stability/findings.json")) {
        Ok(text) => Ok(serde_json::from_str(&text)?),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(Map::new()),
        Err(error) => Err(error),
    }
}

/// A table with commas; entries that have one are quoted.
pub fn csv(table: &Table) -> String {
    let line = |entries: Vec<&str>| {
        let quoted = entries.into_iter().map(|entry| {
            if entry.contains([',', '"']) {
                format!("\"{}\"", entry.replace('"', "\"\""))
            } else {
                entry.to_owned()
            }
        });
        quoted.collect::<Vec<String>>().join(",") + "\n"
    };
    let rows = table
        .rows
        .iter()
        .map(|row| row.iter().map(String::as_str).collect());
    let head = std::iter::once(table.head.clone());
    head.chain(rows).map(line).collect()
}

const HEAD: &str = "# Stability map

Written by `cargo bench --bench stability`: every parameter is swept over many decades, beside a method that breaks,
on small meshes and with default settings. Nothing here is typed in: numbers come from the run, and stand in
`docs/stability/*.csv`. Short forms of all studies are tests (`tests/physics/stability.rs`).

";

/// Writes the page from all that is kept.
pub fn write(folder: &Path) -> io::Result<()> {
    let findings = kept(folder)?;
    let known = || {
        ALL.iter()
            .filter_map(|study| Some((study, findings.get(study.name)?)))
    };
    let text = |finding: &Value, key: &str| finding[key].as_str().unwrap_or_default().to_owned();
    let mut page = HEAD.to_owned();
    page += "| study | sweep | what breaks | Kluft |\n|---|---|---|---|\n";
    for (study, finding) in known() {
        let anchor = study
            .title
            .to_lowercase()
            .replace(' ', "-")
            .replace(',', "");
        let (breaks, ours) = (text(finding, "breaks"), text(finding, "ours"));
        let _ = writeln!(
            page,
            "| [{}](#{anchor}) | {} | {breaks} | {ours} |",
            study.title, study.sweep
        );
    }
    for (study, finding) in known() {
        let _ = writeln!(
            page,
            "\n## {}\n\n{}\n",
            study.title,
            wrapped(&text(finding, "paragraph"))
        );
        for chart in finding["charts"].as_array().into_iter().flatten() {
            let (name, title) = (
                chart[0].as_str().unwrap_or(""),
                chart[1].as_str().unwrap_or(""),
            );
            let _ = writeln!(page, "![{title}](stability/{name}.svg)\n");
        }
        let _ = writeln!(page, "Numbers: [{0}.csv](stability/{0}.csv)", study.name);
    }
    page += "\n## What did not\n\n";
    page += &wrapped(&format!(
        "Promised is: every case with a solution converges with default settings in at most {PROMISE} Newton iterations \
         a step, {PROMISE_WITH_FRICTION} with friction in each part that it divides a step into; every case without one \
         ends with exit code 1 and the name of a fracture or block; and what the studies compare agrees as they say."
    ));
    page += "\n\n";
    let mut all = true;
    for (study, finding) in known() {
        for miss in finding["misses"].as_array().into_iter().flatten() {
            all = false;
            let _ = writeln!(page, "- *{}*: {}", study.title, miss.as_str().unwrap_or(""));
        }
    }
    if all {
        page += "Every case held.\n";
    }
    fs::write(folder.join("stability.md"), page)
}

/// Lines of at most 120 characters.
pub fn wrapped(text: &str) -> String {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        let line = lines.last_mut().expect("a line");
        if !line.is_empty() && line.chars().count() + 1 + word.chars().count() > 120 {
            lines.push(word.to_owned());
        } else {
            if !line.is_empty() {
                line.push(' ');
            }
            line.push_str(word);
        }
    }
    lines.join("\n")
}
