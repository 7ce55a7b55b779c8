//! Keys that several sections of a description have.

use std::path::Path;

use kluft_defect::ordinary_text;
use kluft_keys::Range;
use kluft_mesh::Defect;
use kluft_network::{Orientation, SIDES};
use kluft_scene::reader::Section;

/// Reads a text file.
pub(super) fn read_text(file: &Path, remedy: &str) -> Result<String, Vec<Defect>> {
    ordinary_text(file).map_err(|error| {
        let problem = format!("the file cannot be read: {error}");
        vec![Defect::new(file.display().to_string(), problem, remedy)]
    })
}

/// The seed in a section.
pub(super) fn read_seed(section: &Section<'_, '_>) -> Option<u64> {
    section.number("seed").map(|seed| seed as u64)
}

/// Dip and dip direction in a section.
pub(super) fn read_orientation(section: &Section<'_, '_>) -> Option<Orientation> {
    section.require("dip");
    section.require("dip_direction");
    let dip = section.number_in("dip", Range::NotNegative);
    if dip.is_some_and(|dip| dip > 90.0) {
        section.refuse(
            "dip",
            "a dip is at most 90 degrees".into(),
            "turn the dip direction by 180 instead",
        );
    }
    let dip_direction = section.number("dip_direction");
    Some(Orientation {
        dip: dip.filter(|dip| *dip <= 90.0)?,
        dip_direction: dip_direction?,
    })
}

/// Number of corners of a disc or an ellipse.
pub(super) fn read_sides(section: &Section<'_, '_>) -> usize {
    section
        .number("sides")
        .map_or(SIDES, |sides| sides as usize)
}
