//! Defects as the terminal shows them.

use std::fmt::Write;

use kluft_mesh::Defect;

use crate::printing::one_line;

/// Defects beyond these are counted by their kind.
pub const SHOWN: usize = 20;
/// Kinds beyond these are left out.
const KINDS: usize = 10;

/// The first defects with their remedies, and how many more there are of each kind.
pub fn listed(defects: &[Defect]) -> String {
    let count = defects.len();
    let noun = if count == 1 { "defect" } else { "defects" };
    let mut out = format!("{count} {noun} in the input\n");
    for Defect {
        place,
        problem,
        remedy,
        ..
    } in defects.iter().take(SHOWN)
    {
        let [place, problem, remedy] = [place, problem, remedy].map(|text| one_line(text));
        let _ = writeln!(out, "{place}: {problem}\n    remedy: {remedy}");
    }
    if count > SHOWN {
        out += &counted(&defects[SHOWN..]);
    }
    out
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
        let text = listed(&flat.chain(loose).collect::<Vec<_>>());
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
    fn a_name_ends_no_line() {
        let text = listed(&[Defect::new("a\n\u{1b}[2J.toml", "is `\u{7}`", "rename")]);
        assert_eq!(
            text,
            "1 defect in the input\na\\n\\u{1b}[2J.toml: is `\\u{7}`\n    remedy: rename\n"
        );
    }
}
