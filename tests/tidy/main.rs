//! The rules of the house that a compiler does not know: what may depend on what, how long a file
//! or a function may be, how wide prose is. Every rule lists all that break it, by file and line.

mod circles;
mod comments;
mod crates;
mod dependencies;
mod forbidden;
mod imports;
mod lengths;
mod masked;
mod modules;
mod prose;
mod workspace;

use workspace::{rust_files, text_files};

/// Something that breaks a rule.
#[derive(Debug, PartialEq, Eq)]
pub struct Violation {
    /// File and line.
    pub place: String,
    /// What is wrong there.
    pub problem: String,
}

impl Violation {
    fn new(file: &str, line: usize, problem: impl Into<String>) -> Self {
        Self {
            place: format!("{file}:{line}"),
            problem: problem.into(),
        }
    }
}

/// Fails with all violations.
fn assert_none(rule: &str, violations: &[Violation]) {
    let lines = violations
        .iter()
        .map(|violation| format!("{}: {}", violation.place, violation.problem));
    let lines: Vec<String> = lines.collect();
    assert!(
        lines.is_empty(),
        "{rule}: {} violations\n{}",
        lines.len(),
        lines.join("\n")
    );
}

#[test]
fn crates_depend_only_on_those_below() {
    assert_none(
        "edges between crates",
        &crates::check(&workspace::manifests()),
    );
}

#[test]
fn no_files_of_a_crate_import_each_other() {
    let sources: Vec<_> = rust_files();
    assert_none("import circles", &circles::check(&sources));
}

#[test]
fn nothing_is_done_that_nobody_may_do() {
    let found: Vec<Violation> = rust_files().iter().flat_map(forbidden::check).collect();
    assert_none("#[path], unsafe, printing", &found);
}

#[test]
fn files_and_functions_are_short() {
    let found: Vec<Violation> = rust_files().iter().flat_map(lengths::check).collect();
    assert_none("lengths", &found);
}

#[test]
fn files_begin_with_a_line_of_documentation_and_comments_are_narrow() {
    let found: Vec<Violation> = rust_files().iter().flat_map(comments::check).collect();
    assert_none("comments", &found);
}

#[test]
fn prose_is_narrow() {
    let pages = text_files("docs", "md");
    let found: Vec<Violation> = pages
        .iter()
        .flat_map(|(name, text)| prose::check(name, text))
        .collect();
    assert_none("prose", &found);
}

#[test]
fn packages_of_others_are_licensed_and_from_the_registry() {
    assert_none("dependencies", &dependencies::check());
}
