//! Width of the pages that people write.

use crate::Violation;

const WIDEST: usize = 100;

/// Pages that programs write.
const GENERATED: [&str; 2] = ["docs/verification/", "docs/performance/"];

pub fn check(name: &str, text: &str) -> Vec<Violation> {
    let mut found = Vec::new();
    if GENERATED.iter().any(|folder| name.starts_with(folder)) {
        return found;
    }
    let mut in_code = false;
    for (index, line) in text.lines().enumerate() {
        let fence = line.trim_start().starts_with("```");
        in_code ^= fence;
        let width = line.chars().count();
        if width > WIDEST && !in_code && !fence && !is_unbreakable(line) {
            let problem = format!("{width} columns; at most {WIDEST}");
            found.push(Violation::new(name, index + 1, problem));
        }
    }
    found
}

/// Rows of tables, code that is set in, formulas, pictures and addresses.
fn is_unbreakable(line: &str) -> bool {
    let body = line.trim_start();
    let is_code = line.starts_with("    ");
    is_code || body.starts_with(['|', '$']) || body.starts_with("![") || line.contains("://")
}

#[test]
fn wide_prose_is_found_and_nothing_else() {
    let wide = "word ".repeat(21);
    let text = format!("{wide}\n\n| {wide} |\n\n```text\n{wide}\n```\n\n    {wide}\n- {wide}\n");
    let found = check("docs/how-to/x.md", &text);
    let places: Vec<&str> = found.iter().map(|one| one.place.as_str()).collect();
    assert_eq!(places, ["docs/how-to/x.md:1", "docs/how-to/x.md:10"]);
    assert!(check("docs/verification/x.md", &text).is_empty());
}
