//! How fractures conduct: numbers, and values that vary.

use kluft_solver::Conduit;
use lie_core::{HydraulicAperture, Roughness};

use crate::drive::refuse_beside;
use crate::field::{FieldEntry, InTime, Value, read_value};
use crate::fluid::{OF_FRACTURES, refuse_without_fluid};
use crate::reader::Section;
use crate::setting::{FluidUse, Setting};

/// A parameter of a hydraulic aperture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HydraulicParameter {
    /// The aperture itself (m).
    Constant,
    /// What walls in contact leave open (m).
    Residual,
    /// How rough walls are, by a factor or a coefficient.
    Roughness,
}

impl HydraulicParameter {
    /// Gives a hydraulic aperture this parameter, if it has it.
    pub(crate) fn set(self, hydraulic: &mut HydraulicAperture, value: f64) {
        match (self, hydraulic) {
            (Self::Constant, HydraulicAperture::Constant(own)) => *own = value,
            (Self::Residual, HydraulicAperture::OfWalls { residual, .. }) => *residual = value,
            (Self::Roughness, HydraulicAperture::OfWalls { roughness, .. }) => match roughness {
                Roughness::Factor(own) | Roughness::Coefficient(own) => *own = value,
            },
            _ => {}
        }
    }
}

/// Parameters that vary.
pub(crate) type HydraulicFields = Vec<(HydraulicParameter, FieldEntry)>;

/// Reads how a fracture conducts; parameters that vary are kept, and are no numbers here.
pub(crate) fn read_conduit(
    section: &Section<'_, '_>,
    setting: Setting,
    fields: &mut HydraulicFields,
) -> Option<Conduit> {
    refuse_without_fluid(section, setting, &OF_FRACTURES);
    if setting.fluid == FluidUse::None {
        return None;
    }
    if section.flag("sealed") == Some(true) {
        refuse_beside(section, "sealed = true", &OF_FRACTURES[..6]);
        return Some(Conduit::Sealed);
    }
    let mut read = |key: &'static str, parameter: HydraulicParameter| match read_value(
        section,
        key,
        InTime::Never,
    )? {
        Value::Number(number) => Some(number),
        Value::Varying(entry) => {
            fields.push((parameter, *entry));
            Some(f64::NAN)
        }
    };
    if section.has("hydraulic_aperture") {
        refuse_beside(section, "hydraulic_aperture", &OF_FRACTURES[1..4]);
        let constant = read("hydraulic_aperture", HydraulicParameter::Constant);
        return constant.map(|constant| Conduit::Open(HydraulicAperture::Constant(constant)));
    }
    let residual = read("residual_hydraulic_aperture", HydraulicParameter::Residual);
    let factor = read("roughness", HydraulicParameter::Roughness);
    let coefficient = read("joint_roughness", HydraulicParameter::Roughness);
    if section.has("roughness") && section.has("joint_roughness") {
        section.refuse(
            "joint_roughness",
            "both roughness and joint_roughness are given".into(),
            "keep one: a factor on the transmissivity, or Barton's coefficient",
        );
    }
    Some(Conduit::Open(HydraulicAperture::OfWalls {
        roughness: match coefficient {
            Some(coefficient) => Roughness::Coefficient(coefficient),
            None => Roughness::Factor(factor.unwrap_or(1.0)),
        },
        residual: residual.unwrap_or(0.0),
    }))
}
