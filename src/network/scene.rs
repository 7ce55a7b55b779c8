//! Writes the scene that runs the network.

use std::fmt::Write;

use kluft_network::{Grouping, Network};
use toml::de::{DeTable, DeValue};

use super::MADE;
use super::input::Input;
use kluft_scene::reader::Section;

/// Keys and values of a section, as TOML.
pub(super) type Passage = Vec<(String, String)>;

/// Sections that the input has for the scene: the head of each and what is in it.
#[derive(Default)]
pub(super) struct Passages(Vec<(String, Passage)>);

impl Passages {
    fn has(&self, key: &str) -> bool {
        self.0
            .iter()
            .any(|(head, _)| head.trim_start_matches('[').starts_with(key))
    }
}

const ROCK: &str = "
[rock.rock]                       # assumed: granite
young_modulus = 50e9
poisson_ratio = 0.25
";

const MATERIAL: [(&str, &str); 4] = [
    ("aperture", "1e-3"),
    ("normal_stiffness", "2e10"),
    ("shear_stiffness", "1e10"),
    ("closure", "\"logarithmic\""),
];

const BOUNDARIES: &str = "
[boundary.top]                    # assumed: 10 MPa on top, rollers on three faces
pressure = 10e6

[boundary.bottom]
symmetry = true

[boundary.left]
symmetry = true

[boundary.front]
symmetry = true
";

/// Keys and values of a table without those named.
pub(super) fn passage(table: &DeTable<'_>, without: &[&str]) -> Passage {
    let entries = table
        .iter()
        .filter(|(name, _)| !without.contains(&name.get_ref().as_ref()));
    entries
        .map(|(name, value)| (key_text(name.get_ref()), value_text(value.get_ref())))
        .collect()
}

/// All sections of the input that a scene understands.
pub(super) fn passages(root: &Section<'_, '_>) -> Passages {
    let mut found = Vec::new();
    for key in [
        "rock",
        "boundary",
        "fixed_point",
        "body",
        "initial_stress",
        "load",
    ] {
        match root.table().get(key).map(|value| value.get_ref()) {
            Some(DeValue::Table(table)) if ["rock", "boundary"].contains(&key) => {
                for (name, value) in table.iter() {
                    if let DeValue::Table(inner) = value.get_ref() {
                        found.push((
                            format!("[{key}.{}]", key_text(name.get_ref())),
                            passage(inner, &[]),
                        ));
                    }
                }
            }
            Some(DeValue::Table(table)) => found.push((format!("[{key}]"), passage(table, &[]))),
            Some(DeValue::Array(array)) => {
                for entry in array.iter() {
                    if let DeValue::Table(inner) = entry.get_ref() {
                        found.push((format!("[[{key}]]"), passage(inner, &[])));
                    }
                }
            }
            _ => {}
        }
    }
    Passages(found)
}

fn key_text(key: &str) -> String {
    let is_bare = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    if !key.is_empty() && key.chars().all(is_bare) {
        key.to_owned()
    } else {
        quoted(key)
    }
}

fn quoted(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            c if c.is_control() => {
                let _ = write!(out, "\\u{:04X}", c as u32);
            }
            c => out.push(c),
        }
    }
    out + "\""
}

fn value_text(value: &DeValue<'_>) -> String {
    match value {
        DeValue::String(text) => quoted(text),
        DeValue::Integer(number) => i64::from_str_radix(number.as_str(), number.radix())
            .map_or_else(|_| number.as_str().to_owned(), |number| number.to_string()),
        DeValue::Float(number) => number.as_str().to_owned(),
        DeValue::Boolean(flag) => flag.to_string(),
        DeValue::Datetime(time) => time.to_string(),
        DeValue::Array(array) => {
            let entries: Vec<String> = array
                .iter()
                .map(|entry| value_text(entry.get_ref()))
                .collect();
            format!("[{}]", entries.join(", "))
        }
        DeValue::Table(table) => {
            let entries: Vec<String> = passage(table, &[])
                .iter()
                .map(|(key, value)| format!("{key} = {value}"))
                .collect();
            format!("{{ {} }}", entries.join(", "))
        }
    }
}

/// The scene of a network whose geometry is the file `geometry`.
pub(super) fn text(input: &Input, network: &Network, grouping: Grouping, geometry: &str) -> String {
    let mut out = format!("{MADE}\ntitle = {}\n", quoted(&input.title));
    let sizes = &network.sizes;
    let _ = write!(
        out,
        "\n[mesh]\ngeometry = {}\nparameters = {{ h = {:?}, h_fracture = {:?}, h_intersection = {:?} }}\n",
        quoted(geometry),
        sizes.h,
        sizes.h_fracture,
        sizes.h_intersection
    );
    if !input.passages.has("rock") {
        out.push_str(ROCK);
    }
    for (head, passage) in &input.passages.0 {
        section(&mut out, head, passage);
    }
    if !input.passages.has("boundary") {
        out.push_str(BOUNDARIES);
    }
    fractures(&mut out, input, network, grouping);
    out
}

fn section(out: &mut String, head: &str, passage: &Passage) {
    let _ = writeln!(out, "\n{head}");
    for (key, value) in passage {
        let _ = writeln!(out, "{key} = {value}");
    }
}

/// One section a physical surface; a single set is the default of all.
fn fractures(out: &mut String, input: &Input, network: &Network, grouping: Grouping) {
    if let [only] = &input.sets[..] {
        material(out, "[fracture.default]", input, &only.name);
        return;
    }
    match grouping {
        Grouping::Set => {
            for set in &input.sets {
                if network
                    .fractures
                    .iter()
                    .any(|fracture| fracture.set == set.name)
                {
                    material(
                        out,
                        &format!("[fracture.{}]", key_text(&set.name)),
                        input,
                        &set.name,
                    );
                }
            }
        }
        Grouping::Fracture => {
            for fracture in &network.fractures {
                material(
                    out,
                    &format!("[fracture.{}]", key_text(&fracture.name)),
                    input,
                    &fracture.set,
                );
            }
        }
    }
}

fn material(out: &mut String, head: &str, input: &Input, set: &str) {
    let known = input.sets.iter().find(|other| other.name == set);
    match known.and_then(|set| set.material.as_ref()) {
        Some(passage) => section(out, head, passage),
        None => {
            let assumed = MATERIAL.map(|(key, value)| (key.to_owned(), value.to_owned()));
            section(
                out,
                &format!("{head:<33} # assumed: a stiff joint"),
                &assumed.to_vec(),
            );
        }
    }
}
