//! Lines of a scene in the making.

use std::fmt::Write;

use crate::printing::one_line;

/// Least number of columns before a comment.
const BEFORE_COMMENT: usize = 33;

/// Lines with comments.
#[derive(Default)]
pub struct Lines {
    /// All of them.
    pub text: String,
}

impl Lines {
    /// Adds a line with a comment, which may be empty.
    pub fn add(&mut self, line: &str, comment: &str) {
        // Writing to a string cannot fail.
        let _ = match comment {
            "" => writeln!(self.text, "{line}"),
            comment => {
                let comment = one_line(comment);
                writeln!(self.text, "{line:<BEFORE_COMMENT$} # {comment}")
            }
        };
    }

    /// Adds the head of a section behind an empty line.
    pub fn section(&mut self, head: &str, comment: &str) {
        self.text.push('\n');
        self.add(head, comment);
    }
}
