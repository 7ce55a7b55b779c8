//! Reads rocks.

use kluft_solver::RockParameter;
use lie_core::Rock;

use crate::anisotropy::{
    AnisotropicConstants, NoRock, Symmetry, read_orthotropic, read_transverse,
};
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
    /// Constants of rock that is not isotropic.
    pub(crate) anisotropic: Option<AnisotropicConstants>,
}

impl RockEntry {
    /// All of its values that vary.
    pub(crate) fn varying(&self) -> impl Iterator<Item = &FieldEntry> {
        let own = self.fields.iter().map(|(_, field)| field);
        own.chain(self.anisotropic.iter().flat_map(|own| own.fields()))
    }

    /// Whether its axes or its constants along them vary.
    pub(crate) fn has_varying_axes(&self) -> bool {
        let mut constants = self.anisotropic.iter();
        constants.any(|own| own.fields().next().is_some())
    }

    /// The rock with these values of what varies, in the order of [`Self::varying`].
    pub(crate) fn with(&self, values: &[f64]) -> Rock {
        let (own, axial) = values.split_at(self.fields.len());
        let mut rock = self.rock.clone();
        for ((parameter, _), value) in self.fields.iter().zip(own) {
            parameter.set(&mut rock, *value);
        }
        match &self.anisotropic {
            Some(constants) if self.has_varying_axes() => {
                Rock::orthotropic(&constants.with(axial).orthotropy(), rock.density)
            }
            _ => rock,
        }
    }

    /// Why there is no rock with these values of what varies, if there is none.
    pub(crate) fn refusal(&self, values: &[f64]) -> Option<NoRock> {
        let constants = self.anisotropic.as_ref()?;
        constants.with(&values[self.fields.len()..]).refusal()
    }
}

pub(crate) fn read_rock(section: &Section<'_, '_>, setting: Setting) -> Option<RockEntry> {
    if setting.is_rigid() {
        let density = section.number("density");
        return Some(RockEntry {
            rock: Rock::rigid(density.unwrap_or(0.0)),
            fields: Vec::new(),
            anisotropic: None,
        });
    }
    match Symmetry::of(section) {
        Symmetry::Isotropic => read_isotropic(section),
        Symmetry::Transverse => read_transverse(section).and_then(|own| anisotropic(section, own)),
        Symmetry::Orthotropic => {
            read_orthotropic(section).and_then(|own| anisotropic(section, own))
        }
    }
}

/// A rock with these constants.
fn anisotropic(section: &Section<'_, '_>, constants: AnisotropicConstants) -> Option<RockEntry> {
    let (density, fields) = match read_value(section, "density", InTime::Never) {
        Some(Value::Varying(entry)) => (f64::NAN, vec![(RockParameter::Density, *entry)]),
        Some(Value::Number(density)) => (density, Vec::new()),
        None => (0.0, Vec::new()),
    };
    let rock = Rock::orthotropic(&constants.orthotropy(), density);
    Some(RockEntry {
        rock,
        fields,
        anisotropic: Some(constants),
    })
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
    Some(RockEntry {
        rock,
        fields,
        anisotropic: None,
    })
}
