//! What is wrong with an input, where, and how to mend it.

mod ordinary;

use std::fmt;
use std::ops::Range;

pub use ordinary::{open_ordinary, ordinary_bytes, ordinary_text};

/// One defect of an input: every reader and check in the workspace reports through this type.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Defect {
    /// Where it is: a file and line, a group, an element or a node by the tag it has in the file.
    pub place: String,
    /// What is wrong there.
    pub problem: String,
    /// What the user can do about it.
    pub remedy: String,
    /// Names the kind of defect, where a front end can say the remedy better in its own language
    /// than a library can.
    pub code: Option<&'static str>,
    /// The line of the file that it is in, if that helps.
    pub excerpt: Option<Box<Excerpt>>,
}

/// A line of a text with a part of it that is meant.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Excerpt {
    /// Its number, from 1.
    pub number: usize,
    /// What stands before the part.
    pub before: String,
    /// The part, as far as it is on the line.
    pub marked: String,
    /// What stands behind it.
    pub after: String,
}

impl Excerpt {
    /// The first line of a range of bytes of a text; none if the range does not lie in it.
    pub fn of(text: &str, at: &Range<usize>) -> Option<Self> {
        let (head, rest) = (text.get(..at.start)?, text.get(at.start..)?);
        let begin = head.rfind('\n').map_or(0, |end| end + 1);
        let rest = rest.lines().next().unwrap_or_default();
        let length = at.len().min(rest.len());
        Some(Self {
            number: head.matches('\n').count() + 1,
            before: head[begin..].to_owned(),
            marked: rest.get(..length)?.to_owned(),
            after: rest[length..].to_owned(),
        })
    }
}

impl Defect {
    /// Puts the three parts together.
    pub fn new(
        place: impl Into<String>,
        problem: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Self {
        Self {
            place: place.into(),
            problem: problem.into(),
            remedy: remedy.into(),
            code: None,
            excerpt: None,
        }
    }

    /// The same defect with a line of its file.
    #[must_use]
    pub fn with_excerpt(self, excerpt: Option<Excerpt>) -> Self {
        Self {
            excerpt: excerpt.map(Box::new),
            ..self
        }
    }

    /// The same defect with a code.
    #[must_use]
    pub fn with_code(self, code: &'static str) -> Self {
        Self {
            code: Some(code),
            ..self
        }
    }
}

impl fmt::Display for Defect {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            out,
            "{}: {}\n    remedy: {}",
            self.place, self.problem, self.remedy
        )
    }
}

/// Names the first few of `tags` and counts the rest: `12, 13, 14 and 40 more`.
pub fn sample(tags: &[u64]) -> String {
    const SHOWN: usize = 5;
    let first: Vec<String> = tags.iter().take(SHOWN).map(u64::to_string).collect();
    match tags.len().saturating_sub(SHOWN) {
        0 => first.join(", "),
        more => format!("{} and {more} more", first.join(", ")),
    }
}

/// Names further from every known one than this (normalised similarity) get no suggestion.
const ALIKE: f64 = 0.5;

/// The known name most like `name`, if any is like it at all.
pub fn nearest<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    known
        .map(|known| (strsim::normalized_damerau_levenshtein(name, known), known))
        .filter(|(alike, _)| *alike >= ALIKE)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, known)| known)
}
