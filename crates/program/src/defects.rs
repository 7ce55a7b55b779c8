//! Defects as the terminal shows them.

use std::fmt::Write;

use clap::builder::styling::{AnsiColor, Style};
use kluft_mesh::{Defect, Excerpt};

use crate::printing::one_line;

const RED: Style = AnsiColor::Red.on_default().bold();
const GREEN: Style = AnsiColor::Green.on_default();
const BOLD: Style = Style::new().bold();
/// Defects beyond these are counted by their kind.
pub const SHOWN: usize = 20;
/// Kinds beyond these are left out.
const KINDS: usize = 10;
/// Most characters of a line that are shown before what is meant, and from there on.
const BEFORE: usize = 40;
const AFTER: usize = 28;

/// The first defects with their remedies, and how many more there are of each kind; with colours,
/// places are bold, carets red and remedies green.
pub fn listed(defects: &[Defect], has_colours: bool) -> String {
    let shown = |style| if has_colours { style } else { Style::new() };
    let [red, green, bold] = [RED, GREEN, BOLD].map(shown);
    let count = defects.len();
    let noun = if count == 1 { "defect" } else { "defects" };
    let mut out = format!("{red}{count} {noun} in the input{red:#}\n");
    for defect in defects.iter().take(SHOWN) {
        let parts = [&defect.place, &defect.problem, &defect.remedy];
        let [place, problem, remedy] = parts.map(|text| one_line(text));
        let _ = writeln!(out, "{bold}{place}{bold:#}: {problem}");
        let excerpt = defect.excerpt.as_deref();
        out.extend(excerpt.map(|excerpt| marked(excerpt, red)));
        let _ = writeln!(out, "    {green}remedy:{green:#} {remedy}");
    }
    if count > SHOWN {
        out += &counted(&defects[SHOWN..]);
    }
    out
}

/// A line of a file, and below it what is meant.
fn marked(excerpt: &Excerpt, style: Style) -> String {
    let number = excerpt.number.to_string();
    let parts = [&excerpt.before, &excerpt.marked, &excerpt.after];
    let [before, marked, after] = parts.map(|text| one_line(text));
    let (before, left) = match before.chars().count() {
        count if count > BEFORE => (last(&before, BEFORE), "…"),
        _ => (before.to_string(), ""),
    };
    let room = BEFORE + AFTER - before.chars().count();
    let line: String = [&before, &*marked, &*after].concat();
    let right = if line.chars().count() > BEFORE + AFTER {
        "…"
    } else {
        ""
    };
    let line: String = line.chars().take(BEFORE + AFTER).collect();
    let carets = "^".repeat(marked.chars().count().clamp(1, room));
    let indent = " ".repeat(left.chars().count() + before.chars().count());
    let gutter = " ".repeat(number.len());
    format!("    {number} | {left}{line}{right}\n    {gutter} | {indent}{style}{carets}{style:#}\n")
}

/// The last characters of a text.
fn last(text: &str, count: usize) -> String {
    let all = text.chars().count();
    text.chars().skip(all - count).collect()
}

fn counted(defects: &[Defect]) -> String {
    let mut kinds: Vec<(String, &Defect, usize)> = Vec::new();
    for defect in defects {
        let name = kind(&defect.problem);
        match kinds.iter().position(|(known, ..)| *known == name) {
            Some(at) => kinds[at].2 += 1,
            None if kinds.len() < KINDS => kinds.push((name, defect, 1)),
            None => {}
        }
    }
    let mut out = format!("... and {} more\n", defects.len());
    for (_, first, count) in kinds {
        let text = format!("{}: {}", first.place, first.problem);
        let _ = writeln!(out, "    {count} such as {}", one_line(&text));
    }
    out
}

/// What defects of one kind have in common: the words without names and numbers.
fn kind(problem: &str) -> String {
    let unquoted = problem.split('`').step_by(2);
    let words = unquoted.flat_map(str::split_whitespace);
    words
        .filter(|word| !word.contains(|c: char| c.is_ascii_digit()))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_defects_are_counted_by_kind() {
        let flat = (0..1000).map(|i| {
            let problem = format!("cell {i} of `r{i}` is flat");
            Defect::new("a.msh", problem, "mesh it anew")
        });
        let loose = (0..7).map(|i| {
            let problem = format!("node {i} belongs to nothing, at ({i}.5, 0, 1e-{i})");
            Defect::new("a.msh", problem, "remove it")
        });
        let text = listed(&flat.chain(loose).collect::<Vec<_>>(), false);
        assert!(text.starts_with("1007 defects in the input\n"), "{text}");
        assert_eq!(text.matches("remedy: ").count(), SHOWN);
        for part in [
            "... and 987 more\n",
            "    980 such as a.msh: cell 20 of",
            "    7 such as a.msh: node 0 belongs",
        ] {
            assert!(text.contains(part), "{part}:\n{text}");
        }
    }

    #[test]
    fn colours_change_no_word() {
        let excerpt = Excerpt::of("young = 1", &(0..5));
        let defect = Defect::new("a.toml:1", "is unknown", "rename").with_excerpt(excerpt);
        let [plain, shown] = [false, true].map(|has| listed(std::slice::from_ref(&defect), has));
        for part in [RED.render().to_string(), GREEN.render().to_string()] {
            assert!(shown.contains(&part), "{shown:?}");
        }
        let bare: String =
            shown
                .split('\u{1b}')
                .enumerate()
                .fold(String::new(), |all, (i, part)| {
                    let part = if i == 0 {
                        part
                    } else {
                        part.split_once('m').map_or("", |(_, rest)| rest)
                    };
                    all + part
                });
        assert_eq!(bare, plain);
    }

    #[test]
    fn the_part_that_is_meant_is_marked() {
        let text = "[rock.a]\nyoung = 1 # soft\n";
        let shown = |text: &str, at| {
            let excerpt = Excerpt::of(text, &at);
            let defect = Defect::new("a.toml:2", "is unknown", "rename").with_excerpt(excerpt);
            listed(&[defect], false)
        };
        assert_eq!(
            shown(text, 9..14),
            "1 defect in the input\na.toml:2: is unknown\n    2 | young = 1 # soft\n      | ^^^^^\n\
             \x20   remedy: rename\n"
        );
        // A part of several lines, and the end of a text.
        assert!(shown(text, 0..40).contains("    1 | [rock.a]\n      | ^^^^^^^^\n"));
        assert!(shown(text, 26..26).contains("    3 | \n      | ^\n"));
        let long = format!("{}KEY{}", "ä".repeat(300), " = 1".repeat(300));
        let at = 600..603;
        for line in shown(&long, at).lines().filter(|line| line.contains('|')) {
            assert!(line.chars().count() <= 80, "{line}");
            let caret = line.chars().position(|c| c == '^');
            assert!(caret.is_none_or(|at| at == 8 + 1 + BEFORE), "{line}");
        }
    }

    #[test]
    fn a_name_ends_no_line() {
        let text = listed(
            &[Defect::new("a\n\u{1b}[2J.toml", "is `\u{7}`", "rename")],
            false,
        );
        assert_eq!(
            text,
            "1 defect in the input\na\\n\\u{1b}[2J.toml: is `\\u{7}`\n    remedy: rename\n"
        );
    }
}
