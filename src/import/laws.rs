//! Constitutive relations of a project of OpenGeoSys as sections of rocks and fractures.

use std::fmt::Write as _;

use kluft_keys::section_head;

use super::parameters::Parameters;
use super::said::Said;
use super::tree::Element;

/// A number that must not change with time.
fn constant(of: &Element, tag: &str, parameters: &Parameters) -> Result<f64, String> {
    let text = of.word(tag).ok_or_else(|| format!("there is no <{tag}>"))?;
    let found = parameters.named(text)?;
    match (&found.values[..], found.curve) {
        (&[value], None) => Ok(value),
        (_, Some(_)) => Err(format!("`{text}` changes with time")),
        _ => Err(format!("`{text}` is no single number")),
    }
}

/// Three numbers in brackets.
fn triple(of: &Element, tag: &str, parameters: &Parameters) -> Result<String, String> {
    let text = of.word(tag).ok_or_else(|| format!("there is no <{tag}>"))?;
    let found = parameters.named(text)?;
    match &found.values[..] {
        values @ [_, _, _] => Ok(format!("{values:?}")),
        _ => Err(format!("`{text}` has not three numbers")),
    }
}

/// Stiffer rock than any that a scene takes (Pa) is as good as rigid.
const STIFFEST: f64 = 1e15;

/// The rocks of a process.
pub fn rocks(process: &Element, parameters: &Parameters, said: &mut Said) {
    for relation in process.all("constitutive_relation") {
        let name = match relation.attribute("id") {
            Some(id) => format!("material-{id}"),
            None => "default".to_owned(),
        };
        let _ = write!(said.scene, "\n{}", section_head("rock", &name));
        said.scene.push('\n');
        match relation.word("type") {
            Some("LinearElasticIsotropic") => {
                let constant = |tag| constant(relation, tag, parameters);
                let young = constant("youngs_modulus");
                if let Some(stiff) = young.as_ref().ok().filter(|young| **young > STIFFEST) {
                    let note = format!("a young_modulus of {stiff:e} is taken as {STIFFEST:e}");
                    said.notes.push(note);
                }
                said.number("young_modulus", young.map(|young| young.min(STIFFEST)));
                said.number("poisson_ratio", constant("poissons_ratio"));
            }
            Some("LinearElasticOrthotropic") => orthotropic(relation, parameters, said),
            kind => {
                let kind = kind.unwrap_or("unknown").to_owned();
                said.notes
                    .push(format!("no counterpart: rock `{name}` of type {kind}"));
                relation.leave();
            }
        }
        if let Some(density) = process.get("solid_density") {
            let text = density.text.clone();
            let found = parameters.named(&text).and_then(|found| {
                let first = found.values.first().copied();
                first.ok_or_else(|| format!("`{text}` is no number"))
            });
            said.number("density", found);
        }
    }
}

fn orthotropic(relation: &Element, parameters: &Parameters, said: &mut Said) {
    for (key, tag) in [
        ("young_moduli", "youngs_moduli"),
        ("poisson_ratios", "poissons_ratios"),
        ("shear_moduli", "shear_moduli"),
    ] {
        match triple(relation, tag, parameters) {
            Ok(values) => said.scene += &format!("{key} = {values}\n"),
            Err(why) => said.number(key, Err(why)),
        }
    }
}

/// The fractures of a process; all have its fracture model.
pub fn fractures(process: &Element, parameters: &Parameters, said: &mut Said) {
    let models: Vec<&Element> = process.all("fracture_model").collect();
    for properties in process.all("fracture_properties") {
        let id = properties.word("material_id").unwrap_or("?").to_owned();
        let name = format!("surface-{id}");
        let model = models
            .iter()
            .find(|model| model.attribute("id") == Some(&id[..]));
        let Some(model) = model.or(models.first()) else {
            said.notes.push(format!("fracture `{name}` has no model"));
            continue;
        };
        let _ = write!(said.scene, "\n{}\n", section_head("fracture", &name));
        let aperture = constant(properties, "initial_aperture", parameters);
        law(model, aperture, parameters, said);
    }
}

/// The keys of a law. Normal stiffnesses grow with `1 + ln^2(b/b0)` down to the cutoff, as in the
/// logarithmic closure.
fn law(model: &Element, aperture: Result<f64, String>, parameters: &Parameters, said: &mut Said) {
    let constant = |tag| constant(model, tag, parameters);
    let own = aperture.clone().unwrap_or_default();
    said.number("aperture", aperture);
    said.number("normal_stiffness", constant("normal_stiffness"));
    said.number("shear_stiffness", constant("shear_stiffness"));
    match constant("penalty_aperture_cutoff") {
        Ok(cutoff) if cutoff >= own => said.scene += "closure = \"linear\"\n",
        Ok(cutoff) => {
            said.scene += &format!("closure = \"logarithmic\"\ncutoff_aperture = {cutoff:?}\n");
        }
        Err(_) => said.scene += "closure = \"logarithmic\"\n",
    }
    let is_cohesive = model.word("type") == Some("CohesiveZoneModeI");
    // A strength ends the tension by itself.
    let cut = matches!(model.word("tension_cutoff"), Some("1" | "true"));
    if cut && !is_cohesive {
        said.scene += "tension_cutoff = true\n";
    }
    match model.word("type") {
        Some("Coulomb" | "MohrCoulomb") => {
            said.number("friction_angle", constant("friction_angle"));
            said.number("dilation_angle", constant("dilatancy_angle"));
            said.number("cohesion", constant("cohesion"));
        }
        Some("CohesiveZoneModeI") => {
            said.number("tensile_strength", constant("peak_normal_traction"));
            said.number("fracture_energy", constant("fracture_toughness"));
        }
        _ => {}
    }
    model.pass_over(&["nonlinear_solver"]);
}
