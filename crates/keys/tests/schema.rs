//! The schemas take the shipped scenes and descriptions, and refuse slips.

use std::path::{Path, PathBuf};

use kluft_keys::{Document, schema};
use serde_json::{Value, json};

const EVERY_KEY: &str = include_str!("../../../tests/program/every_key.toml");
const TIMED: &str = include_str!("../../../tests/program/timed.toml");

/// What is wrong with a value by a schema, going by the words that our schemas use.
fn refusal(value: &Value, schema: &Value) -> Option<String> {
    let wrong = |what: &str| Some(format!("{value} is no {what} of {schema}"));
    for (word, wanted) in schema.as_object().expect("an object") {
        let is_right = match word.as_str() {
            "type" => is_of_type(value, wanted),
            "enum" => wanted.as_array().expect("a list").contains(value),
            "const" => value == wanted,
            "anyOf" => {
                let mut choices = wanted.as_array().expect("a list").iter();
                choices.any(|choice| refusal(value, choice).is_none())
            }
            "minimum" => of_number(value, |x| x >= number(wanted)),
            "maximum" => of_number(value, |x| x <= number(wanted)),
            "exclusiveMinimum" => of_number(value, |x| x > number(wanted)),
            "exclusiveMaximum" => of_number(value, |x| x < number(wanted)),
            "minLength" => value.as_str().is_none_or(|text| !text.is_empty()),
            "minItems" => length(value).is_none_or(|length| length >= number(wanted)),
            "maxItems" => length(value).is_none_or(|length| length <= number(wanted)),
            "required" => {
                let mut names = wanted.as_array().expect("a list").iter();
                names.all(|name| value.get(name.as_str().expect("a name")).is_some())
            }
            "items" => {
                let entries = value.as_array().into_iter().flatten();
                let mut refusals = entries.filter_map(|entry| refusal(entry, wanted));
                if let Some(refusal) = refusals.next() {
                    return Some(refusal);
                }
                true
            }
            "pattern" => value.as_str().is_none_or(has_unit),
            "properties"
            | "additionalProperties"
            | "$schema"
            | "title"
            | "description"
            | "default" => true,
            other => panic!("the word {other} is unknown to this test"),
        };
        if !is_right {
            return wrong(word);
        }
    }
    keys(value, schema)
}

/// Whether a text is a number with something behind it that may be a unit: what the pattern asks
/// for.
fn has_unit(text: &str) -> bool {
    let text = text.trim_start().trim_start_matches(['+', '-']);
    let unit = text.trim_start_matches(|c: char| c.is_ascii_digit() || "._".contains(c));
    let exponent = unit.strip_prefix(['e', 'E']).unwrap_or(unit);
    let exponent = exponent.trim_start_matches(['+', '-']);
    let behind = exponent.trim_start_matches(|c: char| c.is_ascii_digit());
    let unit = match behind.len() < exponent.len() {
        true => behind,
        false => unit,
    };
    let unit = unit.trim_start().trim_start_matches("1/");
    let is_unit = |c: char| c.is_alphabetic() && !"eE".contains(c) || "%°".contains(c);
    text.starts_with(|c: char| c.is_ascii_digit() || c == '.') && unit.starts_with(is_unit)
}

fn keys(value: &Value, schema: &Value) -> Option<String> {
    let none = json!({});
    let properties = schema.get("properties").unwrap_or(&none);
    let rest = schema.get("additionalProperties");
    let entries = value.as_object().into_iter().flatten();
    let refused = |(name, value): (&String, &Value)| match (properties.get(name), rest) {
        (Some(schema), _) => refusal(value, schema),
        (None, Some(Value::Bool(false))) => Some(format!("unknown key {name}")),
        (None, Some(rest)) => refusal(value, rest),
        (None, None) => None,
    };
    entries.filter_map(refused).next()
}

fn is_of_type(value: &Value, wanted: &Value) -> bool {
    match wanted.as_str().expect("a name") {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "number" => value.is_number(),
        "integer" => value.as_f64().is_some_and(|x| x.fract() == 0.0),
        other => panic!("the type {other}"),
    }
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

fn of_number(value: &Value, fits: impl Fn(f64) -> bool) -> bool {
    value.as_f64().is_none_or(fits)
}

fn length(value: &Value) -> Option<f64> {
    value.as_array().map(|entries| entries.len() as f64)
}

fn from_toml(text: &str) -> Value {
    let table: toml::Table = text.parse().expect("TOML");
    serde_json::to_value(table).expect("JSON")
}

/// Files of this name in the folders of `geometries`.
fn shipped(name: &str) -> Vec<(PathBuf, String)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../geometries");
    let folders = std::fs::read_dir(folder).expect("the geometries");
    let files = folders.map(|folder| folder.expect("an entry").path().join(name));
    let files = files.filter(|file| file.is_file());
    files
        .map(|file| (file.clone(), std::fs::read_to_string(file).expect("a file")))
        .collect()
}

#[test]
fn shipped_files_are_what_the_schemas_describe() {
    for (document, name, least) in [
        (Document::Scene, "scene.toml", 13),
        (Document::Network, "network.toml", 2),
    ] {
        let schema = schema(document);
        let files = shipped(name);
        assert!(files.len() >= least, "{} files", files.len());
        for (file, text) in files {
            assert_eq!(
                refusal(&from_toml(&text), &schema),
                None,
                "{}",
                file.display()
            );
        }
    }
    for text in [EVERY_KEY, TIMED] {
        assert_eq!(refusal(&from_toml(text), &schema(Document::Scene)), None);
    }
}

/// Scenes that `kluft network` makes are made again byte by byte, and have no place for the line.
#[test]
fn shipped_files_name_their_schema() {
    for (name, document) in [("scene.toml", "scene"), ("network.toml", "network")] {
        for (file, text) in shipped(name) {
            let is_made = text.starts_with("# Made by `kluft network`");
            let wanted = format!("#:schema ../../docs/schema/{document}.json\n");
            assert!(is_made || text.starts_with(&wanted), "{}", file.display());
        }
    }
}

#[test]
fn slips_are_refused() {
    let schema = schema(Document::Scene);
    for (from, to) in [
        ("young_modulus = 50e9", "yung_modulus = 50e9"),
        ("young_modulus = 50e9", "young_modulus = -1"),
        ("young_modulus = 50e9", "young_modulus = \"much\""),
        ("young_modulus = 50e9", "young_modulus = \"50e9\""),
        ("viscosity = 1e-3", ""),
        ("poisson_ratio = 0.25", "poisson_ratio = 0.5"),
        ("order = 1", "order = 3"),
        ("order = 1", "order = 1.5"),
        ("quarter_points = false", "quarter_points = 0"),
        ("closure = \"logarithmic\"", "closure = \"logaritmic\""),
        ("[0, 0, -7e6]", "[0, -7e6]"),
        ("at = [1, 0.5, 0]", ""),
        ("[rock.default]", "[rok.default]"),
        ("steps = [0.25, 0.5, 1.0]", "steps = 3"),
        ("zz = -15e6", "zz = { per_metre = 1 }"),
    ] {
        assert!(EVERY_KEY.contains(from), "{from}");
        let text = EVERY_KEY.replace(from, to);
        assert!(refusal(&from_toml(&text), &schema).is_some(), "{to}");
    }
    for (from, to) in [
        ("young_modulus = 50e9", "young_modulus = \"50 GPa\""),
        ("[0, 0, -7e6]", "[0, 0, \"-7 MPa\"]"),
        ("aperture = 1e-4", "aperture = '.1mm'"),
        ("order = 1", "order = 2.0"),
    ] {
        let text = EVERY_KEY.replace(from, to);
        assert_eq!(refusal(&from_toml(&text), &schema), None, "{to}");
    }
}

#[test]
fn studies_are_what_the_schema_describes() {
    let text = "
meshes = [{ h = 0.2 }, { h = 0.1, far = 2 }]
orders = [1, 2]
closures = ['contact', { label = 'cut', closure = 'logarithmic', cutoff_aperture = '1 um' }, { cutoff_aperture = false }]
facets = ['nodal']
solvers = ['direct', 'iterative']
measure = 'volume'
[values]
normal_stiffness = ['1 GPa/m', 1e10]
'joint.aperture' = { from = 1e-5, to = '1 mm', count = 3 }
";
    let schema = schema(Document::Study);
    assert_eq!(refusal(&from_toml(text), &schema), None);
    for (from, to) in [
        ("meshes", "mesh"),
        ("{ h = 0.2 }", "{ h = 'fine' }"),
        ("'contact'", "'contakt'"),
        ("count = 3", "cont = 3"),
        ("['1 GPa/m', 1e10]", "3"),
    ] {
        let text = text.replace(from, to);
        assert!(refusal(&from_toml(&text), &schema).is_some(), "{to}");
    }
}
