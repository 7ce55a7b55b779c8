//! Walks a TOML file and collects every defect with its line.

mod lists;

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::ops::Range;

use kluft_mesh::{Defect, nearest};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

pub use lists::Entry;

/// Which numbers a key accepts.
#[derive(Clone, Copy)]
pub enum Accept {
    /// Any finite number.
    Finite,
    /// Finite and greater than zero.
    Positive,
    /// Finite and zero or greater.
    NotNegative,
    /// Above the first bound and below the second.
    Between(f64, f64),
    /// From the first bound to the second.
    Within(f64, f64),
}

impl Accept {
    fn refusal(self, value: f64) -> Option<String> {
        let fits = match self {
            Accept::Finite => true,
            Accept::Positive => value > 0.0,
            Accept::NotNegative => value >= 0.0,
            Accept::Between(low, high) => low < value && value < high,
            Accept::Within(low, high) => low <= value && value <= high,
        };
        if value.is_finite() && fits {
            return None;
        }
        Some(match self {
            Accept::Finite => "must be a finite number".into(),
            Accept::Positive => "must be a finite number greater than 0".into(),
            Accept::NotNegative => "must be a finite number, 0 or greater".into(),
            Accept::Between(low, high) | Accept::Within(low, high) => {
                format!("must lie between {low} and {high}")
            }
        })
    }
}

/// The file being read and the defects found so far.
pub struct Source<'a> {
    name: &'a str,
    text: &'a str,
    /// How messages call the whole file.
    what: &'static str,
    /// Position of each line break.
    breaks: Vec<usize>,
    /// Defects with their position in the text.
    defects: RefCell<Vec<(usize, Defect)>>,
}

impl<'a> Source<'a> {
    /// A text to read; `name` is the file for messages, `what` how they call the whole.
    pub fn new(name: &'a str, text: &'a str, what: &'static str) -> Self {
        let bytes = text.bytes().enumerate();
        let breaks = bytes.filter(|(_, byte)| *byte == b'\n');
        Self {
            name,
            text,
            what,
            breaks: breaks.map(|(position, _)| position).collect(),
            defects: RefCell::default(),
        }
    }

    /// Keeps a defect of a part of the text.
    pub fn report(&self, at: &Range<usize>, problem: String, remedy: String) {
        self.defects
            .borrow_mut()
            .push((at.start, Defect::new(self.place(at), problem, remedy)));
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
        let mut defects = self.defects.into_inner();
        defects.sort_by_key(|(position, _)| *position);
        defects.into_iter().map(|(_, defect)| defect).collect()
    }

    /// The whole file as a table. With a syntax error there is none: whatever stands behind the
    /// error may have got lost or into another section, and would be reported for nothing.
    pub fn parse(&self) -> Option<Spanned<DeTable<'a>>> {
        let (table, errors) = DeTable::parse_recoverable(self.text);
        let is_sound = errors.is_empty();
        let mut lines = BTreeSet::new();
        for error in errors {
            let at = error.span().unwrap_or(0..0);
            // What follows the first error of a line is mostly its consequence.
            if lines.insert(self.line(at.start)) {
                let remedy = "correct the TOML syntax of this line (key = value, [section], \"text\"), or close the bracket that is open above it";
                self.report(&at, error.message().to_owned(), remedy.into());
            }
        }
        is_sound.then_some(table)
    }
}

/// A table of the file. Keys that nobody asked for are defects when it is dropped by
/// [`Section::finish`].
pub struct Section<'a, 'i> {
    source: &'a Source<'i>,
    table: &'a DeTable<'i>,
    /// How messages call it, e.g. `[rock.granite]`.
    pub title: String,
    /// Where it stands.
    pub at: Range<usize>,
    asked: RefCell<BTreeSet<&'static str>>,
}

impl<'a, 'i> Section<'a, 'i> {
    /// A table of a file; `title` is how messages call it.
    pub fn new(
        source: &'a Source<'i>,
        table: &'a DeTable<'i>,
        title: String,
        at: Range<usize>,
    ) -> Self {
        Self {
            source,
            table,
            title,
            at,
            asked: RefCell::default(),
        }
    }

    fn get(&self, key: &'static str) -> Option<&'a Spanned<DeValue<'i>>> {
        self.asked.borrow_mut().insert(key);
        self.table.get(key)
    }

    fn report(&self, at: &Range<usize>, problem: String, remedy: String) {
        self.source.report(at, problem, remedy);
    }

    fn wrong_type(&self, key: &str, value: &Spanned<DeValue<'i>>, wanted: &str) {
        let found = value.get_ref().type_str();
        self.report(
            &value.span(),
            format!("`{key}` in {} is of type {found}", self.name()),
            format!("write {wanted}"),
        );
    }

    /// Everything in it, unread.
    pub fn table(&self) -> &'a DeTable<'i> {
        self.table
    }

    /// File and line.
    pub fn place(&self) -> String {
        self.source.place(&self.at)
    }

    /// Whether the key is there.
    pub fn has(&self, key: &'static str) -> bool {
        self.get(key).is_some()
    }

    /// Whether the key is there and holds a table.
    pub fn is_table(&self, key: &'static str) -> bool {
        self.get(key)
            .is_some_and(|value| value.get_ref().is_table())
    }

    /// Reports a key that must be there and is not.
    pub fn require(&self, key: &'static str, example: &str) {
        if !self.has(key) && self.misspelt(key).is_none() {
            self.report(
                &self.at,
                format!("`{key}` is missing in {}", self.name()),
                format!("add `{key} = {example}`"),
            );
        }
    }

    /// Reports a section that must be there and is not.
    pub fn require_section(&self, key: &'static str, example: &str) {
        if !self.has(key) && self.misspelt(key).is_none() {
            self.report(
                &self.at,
                format!("there is no [{key}] in {}", self.name()),
                format!("add a section {example}"),
            );
        }
    }

    /// How messages call it, the file itself included.
    fn name(&self) -> &str {
        if self.title.is_empty() {
            self.source.what
        } else {
            &self.title
        }
    }

    /// A key of the file that is probably meant to be `key`; reported as unknown anyway.
    fn misspelt(&self, key: &str) -> Option<&str> {
        let keys = self.table.iter().map(|(name, _)| name.get_ref().as_ref());
        let others = keys.filter(|name| !self.asked.borrow().contains(name));
        others
            .into_iter()
            .find(|name| strsim::normalized_damerau_levenshtein(name, key) > 0.7)
    }

    /// A number.
    pub fn number(&self, key: &'static str, accept: Accept) -> Option<f64> {
        let value = self.get(key)?;
        self.as_number(key, value, accept)
    }

    fn as_number(&self, key: &str, value: &Spanned<DeValue<'i>>, accept: Accept) -> Option<f64> {
        let Some(number) = plain_number(value.get_ref()) else {
            self.wrong_type(key, value, "a number");
            return None;
        };
        if let Some(refusal) = accept.refusal(number) {
            self.report(
                &value.span(),
                format!("`{key}` = {number} in {}", self.name()),
                format!("{key} {refusal}"),
            );
            return None;
        }
        Some(number)
    }

    /// A truth value.
    pub fn flag(&self, key: &'static str) -> Option<bool> {
        let value = self.get(key)?;
        let flag = value.get_ref().as_bool();
        if flag.is_none() {
            self.wrong_type(key, value, "true or false");
        }
        flag
    }

    /// A text in quotes.
    pub fn text(&self, key: &'static str) -> Option<&'a str> {
        let value = self.get(key)?;
        let text = value.get_ref().as_str();
        if text.is_none() {
            self.wrong_type(key, value, "text in quotes");
        }
        text
    }

    /// Reports `key`'s value with a remedy.
    pub fn refuse(&self, key: &'static str, problem: String, remedy: impl Into<String>) {
        let at = self.table.get(key).map_or(self.at.clone(), Spanned::span);
        self.report(&at, problem, remedy.into());
    }

    /// Numbers in brackets.
    pub fn numbers(&self, key: &'static str, accept: Accept) -> Option<Vec<f64>> {
        let value = self.get(key)?;
        let Some(array) = value.get_ref().as_array() else {
            self.wrong_type(key, value, "numbers in brackets, e.g. [0.5, 1.0]");
            return None;
        };
        array
            .iter()
            .map(|entry| self.as_number(key, entry, accept))
            .collect()
    }

    /// Three numbers in brackets.
    pub fn vector(&self, key: &'static str) -> Option<[f64; 3]> {
        let numbers = self.numbers(key, Accept::Finite)?;
        let vector = <[f64; 3]>::try_from(numbers).ok();
        if vector.is_none() {
            self.refuse(
                key,
                format!("`{key}` in {} has not three components", self.name()),
                "write [x, y, z]",
            );
        }
        vector
    }

    /// Points in brackets.
    pub fn vectors(&self, key: &'static str) -> Option<Vec<[f64; 3]>> {
        let example = "points in brackets, e.g. [[0, 0, 0], [1, 0, 0], [0, 1, 0]]";
        self.tuples(key, ("points", example))
    }

    /// Pairs of a time and a factor in brackets.
    pub fn time_factors(&self, key: &'static str) -> Option<Vec<[f64; 2]>> {
        let example = "[time, factor] in brackets, e.g. [[0, 0], [1, 1]]";
        self.tuples(key, ("times with factors", example))
    }

    /// Lists of as many numbers, in brackets; what they are called, and an example.
    fn tuples<const N: usize>(
        &self,
        key: &'static str,
        (what, wanted): (&str, &str),
    ) -> Option<Vec<[f64; N]>> {
        let value = self.get(key)?;
        let point = |entry: &Spanned<DeValue<'i>>| -> Option<[f64; N]> {
            let numbers = entry.get_ref().as_array()?.iter();
            let numbers = numbers.map(|number| self.as_number(key, number, Accept::Finite));
            numbers.collect::<Option<Vec<f64>>>()?.try_into().ok()
        };
        let points = value
            .get_ref()
            .as_array()
            .map(|array| array.iter().map(point).collect());
        if !matches!(points, Some(Some(_))) {
            self.refuse(
                key,
                format!("`{key}` in {} is no list of {what}", self.title),
                format!("write {wanted}"),
            );
        }
        points.flatten()
    }

    /// The section below this one with a name.
    pub fn section(&self, key: &'static str) -> Option<Section<'a, 'i>> {
        let value = self.get(key)?;
        let Some(table) = value.get_ref().as_table() else {
            self.wrong_type(key, value, &format!("a section: [{key}]"));
            return None;
        };
        let title = self.child_title(key);
        Some(Section::new(self.source, table, title, value.span()))
    }

    fn child_title(&self, key: &str) -> String {
        if self.title.is_empty() {
            format!("[{key}]")
        } else {
            format!("{}.{key}]", self.title.trim_end_matches(']'))
        }
    }

    /// All sections `[key.NAME]`.
    pub fn named_sections(&self, key: &'static str) -> Vec<(String, Section<'a, 'i>)> {
        let Some(parent) = self.section(key) else {
            return Vec::new();
        };
        let mut children = Vec::new();
        for (name, value) in parent.table.iter() {
            match value.get_ref().as_table() {
                Some(table) => {
                    let title = format!("[{key}.{}]", name.get_ref());
                    let child = Section::new(self.source, table, title, name.span());
                    children.push((name.get_ref().to_string(), child));
                }
                None => self.report(
                    &name.span(),
                    format!("`{}` stands directly in [{key}]", name.get_ref()),
                    format!("put it in a section with a name: [{key}.NAME] or [{key}.default]"),
                ),
            }
        }
        children
    }

    /// Head of a section `[[key]]`.
    fn listed_title(&self, key: &str) -> String {
        let within = self.title.trim_start_matches('[').trim_end_matches(']');
        match within {
            "" => format!("[[{key}]]"),
            within => format!("[[{within}.{key}]]"),
        }
    }

    /// All sections `[[key]]`.
    pub fn listed_sections(&self, key: &'static str) -> Vec<Section<'a, 'i>> {
        let Some(value) = self.get(key) else {
            return Vec::new();
        };
        let head = self.listed_title(key);
        let Some(array) = value.get_ref().as_array() else {
            self.wrong_type(key, value, &format!("{head} in double brackets"));
            return Vec::new();
        };
        let mut sections = Vec::new();
        for (number, entry) in array.iter().enumerate() {
            match entry.get_ref().as_table() {
                Some(table) => {
                    let title = format!("{head} number {}", number + 1);
                    sections.push(Section::new(self.source, table, title, entry.span()));
                }
                None => self.wrong_type(key, entry, &format!("{head} in double brackets")),
            }
        }
        sections
    }

    /// All keys of a table of numbers whose names are free.
    pub fn free_numbers(&self, key: &'static str) -> Vec<(String, f64)> {
        let section = self.section(key);
        section.map_or_else(Vec::new, |section| section.all_numbers())
    }

    /// All keys of this section, which must be numbers.
    pub fn all_numbers(&self) -> Vec<(String, f64)> {
        let entries = self.table.iter();
        entries
            .filter_map(|(name, value)| {
                let number = self.as_number(name.get_ref(), value, Accept::Finite)?;
                Some((name.get_ref().to_string(), number))
            })
            .collect()
    }

    /// Reports the keys that nobody asked for, each with the nearest known one.
    pub fn finish(self) {
        let known = self.asked.borrow();
        for (name, _) in self.table.iter() {
            let key = name.get_ref().as_ref();
            if known.contains(key) {
                continue;
            }
            let remedy = nearest(key, known.iter().copied()).map_or_else(
                || {
                    format!(
                        "known keys: {}",
                        known.iter().copied().collect::<Vec<_>>().join(", ")
                    )
                },
                |near| format!("did you mean `{near}`?"),
            );
            self.report(
                &name.span(),
                format!("unknown key `{key}` in {}", self.name()),
                remedy,
            );
        }
    }
}

fn plain_number(value: &DeValue<'_>) -> Option<f64> {
    if let Some(float) = value.as_float() {
        return float.as_str().parse().ok();
    }
    let integer = value.as_integer()?;
    i64::from_str_radix(integer.as_str(), integer.radix())
        .ok()
        .map(|number| number as f64)
}
