//! Sets of fractures: listed or random, with the material they share.

use std::path::Path;

use kluft_mesh::Defect;
use kluft_network::{
    Amount, ApertureLaw, Domain, DrawnFracture, Fisher, FractureShape, Grouping, InputFracture,
    SizeLaw, StochasticSet, check_name, read_list,
};

use super::apertures::read_aperture_law;
use super::keys::{read_orientation, read_seed, read_sides, read_text};
use super::passages::{Passage, passage};
use kluft_scene::reader::{Section, Source};
use kluft_scene::{Setting, read_fracture};

/// A set of fractures.
pub(super) struct Set {
    pub(super) name: String,
    /// Its material as keys and values; none if the input has no word on it.
    pub(super) material: Option<Passage>,
    /// How wide its fractures are for a fluid, by their size.
    pub(super) aperture_law: Option<ApertureLaw>,
    /// The random part of it, as asked and as drawn.
    pub(super) drawn: Option<(StochasticSet, Vec<DrawnFracture>)>,
}

impl Set {
    /// A set of which nothing is known but its fractures, and how wide they are for water (m) if
    /// any flows.
    pub(super) fn listed(name: &str, hydraulic_aperture: Option<f64>) -> Self {
        let entry = |width: f64| vec![("hydraulic_aperture".to_owned(), format!("{width:?}"))];
        Self {
            name: name.to_owned(),
            material: hydraulic_aperture.map(entry),
            aperture_law: None,
            drawn: None,
        }
    }
}

type SetAndFractures = Option<(Set, Vec<InputFracture>)>;

/// Reads a set and draws its fractures; defects of the list it names are the error.
pub(super) fn read_set(
    (source, setting): (&Source<'_>, Setting),
    section: Section<'_, '_>,
    name: String,
    folder: &Path,
    seed: u64,
    domain: Option<Domain>,
) -> Result<SetAndFractures, Vec<Defect>> {
    if let Err((problem, remedy)) = check_name(&name) {
        source.report(&section.at, problem, remedy);
    }
    let aperture_law = read_fractures_of_set(&section, setting);
    let list = section.text("list").map(|list| folder.join(list));
    let is_random = ["p32", "count", "orientation", "size"]
        .into_iter()
        .any(|key| section.has(key));
    if list.is_some() && is_random {
        let remedy = "make two sets of it, one with the list and one at random";
        section.refuse(
            "list",
            format!("{} is listed and random", section.title),
            remedy,
        );
    }
    let asked = is_random
        .then(|| read_random(&section, &name, seed))
        .flatten();
    // The other keys are its material.
    let own = kluft_keys::network::FRACTURE_SET.keys.iter();
    let own: Vec<&str> = own.map(|key| key.name).collect();
    let material = passage(section.table(), &own);
    let place = section.place();
    let refuse = |(problem, remedy): (String, String)| source.report(&section.at, problem, remedy);
    let drawn = match (asked, domain) {
        (Some(asked), Some(domain)) => {
            let drawn = asked.draw(&domain).map_err(refuse).ok();
            drawn.map(|drawn| (asked, drawn))
        }
        _ => None,
    };
    section.finish();
    let given = match &list {
        Some(list) => {
            let text = read_text(list, "paths are relative to the folder of the description")?;
            read_list(&text, &list.display().to_string(), &name, true)?
        }
        None => drawn
            .as_ref()
            .map_or(Vec::new(), |(_, drawn)| named(drawn, &name, &place)),
    };
    let set = Set {
        name,
        material: Some(material),
        aperture_law,
        drawn,
    };
    Ok(Some((set, given)))
}

/// Reads what a set says of its fractures, and the law of their apertures if it has one.
fn read_fractures_of_set(section: &Section<'_, '_>, setting: Setting) -> Option<ApertureLaw> {
    if section.has("hydraulic_aperture_law") {
        return read_aperture_law(section, setting);
    }
    read_fracture(section, setting);
    None
}

/// Fractures of one physical surface have one aperture.
pub(super) fn check_grouping(sets: &[Set], grouping: Grouping) -> Result<(), Vec<Defect>> {
    if grouping == Grouping::Fracture {
        return Ok(());
    }
    let with_law = sets.iter().filter(|set| set.aperture_law.is_some());
    let defects = with_law.map(|set| {
        Defect::new(
            format!("[fracture_set.{}]", set.name),
            "hydraulic_aperture_law needs a physical surface for each fracture, and --group set \
             gives one to each set",
            "leave out --group set",
        )
    });
    let defects: Vec<Defect> = defects.collect();
    match defects.is_empty() {
        true => Ok(()),
        false => Err(defects),
    }
}

/// The drawn fractures that reach the domain, numbered.
fn named(drawn: &[DrawnFracture], set: &str, place: &str) -> Vec<InputFracture> {
    let inside: Vec<&DrawnFracture> = drawn.iter().filter(|one| one.area_inside > 0.0).collect();
    let digits = inside.len().to_string().len();
    let numbered = inside.into_iter().zip(1..);
    numbered
        .map(|(one, number)| InputFracture {
            name: format!("{set}-{number:0digits$}"),
            set: set.to_owned(),
            place: place.to_owned(),
            polygon: one.polygon.clone(),
        })
        .collect()
}

fn read_random(section: &Section<'_, '_>, name: &str, seed: u64) -> Option<StochasticSet> {
    section.require("orientation");
    section.require("size");
    let orientation = section.section("orientation").and_then(read_fisher);
    let size = section.section("size").and_then(read_size);
    let shape = read_shape(section);
    let amount = read_amount(section);
    let own_seed = read_seed(section);
    Some(StochasticSet {
        name: name.to_owned(),
        orientation: orientation?,
        size: size?,
        shape: shape?,
        amount: amount?,
        seed: own_seed.unwrap_or(seed),
    })
}

fn read_fisher(section: Section<'_, '_>) -> Option<Fisher> {
    let mean = read_orientation(&section);
    section.require("kappa");
    let kappa = section.number("kappa");
    section.finish();
    Some(Fisher {
        mean: mean?,
        kappa: kappa?,
    })
}

fn read_size(section: Section<'_, '_>) -> Option<SizeLaw> {
    section.require("law");
    let number = |key: &'static str| {
        section.require(key);
        section.number(key)
    };
    let law = match section.choice("law") {
        Some("constant") => number("radius").map(|radius| SizeLaw::Constant { radius }),
        Some("power") => {
            let exponent = number("exponent");
            let bounds = number("min").zip(number("max"));
            exponent
                .zip(bounds)
                .map(|(exponent, (min, max))| SizeLaw::PowerLaw { exponent, min, max })
        }
        Some(_) => {
            let moments = number("mean").zip(number("sd"));
            let bounds = number("min").zip(number("max"));
            moments
                .zip(bounds)
                .map(|((mean, sd), (min, max))| SizeLaw::Lognormal { mean, sd, min, max })
        }
        None => return None,
    };
    let law = law.filter(|law| bounded(&section, law));
    section.finish();
    law
}

fn bounded(section: &Section<'_, '_>, law: &SizeLaw) -> bool {
    let (SizeLaw::PowerLaw { min, max, .. } | SizeLaw::Lognormal { min, max, .. }) = *law else {
        return true;
    };
    if min >= max {
        section.refuse(
            "max",
            format!("max {max} is not above min {min}"),
            "min and max enclose all sizes",
        );
    }
    min < max
}

fn read_shape(section: &Section<'_, '_>) -> Option<FractureShape> {
    if !section.has("shape") {
        return Some(FractureShape::Disc {
            sides: read_sides(section),
        });
    }
    match section.choice("shape")? {
        "disc" => Some(FractureShape::Disc {
            sides: read_sides(section),
        }),
        _ => {
            let aspect = section.number("aspect").unwrap_or(1.0);
            Some(FractureShape::Rectangle { aspect })
        }
    }
}

fn read_amount(section: &Section<'_, '_>) -> Option<Amount> {
    let p32 = section.number("p32");
    let count = section.number("count");
    match (section.has("p32"), section.has("count")) {
        (true, true) => {
            section.refuse(
                "count",
                "both p32 and count are given".into(),
                "keep one of them",
            );
            None
        }
        (false, false) => {
            section.require("p32");
            None
        }
        (true, false) => p32.map(Amount::P32),
        (false, true) => count.map(|count| Amount::Count(count as usize)),
    }
}
