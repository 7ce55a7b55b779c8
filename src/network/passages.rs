//! Sections of a description that go into the scene as they are.

use kluft_keys::{key_text, quoted, section_head};
use kluft_scene::reader::Section;
use toml::de::{DeTable, DeValue};

/// Keys and values of a section, as TOML.
pub(super) type Passage = Vec<(String, String)>;

/// Sections that the input has for the scene: the head of each and what is in it.
#[derive(Default)]
pub(super) struct Passages(pub(super) Vec<(String, Passage)>);

impl Passages {
    /// Water, and nothing else.
    pub(super) fn of_water() -> Self {
        let viscosity = ("viscosity".to_owned(), "1e-3".to_owned());
        Self(vec![("[fluid]".to_owned(), vec![viscosity])])
    }

    /// Whether there is one for a key with another key in it.
    pub(super) fn says(&self, key: &str, inner: &str) -> bool {
        let mut own = self.0.iter().filter(|(head, _)| is_for(head, key));
        own.any(|(_, passage)| passage.iter().any(|(name, _)| name == inner))
    }

    /// Whether there is one for a key.
    pub(super) fn has(&self, key: &str) -> bool {
        self.0.iter().any(|(head, _)| is_for(head, key))
    }
}

fn is_for(head: &str, key: &str) -> bool {
    head.trim_start_matches('[').starts_with(key)
}

/// Keys and values of a table without those named.
pub(super) fn passage(table: &DeTable<'_>, without: &[&str]) -> Passage {
    let entries = table
        .iter()
        .filter(|(name, _)| !without.contains(&name.get_ref().as_ref()));
    entries
        .map(|(name, value)| (key_text(name.get_ref()), value_text(value.get_ref())))
        .collect()
}

/// All sections of the input that a scene understands.
pub(super) fn passages(root: &Section<'_, '_>) -> Passages {
    let mut found = Vec::new();
    for key in [
        "rock",
        "boundary",
        "fixed_point",
        "body",
        "fluid",
        "source",
        "initial_stress",
        "load",
    ] {
        match root.table().get(key).map(|value| value.get_ref()) {
            Some(DeValue::Table(table)) if ["rock", "boundary"].contains(&key) => {
                for (name, value) in table.iter() {
                    if let DeValue::Table(inner) = value.get_ref() {
                        found.push((section_head(key, name.get_ref()), passage(inner, &[])));
                    }
                }
            }
            Some(DeValue::Table(table)) => found.push((format!("[{key}]"), passage(table, &[]))),
            Some(DeValue::Array(array)) => {
                for entry in array.iter() {
                    if let DeValue::Table(inner) = entry.get_ref() {
                        found.push((format!("[[{key}]]"), passage(inner, &[])));
                    }
                }
            }
            _ => {}
        }
    }
    Passages(found)
}

fn value_text(value: &DeValue<'_>) -> String {
    match value {
        DeValue::String(text) => quoted(text),
        DeValue::Integer(number) => i64::from_str_radix(number.as_str(), number.radix())
            .map_or_else(|_| number.as_str().to_owned(), |number| number.to_string()),
        DeValue::Float(number) => number.as_str().to_owned(),
        DeValue::Boolean(flag) => flag.to_string(),
        DeValue::Datetime(time) => time.to_string(),
        DeValue::Array(array) => {
            let entries: Vec<String> = array
                .iter()
                .map(|entry| value_text(entry.get_ref()))
                .collect();
            format!("[{}]", entries.join(", "))
        }
        DeValue::Table(table) => {
            let entries: Vec<String> = passage(table, &[])
                .iter()
                .map(|(key, value)| format!("{key} = {value}"))
                .collect();
            format!("{{ {} }}", entries.join(", "))
        }
    }
}
