//! How names and texts are written in TOML.

use std::fmt::Write;

/// The head of the section of a name: `[boundary.top]`, `[boundary.".side x0"]`.
pub fn section_head(section: &str, name: &str) -> String {
    format!("[{section}.{}]", key_text(name))
}

/// A key as TOML demands it: in quotes unless it is bare.
pub fn key_text(key: &str) -> String {
    let is_bare = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    if !key.is_empty() && key.chars().all(is_bare) {
        key.to_owned()
    } else {
        quoted(key)
    }
}

/// A text in quotes.
pub fn quoted(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            c if c.is_control() => {
                // Writing to a string cannot fail.
                let _ = write!(out, "\\u{:04X}", c as u32);
            }
            c => out.push(c),
        }
    }
    out + "\""
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_are_not_bare_stand_in_quotes() {
        for (name, head) in [
            ("top", "[boundary.top]"),
            ("a-1_b", "[boundary.a-1_b]"),
            (".side_x0", "[boundary.\".side_x0\"]"),
            ("soft layer", "[boundary.\"soft layer\"]"),
            ("Störung", "[boundary.\"Störung\"]"),
            ("say \"hi\" \\", "[boundary.\"say \\\"hi\\\" \\\\\"]"),
            ("", "[boundary.\"\"]"),
        ] {
            assert_eq!(section_head("boundary", name), head);
        }
    }
}
