//! The table as JSON Schema, for editors.

use serde_json::{Map, Value, json};

use crate::dimension::Dimension;
use crate::document::Document;
use crate::range::Range;
use crate::table::{Key, KeySection, Kind, Need, Quantity};

/// The schema of a document; draft 7, which the TOML plug-ins of editors take.
///
/// A text for a quantity is checked for its shape only: units are left to the reader.
pub fn schema(document: Document) -> Value {
    let root = document.root();
    let mut whole = of_section(root);
    whole.insert(
        "$schema".into(),
        "http://json-schema.org/draft-07/schema#".into(),
    );
    let title = match document {
        Document::Scene => "A scene of Kluft",
        Document::Network => "A description for kluft network",
        Document::Study => "The table [study] of a scene",
        Document::List => "A line of a list of fractures",
    };
    whole.insert("title".into(), title.into());
    Value::Object(whole)
}

/// An object with the keys of a section and no others.
fn of_section(section: &'static KeySection) -> Map<String, Value> {
    of_keys(section.says, &section.all_keys().collect::<Vec<_>>())
}

/// An object with these keys and no others.
fn of_keys(says: &str, keys: &[&'static Key]) -> Map<String, Value> {
    let properties = keys.iter();
    let properties: Map<String, Value> = properties
        .map(|key| (key.name.to_owned(), of_key(key)))
        .collect();
    let required = keys.iter().filter(|key| key.need == Need::Required);
    let required: Vec<&str> = required.map(|key| key.name).collect();
    let mut object = Map::new();
    object.insert("type".into(), "object".into());
    object.insert("description".into(), says.into());
    object.insert("properties".into(), properties.into());
    object.insert("additionalProperties".into(), false.into());
    if !required.is_empty() {
        object.insert("required".into(), required.into());
    }
    object
}

/// A number, or the keys of a section in its place: its own, or those that it shares.
fn number_or(quantity: Quantity, section: &'static KeySection) -> Value {
    let own = of_keys(section.says, &section.keys.iter().collect::<Vec<_>>());
    let mut choices = vec![of_quantity(quantity), own.into()];
    choices.extend(section.also.map(|also| Value::Object(of_section(also))));
    json!({ "anyOf": choices })
}

fn of_key(key: &Key) -> Value {
    let mut value = of_kind(&key.kind);
    if let Some(object) = value.as_object_mut() {
        object.insert("description".into(), description(key).into());
        if let Need::Default(default) = key.need
            && let Ok(default) = serde_json::from_str::<Value>(default)
        {
            object.insert("default".into(), default);
        }
    }
    value
}

/// The sentence of a key with its unit, its need and an example.
fn description(key: &Key) -> String {
    let unit = key
        .kind
        .quantity()
        .map_or("", |quantity| quantity.dimension.unit());
    let unit = match unit {
        "" => String::new(),
        unit => format!(" ({unit})"),
    };
    let need = match key.need {
        Need::Required => "; required".to_owned(),
        Need::Or(other) => format!("; this or `{other}`"),
        Need::Unless(holds) => format!("; required, unless {holds}"),
        Need::Default(_) => String::new(),
        Need::Without(what) => format!("; without it: {what}"),
    };
    format!("{}{unit}{need}. Example: {}", key.says, key.shown())
}

fn of_kind(kind: &Kind) -> Value {
    match *kind {
        Kind::Number(quantity) => of_quantity(quantity),
        Kind::Whole(range) => Value::Object(bounded("integer", range)),
        Kind::Flag => json!({ "type": "boolean" }),
        Kind::Text => json!({ "type": "string" }),
        Kind::Path => json!({ "type": "string", "minLength": 1 }),
        Kind::Choice(_, words) => json!({ "enum": words }),
        Kind::Choices(words) => {
            json!({ "type": "array", "items": { "enum": words }, "minItems": 1 })
        }
        Kind::Texts => json!({
            "type": "array", "items": { "type": "string", "minLength": 1 }, "minItems": 1
        }),
        Kind::Pair => tuple(json!({ "type": "string", "minLength": 1 }), 2),
        Kind::Flags => {
            json!({ "type": "array", "items": { "type": "boolean" }, "minItems": 1 })
        }
        Kind::Numbers(quantity) => json!({ "type": "array", "items": of_quantity(quantity) }),
        Kind::Vector(quantity) => tuple(of_quantity(quantity), 3),
        Kind::Points(quantity) => {
            json!({ "type": "array", "items": tuple(of_quantity(quantity), 3), "minItems": 3 })
        }
        Kind::VectorOr(quantity, section) => tuple(
            json!({ "anyOf": [of_quantity(quantity), of_section(section)] }),
            3,
        ),
        Kind::History | Kind::Rows => {
            json!({ "type": "array", "items": tuple(json!({ "type": "number" }), 2), "minItems": 1 })
        }
        Kind::NumberOr(quantity, section) => number_or(quantity, section),
        Kind::FreeNumbers => free_numbers(),
        Kind::Tables(_) => json!({ "type": "array", "items": free_numbers(), "minItems": 1 }),
        Kind::TablesOrWords(section, words) => {
            let table = with_removals(of_section(section));
            let entry = json!({ "anyOf": [{ "enum": words }, table] });
            json!({ "type": "array", "items": entry, "minItems": 1 })
        }
        Kind::Sweeps(section) => {
            let list = json!({ "type": "array", "items": any_quantity(), "minItems": 1 });
            let entry = json!({ "anyOf": [list, of_section(section)] });
            json!({ "type": "object", "additionalProperties": entry })
        }
        Kind::Table(section) => Value::Object(of_section(section)),
        Kind::Named(section) => {
            json!({ "type": "object", "additionalProperties": of_section(section) })
        }
        Kind::Listed(section) => json!({ "type": "array", "items": of_section(section) }),
    }
}

fn free_numbers() -> Value {
    json!({ "type": "object", "additionalProperties": { "type": "number" } })
}

fn tuple(entry: Value, count: usize) -> Value {
    json!({ "type": "array", "items": entry, "minItems": count, "maxItems": count })
}

/// An entry of `closures`, in which no key is required and `false` removes one.
fn with_removals(mut section: Map<String, Value>) -> Map<String, Value> {
    section.remove("required");
    if let Some(Value::Object(keys)) = section.get_mut("properties") {
        for (_, key) in keys.iter_mut().filter(|(name, _)| *name != "label") {
            *key = json!({ "anyOf": [key.take(), { "const": false }] });
        }
    }
    section
}

fn of_quantity(quantity: Quantity) -> Value {
    let number = bounded("number", quantity.range);
    match quantity.dimension {
        Dimension::OfKey => any_quantity(),
        dimension if dimension.units().is_empty() => Value::Object(number),
        dimension => json!({ "anyOf": [number, with_unit(dimension.units())] }),
    }
}

fn any_quantity() -> Value {
    json!({ "anyOf": [{ "type": "number" }, with_unit(&[])] })
}

/// What a number with a unit looks like: digits, an exponent, and a unit, none of which begins with
/// `e`.
const WITH_UNIT: &str = concat!(
    r"^ *[-+]?([0-9][0-9_]*\.?[0-9_]*|\.[0-9_]+)([eE][-+]?[0-9]+)?",
    r" *(1/)?[A-DF-Za-df-z%°µμ].*$"
);

/// A number with a unit as text; some units for it.
fn with_unit(units: &[&str]) -> Value {
    let mut text = json!({ "type": "string", "pattern": WITH_UNIT });
    if let (Some(object), false) = (text.as_object_mut(), units.is_empty()) {
        let says = format!("A number with its unit: {}", units.join(", "));
        object.insert("description".into(), says.into());
    }
    text
}

/// A number in a range.
fn bounded(kind: &str, range: Range) -> Map<String, Value> {
    let bounds: &[(&str, f64)] = match range {
        Range::Finite => &[],
        Range::Positive => &[("exclusiveMinimum", 0.0)],
        Range::NotNegative => &[("minimum", 0.0)],
        Range::Between(low, high) => &[("exclusiveMinimum", low), ("exclusiveMaximum", high)],
        Range::Within(low, high) => &[("minimum", low), ("maximum", high)],
    };
    let mut object = Map::new();
    object.insert("type".into(), kind.into());
    let bounds = bounds.iter();
    object.extend(bounds.map(|(name, bound)| ((*name).to_owned(), plain(*bound))));
    object
}

/// A bound as a person writes it.
fn plain(bound: f64) -> Value {
    match bound.fract() == 0.0 {
        true => (bound as i64).into(),
        false => bound.into(),
    }
}
