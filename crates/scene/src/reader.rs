//! Walks a TOML file by the table of keys, and collects every defect with its line.

mod lists;
mod repeated;
mod section;
mod values;

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::ops::Range;
use std::path::{Path, PathBuf};

use kluft_keys::Document;
use kluft_mesh::{Defect, Excerpt};
use toml::Spanned;
use toml::de::DeTable;

use repeated::{Repeated, follows, repeated};

pub use lists::Entry;
pub use section::Section;

/// The file being read, and what was found so far.
pub struct Source<'a> {
    name: &'a str,
    text: &'a str,
    /// What the file is.
    document: Document,
    /// Where the paths of files begin that are read with it, if any may be named.
    folder: Option<PathBuf>,
    /// Position of each line break.
    breaks: Vec<usize>,
    /// Defects with their position in the text.
    defects: RefCell<Vec<(usize, Defect)>>,
    /// What is a defect if the mesh is one of the plane, with its position in the text.
    in_plane: RefCell<Vec<(usize, Defect)>>,
    /// Doubts about values, with their position in the text.
    warnings: RefCell<Vec<(usize, String)>>,
    /// Patterns of sections with the keys of them that were asked for.
    asked: RefCell<BTreeSet<(&'static str, &'static str)>>,
}

impl<'a> Source<'a> {
    /// A text to read; `name` is the file for messages.
    pub fn new(name: &'a str, text: &'a str, document: Document) -> Self {
        let bytes = text.bytes().enumerate();
        let breaks = bytes.filter(|(_, byte)| *byte == b'\n');
        Self {
            name,
            text,
            document,
            folder: None,
            breaks: breaks.map(|(position, _)| position).collect(),
            defects: RefCell::default(),
            in_plane: RefCell::default(),
            warnings: RefCell::default(),
            asked: RefCell::default(),
        }
    }

    /// The same text in a folder, beside whose files it stands.
    #[must_use]
    pub fn in_folder(self, folder: &Path) -> Self {
        Self {
            folder: Some(folder.to_owned()),
            ..self
        }
    }

    /// Keeps a defect of a part of the text.
    pub fn report(&self, at: &Range<usize>, problem: String, remedy: String) {
        let defect = self.defect(at, problem, remedy);
        self.defects.borrow_mut().push((at.start, defect));
    }

    /// Keeps what a part of the text is wrong about if the mesh is one of the plane.
    fn report_in_plane(&self, at: &Range<usize>, problem: String, remedy: String) {
        let defect = self.defect(at, problem, remedy);
        self.in_plane.borrow_mut().push((at.start, defect));
    }

    fn defect(&self, at: &Range<usize>, problem: String, remedy: String) -> Defect {
        let excerpt = Excerpt::of(self.text, at);
        Defect::new(self.place(at), problem, remedy).with_excerpt(excerpt)
    }

    /// Keeps a doubt about a part of the text.
    fn warn(&self, at: &Range<usize>, doubt: &str) {
        let warning = format!("{}: {doubt}", self.place(at));
        self.warnings.borrow_mut().push((at.start, warning));
    }

    /// File and line of a part of the text.
    pub fn place(&self, at: &Range<usize>) -> String {
        format!("{}:{}", self.name, self.line(at.start))
    }

    fn line(&self, position: usize) -> usize {
        self.breaks.partition_point(|&end| end < position) + 1
    }

    /// The defects in the order of the text.
    pub fn into_defects(self) -> Vec<Defect> {
        in_order(self.defects)
    }

    /// What is a defect if the mesh is one of the plane, in the order of the text.
    pub fn take_defects_in_plane(&self) -> Vec<Defect> {
        in_order(RefCell::new(self.in_plane.take()))
    }

    /// Values that are possible but hardly meant, in the order of the text.
    pub fn take_warnings(&self) -> Vec<String> {
        in_order(RefCell::new(self.warnings.take()))
    }

    /// Keys of the table that nobody has asked for, `section key`: none, after a text with every
    /// section.
    pub fn unasked(&self) -> Vec<String> {
        let asked = self.asked.borrow();
        let sections = self.document.sections().into_iter();
        let keys = sections.flat_map(|section| {
            let keys = section.keys.iter();
            keys.map(|key| (section.pattern, key.name))
        });
        let unasked = keys.filter(|key| !asked.contains(key));
        unasked
            .map(|(section, key)| format!("{section} {key}"))
            .collect()
    }

    /// The whole file as a table. With a syntax error there is none: whatever stands behind the
    /// error may have got lost or into another section, and would be reported for nothing.
    pub fn parse(&self) -> Option<Spanned<DeTable<'a>>> {
        let (table, errors) = DeTable::parse_recoverable(self.text);
        let is_sound = errors.is_empty();
        let mut lines = BTreeSet::new();
        let mut section = None;
        for error in errors {
            let at = error.span().unwrap_or(0..0);
            if section.is_some_and(|section| follows(self.text, &error, section)) {
                continue;
            }
            // What follows the first error of a line is mostly its consequence.
            if !lines.insert(self.line(at.start)) {
                continue;
            }
            let Some(found) = repeated(self.text, &error) else {
                let remedy = "correct the TOML syntax of this line (key = value, [section], \"text\"), or close the bracket that is open above it";
                self.report(&at, error.message().to_owned(), remedy.into());
                continue;
            };
            if found.what.starts_with('[') {
                section = Some(at.start);
            }
            self.report_repeated(&at, &found);
        }
        is_sound.then_some(table)
    }

    /// Keeps a key or a section that stands twice.
    fn report_repeated(&self, at: &Range<usize>, found: &Repeated<'_>) {
        let first = found.first.map_or_else(
            || "above".to_owned(),
            |first| format!("in line {}", self.line(first)),
        );
        let (problem, remedy) = match found.what.starts_with('[') {
            true => (
                format!(
                    "the section {} stands twice: it is {first} already",
                    found.what
                ),
                "put the keys of both under one head, or give one another name",
            ),
            false => (
                format!(
                    "the key `{}` stands twice: it is {first} already",
                    found.what
                ),
                "keep one of them",
            ),
        };
        self.report(at, problem, remedy.into());
    }
}

fn in_order<T>(found: RefCell<Vec<(usize, T)>>) -> Vec<T> {
    let mut found = found.into_inner();
    found.sort_by_key(|(position, _)| *position);
    found.into_iter().map(|(_, one)| one).collect()
}
