//! Reads values that vary: tables, expressions and files of samples.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use kluft_field::{Beyond, Coordinate, Expression, Field, Method, SampleFile, Samples, Table};
use kluft_io::import::read_values;
use kluft_keys::{Quantity, read_quantity};
use kluft_mesh::Defect;

use crate::load::Clock;
use crate::reader::Section;

/// A value that varies, and what is asked of it.
#[derive(Debug, Clone)]
pub struct FieldEntry {
    /// Its values in SI units, angles in degrees.
    pub field: Field,
    /// File, line and section.
    pub place: String,
    /// How messages call its section.
    pub title: String,
    /// The key that it stands under.
    pub key: &'static str,
    /// Which values are accepted.
    pub quantity: Quantity,
    /// Where the values come from, for messages.
    pub origin: String,
    /// The file that they come from.
    pub file: Option<PathBuf>,
    /// Largest distance from a sample (m).
    pub reach: Option<f64>,
}

/// A number, or a value that varies.
#[derive(Debug, Clone)]
pub(crate) enum Value {
    Number(f64),
    Varying(Box<FieldEntry>),
}

/// Whether a value may change with time.
#[derive(Debug, Clone, Copy)]
pub(crate) enum InTime {
    /// As a load does, if the load steps have times.
    By(Clock),
    /// What it belongs to does not.
    Never,
}

/// Where a value stands, and what its numbers must be.
struct Wanted {
    key: &'static str,
    quantity: Quantity,
    in_time: InTime,
}

/// Reads a number or a value that varies.
pub(crate) fn read_value(
    section: &Section<'_, '_>,
    key: &'static str,
    in_time: InTime,
) -> Option<Value> {
    if !section.is_table(key) {
        return section.number(key).map(Value::Number);
    }
    let quantity = section.quantity(key);
    read_field(section.section(key)?, (key, quantity), in_time)
}

/// Reads the three components of a vector, numbers or values that vary.
pub(crate) fn read_components(
    section: &Section<'_, '_>,
    key: &'static str,
    in_time: InTime,
) -> Option<[Value; 3]> {
    if !section.has_table_in(key) {
        return section.vector(key).map(|vector| vector.map(Value::Number));
    }
    let quantity = section.quantity(key);
    let entries = section.numbers_or_sections(key, quantity)?;
    let read = entries.into_iter().map(|entry| match entry {
        Ok(number) => Some(Value::Number(number)),
        Err(table) => read_field(table, (key, quantity), in_time),
    });
    let values: Vec<Option<Value>> = read.collect();
    if values.len() != 3 {
        let problem = format!("`{key}` in {} has not three components", section.title);
        section.refuse(key, problem, "write [x, y, z]");
        return None;
    }
    let values: Option<Vec<Value>> = values.into_iter().collect();
    values?.try_into().ok()
}

/// Reads the keys of a value that varies.
pub(crate) fn read_field(
    section: Section<'_, '_>,
    (key, quantity): (&'static str, Quantity),
    in_time: InTime,
) -> Option<Value> {
    let wanted = Wanted {
        key,
        quantity,
        in_time,
    };
    let given = ["table", "expression", "file"].map(|form| (form, section.has(form)));
    let mut given = given.into_iter().filter(|(_, has)| *has);
    let entry = match (given.next(), given.next()) {
        (Some((first, _)), Some((second, _))) => {
            let problem = format!("both `{first}` and `{second}` are given");
            section.refuse(second, problem, "keep one of them");
            None
        }
        (Some(("table", _)), _) => read_table(&section, &wanted),
        (Some(("expression", _)), _) => read_expression(&section, &wanted),
        (Some(_), _) => read_samples(&section, &wanted),
        (None, _) => {
            let problem = format!("{} says no value", section.title);
            let remedy = "add table = [[0, 1.0], [100, 2.0]] with over = \"depth\", an expression, \
                          or a file with its column";
            section.refuse("table", problem, remedy);
            None
        }
    };
    section.finish();
    entry.map(|entry| Value::Varying(Box::new(entry)))
}

/// Factor from the unit of the values to SI units.
fn read_unit(section: &Section<'_, '_>, wanted: &Wanted) -> Option<f64> {
    let Some(unit) = section.text("unit") else {
        return Some(1.0);
    };
    let dimension = wanted.quantity.dimension;
    let factor = read_quantity(&format!("1 {unit}"), dimension).ok();
    if factor.is_none() {
        let units = dimension.units().join(", ");
        let problem = format!("\"{unit}\" is no unit of {}", dimension.name());
        section.refuse("unit", problem, format!("write one of {units}"));
    }
    factor
}

fn read_beyond(section: &Section<'_, '_>) -> Beyond {
    match section.choice("beyond") {
        Some("nearest") => Beyond::Nearest,
        _ => Beyond::Refuse,
    }
}

/// Refuses a value that changes with time where nothing does.
fn check_time(section: &Section<'_, '_>, key: &'static str, wanted: &Wanted) {
    match wanted.in_time {
        InTime::By(clock) if clock.runs => {}
        InTime::By(_) => section.refuse(
            key,
            "the value depends on time, but the load steps have no times".into(),
            "give times = [1.0, 2.0] or [[load.phase]] under [load], without steps",
        ),
        InTime::Never => section.refuse(
            key,
            format!("`{}` does not change with time", wanted.key),
            "write a value by x, y, z or depth",
        ),
    }
}

fn read_table(section: &Section<'_, '_>, wanted: &Wanted) -> Option<FieldEntry> {
    let over = section.choice("over");
    if !section.has("over") {
        let remedy = "add over = \"depth\" (or \"x\", \"y\", \"z\", \"time\")";
        section.refuse("table", "the table says not what it is over".into(), remedy);
    }
    let over_what = over.and_then(Coordinate::named);
    let ground = match over_what {
        Some(Coordinate::Depth) => section.number("ground").unwrap_or(0.0),
        _ => 0.0,
    };
    if over_what == Some(Coordinate::Time) {
        check_time(section, "over", wanted);
    }
    let beyond = read_beyond(section);
    let factor = read_unit(section, wanted)?;
    let rows = section.rows("table")?;
    let scaled = rows.iter().map(|[at, value]| [*at, factor * value]);
    let table = Table::new(scaled.collect(), over_what?, ground, beyond);
    if table.is_none() {
        let remedy = "write at least one row [coordinate, value], and each coordinate once";
        let problem = match rows.is_empty() {
            true => "the table is empty",
            false => "the table has two values at one coordinate",
        };
        section.refuse("table", problem.into(), remedy);
    }
    if matches!(over_what, Some(Coordinate::Z | Coordinate::Depth)) {
        section.refuse_in_plane("over", "write over = \"y\", with the rows by y");
    }
    let table = table?;
    let [first, last] = table.ends();
    let origin = format!(
        "a table over {} from {first} to {last}",
        over.unwrap_or_default()
    );
    Some(entry(section, wanted, (Field::Table(table), origin)))
}

fn read_expression(section: &Section<'_, '_>, wanted: &Wanted) -> Option<FieldEntry> {
    let text = section.text("expression");
    let ground = section.number("ground");
    let factor = read_unit(section, wanted);
    let text = text?;
    match Expression::read(text, factor?, ground.unwrap_or(0.0)) {
        Ok(expression) => {
            if expression.depends_on_time() {
                check_time(section, "expression", wanted);
            }
            if expression.depends_on_elevation() {
                section.refuse_in_plane("expression", "write y (upwards) in place of z and depth");
            }
            let field = Field::Expression(Arc::new(expression));
            Some(entry(section, wanted, (field, format!("`{text}`"))))
        }
        Err([problem, remedy]) => {
            section.refuse("expression", problem, remedy);
            None
        }
    }
}

fn read_samples(section: &Section<'_, '_>, wanted: &Wanted) -> Option<FieldEntry> {
    let name = section.text("file");
    let column = section.text("column");
    if !section.has("column") {
        let remedy = "add column = \"NAME\", the column of the file with the values";
        section.refuse("file", "no column of the file is named".into(), remedy);
    }
    let (method, beyond) = match section.choice("method") {
        Some("linear") => (Method::Linear, read_beyond(section)),
        _ => (Method::Nearest, Beyond::Nearest),
    };
    let reach = section.number("reach");
    let factor = read_unit(section, wanted);
    let (name, column, factor) = (name?, column?, factor?);
    let Some(path) = section.beside(name) else {
        let problem = "a file of values has no place in a description of a network".into();
        let remedy = "write the file into the scene that the network makes";
        section.refuse("file", problem, remedy);
        return None;
    };
    let read = match path.extension().is_some_and(|end| end == "vtu") {
        true => samples_of_grid((&path, column), factor, (method, beyond)),
        false => {
            let file = SampleFile {
                path: &path,
                column,
                factor,
                method,
                beyond,
            };
            file.read()
        }
    };
    match read {
        Ok(samples) => {
            let origin = format!("{} samples of `{name}`", samples.count());
            let field = Field::Samples(Arc::new(samples));
            Some(FieldEntry {
                reach,
                file: Some(path),
                ..entry(section, wanted, (field, origin))
            })
        }
        Err(found) => {
            for [problem, remedy] in found {
                section.refuse("file", problem, remedy);
            }
            None
        }
    }
}

/// Samples of an array of a grid.
fn samples_of_grid(
    (path, array): (&Path, &str),
    factor: f64,
    way: (Method, Beyond),
) -> Result<Samples, Vec<[String; 2]>> {
    let values = read_values(path, array).map_err(|defects| {
        let said = |defect: Defect| {
            let problem = format!("`{}`: {}", defect.place, defect.problem);
            [problem, defect.remedy]
        };
        defects.into_iter().map(said).collect::<Vec<_>>()
    })?;
    let scaled = values.into_iter().map(|(at, value)| (at, factor * value));
    Samples::of(&scaled.collect::<Vec<_>>(), way)
        .map_err(|[problem, remedy]| vec![[format!("`{}`: {problem}", path.display()), remedy]])
}

fn entry(
    section: &Section<'_, '_>,
    wanted: &Wanted,
    (field, origin): (Field, String),
) -> FieldEntry {
    FieldEntry {
        field,
        place: format!("{} {}", section.place(), section.title),
        title: section.title.clone(),
        key: wanted.key,
        quantity: wanted.quantity,
        origin,
        file: None,
        reach: None,
    }
}
