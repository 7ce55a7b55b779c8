//! Lists: of numbers, of vectors, of texts and tables.

use kluft_keys::{Dimension, Kind, Quantity, Range};
use toml::Spanned;
use toml::de::DeValue;

use super::Section;

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
                    let section = self.child(key, title, (table, entry.span()));
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

    /// The entries of a list: numbers, or keys in braces.
    pub(crate) fn numbers_or_sections(
        &self,
        key: &'static str,
        quantity: Quantity,
    ) -> Option<Vec<Result<f64, Section<'a, 'i>>>> {
        let array = self.get(key)?.get_ref().as_array()?;
        let read = |(number, entry): (usize, &'a Spanned<DeValue<'i>>)| {
            let title = format!("`{key}` number {} of {}", number + 1, self.name());
            match entry.get_ref() {
                DeValue::Table(table) => Some(Err(self.child(key, title, (table, entry.span())))),
                _ => self.as_number(key, entry, quantity).map(Ok),
            }
        };
        // Every entry is read, so that every defect is found.
        let entries: Vec<Option<_>> = array.iter().enumerate().map(read).collect();
        entries.into_iter().collect()
    }

    /// Texts in brackets, each one of those that the table of keys has.
    pub fn choices(&self, key: &'static str) -> Option<Vec<&'static str>> {
        let Some(Kind::Choices(known)) = self.known(key).map(|key| key.kind) else {
            debug_assert!(false, "{key} is no list of choices");
            return None;
        };
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

    /// Two texts in brackets.
    pub fn pair(&self, key: &'static str) -> Option<[String; 2]> {
        let value = self.get(key)?;
        let array = value.get_ref().as_array();
        let texts = array.and_then(|array| {
            let texts = array.iter().map(|entry| entry.get_ref().as_str());
            texts.map(|text| text.map(str::to_owned)).collect()
        });
        let pair = texts.and_then(|texts: Vec<String>| <[String; 2]>::try_from(texts).ok());
        if pair.is_none() {
            let problem = format!("`{key}` in {} is no pair of names", self.name());
            let remedy = "write two names in brackets, e.g. [\"left\", \"right\"]";
            self.refuse(key, problem, remedy);
        }
        pair
    }

    /// Texts in brackets.
    pub fn texts(&self, key: &'static str) -> Option<Vec<String>> {
        let value = self.get(key)?;
        let array = value.get_ref().as_array();
        let texts = array.and_then(|array| {
            let texts = array.iter().map(|entry| entry.get_ref().as_str());
            texts.map(|text| text.map(str::to_owned)).collect()
        });
        if texts.is_none() {
            self.wrong_type(key, value, "names in brackets, e.g. [\"heading\"]");
        }
        texts
    }

    /// Truth values in brackets.
    pub fn flags(&self, key: &'static str) -> Option<Vec<bool>> {
        let value = self.get(key)?;
        let array = value.get_ref().as_array();
        let flags = array.and_then(|array| {
            let flags = array.iter().map(|entry| entry.get_ref().as_bool());
            flags.collect()
        });
        if flags.is_none() {
            self.wrong_type(key, value, "true and false in brackets, e.g. [true, false]");
        }
        flags
    }

    /// Numbers in brackets.
    pub fn numbers(&self, key: &'static str) -> Option<Vec<f64>> {
        let quantity = self.known(key).and_then(|key| key.kind.quantity());
        self.numbers_of(key, quantity.unwrap_or(Quantity::PLAIN))
    }

    fn numbers_of(&self, key: &'static str, quantity: Quantity) -> Option<Vec<f64>> {
        let value = self.get(key)?;
        let Some(array) = value.get_ref().as_array() else {
            self.wrong_type(key, value, "numbers in brackets, e.g. [0.5, 1.0]");
            return None;
        };
        array
            .iter()
            .map(|entry| self.as_number(key, entry, quantity))
            .collect()
    }

    /// Three numbers in brackets; a doubt is about their length.
    pub fn vector(&self, key: &'static str) -> Option<[f64; 3]> {
        let quantity = self.known(key)?.kind.quantity()?;
        let plain = Quantity {
            plausible: None,
            ..quantity
        };
        let numbers = self.numbers_of(key, plain)?;
        let vector = <[f64; 3]>::try_from(numbers).ok();
        match (vector, self.get(key)) {
            (Some(vector), Some(value)) => {
                let length = vector.map(|x| x * x).iter().sum::<f64>().sqrt();
                self.doubt(key, value, (length, quantity));
            }
            _ => self.refuse(
                key,
                format!("`{key}` in {} has not three components", self.name()),
                "write [x, y, z]",
            ),
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

    /// Pairs of a coordinate and a value in brackets.
    pub fn rows(&self, key: &'static str) -> Option<Vec<[f64; 2]>> {
        let example = "[coordinate, value] in brackets, e.g. [[0, 1e9], [500, 4e9]]";
        self.tuples(key, ("rows", example))
    }

    /// Lists of as many numbers, in brackets; what they are called, and an example.
    fn tuples<const N: usize>(
        &self,
        key: &'static str,
        (what, wanted): (&str, &str),
    ) -> Option<Vec<[f64; N]>> {
        let value = self.get(key)?;
        let quantity = self.known(key)?.kind.quantity();
        let quantity = quantity.unwrap_or(Quantity {
            dimension: Dimension::Time,
            ..Quantity::PLAIN
        });
        let point = |entry: &Spanned<DeValue<'i>>| -> Option<[f64; N]> {
            let numbers = entry.get_ref().as_array()?.iter();
            let numbers = numbers.map(|number| self.as_number(key, number, quantity));
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

    /// All keys of a table of numbers whose names are free.
    pub fn free_numbers(&self, key: &'static str) -> Vec<(String, f64)> {
        let section = self.section(key);
        section.map_or_else(Vec::new, |section| section.all_numbers())
    }

    /// All keys of this section, which must be plain numbers.
    pub fn all_numbers(&self) -> Vec<(String, f64)> {
        let plain = Quantity {
            dimension: Dimension::OfKey,
            ..Quantity::PLAIN
        };
        let entries = self.table.iter();
        entries
            .filter_map(|(name, value)| {
                let number = self.as_number(name.get_ref(), value, plain)?;
                Some((name.get_ref().to_string(), number))
            })
            .collect()
    }

    /// All keys below `key`, which must be lists of numbers, or `{ from, to, count }` for numbers
    /// whose logarithms lie evenly. What a number is follows from the name that it stands under.
    pub fn number_lists(
        &self,
        key: &'static str,
        quantity_of: impl Fn(&str) -> Quantity,
    ) -> Vec<(String, Vec<f64>)> {
        let Some(lists) = self.section(key) else {
            return Vec::new();
        };
        let read = |name: &str, value: &'a Spanned<DeValue<'i>>| match value.get_ref() {
            DeValue::Array(array) => {
                let numbers = array.iter();
                let numbers = numbers.map(|n| lists.as_number(name, n, quantity_of(name)));
                numbers.collect::<Option<Vec<f64>>>().unwrap_or_default()
            }
            DeValue::Table(table) => {
                let title = format!("`{name}` in {}", lists.name());
                let series = self.child(key, title, (table, value.span()));
                series.evenly(quantity_of(name))
            }
            _ => {
                let wanted = "numbers in brackets, or { from = 1e8, to = 1e12, count = 9 }";
                lists.wrong_type(name, value, wanted);
                Vec::new()
            }
        };
        let entries = lists.table.iter();
        entries
            .map(|(name, value)| (name.get_ref().to_string(), read(name.get_ref(), value)))
            .collect()
    }

    fn evenly(self, quantity: Quantity) -> Vec<f64> {
        for key in ["from", "to", "count"] {
            self.require(key);
        }
        let end = Quantity {
            range: Range::Positive,
            ..quantity
        };
        let from = self.number_of("from", end);
        let to = self.number_of("to", end);
        let count = self.number("count");
        self.finish();
        let (Some(from), Some(to), Some(count)) = (from, to, count) else {
            return Vec::new();
        };
        let share = |i: usize| i as f64 / (count.floor() - 1.0);
        let numbers = (0..count as usize).map(|i| from * (to / from).powf(share(i)));
        numbers.collect()
    }
}
