//! A section of a file, beside what the table of keys says of it.

use std::cell::{Cell, RefCell};
use std::collections::BTreeSet;
use std::ops::Range;
use std::path::PathBuf;

use kluft_keys::{Key, Need, nearest, section_head};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::Source;

/// A table of the file. Keys that nobody asked for are defects when it is dropped by
/// [`Section::finish`].
pub struct Section<'a, 'i> {
    pub(super) source: &'a Source<'i>,
    pub(super) table: &'a DeTable<'i>,
    /// Its keys.
    pub(super) keys: &'static kluft_keys::KeySection,
    /// How messages call it, e.g. `[rock.granite]`.
    pub title: String,
    /// Where it stands.
    pub at: Range<usize>,
    asked: RefCell<BTreeSet<&'static str>>,
    /// Whether anything in it was refused, so that not all of it may have been read.
    is_defective: Cell<bool>,
}

impl<'a, 'i> Section<'a, 'i> {
    /// The outermost table of a file.
    pub fn root(source: &'a Source<'i>, table: &'a DeTable<'i>) -> Self {
        let value = (table, 0..0);
        Self::new(source, source.document.root(), String::new(), value)
    }

    /// A table of a file, with its place; `title` is how messages call it.
    pub(super) fn new(
        source: &'a Source<'i>,
        keys: &'static kluft_keys::KeySection,
        title: String,
        (table, at): (&'a DeTable<'i>, Range<usize>),
    ) -> Self {
        Self {
            source,
            table,
            keys,
            title,
            at,
            asked: RefCell::default(),
            is_defective: Cell::default(),
        }
    }

    /// What the table of keys says of a key, which must be in it.
    pub(super) fn known(&self, name: &'static str) -> Option<&'static Key> {
        let found = self.keys.find(name);
        debug_assert!(found.is_some(), "{} {name}", self.keys.pattern);
        let (owner, key) = found?;
        self.asked.borrow_mut().insert(name);
        let mut asked = self.source.asked.borrow_mut();
        asked.insert((owner.pattern, name));
        Some(key)
    }

    pub(super) fn get(&self, key: &'static str) -> Option<&'a Spanned<DeValue<'i>>> {
        self.known(key);
        self.table.get(key)
    }

    pub(super) fn report(&self, at: &Range<usize>, problem: String, remedy: String) {
        self.is_defective.set(true);
        self.source.report(at, problem, remedy);
    }

    pub(super) fn wrong_type(&self, key: &str, value: &Spanned<DeValue<'i>>, wanted: &str) {
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

    /// The path of a file that stands beside this one; none where no files may be named.
    pub fn beside(&self, name: &str) -> Option<PathBuf> {
        let folder = self.source.folder.as_ref()?;
        Some(folder.join(name))
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

    /// Whether the key is there and holds this word.
    pub fn is_word(&self, key: &'static str, word: &str) -> bool {
        self.get(key)
            .is_some_and(|value| value.get_ref().as_str() == Some(word))
    }

    /// Whether the key is there and holds a list with a table in it.
    pub fn has_table_in(&self, key: &'static str) -> bool {
        let list = self.get(key).and_then(|value| value.get_ref().as_array());
        list.is_some_and(|list| list.iter().any(|entry| entry.get_ref().is_table()))
    }

    /// Reports `key`'s value with a remedy.
    pub fn refuse(&self, key: &'static str, problem: String, remedy: impl Into<String>) {
        let at = self.table.get(key).map_or(self.at.clone(), Spanned::span);
        self.report(&at, problem, remedy.into());
    }

    /// Reports `key`'s value, which varies along z, for meshes of the plane.
    pub fn refuse_in_plane(&self, key: &'static str, remedy: impl Into<String>) {
        let at = self.table.get(key).map_or(self.at.clone(), Spanned::span);
        let problem = format!(
            "{} varies along z, out of the plane of the mesh",
            self.title
        );
        self.source.report_in_plane(&at, problem, remedy.into());
    }

    /// Reports a key that must be there and is not.
    pub fn require(&self, key: &'static str) {
        if self.has(key) || self.misspelt(key).is_some() {
            return;
        }
        let Some(known) = self.known(key) else {
            return;
        };
        let name = self.name();
        let is_section = known.kind.heads_section(known.example);
        let (problem, remedy) = match is_section {
            true => (
                format!("there is no [{key}] in {name}"),
                format!("add a section {}", known.example),
            ),
            false => (
                format!("`{key}` is missing in {name}"),
                format!("add `{}`{}", known.shown(), self.instead(known)),
            ),
        };
        self.report(&self.at, problem, remedy);
    }

    /// The key that may stand in the place of another.
    fn instead(&self, key: &Key) -> String {
        let Need::Or(other) = key.need else {
            return String::new();
        };
        let other = self.keys.key(other);
        other.map_or(String::new(), |other| format!(" or `{}`", other.shown()))
    }

    /// How messages call it, the file itself included.
    pub(super) fn name(&self) -> &str {
        if self.title.is_empty() {
            self.source.document.title()
        } else {
            &self.title
        }
    }

    /// A key of the file that is probably meant to be `key`; reported as unknown anyway.
    fn misspelt(&self, key: &str) -> Option<&str> {
        let mut names = self.table.iter().map(|(name, _)| name.get_ref().as_ref());
        names.find(|name| {
            self.keys.find(name).is_none()
                && strsim::normalized_damerau_levenshtein(name, key) > 0.7
        })
    }

    /// The section below this one with a name.
    pub fn section(&self, key: &'static str) -> Option<Section<'a, 'i>> {
        let value = self.get(key)?;
        let Some(table) = value.get_ref().as_table() else {
            self.wrong_type(key, value, &format!("a section: [{key}]"));
            return None;
        };
        Some(self.child(key, self.child_title(key), (table, value.span())))
    }

    /// A table below this one, whose keys are those that the table of keys gives it.
    pub(super) fn child(
        &self,
        key: &'static str,
        title: String,
        value: (&'a DeTable<'i>, Range<usize>),
    ) -> Section<'a, 'i> {
        let keys = self.known(key).and_then(|key| key.kind.section());
        debug_assert!(keys.is_some(), "{key} is no section");
        Section::new(self.source, keys.unwrap_or(self.keys), title, value)
    }

    fn child_title(&self, key: &str) -> String {
        match (self.title.as_str(), self.title.strip_suffix(']')) {
            ("", _) => format!("[{key}]"),
            (_, Some(head)) => format!("{head}.{key}]"),
            (listed, None) => format!("{listed}, {key}"),
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
                    let title = section_head(key, name.get_ref());
                    let child = self.child(key, title, (table, name.span()));
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
                    sections.push(self.child(key, title, (table, entry.span())));
                }
                None => self.wrong_type(key, entry, &format!("{head} in double brackets")),
            }
        }
        sections
    }

    /// Reports the keys that nobody asked for: unknown ones with the nearest known one, and known
    /// ones that other keys leave without effect.
    pub fn finish(self) {
        let is_sound = !self.is_defective.get();
        let asked = self.asked.borrow().clone();
        for (name, _) in self.table.iter() {
            let key = name.get_ref().as_ref();
            if self.keys.find(key).is_none() {
                let problem = format!("unknown key `{key}` in {}", self.name());
                self.report(&name.span(), problem, self.suggestion(key));
            } else if is_sound && !asked.contains(key) {
                let problem = format!("`{key}` has no effect in {} as it stands", self.name());
                let remedy = format!("remove it; these have: {}", list(asked.iter().copied()));
                self.report(&name.span(), problem, remedy);
            }
        }
    }

    /// The key of the table that is nearest to an unknown one, or all of them.
    fn suggestion(&self, key: &str) -> String {
        let known = || self.keys.all_keys().map(|key| key.name);
        match nearest(key, known()) {
            Some(near) => format!("did you mean `{near}`?"),
            None => format!("known keys: {}", list(known())),
        }
    }
}

/// Names in alphabetical order.
fn list(names: impl Iterator<Item = &'static str>) -> String {
    let names: BTreeSet<&str> = names.collect();
    names.into_iter().collect::<Vec<_>>().join(", ")
}
