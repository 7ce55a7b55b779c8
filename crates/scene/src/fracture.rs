//! What a scene may say of a fracture.

use kluft_keys::Range;
use kluft_solver::{Conduit, Fracture, LawParameter};
use lie_core::{Closure, ClosureKind, FractureLaw, Friction, HydraulicAperture, Tension};

use crate::conditions::FractureEntry;
use crate::conduit::{HydraulicFields, HydraulicParameter, read_conduit};
use crate::drive::{DriveEntry, refuse_both_ways};
use crate::field::{FieldEntry, InTime, Value, read_value};
use crate::fluid::read_leakoff;
use crate::load::{Scaled, read_history};
use crate::reader::Section;
use crate::roles::DEFAULT;
use crate::setting::Setting;

/// Reads a section on a fracture of a scene: its law, and where it is.
pub(crate) fn read_placed_fracture(
    section: &Section<'_, '_>,
    name: &str,
    setting: Setting,
) -> Option<FractureEntry> {
    let between = section.pair("between");
    if between.is_some() && name == DEFAULT {
        section.refuse(
            "between",
            "[fracture.default] serves surfaces that the mesh has, none of its own".into(),
            "give the fracture between these volumes a name: [fracture.NAME]",
        );
    }
    let entry = read_fracture(section, setting)?;
    Some(FractureEntry { between, ..entry })
}

/// Reads what a section says of a fracture, wherever it is.
pub fn read_fracture(section: &Section<'_, '_>, setting: Setting) -> Option<FractureEntry> {
    let mut hydraulic_fields = Vec::new();
    let conduit = read_conduit(section, setting, &mut hydraulic_fields);
    let mut fields = Fields::default();
    let law = match setting.is_rigid() {
        true => read_rigid_law(section, (conduit, &hydraulic_fields), &mut fields),
        false => read_law(section, &mut fields),
    };
    let is_open = matches!(conduit, Some(Conduit::Open(_)));
    // Nothing moves the walls of a sealed fracture in rigid rock.
    let has_use = is_open || !setting.is_rigid();
    let key = "fluid_pressure";
    let given = has_use.then(|| read_value(section, key, InTime::By(setting.clock)));
    let (fluid_pressure, varying_pressure) = match given.flatten() {
        Some(Value::Number(pressure)) => (Some(pressure), None),
        Some(Value::Varying(entry)) => (None, Some(entry)),
        None => (None, None),
    };
    if is_open {
        refuse_both_ways(section, key, varying_pressure.as_deref());
    }
    let scaled = Scaled {
        is_there: has_use && section.has(key),
        what: "a fluid_pressure",
    };
    let history = read_history(section, setting.clock, scaled);
    Some(FractureEntry {
        between: None,
        fracture: Fracture {
            law: law?,
            fluid_pressure: match is_open {
                true => 0.0,
                false => fluid_pressure.unwrap_or(0.0),
            },
        },
        fields: fields.0,
        given_pressure: match (&varying_pressure, fluid_pressure) {
            _ if !is_open => None,
            (Some(entry), _) => Some(DriveEntry::of_field(entry.clone())),
            (None, pressure) => pressure.map(DriveEntry::of_constant),
        },
        varying_pressure: varying_pressure.filter(|_| !is_open),
        leakoff: read_leakoff(section, conduit),
        conduit,
        hydraulic_fields,
        history,
    })
}

/// The law of walls in rigid rock, of which the aperture is all that counts.
fn read_rigid_law(
    section: &Section<'_, '_>,
    (conduit, hydraulic_fields): (Option<Conduit>, &HydraulicFields),
    fields: &mut Fields,
) -> Option<FractureLaw> {
    let hydraulic = match conduit {
        Some(Conduit::Open(HydraulicAperture::Constant(constant))) => Some(constant),
        _ => None,
    };
    let is_sealed = conduit == Some(Conduit::Sealed);
    if hydraulic.is_none() && !is_sealed {
        section.require("aperture");
    }
    let aperture = fields.read(section, "aperture", LawParameter::Aperture);
    if aperture.is_none() {
        fields.follow_hydraulic_aperture(hydraulic_fields);
    }
    let aperture = aperture.or(hydraulic).or(is_sealed.then_some(0.0));
    aperture.map(FractureLaw::rigid)
}

/// Parameters that vary.
#[derive(Default)]
struct Fields(Vec<(LawParameter, FieldEntry)>);

impl Fields {
    /// Reads a parameter; one that varies is kept, and is not a number here, so that nothing is
    /// found wrong with it before its values are known.
    fn read(
        &mut self,
        section: &Section<'_, '_>,
        key: &'static str,
        parameter: LawParameter,
    ) -> Option<f64> {
        self.read_in(section, (key, section.quantity(key).range), parameter)
    }

    /// Reads a parameter of another range.
    fn read_in(
        &mut self,
        section: &Section<'_, '_>,
        (key, range): (&'static str, Range),
        parameter: LawParameter,
    ) -> Option<f64> {
        if !section.is_table(key) {
            return section.number_in(key, range);
        }
        let Value::Varying(mut entry) = read_value(section, key, InTime::Never)? else {
            return None;
        };
        entry.quantity.range = range;
        self.0.push((parameter, *entry));
        Some(f64::NAN)
    }

    /// Lets the largest closure of a hyperbola be the aperture, which varies.
    fn follow_aperture(&mut self) {
        let mut own = self.0.iter();
        let aperture = own.find(|(parameter, _)| *parameter == LawParameter::Aperture);
        let followed = aperture.map(|(_, entry)| (LawParameter::MaxClosure, entry.clone()));
        self.0.extend(followed);
    }
}

impl Fields {
    /// Lets walls be as far apart as the fluid sees them.
    fn follow_hydraulic_aperture(&mut self, hydraulic: &HydraulicFields) {
        let constant = hydraulic.iter();
        let constant = constant.filter(|(own, _)| *own == HydraulicParameter::Constant);
        let followed = constant.map(|(_, entry)| (LawParameter::Aperture, entry.clone()));
        self.0.extend(followed);
    }
}

/// The law of walls that move.
fn read_law(section: &Section<'_, '_>, fields: &mut Fields) -> Option<FractureLaw> {
    let closure = section.choice("closure");
    let is_known = closure.is_some() || !section.has("closure");
    let closure = closure.unwrap_or("linear");
    let contact = closure == "contact";
    let has_friction = section.has("friction_angle");
    let needed = [
        (true, "aperture"),
        (!contact, "normal_stiffness"),
        (!contact && !has_friction, "shear_stiffness"),
    ];
    for (_, key) in needed.into_iter().filter(|(needed, _)| *needed) {
        section.require(key);
    }
    let positive = if contact {
        Range::NotNegative
    } else {
        Range::Positive
    };
    let aperture = fields.read_in(section, ("aperture", positive), LawParameter::Aperture);
    let normal_stiffness = fields.read(section, "normal_stiffness", LawParameter::NormalStiffness);
    let kind = closure_kind(section, (closure, aperture), fields);
    let tension = read_tension(section, normal_stiffness, fields);
    let friction = read_friction(section, fields);
    let shear_stiffness = read_shear_stiffness(section, contact, fields);
    if contact {
        refuse_in_contact(section);
    }
    let closure = if contact {
        Closure::contact(aperture?)
    } else {
        Closure {
            aperture: aperture?,
            normal_stiffness: normal_stiffness?,
            kind,
            tension,
        }
    };
    let law = FractureLaw {
        closure,
        shear_stiffness: shear_stiffness?,
        friction,
    };
    is_known.then_some(law)
}

/// Keys that a closure law refuses; `has_friction` tells whether the fracture has friction.
pub fn refused_keys(closure: &str, has_friction: bool) -> Vec<&'static str> {
    let refused = [
        (closure != "logarithmic", "cutoff_aperture"),
        (closure != "hyperbolic", "max_closure"),
        (closure == "contact", "normal_stiffness"),
        (closure == "contact", "tensile_strength"),
        (closure == "contact", "fracture_energy"),
        (closure == "contact" && !has_friction, "shear_stiffness"),
    ];
    let keys = refused.into_iter().filter(|(refuses, _)| *refuses);
    keys.map(|(_, key)| key).collect()
}

fn closure_kind(
    section: &Section<'_, '_>,
    (closure, aperture): (&str, Option<f64>),
    fields: &mut Fields,
) -> ClosureKind {
    let mut below = |key: &'static str, parameter: LawParameter| {
        let value = fields.read(section, key, parameter)?;
        if let Some(aperture) = aperture.filter(|&aperture| value > aperture) {
            section.refuse(
                key,
                format!("{key} {value} is above the aperture {aperture}"),
                "it must lie between 0 and the aperture; leave it out for the exact law",
            );
        }
        Some(value)
    };
    let belongs = |key: &'static str, to: &'static str| {
        if section.has(key) && closure != to {
            section.refuse(
                key,
                format!("a {closure} closure has no {key}"),
                format!("remove {key} or write closure = \"{to}\""),
            );
        }
    };
    belongs("cutoff_aperture", "logarithmic");
    belongs("max_closure", "hyperbolic");
    let cutoff = below("cutoff_aperture", LawParameter::CutoffAperture);
    let max_closure = below("max_closure", LawParameter::MaxClosure);
    if closure == "hyperbolic" && max_closure.is_none() {
        fields.follow_aperture();
    }
    match closure {
        "logarithmic" => ClosureKind::Logarithmic { cutoff },
        "hyperbolic" => ClosureKind::Hyperbolic {
            max_closure: max_closure.or(aperture).unwrap_or(1.0),
        },
        "contact" => ClosureKind::Contact,
        _ => ClosureKind::Linear,
    }
}

fn read_tension(section: &Section<'_, '_>, stiffness: Option<f64>, fields: &mut Fields) -> Tension {
    let cut = section.flag("tension_cutoff").unwrap_or(false);
    let strength = fields.read(section, "tensile_strength", LawParameter::TensileStrength);
    let energy = fields.read(section, "fracture_energy", LawParameter::FractureEnergy);
    if strength.is_some() != energy.is_some() {
        let (given, missing) = match strength {
            Some(_) => ("tensile_strength", "fracture_energy"),
            None => ("fracture_energy", "tensile_strength"),
        };
        section.refuse(
            given,
            format!("{given} is given, but not {missing}"),
            "a cohesive bond needs both: tensile_strength = 1e6 (Pa), fracture_energy = 100 (J/m^2)",
        );
    }
    let (Some(strength), Some(energy)) = (strength, energy) else {
        return if cut {
            Tension::CutOff
        } else {
            Tension::Elastic
        };
    };
    if cut {
        section.refuse(
            "tension_cutoff",
            "a fracture with tensile strength has no tension_cutoff".into(),
            "remove one of them: the strength ends the tension by itself",
        );
    }
    let stored = stiffness.map_or(0.0, |stiffness| strength * strength / 2.0 / stiffness);
    if energy <= stored {
        section.refuse(
            "fracture_energy",
            format!("{energy} J/m^2 is not more than the {stored:.4e} J/m^2 stored at the strength"),
            "raise fracture_energy or normal_stiffness: above tensile_strength^2 / (2 normal_stiffness)",
        );
    }
    Tension::Cohesive { strength, energy }
}

fn read_friction(section: &Section<'_, '_>, fields: &mut Fields) -> Option<Friction> {
    let angle = fields.read(section, "friction_angle", LawParameter::FrictionAngle);
    let cohesion = fields.read(section, "cohesion", LawParameter::Cohesion);
    let dilation = fields.read(section, "dilation_angle", LawParameter::DilationAngle);
    for key in ["cohesion", "dilation_angle"] {
        if section.has(key) && !section.has("friction_angle") {
            section.refuse(
                key,
                format!("{key} is given, but no friction_angle"),
                "add friction_angle = 30 (degrees; 0 for cohesion alone)",
            );
        }
    }
    let tangent = |degrees: f64| degrees.to_radians().tan();
    if let (Some(angle), Some(dilation)) = (angle, dilation)
        && dilation > angle
    {
        section.refuse(
            "dilation_angle",
            format!("a dilation_angle of {dilation} is above the friction_angle of {angle}"),
            "sliding would give energy; the dilation angle is at most the friction angle",
        );
    }
    Some(Friction {
        coefficient: tangent(angle?),
        cohesion: cohesion.unwrap_or(0.0),
        dilation: tangent(dilation.unwrap_or(0.0)),
    })
}

/// Without one, friction holds the walls rigidly, and walls in contact without friction slide
/// freely.
fn read_shear_stiffness(
    section: &Section<'_, '_>,
    contact: bool,
    fields: &mut Fields,
) -> Option<f64> {
    let has_friction = section.has("friction_angle");
    let given = fields.read(section, "shear_stiffness", LawParameter::ShearStiffness);
    if section.has("shear_stiffness") && has_friction && given == Some(0.0) {
        section.refuse(
            "shear_stiffness",
            "without shear stiffness there is nothing for friction to limit".into(),
            "give a stiffness, or leave it out: then nothing moves before it slides",
        );
    }
    if section.has("shear_stiffness") && contact && !has_friction && given != Some(0.0) {
        section.refuse(
            "shear_stiffness",
            "walls in contact without friction slide freely".into(),
            "remove shear_stiffness, or add friction_angle",
        );
    }
    match (section.has("shear_stiffness"), has_friction, contact) {
        (true, ..) => given,
        (false, true, _) => Some(f64::INFINITY),
        (false, false, true) => Some(0.0),
        (false, false, false) => None,
    }
}

fn refuse_in_contact(section: &Section<'_, '_>) {
    for key in ["normal_stiffness", "tensile_strength"] {
        if section.has(key) {
            section.refuse(
                key,
                format!("contact has no {key}"),
                "remove it, or choose another closure",
            );
        }
    }
}
