//! Reads the stress before any load.

use kluft_solver::{Field, InitialStress};

use crate::field::{FieldEntry, InTime, Value, read_field};
use crate::profile::read_profile;
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
        let varies = section.is_table(name)
            && section.section(name).is_some_and(|component| {
                let forms = ["table", "expression", "file"];
                forms.into_iter().any(|form| component.has(form))
            });
        if !varies {
            return Field::from(read_profile(&section, name));
        }
        let quantity = section.quantity(name);
        let value = section
            .section(name)
            .and_then(|component| read_field(component, (name, quantity), InTime::Never));
        let Some(Value::Varying(entry)) = value else {
            return Field::default();
        };
        let field = entry.field.clone();
        fields.push(*entry);
        field
    });
    section.finish();
    InitialStressEntry {
        stress: InitialStress { components },
        fields,
    }
}
