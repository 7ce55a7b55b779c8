//! Reads rocks.

use kluft_solver::RockParameter;
use lie_core::{Orthotropy, Rock};

use crate::anisotropy::{Symmetry, read_orthotropic, read_transverse};
use crate::field::{FieldEntry, InTime, Value, read_value};
use crate::reader::Section;
use crate::setting::Setting;

/// A rock.
#[derive(Debug, Clone)]
pub struct RockEntry {
    /// Its constants. Those that vary are not numbers until the mesh is known.
    pub rock: Rock,
    /// Constants that vary.
    pub fields: Vec<(RockParameter, FieldEntry)>,
}

pub(crate) fn read_rock(section: &Section<'_, '_>, setting: Setting) -> Option<RockEntry> {
    if setting.is_rigid() {
        let density = section.number("density");
        return Some(RockEntry {
            rock: Rock::rigid(density.unwrap_or(0.0)),
            fields: Vec::new(),
        });
    }
    match Symmetry::of(section) {
        Symmetry::Isotropic => read_isotropic(section),
        Symmetry::Transverse => read_transverse(section).and_then(|own| anisotropic(section, &own)),
        Symmetry::Orthotropic => {
            read_orthotropic(section).and_then(|own| anisotropic(section, &own))
        }
    }
}

/// A rock with these constants, whose density alone may vary.
fn anisotropic(section: &Section<'_, '_>, constants: &Orthotropy) -> Option<RockEntry> {
    let (density, fields) = match read_value(section, "density", InTime::Never) {
        Some(Value::Varying(entry)) => (f64::NAN, vec![(RockParameter::Density, *entry)]),
        Some(Value::Number(density)) => (density, Vec::new()),
        None => (0.0, Vec::new()),
    };
    let rock = Rock::orthotropic(constants, density);
    Some(RockEntry { rock, fields })
}

fn read_isotropic(section: &Section<'_, '_>) -> Option<RockEntry> {
    section.require("young_modulus");
    section.require("poisson_ratio");
    let mut fields = Vec::new();
    let mut read = |key, parameter| match read_value(section, key, InTime::Never)? {
        Value::Number(number) => Some(number),
        Value::Varying(entry) => {
            fields.push((parameter, *entry));
            Some(f64::NAN)
        }
    };
    let young_modulus = read("young_modulus", RockParameter::YoungModulus);
    let poisson_ratio = read("poisson_ratio", RockParameter::PoissonRatio);
    let density = read("density", RockParameter::Density);
    let rock = Rock {
        young_modulus: young_modulus?,
        poisson_ratio: poisson_ratio?,
        density: density.unwrap_or(0.0),
        anisotropy: None,
    };
    Some(RockEntry { rock, fields })
}
