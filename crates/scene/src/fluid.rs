//! What a scene says of a fluid: what it is, how fractures conduct it, what drives it.

use glam::DVec3;
use kluft_solver::{Conduit, Field, FlowDrive, Fluid, Leakoff, Profile};

use crate::field::{FieldEntry, InTime, Value, read_value};
use crate::history::{LoadHistory, StepEnd};
use crate::load::{Scaled, read_history};
use crate::profile::{read_profile_or_field, says};
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
    pub drive: FlowDrive,
    /// The rate (m^3/s), if the time is in it; then `drive` is a rate of 1 m^3/s.
    pub rate: Option<Box<FieldEntry>>,
    /// How that changes with time.
    pub history: Option<LoadHistory>,
}

impl SourceEntry {
    /// The factor on what it does: its history, times a rate that the time is in, which is linear
    /// between the ends of the load steps.
    pub(crate) fn course(&self, ends: &[StepEnd]) -> Option<LoadHistory> {
        let Some(rate) = &self.rate else {
            return self.history.clone();
        };
        let scaled = |time: f64| {
            let factor = self.history.as_ref().map_or(1.0, |own| own.at(time));
            [time, factor * rate.field.at(DVec3::ZERO, time)]
        };
        let times = [0.0].into_iter().chain(ends.iter().map(|end| end.time));
        Some(LoadHistory {
            points: times.map(scaled).collect(),
        })
    }
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

/// The pressure of a fluid, as the scene gives it.
#[derive(Debug, Clone, Default)]
pub struct PressureEntry {
    /// Its values (Pa); without meaning where there is a water table.
    pub pressure: Field,
    /// The same, if it varies by more than the elevation.
    pub field: Option<FieldEntry>,
    /// Elevation below which the fluid rests (m), where its pressure is given so.
    pub water_table: Option<f64>,
}

impl PressureEntry {
    /// The values (Pa) for the weight of the fluid along z (Pa/m), which is negative downwards.
    pub(crate) fn resolved(&self, weight: f64) -> Field {
        let resting = |level| {
            Field::from(Profile {
                at: level,
                value: 0.0,
                per_metre: weight,
            })
        };
        self.water_table
            .map_or_else(|| self.pressure.clone(), resting)
    }
}

/// Reads the elevation below which a fluid rests (m), if a pressure is given so.
fn read_water_table(section: &Section<'_, '_>, name: &'static str) -> Option<f64> {
    if section.is_word(name, "hydrostatic") {
        let problem = format!("`{name}` is hydrostatic, but from which elevation on?");
        let remedy = format!("write {name} = {{ water_table = 0.0 }}, where the pressure is 0 (m)");
        section.refuse(name, problem, remedy);
        return Some(0.0);
    }
    if !says(section, name, &["water_table"]) {
        return None;
    }
    let value = section.section(name)?;
    let forms = ["value", "per_metre", "at", "table", "expression", "file"];
    refuse_beside(&value, "water_table", &forms);
    let level = value.number("water_table");
    value.finish();
    level
}

fn read_pressure(section: &Section<'_, '_>, key: &'static str) -> PressureEntry {
    let water_table = read_water_table(section, key);
    if water_table.is_some() {
        return PressureEntry {
            water_table,
            ..PressureEntry::default()
        };
    }
    let (pressure, field) = read_profile_or_field(section, key);
    PressureEntry {
        pressure,
        field,
        water_table,
    }
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
    let initial_pressure = read_pressure(&section, "initial_pressure");
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
    let constant = || Field::constant(section.number("pressure").unwrap_or(0.0));
    let (drive, rate) = match section.is_table("rate") && !section.has("pressure") {
        true => (Some(FlowDrive::Rate(1.0)), read_rate(section, setting)),
        false => (read_drive(section, ["pressure", "rate"], constant), None),
    };
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
        rate,
        history,
    })
}

/// A rate that changes with time; all that a source feeds has one.
fn read_rate(section: &Section<'_, '_>, setting: Setting) -> Option<Box<FieldEntry>> {
    let value = read_value(section, "rate", InTime::By(setting.clock));
    let Some(Value::Varying(entry)) = value else {
        return None;
    };
    if entry.field.depends_on_place() {
        section.refuse(
            "rate",
            "a source has one rate, which varies with time alone".into(),
            "write an expression of time, or a table over = \"time\"",
        );
    }
    Some(entry)
}

/// Reads what drives the fluid at a part of the outer surface, and how its pressure is given.
pub(crate) fn read_boundary_fluid(
    section: &Section<'_, '_>,
    setting: Setting,
) -> (Option<FlowDrive>, PressureEntry) {
    let keys = ["fluid_pressure", "fluid_inflow"];
    refuse_without_fluid(section, setting, &keys);
    let mut given = PressureEntry::default();
    let drive = read_drive(section, keys, || {
        given = read_pressure(section, "fluid_pressure");
        given.pressure.clone()
    });
    (drive, given)
}

/// A pressure or a rate.
fn read_drive(
    section: &Section<'_, '_>,
    [pressure, rate]: [&'static str; 2],
    read_pressure: impl FnOnce() -> Field,
) -> Option<FlowDrive> {
    if section.has(pressure) && section.has(rate) {
        let problem = format!("both {pressure} and {rate} are given");
        let remedy = "keep one: where the pressure is given the rate follows from it";
        section.refuse(rate, problem, remedy);
    }
    if !section.has(pressure) {
        return section.number(rate).map(FlowDrive::Rate);
    }
    section.number(rate);
    Some(FlowDrive::Pressure(read_pressure()))
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

/// Refuses keys that another one leaves without effect.
pub(crate) fn refuse_beside(section: &Section<'_, '_>, other: &str, keys: &[&'static str]) {
    for &key in keys.iter().filter(|key| section.has(key)) {
        let problem = format!("`{key}` has no effect beside {other}");
        section.refuse(key, problem, "keep one of them");
    }
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
