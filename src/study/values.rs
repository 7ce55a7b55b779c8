//! Numbers of a scene that a study sweeps.

use kluft_keys::Quantity;
use kluft_keys::scene::FRACTURE;
use toml::{Table, Value};

use super::dimension::Choice;
use super::edits::Edit;
use super::words::digits;
use kluft_scene::reader::Section;

/// The names of the fractures of a scene.
pub(super) fn fractures(scene: &Table) -> impl Iterator<Item = (&String, &Value)> {
    let fractures = scene.get("fracture").and_then(Value::as_table);
    fractures.into_iter().flatten()
}

/// Numbers of fractures: of all that have the key, of one (`"NAME.key"`), or of all if none has it.
pub(super) fn values_of(section: &Section<'_, '_>, scene: &Table) -> Vec<(String, Vec<Choice>)> {
    let mut swept = Vec::new();
    for (name, numbers) in section.number_lists("values", quantity_of) {
        let (wanted, key) = fracture_and_key(&name);
        let fits = |name: &str| wanted.is_none_or(|wanted| wanted == name);
        let all: Vec<(&String, &Value)> = fractures(scene).filter(|(name, _)| fits(name)).collect();
        if all.is_empty() {
            let names: Vec<&str> = fractures(scene).map(|(name, _)| name.as_str()).collect();
            let remedy = format!("the scene has: {}", names.join(", "));
            section.refuse("values", format!("`{name}` is of no fracture"), remedy);
        }
        let mut own = all.clone();
        own.retain(|(_, fracture)| fracture.get(key).is_some());
        let own = if own.is_empty() { all } else { own };
        let set = |number: f64| {
            own.iter()
                .map(move |(n, _)| Edit::set(&["fracture", n, key], number))
        };
        let choice = |number: f64| Choice {
            number: Some(number),
            ..Choice::new(
                &format!("{key}={}", digits(number, 4)),
                set(number).collect(),
            )
        };
        swept.push((name.clone(), numbers.into_iter().map(choice).collect()));
    }
    swept
}

/// Name of the fracture, if one is named, and the key.
fn fracture_and_key(name: &str) -> (Option<&str>, &str) {
    match name.rsplit_once('.') {
        Some((fracture, key)) => (Some(fracture), key),
        None => (None, name),
    }
}

/// What a swept number is; its range is checked with the scene of each setting.
fn quantity_of(name: &str) -> Quantity {
    let key = FRACTURE.key(fracture_and_key(name).1);
    let dimension = key
        .and_then(|key| key.kind.quantity())
        .map_or(Quantity::PLAIN.dimension, |quantity| quantity.dimension);
    Quantity {
        dimension,
        ..Quantity::PLAIN
    }
}
