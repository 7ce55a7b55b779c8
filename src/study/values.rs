//! Numbers of a scene that a study sweeps: of fractures, of a fluid and its sources, and loads of
//! boundaries.

use kluft_keys::scene::{BOUNDARY, FLUID, FRACTURE, SOURCE};
use kluft_keys::{Key, KeySection, Kind, Quantity};
use toml::{Table, Value};

use super::dimension::Choice;
use super::edits::Edit;
use super::words::digits;
use kluft_scene::reader::Section;

/// What a name under `[study.values]` stands for.
enum SweptName<'a> {
    /// A key of one fracture, or of all.
    Fracture(Option<&'a str>, &'a str),
    /// A boundary and the keys below it, `top.pressure`.
    Boundary(&'a str),
    /// A key of the fluid.
    Fluid(&'a str),
    /// A key of one source, or of all that have it.
    Source(Option<&'a str>, &'a str),
}

/// A number that is swept.
struct SweptNumber {
    /// What labels call it.
    label: String,
    /// Where it stands in the scene, as sections and key.
    paths: Vec<Vec<String>>,
}

/// The names of the fractures of a scene.
pub(super) fn fractures(scene: &Table) -> impl Iterator<Item = (&String, &Value)> {
    named(scene, "fracture")
}

fn named<'a>(scene: &'a Table, kind: &str) -> impl Iterator<Item = (&'a String, &'a Value)> {
    let sections = scene.get(kind).and_then(Value::as_table);
    sections.into_iter().flatten()
}

/// Numbers of fractures and of boundaries.
pub(super) fn values_of(section: &Section<'_, '_>, scene: &Table) -> Vec<(String, Vec<Choice>)> {
    let mut swept = Vec::new();
    for (name, numbers) in section.number_lists("values", |name| quantity_of(name, scene)) {
        let number = match swept_name(&name, scene) {
            SweptName::Fracture(wanted, key) => of_fractures((wanted, key), scene),
            SweptName::Boundary(rest) => of_boundary(section, rest, scene),
            SweptName::Fluid(key) => of_fluid(section, key, scene),
            SweptName::Source(wanted, key) => of_sources(section, (wanted, key), scene),
        };
        let Some(number) = number else {
            let problem = format!("`{name}` is of no fracture, boundary, fluid or source");
            let names = |kind| named(scene, kind).map(move |(name, _)| format!("{kind}.{name}"));
            let fluid = scene.get("fluid").map(|_| "fluid".to_owned());
            let sources = sources(scene).map(|(_, name)| format!("source.{name}"));
            let all = names("fracture").chain(names("boundary"));
            let all: Vec<String> = all.chain(fluid).chain(sources).collect();
            section.refuse(
                "values",
                problem,
                format!("the scene has: {}", all.join(", ")),
            );
            continue;
        };
        let set = |value: f64| {
            let paths = number.paths.iter().cloned();
            paths.map(move |path| Edit::Set(path, value.into()))
        };
        let choice = |value: f64| Choice {
            number: Some(value),
            ..Choice::new(
                &format!("{}={}", number.label, digits(value, 4)),
                set(value).collect(),
            )
        };
        swept.push((name.clone(), numbers.into_iter().map(choice).collect()));
    }
    swept
}

/// A fracture whose name looks like a section keeps its meaning.
fn swept_name<'a>(name: &'a str, scene: &Table) -> SweptName<'a> {
    let (fracture, key) = fracture_and_key(name);
    let is_fracture = |name: &str| fractures(scene).any(|(own, _)| own == name);
    if fracture.is_some_and(is_fracture) {
        return SweptName::Fracture(fracture, key);
    }
    if let Some(rest) = name.strip_prefix("boundary.") {
        return SweptName::Boundary(rest);
    }
    if let Some(key) = name.strip_prefix("fluid.") {
        return SweptName::Fluid(key);
    }
    if let Some(rest) = name.strip_prefix("source.") {
        let (source, key) = fracture_and_key(rest);
        return SweptName::Source(source, key);
    }
    let (fracture, key) = fracture_and_key(name.strip_prefix("fracture.").unwrap_or(name));
    SweptName::Fracture(fracture, key)
}

/// Name of the fracture, if one is named, and the key.
fn fracture_and_key(name: &str) -> (Option<&str>, &str) {
    match name.rsplit_once('.') {
        Some((fracture, key)) => (Some(fracture), key),
        None => (None, name),
    }
}

/// Of all fractures that have the key, of one (`"NAME.key"`), or of all if none has it.
fn of_fractures((wanted, key): (Option<&str>, &str), scene: &Table) -> Option<SweptNumber> {
    let fits = |name: &str| wanted.is_none_or(|wanted| wanted == name);
    let all: Vec<(&String, &Value)> = fractures(scene).filter(|(name, _)| fits(name)).collect();
    let mut own = all.clone();
    own.retain(|(_, fracture)| fracture.get(key).is_some());
    let own = if own.is_empty() { all } else { own };
    let path = |(name, _): (&String, &Value)| vec!["fracture".into(), name.clone(), key.into()];
    (!own.is_empty()).then(|| SweptNumber {
        label: key.to_owned(),
        paths: own.into_iter().map(path).collect(),
    })
}

/// Of a boundary that the scene has: `NAME.pressure`, `NAME.displacement.z`.
fn of_boundary(section: &Section<'_, '_>, rest: &str, scene: &Table) -> Option<SweptNumber> {
    let (name, keys) = boundary_and_keys(rest, scene)?;
    let keys: Vec<&str> = keys.split('.').collect();
    if number_below(&BOUNDARY, &keys).is_none() {
        let problem = format!("`{}` of a boundary is no number", keys.join("."));
        let remedy = format!(
            "write \"boundary.{name}.pressure\", or \"boundary.{name}.displacement.x\", y or z"
        );
        section.refuse("values", problem, remedy);
    }
    let path = ["boundary", name].into_iter().chain(keys);
    Some(SweptNumber {
        label: rest.to_owned(),
        paths: vec![path.map(str::to_owned).collect()],
    })
}

/// Of the fluid, if the scene has one.
fn of_fluid(section: &Section<'_, '_>, key: &str, scene: &Table) -> Option<SweptNumber> {
    scene.get("fluid")?;
    if number_below(&FLUID, &[key]).is_none() {
        let problem = format!("`{key}` of a fluid is no number");
        section.refuse("values", problem, "write \"fluid.viscosity\"");
    }
    Some(SweptNumber {
        label: key.to_owned(),
        paths: vec![vec!["fluid".into(), key.to_owned()]],
    })
}

/// The sources of a scene, by their numbers, and what they are called.
fn sources(scene: &Table) -> impl Iterator<Item = (usize, String)> {
    let sources = scene.get("source").and_then(Value::as_array);
    let named = sources.into_iter().flatten().enumerate();
    named.map(|(number, source)| {
        let name = source.get("name").and_then(Value::as_str);
        (number, name.map_or((number + 1).to_string(), str::to_owned))
    })
}

/// Of all sources that have the key, or of one (`source.NAME.rate`; by its number without a name).
fn of_sources(
    section: &Section<'_, '_>,
    (wanted, key): (Option<&str>, &str),
    scene: &Table,
) -> Option<SweptNumber> {
    let own = sources(scene).filter(|(number, name)| match wanted {
        Some(wanted) => name == wanted,
        None => scene["source"][*number].get(key).is_some(),
    });
    let path = |(number, _): (usize, String)| vec!["source".into(), number.to_string(), key.into()];
    let paths: Vec<Vec<String>> = own.map(path).collect();
    if !paths.is_empty() && number_below(&SOURCE, &[key]).is_none() {
        let problem = format!("`{key}` of a source is no number");
        let remedy = "write \"source.NAME.rate\", or \"source.NAME.pressure\"";
        section.refuse("values", problem, remedy);
    }
    (!paths.is_empty()).then(|| SweptNumber {
        label: wanted.map_or(key.to_owned(), |name| format!("{name}.{key}")),
        paths,
    })
}

/// The boundary of the scene that a name begins with, and what follows it.
fn boundary_and_keys<'a>(rest: &'a str, scene: &'a Table) -> Option<(&'a str, &'a str)> {
    named(scene, "boundary").find_map(|(name, _)| {
        let keys = rest.strip_prefix(name.as_str())?.strip_prefix('.')?;
        Some((name.as_str(), keys))
    })
}

/// The key at the end of a path below a section, if it holds a number.
fn number_below(section: &'static KeySection, path: &[&str]) -> Option<&'static Key> {
    let (first, rest) = path.split_first()?;
    let key = section.key(first)?;
    match rest {
        [] => Some(key).filter(|key| matches!(key.kind, Kind::Number(_) | Kind::NumberOr(..))),
        rest => number_below(key.kind.section()?, rest),
    }
}

/// What a swept number is; its range is checked with the scene of each setting.
fn quantity_of(name: &str, scene: &Table) -> Quantity {
    let key = match swept_name(name, scene) {
        SweptName::Fracture(_, key) => FRACTURE.key(key),
        SweptName::Boundary(rest) => {
            let keys = boundary_and_keys(rest, scene).map(|(_, keys)| keys);
            let keys: Vec<&str> = keys.unwrap_or(rest).split('.').collect();
            number_below(&BOUNDARY, &keys)
        }
        SweptName::Fluid(key) => FLUID.key(key),
        SweptName::Source(_, key) => SOURCE.key(key),
    };
    let dimension = key
        .and_then(|key| key.kind.quantity())
        .map_or(Quantity::PLAIN.dimension, |quantity| quantity.dimension);
    Quantity {
        dimension,
        ..Quantity::PLAIN
    }
}
