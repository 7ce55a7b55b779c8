//! Writes the pages and the index.
//!
//! What the index says of a page is kept in `index.json`, so that one page can be made again without
//! the others.

use std::fmt::Write as _;
use std::fs;
use std::io;
use std::path::Path;

use serde_json::{Map, Value, json};

use crate::pages::{ALL, Found, Page};
use crate::stability_page::{csv, wrapped as lines};
use crate::studies::Table;

/// Writes a page with its numbers and charts, and keeps what the index says of it.
pub fn write_page(
    folder: &Path,
    page: &Page,
    found: &Found,
    seconds: f64,
    is_busy: bool,
) -> io::Result<()> {
    fs::create_dir_all(folder)?;
    for (name, table) in &found.tables {
        fs::write(folder.join(format!("{name}.csv")), csv(table))?;
    }
    for (name, chart) in &found.charts {
        fs::write(folder.join(format!("{name}.svg")), chart.svg())?;
    }
    fs::write(folder.join(format!("{}.md", page.name)), text(page, found))?;
    let mut index = kept(folder)?;
    let entry = json!({
        "oracle": page.oracle,
        "reached": found.reached,
        "unknowns": found.unknowns,
        "seconds": seconds.round(),
        "busy": is_busy,
    });
    index.insert(page.name.to_owned(), entry);
    let text = serde_json::to_string_pretty(&index)? + "\n";
    fs::write(folder.join("index.json"), text)
}

/// Lines of at most 120 characters, none of which begins with a percent sign.
fn wrapped(text: &str) -> String {
    lines(&text.replace(" %", "\u{1}%")).replace('\u{1}', " ")
}

fn kept(folder: &Path) -> io::Result<Map<String, Value>> {
    match fs::read_to_string(folder.join("index.json")) {
        Ok(text) => Ok(serde_json::from_str(&text)?),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(Map::new()),
        Err(error) => Err(error),
    }
}

/// Longer tables are in the CSV file only.
const MOST_ROWS: usize = 30;

fn text(page: &Page, found: &Found) -> String {
    let mut text = format!("# {}\n\n{}\n", page.title, wrapped(&found.problem));
    let _ = writeln!(text, "\n## Closed form\n\n{}\n", page.closed_form.trim());
    let _ = writeln!(text, "Source: {}.\n\n## Result", page.oracle);
    for (name, chart) in &found.charts {
        let _ = writeln!(text, "\n![{}]({name}.svg)", chart.title);
    }
    for (name, table) in &found.tables {
        if table.rows.len() <= MOST_ROWS {
            let _ = write!(text, "\n{}", markdown(table));
        }
        let _ = writeln!(text, "\nNumbers: [{name}.csv]({name}.csv)");
    }
    let _ = writeln!(text, "\n## What it shows\n\n{}", wrapped(&found.shows));
    let command = format!("cargo bench --bench book -- {}", page.name);
    let _ = writeln!(text, "\n## Make it again\n\n    {command}");
    text
}

fn markdown(table: &Table) -> String {
    let line = |entries: &[&str]| format!("| {} |\n", entries.join(" | "));
    let mut text = line(&table.head);
    text += &format!("|{}\n", "---|".repeat(table.head.len()));
    for row in &table.rows {
        text += &line(&row.iter().map(String::as_str).collect::<Vec<_>>());
    }
    text
}

const HEAD: &str = "# Verification book

Written by `cargo bench --bench book`: every benchmark is a real run beside a closed form that knows nothing of the program.
Nothing here is typed in; all numbers of a page stand in its CSV files. Errors are relative.

";

/// Writes the index of all pages that are kept.
pub fn write_index(folder: &Path) -> io::Result<()> {
    let index = kept(folder)?;
    let mut text = HEAD.to_owned();
    text += "| benchmark | oracle | error reached | most unknowns | time of the page |\n|---|---|---|---|---|\n";
    let known = || {
        ALL.iter()
            .filter_map(|page| Some((page, index.get(page.name)?)))
    };
    for (page, entry) in known() {
        let _ = writeln!(
            text,
            "| [{}]({}.md) | {} | {} | {} | {} s |",
            page.title,
            page.name,
            page.oracle,
            entry["reached"].as_str().unwrap_or_default(),
            match entry["unknowns"].as_u64() {
                Some(count @ 1..) => count.to_string(),
                _ => String::new(),
            },
            entry["seconds"].as_f64().unwrap_or(f64::NAN)
        );
    }
    if known().any(|(_, entry)| entry["busy"] == true) {
        text += "\nTimes are from a machine that was busy with other work; they say what to expect at most. ";
    } else {
        text += "\n";
    }
    text += "A time covers all meshes of a page,\nmade by gmsh. Everything but times is the same in every run.\n";
    fs::write(folder.join("README.md"), text)
}
