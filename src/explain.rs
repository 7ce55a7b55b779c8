//! `kluft explain` and `kluft schema`: what the table of keys says.

use kluft_keys::Document;
use kluft_mesh::Defect;

use crate::failure::Failure;
use crate::printing::wrapped;
use crate::stdout::print;

/// Prints what a key or a section means; without one, all keys.
///
/// # Errors
/// If no key or section has that name.
pub fn explain(key: Option<&str>) -> Result<(), Failure> {
    let text = match key {
        None => kluft_keys::overview(),
        Some(key) => kluft_keys::explain(key).map_err(|near| unknown(key, &near))?,
    };
    let lines = text.lines().map(|line| wrapped(line, hanging(line)) + "\n");
    print(&lines.collect::<String>())
}

/// Where a line goes on: below the text that follows its name, or four columns in.
fn hanging(line: &str) -> usize {
    let lead = line.len() - line.trim_start().len();
    let name = line[lead..].find("  ").filter(|_| lead == 2);
    let gap = name.map(|at| line[lead + at..].len() - line[lead + at..].trim_start().len());
    name.zip(gap).map_or(4, |(at, gap)| lead + at + gap)
}

fn unknown(key: &str, near: &[&str]) -> Defect {
    let remedy = if near.is_empty() {
        "`kluft explain` lists all keys".to_owned()
    } else {
        format!("did you mean {}?", near.join(", "))
    };
    Defect::new(key, "no key or section has that name", remedy)
}

/// Prints the JSON Schema of a document.
///
/// # Errors
/// If it cannot be written.
pub fn print_schema(document: Document) -> Result<(), Failure> {
    let schema = kluft_keys::schema(document);
    print(&format!("{schema:#}\n"))
}
