//! Reads what a network is to be made of.

use std::path::{Path, PathBuf};

use glam::DVec3;
use kluft_keys::Document;
use kluft_mesh::Defect;
use kluft_network::{
    CellSizes, Domain, InputFracture, Outline, Polygon, check_name, read_foreign_list, read_list,
    repeated_names,
};

use super::keys::{read_orientation, read_seed, read_sides, read_text};
use super::passages::{Passages, passages};
use super::sets::{Set, read_set};
use kluft_scene::reader::{Section, Source};
use kluft_scene::{FluidUse, check_conditions};

/// What the command line says.
pub(super) struct Overrides {
    pub(super) domain: Option<Domain>,
    pub(super) h: Option<f64>,
    pub(super) keep_small: bool,
    pub(super) hydraulic_aperture: Option<f64>,
}

/// What a network is made of.
pub(super) struct Input {
    pub(super) title: String,
    pub(super) domain: Domain,
    /// The geometry of the rock, if it is not all of the box.
    pub(super) body: Option<PathBuf>,
    pub(super) sizes: CellSizes,
    pub(super) sets: Vec<Set>,
    pub(super) given: Vec<InputFracture>,
    /// Whether a fluid flows, and in what rock.
    pub(super) fluid: FluidUse,
    /// Sections for the scene, as the input has them.
    pub(super) passages: Passages,
    /// What was assumed because nobody said it, one line each.
    pub(super) assumptions: Vec<String>,
}

impl Input {
    /// Reads a list or a description, going by the ending of its name.
    pub(super) fn read(file: &Path, overrides: &Overrides) -> Result<Self, Vec<Defect>> {
        let name = file.display().to_string();
        let text = read_text(
            file,
            "give the path of a list (.csv) or a description (.toml)",
        )?;
        match file.extension().and_then(|ending| ending.to_str()) {
            Some("csv" | "dat") => Self::from_list(&text, &name, overrides),
            Some("toml") if overrides.hydraulic_aperture.is_some() => Err(vec![Defect::new(
                name,
                "--hydraulic-aperture is for lists, and this is a description",
                "write [fluid] and hydraulic_aperture under [fracture_set.NAME]",
            )]),
            Some("toml") => Self::from_description(&text, &name, file, overrides),
            _ => Err(vec![Defect::new(
                name,
                "the name ends neither in .csv or .dat nor in .toml",
                "give a list of fractures as FILE.csv, or a description as FILE.toml",
            )]),
        }
    }

    fn from_list(text: &str, name: &str, overrides: &Overrides) -> Result<Self, Vec<Defect>> {
        const SET: &str = "fractures";
        let mut assumptions = Vec::new();
        let (given, own) = match read_foreign_list(text, name, SET) {
            None => (read_list(text, name, SET, false)?, None),
            Some(list) => {
                let list = list?;
                assumptions.push(format!("a list of {}", list.program));
                (list.fractures, list.domain)
            }
        };
        let domain = overrides
            .domain
            .or(own)
            .or_else(|| around(&given, &mut assumptions))
            .ok_or_else(|| {
                vec![Defect::new(
                    name,
                    "the list holds no fracture",
                    "add one line for each fracture",
                )]
            })?;
        let h = overrides.h.unwrap_or_else(|| {
            let h = rounded((domain.high - domain.low).min_element() / 10.0);
            assumptions.push(format!(
                "cells of {h} m, a tenth of the shortest side; --h sets it"
            ));
            h
        });
        let mut sets: Vec<Set> = Vec::new();
        for fracture in &given {
            if sets.iter().all(|set| set.name != fracture.set) {
                sets.push(Set::listed(&fracture.set, overrides.hydraulic_aperture));
            }
        }
        let is_wet = overrides.hydraulic_aperture.is_some();
        Ok(Self {
            title: "Fracture network".into(),
            domain,
            body: None,
            sizes: sizes(h, None, None, overrides),
            sets,
            given,
            fluid: match is_wet {
                true => FluidUse::InRigidRock,
                false => FluidUse::None,
            },
            passages: match is_wet {
                true => Passages::of_water(),
                false => Passages::default(),
            },
            assumptions,
        })
    }

    fn from_description(
        text: &str,
        name: &str,
        file: &Path,
        overrides: &Overrides,
    ) -> Result<Self, Vec<Defect>> {
        let source = Source::new(name, text, Document::Network);
        let folder = file.parent().unwrap_or(Path::new("."));
        let table = source.parse();
        let mut more = Vec::new();
        let input = table.as_ref().and_then(|table| {
            let root = Section::root(&source, table.get_ref());
            let input = read_description(&source, &root, folder, overrides, &mut more);
            root.finish();
            input
        });
        let mut defects = source.into_defects();
        defects.append(&mut more);
        match input {
            Some(input) if defects.is_empty() => Ok(input),
            _ => Err(defects),
        }
    }
}

/// A box around all fractures, a quarter of their extent larger on each side.
fn around(given: &[InputFracture], assumptions: &mut Vec<String>) -> Option<Domain> {
    let start = given.first()?.polygon.bounds();
    let widen = |(low, high): (DVec3, DVec3), fracture: &InputFracture| {
        let (a, b) = fracture.polygon.bounds();
        (low.min(a), high.max(b))
    };
    let (low, high) = given.iter().fold(start, widen);
    let margin = rounded((high - low).max_element() / 4.0);
    // Whole margins make coordinates that a person can read.
    let domain = Domain {
        low: ((low - margin) / margin).floor() * margin,
        high: ((high + margin) / margin).ceil() * margin,
    };
    assumptions.push(format!(
        "the domain from {} to {}; --domain sets it",
        domain.low, domain.high
    ));
    Some(domain)
}

/// One significant digit.
fn rounded(value: f64) -> f64 {
    format!("{value:.0e}").parse().unwrap_or(value)
}

fn sizes(
    h: f64,
    h_fracture: Option<f64>,
    h_intersection: Option<f64>,
    overrides: &Overrides,
) -> CellSizes {
    let h_fracture = h_fracture.unwrap_or(h / 2.0).min(h);
    CellSizes {
        h,
        h_fracture,
        h_intersection: h_intersection.unwrap_or(h_fracture).min(h_fracture),
        growth: 0.5,
        small: 0.2,
        small_angle: 10.0,
        snap: !overrides.keep_small,
    }
}

fn read_description(
    source: &Source<'_>,
    root: &Section<'_, '_>,
    folder: &Path,
    overrides: &Overrides,
    defects: &mut Vec<Defect>,
) -> Option<Input> {
    let setting = check_conditions(source, root);
    let (domain, body) = read_domain(root, folder, overrides.domain);
    let sizes = read_sizes(root, overrides);
    let seed = read_seed(root).unwrap_or(0);
    root.require("fracture_set");
    let mut sets = Vec::new();
    let mut given = Vec::new();
    for (name, section) in root.named_sections("fracture_set") {
        let read = read_set((source, setting), section, name, folder, seed, domain);
        match read {
            Ok(Some((set, mut fractures))) => {
                sets.push(set);
                given.append(&mut fractures);
            }
            Ok(None) => {}
            Err(mut found) => defects.append(&mut found),
        }
    }
    let names: Vec<String> = root
        .named_sections("fracture_set")
        .into_iter()
        .map(|(name, _)| name)
        .collect();
    for section in root.listed_sections("fracture") {
        given.extend(read_fracture(section, &names));
    }
    repeated_names(&given, defects);
    Some(Input {
        title: root.text("title").unwrap_or("Fracture network").to_owned(),
        domain: domain?,
        body,
        sizes: sizes?,
        sets,
        given,
        fluid: setting.fluid,
        passages: passages(root),
        assumptions: Vec::new(),
    })
}

/// The domain of the description, or that of the command line in its place, and the geometry of
/// the rock in it.
fn read_domain(
    root: &Section<'_, '_>,
    folder: &Path,
    wished: Option<Domain>,
) -> (Option<Domain>, Option<PathBuf>) {
    if wished.is_none() {
        root.require("domain");
    }
    let Some(section) = root.section("domain") else {
        return (wished, None);
    };
    section.require("low");
    section.require("high");
    let corners = section.vector("low").zip(section.vector("high"));
    let domain = corners.map(|(low, high)| Domain::between(low, high));
    let is_box = domain.is_none_or(|domain| (domain.high - domain.low).min_element() > 0.0);
    if !is_box {
        let remedy = "high must be above low in every coordinate";
        section.refuse("high", "the domain has no volume".into(), remedy);
    }
    let body = section.text("geometry").map(|name| folder.join(name));
    if let Some(missing) = body.as_ref().filter(|body| !body.is_file()) {
        let problem = format!("there is no file {}", missing.display());
        let remedy = "give the path of a gmsh geometry (.geo), relative to this description";
        section.refuse("geometry", problem, remedy);
    }
    section.finish();
    (wished.or(domain.filter(|_| is_box)), body)
}

fn read_sizes(root: &Section<'_, '_>, overrides: &Overrides) -> Option<CellSizes> {
    if overrides.h.is_none() {
        root.require("mesh");
    }
    let Some(section) = root.section("mesh") else {
        return overrides.h.map(|h| sizes(h, None, None, overrides));
    };
    if overrides.h.is_none() {
        section.require("h");
    }
    let number = |key| section.number(key);
    let (h, h_fracture, h_intersection) =
        (number("h"), number("h_fracture"), number("h_intersection"));
    let (growth, small) = (number("growth"), section.number("small"));
    let small_angle = section.number("small_angle");
    let snap = section.flag("mend").unwrap_or(true);
    for (key, fine, coarse) in [
        ("h_fracture", h_fracture, h),
        ("h_intersection", h_intersection, h_fracture.or(h)),
    ] {
        if let (None, Some(fine), Some(coarse)) = (overrides.h, fine, coarse)
            && fine > coarse
        {
            let remedy = "cells become finer towards fractures: h >= h_fracture >= h_intersection";
            section.refuse(
                key,
                format!("{key} = {fine} is coarser than {coarse}"),
                remedy,
            );
        }
    }
    section.finish();
    let plain = sizes(overrides.h.or(h)?, h_fracture, h_intersection, overrides);
    Some(CellSizes {
        growth: growth.unwrap_or(plain.growth),
        small: small.unwrap_or(plain.small),
        small_angle: small_angle.unwrap_or(plain.small_angle),
        snap: plain.snap && snap,
        ..plain
    })
}

fn read_fracture(section: Section<'_, '_>, sets: &[String]) -> Option<InputFracture> {
    section.require("name");
    section.require("set");
    let name = section.text("name").map(str::to_owned);
    let set = section.text("set").map(str::to_owned);
    if let Some(Err((problem, remedy))) = name.as_deref().map(check_name) {
        section.refuse("name", problem, remedy);
    }
    if let Some(set) = set
        .as_deref()
        .filter(|set| sets.iter().all(|known| known != set))
    {
        let known = sets.iter().map(String::as_str);
        let remedy = kluft_mesh::nearest(set, known).map_or_else(
            || format!("add a section [fracture_set.{set}]"),
            |near| format!("did you mean \"{near}\"?"),
        );
        section.refuse("set", format!("there is no set \"{set}\""), remedy);
    }
    let polygon = read_polygon(&section);
    let place = section.place();
    section.finish();
    Some(InputFracture {
        name: name?,
        set: set?,
        place,
        polygon: polygon?,
    })
}

fn read_polygon(section: &Section<'_, '_>) -> Option<Polygon> {
    section.require("shape");
    let outline = match section.choice("shape")? {
        "polygon" => {
            section.require("points");
            let corners: Vec<DVec3> = section
                .vectors("points")?
                .into_iter()
                .map(DVec3::from)
                .collect();
            let refuse =
                |(problem, remedy): (String, String)| section.refuse("points", problem, remedy);
            return Polygon::through(&corners).map_err(refuse).ok();
        }
        "disc" => read_disc(section),
        "ellipse" => read_ellipse(section),
        _ => read_rectangle(section),
    };
    section.require("centre");
    let (centre, orientation) = (section.vector("centre"), read_orientation(section));
    Some(Polygon::placed(outline?, centre?.into(), orientation?))
}

fn read_length(section: &Section<'_, '_>, key: &'static str) -> Option<f64> {
    section.require(key);
    section.number(key)
}

fn read_rotation(section: &Section<'_, '_>) -> f64 {
    section.number("rotation").unwrap_or(0.0)
}

fn read_disc(section: &Section<'_, '_>) -> Option<Outline> {
    let (radius, sides, rotation) = (
        read_length(section, "radius"),
        read_sides(section),
        read_rotation(section),
    );
    Some(Outline::Disc {
        radius: radius?,
        sides,
        rotation,
    })
}

fn read_ellipse(section: &Section<'_, '_>) -> Option<Outline> {
    let (semi_major, semi_minor) = (
        read_length(section, "semi_major"),
        read_length(section, "semi_minor"),
    );
    let (rotation, sides) = (read_rotation(section), read_sides(section));
    Some(Outline::Ellipse {
        semi_major: semi_major?,
        semi_minor: semi_minor?,
        rotation,
        sides,
    })
}

fn read_rectangle(section: &Section<'_, '_>) -> Option<Outline> {
    let (length, width) = (
        read_length(section, "length"),
        read_length(section, "width"),
    );
    Some(Outline::Rectangle {
        length: length?,
        width: width?,
        rotation: read_rotation(section),
    })
}

#[cfg(test)]
mod tests;
