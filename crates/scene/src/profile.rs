//! Values that are constant, or linear in the elevation.

use kluft_solver::Profile;

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
    profile.finish();
    read
}
