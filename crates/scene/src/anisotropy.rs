//! Reads rock that is stiffer in some directions than in others.

use glam::DMat3;
use kluft_mesh::Orientation;
use lie_core::Orthotropy;

use crate::field::{FieldEntry, InTime, Value, read_components, read_value};
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

/// Constants of a rock that is not isotropic, as its section gives them.
#[derive(Debug, Clone)]
pub(crate) struct AnisotropicConstants {
    /// Whether they are `E, nu, E', nu', G'`; if not, three moduli, ratios and shear moduli.
    is_transverse: bool,
    /// Those, dip and dip direction (degrees); not numbers where they vary.
    numbers: Vec<f64>,
    /// Those that vary, by their index.
    fields: Vec<(usize, FieldEntry)>,
}

/// Why constants are no rock: the key to change, the problem and what helps.
pub(crate) struct NoRock {
    pub(crate) key: &'static str,
    pub(crate) problem: String,
    pub(crate) remedy: String,
}

impl AnisotropicConstants {
    fn of(is_transverse: bool, values: Vec<Value>) -> Self {
        let mut fields = Vec::new();
        let values = values.into_iter().enumerate();
        let numbers = values.map(|(index, value)| match value {
            Value::Number(number) => number,
            Value::Varying(entry) => {
                fields.push((index, *entry));
                f64::NAN
            }
        });
        Self {
            is_transverse,
            numbers: numbers.collect(),
            fields,
        }
    }

    /// Those that vary.
    pub(crate) fn fields(&self) -> impl Iterator<Item = &FieldEntry> {
        self.fields.iter().map(|(_, field)| field)
    }

    /// All of them with these values of what varies, in the order of [`Self::fields`].
    pub(crate) fn with(&self, values: &[f64]) -> Self {
        let mut own = self.clone();
        for ((index, _), value) in self.fields.iter().zip(values) {
            own.numbers[*index] = *value;
        }
        own
    }

    /// What they are along the axes of the rock.
    pub(crate) fn orthotropy(&self) -> Orthotropy {
        let n = &self.numbers[..];
        let three = |first: usize| [n[first], n[first + 1], n[first + 2]];
        match self.is_transverse {
            true => Orthotropy::transverse([n[0], n[2]], [n[1], n[3]], n[4], axes([n[5], n[6]])),
            false => Orthotropy {
                young_moduli: three(0),
                poisson_ratios: three(3),
                shear_moduli: three(6),
                axes: axes([n[9], n[10]]),
            },
        }
    }

    /// Why they are no rock, if they are none: all of them are numbers.
    pub(crate) fn refusal(&self) -> Option<NoRock> {
        let rock = self.orthotropy();
        if rock.is_positive_definite() {
            return None;
        }
        Some(match self.is_transverse {
            true => self.beyond_bound(),
            false => without_energy(&rock),
        })
    }

    fn beyond_bound(&self) -> NoRock {
        let n = &self.numbers[..];
        let (e, nu, across, nu_across) = (n[0], n[1], n[2], n[3]);
        let bound = (across / e * (1.0 - nu) / 2.0).sqrt();
        NoRock {
            key: "normal_poisson_ratio",
            problem: format!(
                "with a `normal_poisson_ratio` of {nu_across} some strains cost no energy"
            ),
            remedy: format!(
                "give less than sqrt(E'/E (1 - nu)/2) = {bound:.6}; a stress across the plane strains it by -nu'/E' of it"
            ),
        }
    }
}

fn without_energy(rock: &Orthotropy) -> NoRock {
    let [a, b, c] = rock.poisson_bounds();
    NoRock {
        key: "poisson_ratios",
        problem: "with these `poisson_ratios` some strains cost no energy".into(),
        remedy: format!(
            "nu_ij must be less than sqrt(E_i/E_j), [{a:.4}, {b:.4}, {c:.4}], and 1 - nu12 nu21 - nu23 nu32 - nu13 nu31 - 2 nu21 nu32 nu13 = {:.4e} more than 0, with nu_ji = nu_ij E_j/E_i",
            rock.definiteness()
        ),
    }
}

/// The constants of a rock with a plane of isotropy.
pub(crate) fn read_transverse(section: &Section<'_, '_>) -> Option<AnisotropicConstants> {
    let plain = ["young_modulus", "poisson_ratio"].into_iter();
    let keys: Vec<&'static str> = plain.chain(TRANSVERSE).collect();
    keys.iter().for_each(|key| section.require(key));
    let angles = read_angles(section);
    let values = keys.iter();
    let values: Vec<_> = values
        .map(|key| read_value(section, key, InTime::Never))
        .chain(angles)
        .collect();
    settled(section, true, values)
}

/// The constants of a rock with three axes.
pub(crate) fn read_orthotropic(section: &Section<'_, '_>) -> Option<AnisotropicConstants> {
    let others = ["young_modulus", "poisson_ratio"].into_iter();
    for key in others.chain(TRANSVERSE).filter(|key| section.has(key)) {
        section.refuse(
            key,
            format!("`{key}` has no meaning beside the constants of three axes"),
            format!("remove it, or `{}`", ORTHOTROPIC.join("`, `")),
        );
    }
    ORTHOTROPIC.iter().for_each(|key| section.require(key));
    let angles = read_angles(section);
    let triples = ORTHOTROPIC.map(|key| read_components(section, key, InTime::Never));
    let values = triples.into_iter().flat_map(|triple| match triple {
        Some(triple) => triple.map(Some),
        None => [None, None, None],
    });
    settled(section, false, values.chain(angles).collect())
}

/// Constants that are a rock, as far as they do not vary.
fn settled(
    section: &Section<'_, '_>,
    is_transverse: bool,
    values: Vec<Option<Value>>,
) -> Option<AnisotropicConstants> {
    let values: Option<Vec<Value>> = values.into_iter().collect();
    let constants = AnisotropicConstants::of(is_transverse, values?);
    if !constants.fields.is_empty() {
        return Some(constants);
    }
    match constants.refusal() {
        None => Some(constants),
        Some(no_rock) => {
            section.refuse(no_rock.key, no_rock.problem, no_rock.remedy);
            None
        }
    }
}

/// Dip and dip direction (degrees).
fn read_angles(section: &Section<'_, '_>) -> [Option<Value>; 2] {
    [("dip", 0.0), ("dip_direction", 90.0)].map(|(key, default)| match section.has(key) {
        true => read_value(section, key, InTime::Never),
        false => Some(Value::Number(default)),
    })
}

/// Axes down the dip, along the strike and across the plane, for dip and dip direction (degrees).
fn axes([dip, dip_direction]: [f64; 2]) -> DMat3 {
    let orientation = Orientation { dip, dip_direction };
    let (strike, fall) = orientation.strike_and_fall();
    DMat3::from_cols(fall, strike, orientation.pole())
}
