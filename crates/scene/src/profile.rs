//! Values that are constant, or linear in the elevation.

use kluft_solver::{Field, Profile};

use crate::field::{FieldEntry, InTime, Value, read_field};
use crate::reader::Section;

/// Reads a value; 0 if the key is not there.
pub(crate) fn read_profile(section: &Section<'_, '_>, name: &'static str) -> Profile {
    if !section.is_table(name) {
        return Profile {
            value: section.number(name).unwrap_or(0.0),
            ..Profile::default()
        };
    }
    let Some(profile) = section.section(name) else {
        return Profile::default();
    };
    profile.require("value");
    let number = |key| profile.number(key).unwrap_or(0.0);
    let read = Profile {
        at: number("at"),
        value: number("value"),
        per_metre: number("per_metre"),
    };
    if read.per_metre != 0.0 {
        let Profile {
            value,
            per_metre,
            at,
        } = read;
        let remedy =
            format!("write {{ expression = \"{value:?} + {per_metre:?} * (y - {at:?})\" }}");
        profile.refuse_in_plane("per_metre", remedy);
    }
    profile.finish();
    read
}

/// Whether a key holds a section with one of some keys.
pub(crate) fn says(section: &Section<'_, '_>, name: &'static str, keys: &[&'static str]) -> bool {
    let value = section.is_table(name).then(|| section.section(name));
    value
        .flatten()
        .is_some_and(|value| keys.iter().any(|key| value.has(key)))
}

/// Reads a number, a profile, or a value that varies otherwise, which is kept beside.
pub(crate) fn read_profile_or_field(
    section: &Section<'_, '_>,
    name: &'static str,
    in_time: InTime,
) -> (Field, Option<FieldEntry>) {
    if !says(section, name, &["table", "expression", "file"]) {
        return (Field::from(read_profile(section, name)), None);
    }
    let quantity = section.quantity(name);
    let value = section.section(name);
    let value = value.and_then(|value| read_field(value, (name, quantity), in_time));
    match value {
        Some(Value::Varying(entry)) => (entry.field.clone(), Some(*entry)),
        Some(Value::Number(_)) | None => (Field::default(), None),
    }
}
