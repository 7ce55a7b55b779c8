//! Writes what the studies found: numbers, charts, and the page.
//!
//! What the page says of a study is kept in `findings.json` beside its numbers, so that one study can be run
//! again without the others.

use std::fmt::Write as _;
use std::fs;
use std::io;
use std::path::Path;
use std::time::Instant;

use serde_json::{Map, Value, json};

use crate::studies::{Effort, Finding, Study, Table};

/// A page of studies.
pub struct Page<'a> {
    /// Its name, and that of the folder with its numbers and charts.
    pub name: &'static str,
    /// What it begins with: a title, and what it is.
    pub head: &'static str,
    /// Heads of the last two columns of its overview.
    pub columns: [&'static str; 2],
    /// Its studies, in their order.
    pub studies: &'a [Study],
    /// Studies whose tables it prints; they should be short.
    pub tables: &'a [&'static str],
    /// What all cases must hold.
    pub promise: String,
}

/// Runs the studies that the command line names, all if it names none, and writes the page into `docs`; with
/// `--quick` a few values only, into `target/NAME`.
pub fn run(page: &Page<'_>) {
    let arguments: Vec<String> = std::env::args()
        .skip(1)
        .filter(|a| a != "--bench")
        .collect();
    let quick = arguments.iter().any(|argument| argument == "--quick");
    let asked: Vec<&String> = arguments.iter().filter(|a| *a != "--quick").collect();
    let known: Vec<&str> = page.studies.iter().map(|study| study.name).collect();
    for name in &asked {
        assert!(
            known.contains(&name.as_str()),
            "no study {name}; there are {known:?}"
        );
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let (effort, folder) = if quick {
        (Effort::Quick, root.join("target").join(page.name))
    } else {
        (Effort::Full, root.join("docs"))
    };
    for study in page.studies {
        if asked.is_empty() || asked.iter().any(|name| *name == study.name) {
            run_study(page, study, effort, &folder);
        }
    }
    write(page, &folder).expect("a page");
}

fn run_study(page: &Page<'_>, study: &Study, effort: Effort, folder: &Path) {
    let start = Instant::now();
    let finding = (study.run)(effort);
    keep(page, folder, study, &finding).expect("files of the study");
    let seconds = start.elapsed().as_secs_f64();
    println!("{}: {seconds:.0} s. {}", study.name, finding.ours);
    for miss in &finding.misses {
        println!("  did not hold: {miss}");
    }
}

/// Writes the files of a study, and keeps what the page says of it.
pub fn keep(page: &Page<'_>, folder: &Path, study: &Study, finding: &Finding) -> io::Result<()> {
    let own = folder.join(page.name);
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
    let mut findings = kept(page, folder)?;
    let shown = page.tables.contains(&study.name);
    let entry = json!({
        "breaks": finding.breaks,
        "ours": finding.ours,
        "paragraph": finding.paragraph,
        "charts": charts,
        "misses": finding.misses,
        "table": if shown { markdown(&finding.table) } else { String::new() },
    });
    findings.insert(study.name.to_owned(), entry);
    let text = serde_json::to_string_pretty(&findings)? + "\n";
    fs::write(own.join("findings.json"), text)
}

/// What was found before, by study.
fn kept(page: &Page<'_>, folder: &Path) -> io::Result<Map<String, Value>> {
    match fs::read_to_string(folder.join(page.name).join("findings.json")) {
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

/// The table as the page prints it.
fn markdown(table: &Table) -> String {
    let rule = format!("|{}\n", "---|".repeat(table.head.len()));
    let rows = table.rows.iter();
    let rows = rows.map(|row| format!("| {} |\n", row.join(" | ")));
    format!("| {} |\n{rule}", table.head.join(" | ")) + &rows.collect::<String>()
}

/// A paragraph and charts: what stands after an empty line of the paragraph belongs to the charts, one each.
fn story(page: &Page<'_>, finding: &Value) -> String {
    let paragraph = finding["paragraph"].as_str().unwrap_or_default();
    let mut parts = paragraph.split("\n\n").map(wrapped);
    let mut text = parts.next().unwrap_or_default() + "\n\n";
    for chart in finding["charts"].as_array().into_iter().flatten() {
        let (name, title) = (
            chart[0].as_str().unwrap_or(""),
            chart[1].as_str().unwrap_or(""),
        );
        let _ = writeln!(text, "![{title}]({}/{name}.svg)\n", page.name);
        if let Some(part) = parts.next() {
            text += &(part + "\n\n");
        }
    }
    match finding["table"].as_str() {
        Some(table) if !table.is_empty() => text + table + "\n",
        _ => text,
    }
}

/// Writes the page from all that is kept.
pub fn write(of: &Page<'_>, folder: &Path) -> io::Result<()> {
    let findings = kept(of, folder)?;
    let known = || {
        of.studies
            .iter()
            .filter_map(|study| Some((study, findings.get(study.name)?)))
    };
    let text = |finding: &Value, key: &str| finding[key].as_str().unwrap_or_default().to_owned();
    let mut page = of.head.to_owned();
    let [breaks, ours] = of.columns;
    let _ = writeln!(
        page,
        "| study | sweep | {breaks} | {ours} |\n|---|---|---|---|"
    );
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
        let _ = write!(page, "\n## {}\n\n{}", study.title, story(of, finding));
        let _ = writeln!(page, "Numbers: [{0}.csv]({1}/{0}.csv)", study.name, of.name);
    }
    page += "\n## What did not\n\n";
    page += &wrapped(&of.promise);
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
    fs::write(folder.join(format!("{}.md", of.name)), page)
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
