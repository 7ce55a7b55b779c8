//! Lines of the report of an inspection.

use std::fmt::Write;

use crate::printing::{one_line, shortened, wrapped};

use super::findings::Place;

/// Lists longer than this are cut; `--json` has all of them.
const SHOWN: usize = 12;

/// Adds one line, broken where it is too long, below its own beginning or a head of eleven columns.
pub fn line(out: &mut String, text: &str) {
    let text = one_line(text.trim_end());
    let indent = if text.starts_with("  ") { 4 } else { 11 };
    // Writing to a string does not fail.
    let _ = writeln!(out, "{}", wrapped(&text, indent));
}

/// The same after an empty line.
pub fn head_line(out: &mut String, text: &str) {
    out.push('\n');
    line(out, text);
}

/// A name that leaves room beside it on a line.
pub fn short(name: &str) -> String {
    shortened(name, 50)
}

pub fn at(place: Place) -> String {
    // Without rounding first, -1e-9 would be printed as -0.0000.
    let [x, y, z] = place.map(|value| (1e4 * value).round() / 1e4 + 0.0);
    format!("({x:.4}, {y:.4}, {z:.4})")
}

/// Prints the first few entries of a list and counts the others.
pub fn list<T>(out: &mut String, entries: &[T], print: impl Fn(&T) -> String) {
    for entry in entries.iter().take(SHOWN) {
        line(out, &print(entry));
    }
    if entries.len() > SHOWN {
        line(
            out,
            &format!("  and {} more (--json lists them)", entries.len() - SHOWN),
        );
    }
}
