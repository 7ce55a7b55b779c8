//! Lengths of files and functions.

use crate::Violation;
use crate::workspace::{Source, line_of};

const LONGEST_FILE: usize = 500;
const LONGEST_FUNCTION: usize = 60;

pub fn check(source: &Source) -> Vec<Violation> {
    let mut found = Vec::new();
    let lines = source.text.lines().count();
    if lines > LONGEST_FILE {
        let problem = format!("{lines} lines; at most {LONGEST_FILE}");
        found.push(Violation::new(&source.name, 1, problem));
    }
    for (name, first, lines) in functions(&source.code) {
        if lines > LONGEST_FUNCTION {
            let problem = format!("`{name}` has {lines} lines; at most {LONGEST_FUNCTION}");
            found.push(Violation::new(&source.name, first, problem));
        }
    }
    found
}

/// Name, first line and number of lines of all functions with a body.
fn functions(code: &str) -> Vec<(String, usize, usize)> {
    let mut found = Vec::new();
    for (at, _) in code.match_indices("fn ") {
        let before = code[..at].chars().next_back();
        if before.is_some_and(|c| c.is_alphanumeric() || c == '_') {
            continue;
        }
        let name: String = code[at + 3..]
            .chars()
            .take_while(|c| c.is_alphanumeric() || *c == '_')
            .collect();
        if let (false, Some(end)) = (name.is_empty(), end_of_body(code, at)) {
            let (first, last) = (line_of(code, at), line_of(code, end));
            found.push((name, first, last - first + 1));
        }
    }
    found
}

/// Where the body of a function ends; none if it has none.
fn end_of_body(code: &str, from: usize) -> Option<usize> {
    let (mut round, mut curly) = (0, 0);
    for (offset, byte) in code.as_bytes()[from..].iter().enumerate() {
        match byte {
            b'(' | b'[' => round += 1,
            b')' | b']' => round -= 1,
            b'{' => curly += 1,
            b'}' => {
                curly -= 1;
                if curly == 0 {
                    return Some(from + offset);
                }
            }
            b';' if curly == 0 && round == 0 => return None,
            _ => {}
        }
    }
    None
}

#[test]
fn a_long_function_and_a_long_file_are_found() {
    let body = "    g(\"}\");\n".repeat(LONGEST_FUNCTION - 1);
    let text =
        format!("trait T {{\n    fn f([u8; 2]);\n}}\nfn long() {{\n{body}}}\nfn short() {{}}\n");
    let found = check(&Source::new("x.rs", &text));
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(found[0].place, "x.rs:4");
    let shorter = text.replacen("    g(\"}\");\n", "", 1);
    assert!(check(&Source::new("x.rs", &shorter)).is_empty());
    assert_eq!(check(&Source::new("x.rs", &"\n".repeat(501))).len(), 1);
}
