//! What drives a fluid: pressures and rates, numbers or values that vary.

use glam::DVec3;
use kluft_solver::{Field, FlowDrive, Profile};

use crate::field::{FieldEntry, InTime, Value, read_value};
use crate::history::{LoadHistory, StepEnd, moments};
use crate::load::Clock;
use crate::profile::{read_profile_or_field, says};
use crate::reader::Section;

/// What drives the fluid somewhere.
#[derive(Debug, Clone)]
pub struct DriveEntry {
    /// A pressure or a rate; if it changes with time 1 Pa or 1 m^3/s. Without meaning where there
    /// is a water table.
    pub drive: FlowDrive,
    /// Its values (Pa or m^3/s), if they vary by more than the elevation.
    pub field: Option<Box<FieldEntry>>,
    /// Elevation below which the fluid rests (m), where its pressure is given so.
    pub water_table: Option<f64>,
}

impl DriveEntry {
    /// The same pressure everywhere (Pa).
    pub(crate) fn of_constant(pressure: f64) -> Self {
        Self::of_pressure(PressureEntry {
            pressure: Field::constant(pressure),
            ..PressureEntry::default()
        })
    }

    /// A pressure that varies.
    pub(crate) fn of_field(entry: Box<FieldEntry>) -> Self {
        Self::of_pressure(PressureEntry {
            pressure: entry.field.clone(),
            field: Some(*entry),
            water_table: None,
        })
    }

    /// A pressure.
    pub(crate) fn of_pressure(given: PressureEntry) -> Self {
        let in_time = given
            .field
            .as_ref()
            .is_some_and(|entry| entry.field.depends_on_time());
        let pressure = match in_time {
            true => Field::constant(1.0),
            false => given.pressure,
        };
        Self {
            drive: FlowDrive::Pressure(pressure),
            field: given.field.map(Box::new),
            water_table: given.water_table,
        }
    }

    /// A rate.
    fn of_rate(value: Value) -> Self {
        let (rate, field) = match value {
            Value::Number(rate) => (rate, None),
            Value::Varying(entry) if entry.field.depends_on_time() => (1.0, Some(entry)),
            Value::Varying(entry) => (entry.field.at(DVec3::ZERO, 0.0), Some(entry)),
        };
        Self {
            drive: FlowDrive::Rate(rate),
            field,
            water_table: None,
        }
    }

    /// Its values, if they change with time.
    pub(crate) fn in_time(&self) -> Option<&FieldEntry> {
        let field = self.field.as_deref();
        field.filter(|entry| entry.field.depends_on_time())
    }

    /// Its values, if they vary but not with time.
    pub(crate) fn in_space(&self) -> Option<&FieldEntry> {
        let field = self.field.as_deref();
        field.filter(|entry| !entry.field.depends_on_time())
    }

    /// The factor on it: its history, times values that change with time, which are linear between
    /// the ends of the load steps.
    pub(crate) fn course(
        &self,
        history: Option<&LoadHistory>,
        ends: &[StepEnd],
    ) -> Option<LoadHistory> {
        let Some(entry) = self.in_time() else {
            return history.cloned();
        };
        let scaled = |time: f64| {
            let factor = history.map_or(1.0, |own| own.at(time));
            [time, factor * entry.field.at(DVec3::ZERO, time)]
        };
        Some(LoadHistory {
            points: moments(ends).map(scaled).collect(),
        })
    }

    /// It for the weight of the fluid along z (Pa/m), which is negative downwards.
    pub(crate) fn resolved(&self, weight: f64) -> FlowDrive {
        match self.water_table {
            Some(level) => FlowDrive::Pressure(resting(level, weight)),
            None => self.drive.clone(),
        }
    }
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
        match self.water_table {
            Some(level) => resting(level, weight),
            None => self.pressure.clone(),
        }
    }
}

/// Pressures (Pa) of a fluid that rests below an elevation (m).
fn resting(level: f64, weight: f64) -> Field {
    Field::from(Profile {
        at: level,
        value: 0.0,
        per_metre: weight,
    })
}

/// Reads a pressure of a fluid.
pub(crate) fn read_pressure(
    section: &Section<'_, '_>,
    key: &'static str,
    in_time: InTime,
) -> PressureEntry {
    let water_table = read_water_table(section, key);
    if water_table.is_some() {
        return PressureEntry {
            water_table,
            ..PressureEntry::default()
        };
    }
    let (pressure, field) = read_profile_or_field(section, key, in_time);
    PressureEntry {
        pressure,
        field,
        water_table,
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
    let remedy = format!(
        "write {{ expression = \"9810 * ({:?} - y)\" }}, with the weight of the fluid (Pa/m)",
        level.unwrap_or(0.0)
    );
    value.refuse_in_plane("water_table", remedy);
    value.finish();
    level
}

/// Refuses keys that another one leaves without effect.
pub(crate) fn refuse_beside(section: &Section<'_, '_>, other: &str, keys: &[&'static str]) {
    for &key in keys.iter().filter(|key| section.has(key)) {
        let problem = format!("`{key}` has no effect beside {other}");
        section.refuse(key, problem, "keep one of them");
    }
}

/// Reads a pressure or a rate, by the names of their keys.
pub(crate) fn read_drive(
    section: &Section<'_, '_>,
    [pressure, rate]: [&'static str; 2],
    clock: Clock,
) -> Option<DriveEntry> {
    if section.has(pressure) && section.has(rate) {
        let problem = format!("both {pressure} and {rate} are given");
        let remedy = "keep one: where the pressure is given the rate follows from it";
        section.refuse(rate, problem, remedy);
    }
    let read_rate = || read_value(section, rate, InTime::By(clock)).map(DriveEntry::of_rate);
    if !section.has(pressure) {
        let read = read_rate();
        let field = read.as_ref().and_then(|read| read.field.as_deref());
        if field.is_some_and(|entry| entry.field.depends_on_place()) {
            section.refuse(
                rate,
                format!("`{rate}` is one rate in all, which varies with time alone"),
                "write an expression of time, or a table over = \"time\"",
            );
        }
        return read;
    }
    read_rate();
    let given = read_pressure(section, pressure, InTime::By(clock));
    refuse_both_ways(section, pressure, given.field.as_ref());
    Some(DriveEntry::of_pressure(given))
}

/// Refuses a pressure that drives a fluid and changes with time and from place to place.
pub(crate) fn refuse_both_ways(
    section: &Section<'_, '_>,
    key: &'static str,
    entry: Option<&FieldEntry>,
) {
    let both = |entry: &FieldEntry| entry.field.depends_on_time() && entry.field.depends_on_place();
    if entry.is_some_and(both) {
        let problem =
            format!("`{key}` drives a fluid and changes with time and from place to place");
        let remedy = "let it change with one of them; a history scales values that change from \
                      place to place";
        section.refuse(key, problem, remedy);
    }
}
