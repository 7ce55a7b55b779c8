//! Reads the stress before any load.

use kluft_solver::InitialStress;

use crate::field::{FieldEntry, InTime};
use crate::profile::read_profile_or_field;
use crate::reader::Section;

/// Stress before any load.
#[derive(Debug, Clone)]
pub struct InitialStressEntry {
    /// Its components.
    pub stress: InitialStress,
    /// Those that vary by more than the elevation.
    pub fields: Vec<FieldEntry>,
}

pub(crate) fn read_initial_stress(section: Section<'_, '_>) -> InitialStressEntry {
    let mut fields = Vec::new();
    let components = ["xx", "yy", "zz", "xy", "yz", "xz"].map(|name| {
        let (component, entry) = read_profile_or_field(&section, name, InTime::Never);
        fields.extend(entry);
        component
    });
    section.finish();
    InitialStressEntry {
        stress: InitialStress { components },
        fields,
    }
}
