//! Keys and sections that stand twice in a file.

use std::ops::Range;

use toml::de::{DeTable, Error};

/// How many lines are tried as the place of the first one.
const TRIED: usize = 64;

/// A key or a section that stands twice.
pub(super) struct Repeated<'a> {
    /// It as the file has it, with its brackets if it is a section.
    pub(super) what: &'a str,
    /// Where its first one begins, if that was found.
    pub(super) first: Option<usize>,
}

/// What an error of the parser is about, if something stands twice.
pub(super) fn repeated<'a>(text: &'a str, error: &Error) -> Option<Repeated<'a>> {
    if error.message() != DUPLICATE {
        return None;
    }
    let at = error.span()?;
    let line = line_around(text, at.start);
    let key = text.get(at.clone())?;
    let head = text[line.clone()].trim_start();
    let what = match head.strip_prefix('[') {
        Some(_) => head.split_inclusive(']').next().unwrap_or(head),
        None => key,
    };
    Some(Repeated {
        what,
        first: first(text, key, &at, line.start),
    })
}

/// Whether an error only follows from a section that stands twice: the parser puts both into one.
pub(super) fn follows(text: &str, error: &Error, section: usize) -> bool {
    let behind = error.span().map(|at| at.start).filter(|at| *at > section);
    let between = behind.and_then(|at| text.get(section..at));
    error.message() == DUPLICATE
        && between.is_some_and(|between| {
            let mut lines = between.lines().skip(1);
            !lines.any(|line| line.trim_start().starts_with('['))
        })
}

/// The parser's words.
const DUPLICATE: &str = "duplicate key";

/// The nearest line above without which the error is gone.
fn first(text: &str, key: &str, at: &Range<usize>, line: usize) -> Option<usize> {
    let name = key.trim_matches(['"', '\'']);
    let above = text.get(..line)?.rmatch_indices(name);
    let mut tried = above.map(|(position, _)| line_around(text, position));
    let mut last = None;
    let lines = std::iter::from_fn(|| {
        let next = tried.find(|line| last != Some(line.start))?;
        last = Some(next.start);
        Some(next)
    });
    lines
        .take(TRIED)
        .find(|line| !is_repeated_without(text, line, at))
        .map(|line| line.start)
}

fn is_repeated_without(text: &str, line: &Range<usize>, at: &Range<usize>) -> bool {
    let blank = " ".repeat(line.len());
    let text = [&text[..line.start], &blank, &text[line.end..]].concat();
    let (_, errors) = DeTable::parse_recoverable(&text);
    errors
        .iter()
        .any(|error| error.message() == DUPLICATE && error.span().as_ref() == Some(at))
}

/// The line of a position, without its end.
fn line_around(text: &str, position: usize) -> Range<usize> {
    let start = text[..position].rfind('\n').map_or(0, |end| end + 1);
    let end = text[position..]
        .find('\n')
        .map_or(text.len(), |end| position + end);
    start..end
}
