//! Reads rock that is stiffer in some directions than in others.

use glam::DMat3;
use kluft_mesh::Orientation;
use lie_core::Orthotropy;

use crate::reader::Section;

/// Keys that make a rock the same in all directions of a plane only.
const TRANSVERSE: [&str; 3] = [
    "normal_young_modulus",
    "normal_poisson_ratio",
    "normal_shear_modulus",
];
/// Keys that give it three axes.
const ORTHOTROPIC: [&str; 3] = ["young_moduli", "poisson_ratios", "shear_moduli"];

/// How the stiffness of a rock depends on the direction.
pub(crate) enum Symmetry {
    Isotropic,
    Transverse,
    Orthotropic,
}

impl Symmetry {
    /// What the keys of a section make of it.
    pub(crate) fn of(section: &Section<'_, '_>) -> Self {
        let any = |keys: [&'static str; 3]| keys.into_iter().any(|key| section.has(key));
        match (any(TRANSVERSE), any(ORTHOTROPIC)) {
            (_, true) => Self::Orthotropic,
            (true, false) => Self::Transverse,
            (false, false) => Self::Isotropic,
        }
    }
}

/// The constants of a rock with a plane of isotropy.
pub(crate) fn read_transverse(section: &Section<'_, '_>) -> Option<Orthotropy> {
    for key in ["young_modulus", "poisson_ratio"] {
        section.require(key);
        refuse_field(section, key);
    }
    TRANSVERSE.iter().for_each(|key| section.require(key));
    let axes = read_axes(section);
    let [e, nu] = ["young_modulus", "poisson_ratio"].map(|key| section.number(key));
    let [across, nu_across, shear] = TRANSVERSE.map(|key| section.number(key));
    let (e, nu, across, nu_across) = (e?, nu?, across?, nu_across?);
    let rock = Orthotropy::transverse([e, across], [nu, nu_across], shear?, axes?);
    if rock.is_positive_definite() {
        return Some(rock);
    }
    let bound = (across / e * (1.0 - nu) / 2.0).sqrt();
    section.refuse(
        "normal_poisson_ratio",
        format!("with a `normal_poisson_ratio` of {nu_across} some strains cost no energy"),
        format!("give less than sqrt(E'/E (1 - nu)/2) = {bound:.6}; a stress across the plane strains it by -nu'/E' of it"),
    );
    None
}

/// The constants of a rock with three axes.
pub(crate) fn read_orthotropic(section: &Section<'_, '_>) -> Option<Orthotropy> {
    let others = ["young_modulus", "poisson_ratio"].into_iter();
    for key in others.chain(TRANSVERSE).filter(|key| section.has(key)) {
        section.refuse(
            key,
            format!("`{key}` has no meaning beside the constants of three axes"),
            format!("remove it, or `{}`", ORTHOTROPIC.join("`, `")),
        );
    }
    ORTHOTROPIC.iter().for_each(|key| section.require(key));
    let axes = read_axes(section);
    let [young_moduli, poisson_ratios, shear_moduli] = ORTHOTROPIC.map(|key| section.vector(key));
    let rock = Orthotropy {
        young_moduli: young_moduli?,
        poisson_ratios: poisson_ratios?,
        shear_moduli: shear_moduli?,
        axes: axes?,
    };
    if rock.is_positive_definite() {
        return Some(rock);
    }
    let [a, b, c] = rock.poisson_bounds();
    section.refuse(
        "poisson_ratios",
        "with these `poisson_ratios` some strains cost no energy".into(),
        format!(
            "nu_ij must be less than sqrt(E_i/E_j), [{a:.4}, {b:.4}, {c:.4}], and 1 - nu12 nu21 - nu23 nu32 - nu13 nu31 - 2 nu21 nu32 nu13 = {:.4e} more than 0, with nu_ji = nu_ij E_j/E_i",
            rock.definiteness()
        ),
    );
    None
}

/// A modulus of such rock has one value.
fn refuse_field(section: &Section<'_, '_>, key: &'static str) {
    if section.is_table(key) {
        let problem = format!("`{key}` cannot vary within rock that is not isotropic");
        section.refuse(key, problem, "give a number, and volumes of their own");
    }
}

/// Axes down the dip, along the strike and across the plane.
fn read_axes(section: &Section<'_, '_>) -> Option<DMat3> {
    let angle = |key, default| match section.has(key) {
        true => section.number(key),
        false => Some(default),
    };
    let orientation = Orientation {
        dip: angle("dip", 0.0)?,
        dip_direction: angle("dip_direction", 90.0)?,
    };
    let (strike, fall) = orientation.strike_and_fall();
    Some(DMat3::from_cols(fall, strike, orientation.pole()))
}
