//! Lists of texts and tables.

use toml::Spanned;
use toml::de::DeValue;

use super::{Accept, Section};

/// An entry of a list.
pub enum Entry<'a, 'i> {
    /// Text in quotes.
    Text(&'a str),
    /// Keys in braces.
    Section(Section<'a, 'i>),
}

impl<'a, 'i> Section<'a, 'i> {
    /// The entries of a list, each with its number: texts and tables.
    pub fn entries(&self, key: &'static str, wanted: &str) -> Vec<Entry<'a, 'i>> {
        let Some(value) = self.get(key) else {
            return Vec::new();
        };
        let Some(array) = value.get_ref().as_array() else {
            self.wrong_type(key, value, wanted);
            return Vec::new();
        };
        let read = |(number, entry): (usize, &'a Spanned<DeValue<'i>>)| {
            let title = format!("`{key}` number {} of {}", number + 1, self.name());
            match entry.get_ref() {
                DeValue::String(text) => Some(Entry::Text(text)),
                DeValue::Table(table) => {
                    let section = Section::new(self.source, table, title, entry.span());
                    Some(Entry::Section(section))
                }
                _ => {
                    self.wrong_type(key, entry, wanted);
                    None
                }
            }
        };
        array.iter().enumerate().filter_map(read).collect()
    }

    /// Texts in brackets, each one of those known; what they are called.
    pub fn choices(&self, key: &'static str, known: &[&'static str]) -> Option<Vec<&'static str>> {
        let value = self.get(key)?;
        let wanted = format!("some of \"{}\" in brackets", known.join("\", \""));
        let find = |entry: &Spanned<DeValue<'i>>| {
            let name = entry.get_ref().as_str();
            let found = known.iter().find(|known| Some(**known) == name).copied();
            if found.is_none() {
                let problem = format!("unknown entry of `{key}` in {}", self.name());
                self.report(&entry.span(), problem, format!("write {wanted}"));
            }
            found
        };
        match value.get_ref().as_array() {
            Some(array) => array.iter().map(find).collect(),
            None => {
                self.wrong_type(key, value, &wanted);
                None
            }
        }
    }

    /// All keys of this section, which must be lists of numbers, or `{ from, to, count }` for numbers
    /// whose logarithms lie evenly.
    pub fn number_lists(&self) -> Vec<(String, Vec<f64>)> {
        let mut lists = Vec::new();
        for (name, value) in self.table.iter() {
            let key = name.get_ref().as_ref();
            let numbers = match value.get_ref() {
                DeValue::Array(array) => {
                    let numbers = array.iter();
                    let numbers = numbers.map(|n| self.as_number(key, n, Accept::Finite));
                    numbers.collect::<Option<Vec<f64>>>().unwrap_or_default()
                }
                DeValue::Table(table) => {
                    let title = format!("`{key}` in {}", self.name());
                    Section::new(self.source, table, title, value.span()).evenly()
                }
                _ => {
                    let wanted = "numbers in brackets, or { from = 1e8, to = 1e12, count = 9 }";
                    self.wrong_type(key, value, wanted);
                    Vec::new()
                }
            };
            lists.push((key.to_owned(), numbers));
        }
        lists
    }

    fn evenly(self) -> Vec<f64> {
        for (key, example) in [("from", "1e8"), ("to", "1e12"), ("count", "9")] {
            self.require(key, example);
        }
        let from = self.number("from", Accept::Positive);
        let to = self.number("to", Accept::Positive);
        let count = self.number("count", Accept::Within(2.0, 1000.0));
        self.finish();
        let (Some(from), Some(to), Some(count)) = (from, to, count) else {
            return Vec::new();
        };
        let share = |i: usize| i as f64 / (count.floor() - 1.0);
        let numbers = (0..count as usize).map(|i| from * (to / from).powf(share(i)));
        numbers.collect()
    }
}
