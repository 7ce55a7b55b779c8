//! Text for terminals, pages and tables: lines fit, and what a file or a name holds commands none
//! of them.

use std::fmt::Write;
use std::path::Path;

use crate::invocation::quoted;
pub use kluft_io::printable::{cell, json, lines, one_line};

/// Columns of a line.
pub const WIDTH: usize = 80;

/// A name in at most `width` characters, an ellipsis in its middle if it is longer.
pub fn shortened(name: &str, width: usize) -> String {
    let name = one_line(name);
    let count = name.chars().count();
    if count <= width {
        return name.into_owned();
    }
    let tail = width.saturating_sub(1) / 2;
    let head: String = name.chars().take(width.saturating_sub(1) - tail).collect();
    let tail: String = name.chars().skip(count - tail).collect();
    format!("{head}…{tail}")
}

/// A line broken between words at [`WIDTH`] columns; what follows the first is indented. A word
/// that is longer stays whole.
pub fn wrapped(line: &str, indent: usize) -> String {
    let mut out = String::with_capacity(line.len() + 16);
    let mut column = 0;
    for word in line.split_inclusive(' ') {
        let length = word.trim_end_matches(' ').chars().count();
        if column + length > WIDTH && column > indent {
            out.truncate(out.trim_end_matches(' ').len());
            let _ = write!(out, "\n{:indent$}", "");
            column = indent;
        }
        out.push_str(word);
        column += word.chars().count();
    }
    out.truncate(out.trim_end_matches(' ').len());
    out
}

/// A path as a shell takes it for a file: in quotes where it needs them, and never as an option.
pub fn shell_path(path: &Path) -> String {
    let text = path.to_string_lossy();
    match text.starts_with('-') {
        true => quoted(&format!("./{text}")),
        false => quoted(&text),
    }
}

/// A number in at most nine characters.
pub fn in_nine(value: f64) -> String {
    match value.abs() {
        size if size == 0.0 || (1e-3..1e4).contains(&size) => format!("{value:.4}"),
        _ => format!("{value:.3e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_names_lose_their_middle() {
        assert_eq!(shortened("joint", 5), "joint");
        assert_eq!(shortened("FRACTURE_0123", 8), "FRAC…123");
    }

    #[test]
    fn a_path_is_one_word_of_a_shell() {
        for (path, word) in [
            ("a/b-1.5_c.toml", "a/b-1.5_c.toml"),
            ("my rock/a.toml", "'my rock/a.toml'"),
            ("rock's.msh", r"'rock'\''s.msh'"),
            ("$x;&*.msh", "'$x;&*.msh'"),
            ("-o.msh", "./-o.msh"),
        ] {
            assert_eq!(shell_path(Path::new(path)), word);
        }
    }

    #[test]
    fn lines_break_between_words() {
        let text = wrapped(&"word ".repeat(40), 4);
        assert!(text.lines().all(|line| line.chars().count() <= WIDTH));
        assert!(
            text.lines()
                .skip(1)
                .all(|line| line.starts_with("    word"))
        );
        assert_eq!(text.split_whitespace().count(), 40);
        let long = "x".repeat(200);
        assert_eq!(wrapped(&long, 4), long);
    }
}
