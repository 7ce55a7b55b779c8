//! What a scene says of a fluid: what it is, how fractures conduct it, what drives it.

use glam::DVec3;
use kluft_solver::{Conduit, Fluid, Leakoff};

use crate::drive::{DriveEntry, PressureEntry, read_drive, read_pressure};
use crate::field::{FieldEntry, InTime, Value, read_value};
use crate::history::LoadHistory;
use crate::load::{Scaled, read_history};
use crate::reader::Section;
use crate::setting::{FluidUse, Setting};

/// Where fluid is driven inside the body.
#[derive(Debug, Clone, PartialEq)]
pub enum SourcePlace {
    /// A borehole through a fracture.
    At {
        /// Where (m).
        at: DVec3,
        /// Its radius (m).
        radius: f64,
    },
    /// A borehole through every fracture that it crosses.
    Along {
        /// Where it begins (m).
        from: DVec3,
        /// Where it ends (m).
        to: DVec3,
        /// Its radius (m).
        radius: f64,
    },
    /// All of a fracture of this name.
    Fracture(String),
    /// Along a curve of the mesh of this name, within fractures.
    Curve(String),
    /// Along straight lines between points (m), within fractures.
    Points(Vec<DVec3>),
}

/// What drives fluid inside the body.
#[derive(Debug, Clone)]
pub struct SourceEntry {
    /// Where it is.
    pub place: SourcePlace,
    /// What it does.
    pub drive: DriveEntry,
    /// How that changes with time.
    pub history: Option<LoadHistory>,
}

/// What leaks off from a fracture.
#[derive(Debug, Clone)]
pub struct LeakoffEntry {
    /// What the flow has of it.
    pub leakoff: Leakoff,
    /// Carter's coefficient, if it varies.
    pub field: Option<Box<FieldEntry>>,
}

/// Keys of a fracture that speak of the fluid.
pub(crate) const OF_FRACTURES: [&str; 7] = [
    "hydraulic_aperture",
    "residual_hydraulic_aperture",
    "roughness",
    "joint_roughness",
    "leakoff",
    "exposed_at",
    "sealed",
];

/// Whether a fluid flows in a scene, and in what rock: in rigid rock if no rock has a Young's
/// modulus.
pub(crate) fn fluid_use(root: &Section<'_, '_>) -> FluidUse {
    if !root.has("fluid") {
        return FluidUse::None;
    }
    let rocks = root.section("rock");
    let mut rocks = rocks.iter().flat_map(|rocks| rocks.table().iter());
    let deforms = rocks.any(|(_, rock)| {
        let keys = rock.get_ref().as_table();
        let moduli = ["young_modulus", "young_moduli"];
        keys.is_some_and(|keys| moduli.iter().any(|key| keys.get(*key).is_some()))
    });
    match deforms {
        true => FluidUse::InElasticRock,
        false => FluidUse::InRigidRock,
    }
}

/// A fluid and its state before any load.
#[derive(Debug, Clone)]
pub struct FluidEntry {
    /// The fluid.
    pub fluid: Fluid,
    /// Pressure before any load (Pa).
    pub initial_pressure: PressureEntry,
}

/// Reads the fluid.
pub(crate) fn read_fluid(section: Section<'_, '_>, gravity: DVec3) -> Option<FluidEntry> {
    section.require("viscosity");
    if gravity != DVec3::ZERO {
        section.require("density");
    }
    let viscosity = section.number("viscosity");
    let density = section.number("density");
    let compressibility = section.number("compressibility");
    let initial_pressure = read_pressure(&section, "initial_pressure", InTime::Never);
    section.finish();
    Some(FluidEntry {
        fluid: Fluid {
            viscosity: viscosity?,
            density: density.unwrap_or(0.0),
            compressibility: compressibility.unwrap_or(0.0),
        },
        initial_pressure,
    })
}

/// Reads where a source is: by one of `at`, `from`, `fracture`, `curve` and `points`.
fn read_place(section: &Section<'_, '_>) -> Option<SourcePlace> {
    let given: Vec<&'static str> = ["at", "from", "fracture", "curve", "points"]
        .into_iter()
        .filter(|key| section.has(key))
        .collect();
    if let [first, second, ..] = given[..] {
        let problem = format!("both {first} and {second} are given");
        let remedy = "keep one: a place, a borehole from and to, a fracture, a curve, or points";
        section.refuse(second, problem, remedy);
    }
    if section.has("to") && !section.has("from") {
        let remedy = "add from: where the borehole begins";
        section.refuse("to", "to is given, but not from".into(), remedy);
    }
    if section.has("fracture") {
        return section
            .text("fracture")
            .map(|name| SourcePlace::Fracture(name.to_owned()));
    }
    if section.has("curve") {
        return section
            .text("curve")
            .map(|name| SourcePlace::Curve(name.to_owned()));
    }
    if section.has("points") {
        return read_points(section);
    }
    section.require("radius");
    let radius = section.number("radius");
    if !section.has("from") {
        section.require("at");
        let at = section.vector("at");
        return Some(SourcePlace::At {
            at: at?.into(),
            radius: radius?,
        });
    }
    section.require("to");
    let (from, to) = (section.vector("from"), section.vector("to"));
    if from.is_some() && from == to {
        let remedy = "let it end elsewhere, or write at = [...] for one place";
        section.refuse("to", "the borehole has no length".into(), remedy);
    }
    Some(SourcePlace::Along {
        from: from?.into(),
        to: to?.into(),
        radius: radius?,
    })
}

/// Reads the points of a line.
fn read_points(section: &Section<'_, '_>) -> Option<SourcePlace> {
    let points: Vec<DVec3> = section
        .vectors("points")?
        .into_iter()
        .map(DVec3::from)
        .collect();
    let has_length = points.windows(2).all(|pair| pair[0] != pair[1]);
    if points.len() < 2 || !has_length {
        let problem = "the points make no line".into();
        let remedy = "give two or more places that differ, e.g. [[0, 0, 0], [1, 0, 0]]";
        section.refuse("points", problem, remedy);
        return None;
    }
    Some(SourcePlace::Points(points))
}

/// Reads what drives fluid inside the body.
pub(crate) fn read_source(section: &Section<'_, '_>, setting: Setting) -> Option<SourceEntry> {
    refuse_without_fluid(section, setting, &["rate", "pressure"]);
    let place = read_place(section);
    let drive = read_drive(section, ["pressure", "rate"], setting.clock);
    if drive.is_none() {
        section.require("rate");
    }
    let scaled = Scaled {
        is_there: section.has("rate") || section.has("pressure"),
        what: "a rate or a pressure",
    };
    let history = read_history(section, setting.clock, scaled);
    Some(SourceEntry {
        place: place?,
        drive: drive?,
        history,
    })
}

/// Reads what drives the fluid at a part of the outer surface.
pub(crate) fn read_boundary_fluid(
    section: &Section<'_, '_>,
    setting: Setting,
) -> Option<DriveEntry> {
    let keys = ["fluid_pressure", "fluid_inflow"];
    refuse_without_fluid(section, setting, &keys);
    read_drive(section, keys, setting.clock)
}

/// Reads what leaks off from a fracture; none if nothing does.
pub(crate) fn read_leakoff(
    section: &Section<'_, '_>,
    conduit: Option<Conduit>,
) -> Option<LeakoffEntry> {
    let coefficient = read_value(section, "leakoff", InTime::Never);
    let exposed = section.number("exposed_at");
    if section.has("exposed_at") && !section.has("leakoff") {
        let problem = "exposed_at is given, but nothing leaks off".into();
        section.refuse("exposed_at", problem, "add leakoff = 1e-5 (m/s^0.5)");
    }
    let is_open = matches!(conduit, Some(Conduit::Open(_)));
    let (coefficient, field) = match coefficient? {
        Value::Number(number) => (number, None),
        Value::Varying(entry) => (1.0, Some(entry)),
    };
    let leakoff = Leakoff {
        coefficient,
        varying: field.as_ref().map(|entry| entry.field.clone()),
        exposed: exposed.unwrap_or(0.0),
    };
    (is_open && leakoff.coefficient > 0.0).then_some(LeakoffEntry { leakoff, field })
}

pub(crate) fn refuse_without_fluid(
    section: &Section<'_, '_>,
    setting: Setting,
    keys: &[&'static str],
) {
    for &key in keys.iter().filter(|key| section.has(key)) {
        if setting.fluid == FluidUse::None {
            section.refuse(
                key,
                format!("`{key}` is given, but there is no [fluid]"),
                "add [fluid] with viscosity = 1e-3 (Pa s), or remove it",
            );
        }
    }
}
