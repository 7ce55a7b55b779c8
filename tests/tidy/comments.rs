//! Comments: a line of documentation on top of each file, and their width.

use crate::Violation;
use crate::workspace::Source;

const WIDEST: usize = 100;

pub fn check(source: &Source) -> Vec<Violation> {
    let mut found = Vec::new();
    let first = source.text.lines().find(|line| !line.trim().is_empty());
    if !first.is_some_and(|line| line.starts_with("//!")) {
        let problem = "no line `//!` on top says what the file is";
        found.push(Violation::new(&source.name, 1, problem));
    }
    for (index, line) in source.text.lines().enumerate() {
        let width = line.chars().count();
        if width > WIDEST && line.trim_start().starts_with("//") && !is_unbreakable(line) {
            let problem = format!("a comment of {width} columns; at most {WIDEST}");
            found.push(Violation::new(&source.name, index + 1, problem));
        }
    }
    found
}

/// Addresses and rows of tables stay in one line.
fn is_unbreakable(line: &str) -> bool {
    let body = line
        .trim_start()
        .trim_start_matches(['/', '!'])
        .trim_start();
    line.contains("://") || body.starts_with('|')
}

#[test]
fn a_missing_head_and_a_wide_comment_are_found() {
    let wide = format!("    // {}", "word ".repeat(20));
    let code = format!("    let x = \"{}\";", "word ".repeat(20));
    let text = format!("use a;\n{wide}\n{code}\n");
    let found = check(&Source::new("x.rs", &text));
    let places: Vec<&str> = found.iter().map(|one| one.place.as_str()).collect();
    assert_eq!(places, ["x.rs:1", "x.rs:2"]);
    assert!(check(&Source::new("x.rs", "//! A file.\n")).is_empty());
}
