//! Text from files and names, such that it commands no terminal, page or spreadsheet.

use std::borrow::Cow;
use std::fmt::Write;

/// A text on one line: what commands a terminal or turns the direction of text is shown as an
/// escape, `\u{1b}`, a line end as `\n`.
pub fn one_line(text: &str) -> Cow<'_, str> {
    escaped(text, &[])
}

/// The same for a text of several lines, which keep their ends and tabs.
pub fn lines(text: &str) -> Cow<'_, str> {
    escaped(text, &['\n', '\t'])
}

fn escaped<'a>(text: &'a str, kept: &[char]) -> Cow<'a, str> {
    let shown = |c: char| kept.contains(&c) || !is_command(c);
    if text.chars().all(shown) {
        return text.into();
    }
    let mut out = String::with_capacity(text.len() + 8);
    for c in text.chars() {
        match shown(c) {
            true => out.push(c),
            false => out.extend(c.escape_default()),
        }
    }
    out.into()
}

/// Controls of terminals, and the marks that turn the direction of text or end lines unseen.
fn is_command(c: char) -> bool {
    let directs = matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    c.is_control() || directs || matches!(c, '\u{2028}' | '\u{2029}' | '\u{feff}')
}

/// A JSON text whose strings hold no commands raw: the same value to every reader.
pub fn json(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match is_command(c) && c != '\n' {
            // All of them have four hexadecimal digits.
            true => write!(out, "\\u{:04x}", u32::from(c)).unwrap_or_default(),
            false => out.push(c),
        }
    }
    out
}

/// A cell of a table for other programs: text that a spreadsheet would take for a formula follows
/// an apostrophe (OWASP, CSV injection); numbers stay.
pub fn cell(text: &str) -> String {
    let text = lines(text);
    let is_formula = text.starts_with(['=', '+', '-', '@', '\t', '\r', '\n']);
    match is_formula && text.parse::<f64>().is_err() {
        true => format!("'{text}"),
        false => text.into_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_commands_a_terminal_is_shown() {
        assert_eq!(one_line("\u{1b}]0;x\u{7}"), "\\u{1b}]0;x\\u{7}");
        assert_eq!(one_line("a\nb\u{9b}2J\r"), "a\\nb\\u{9b}2J\\r");
        assert_eq!(one_line("\u{202e}gpj"), "\\u{202e}gpj");
        assert_eq!(one_line("Störung Süd–Ost 断層"), "Störung Süd–Ost 断層");
        assert_eq!(lines("a\n\tb\u{8}"), "a\n\tb\\u{8}");
    }

    #[test]
    fn json_stays_the_same_value() {
        let value = serde_json::json!({ "name": "a\u{9b}2J\u{7f}\n\u{1b}" });
        let text = json(&serde_json::to_string_pretty(&value).expect("JSON"));
        assert!(text.chars().all(|c| c == '\n' || !c.is_control()));
        let back: serde_json::Value = serde_json::from_str(&text).expect("JSON");
        assert_eq!(back, value);
    }

    #[test]
    fn formulas_are_no_cells_but_numbers_are() {
        for text in ["=1+1", "+cmd|' /C calc'!A0", "-2+3", "@SUM(A1)", "\tx"] {
            assert_eq!(cell(text), format!("'{text}"));
        }
        for text in ["-1.5e-3", "+4", "", "logarithmic", "1e9"] {
            assert_eq!(cell(text), text);
        }
    }
}
