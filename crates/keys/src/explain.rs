//! What the table says of one key, for a terminal.

use std::fmt::Write;

use crate::document::Document;
use crate::names::some_near;
use crate::page::{holds, need};
use crate::scene::{CLOSURES, LAWS};
use crate::table::{Key, KeySection, Kind};

/// A section, and the documents that have it.
struct KeyPlace {
    section: &'static KeySection,
    documents: Vec<&'static str>,
    /// Its path without brackets and names: `rock`, `load.phase`.
    path: String,
}

/// All that is known of a key or section, by its name or a path such as `rock.young_modulus`.
///
/// # Errors
/// The names nearest to one that is not known.
pub fn explain(query: &str) -> Result<String, Vec<&'static str>> {
    let wanted = path_of(query.trim_matches('`'));
    let places = places();
    let mut out = Vec::new();
    for place in &places {
        if ends_with(&place.path, &wanted) {
            out.push(of_section(place));
        }
        for key in place.section.keys {
            if ends_with(&format!("{}.{}", place.path, key.name), &wanted)
                || is_of_a_name(&place.path, key.name, &wanted)
            {
                out.push(of_key(place, key));
            }
        }
    }
    if out.is_empty() {
        let named = places.iter().filter(|place| is_a_name(place, &wanted));
        out.extend(named.map(of_section));
    }
    if out.is_empty() {
        let names = places.iter().flat_map(|place| place.section.keys);
        let last = wanted.rsplit('.').next().unwrap_or_default();
        return Err(some_near(last, names.map(|key| key.name), 3));
    }
    Ok(out.join("\n"))
}

/// All sections with their keys.
pub fn overview() -> String {
    let mut out = String::new();
    for place in places() {
        let keys: Vec<&str> = place.section.keys.iter().map(|key| key.name).collect();
        let _ = writeln!(out, "{}\n    {}", head(&place), keys.join(", "));
    }
    let _ = write!(out, "\n{}", laws());
    out + "\n`kluft explain KEY` or SECTION.KEY says what a key means.\n"
}

fn places() -> Vec<KeyPlace> {
    let mut places: Vec<KeyPlace> = Vec::new();
    for document in Document::ALL {
        for section in document.sections() {
            let known = places
                .iter_mut()
                .find(|place| std::ptr::eq(place.section, section));
            match known {
                Some(place) => place.documents.push(document.name()),
                None => places.push(KeyPlace {
                    section,
                    documents: vec![document.name()],
                    path: path_of(section.pattern),
                }),
            }
        }
    }
    places
}

/// A path without brackets, and without the place of a name.
fn path_of(text: &str) -> String {
    let parts = text.split(['.', '[', ']', ' ']);
    let parts = parts.filter(|part| !part.is_empty() && !["NAME", "default"].contains(part));
    parts.collect::<Vec<_>>().join(".")
}

fn ends_with(path: &str, wanted: &str) -> bool {
    let path = path.trim_start_matches('.');
    path == wanted
        || path
            .strip_suffix(wanted)
            .is_some_and(|front| front.ends_with('.'))
}

/// Whether the path is that of a key in a section with a name of the user's:
/// `rock.granite.density`.
fn is_of_a_name(section: &str, key: &str, wanted: &str) -> bool {
    let parts: Vec<&str> = wanted.split('.').collect();
    parts.len() == 3 && parts[0] == section && parts[2] == key
}

/// Whether the path is that of a section with a name of the user's: `rock.granite`.
fn is_a_name(place: &KeyPlace, wanted: &str) -> bool {
    let name = wanted.strip_prefix(&place.path);
    let is_one = name.is_some_and(|name| name.starts_with('.') && !name[1..].contains('.'));
    is_one && place.section.pattern.contains("NAME")
}

/// Name of a section, the documents that have it, and its sentence.
fn head(place: &KeyPlace) -> String {
    let pattern = match place.section.pattern {
        "" => "top",
        pattern => pattern,
    };
    let documents = place.documents.join(", ");
    format!("{pattern}  ({documents})  {}", place.section.says)
}

fn of_section(place: &KeyPlace) -> String {
    let mut out = head(place) + "\n";
    let keys: Vec<&Key> = place.section.all_keys().collect();
    let width = keys.iter().map(|key| key.name.len()).max().unwrap_or(0);
    for key in keys {
        let _ = writeln!(out, "  {:width$}  {}", key.name, key.says);
    }
    out
}

fn of_key(place: &KeyPlace, key: &Key) -> String {
    let mut out = String::new();
    let mut line = |name: &str, text: &str| {
        if !text.is_empty() {
            let _ = writeln!(out, "  {name:<8} {}", text.replace('`', ""));
        }
    };
    line("in", &head(place));
    line("holds", &holds(&key.kind));
    if let Some(quantity) = key.kind.quantity() {
        line("unit", &units(quantity.dimension));
        line("range", &quantity.range.to_string());
    }
    line("default", &need(key.need));
    line("example", &key.shown());
    if matches!(key.kind, Kind::Choice(_, names) if names == CLOSURES) {
        out += &laws();
    }
    format!("{}: {}\n{out}", key.name, key.says.replace('`', ""))
}

/// The closure laws, and which keys each takes.
fn laws() -> String {
    let mut out = "closure laws, and the keys of [fracture.NAME] that each takes\n".to_owned();
    for law in &LAWS {
        let _ = writeln!(out, "  {:<11}  {}", law.name, law.says);
        let may = match law.may {
            [] => String::new(),
            keys => format!("; may have {}", keys.join(", ")),
        };
        let _ = writeln!(out, "  {:<11}  needs {}{may}", "", law.needs.join(", "));
    }
    out + "  with friction_angle (and cohesion, dilation_angle) shear_stiffness may be left out;\n  \
           all but contact may have tensile_strength with fracture_energy\n"
}

fn units(dimension: crate::Dimension) -> String {
    let known = dimension.units().join(", ");
    match (dimension.unit(), known.is_empty()) {
        (unit, true) => unit.to_owned(),
        ("", false) => format!("none, or as text: {known}"),
        (unit, false) => format!("{unit}, or as text: {known}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_is_found_by_its_name_and_by_its_path() {
        for query in [
            "young_modulus",
            "rock.young_modulus",
            "[rock.NAME].young_modulus",
            "rock.granite.young_modulus",
        ] {
            let text = explain(query).expect(query);
            for part in [
                "[rock.NAME]",
                "Pa, or as text: Pa, kPa",
                "1 to 1e15",
                "required",
                "50e9",
            ] {
                assert!(text.contains(part), "{query}, {part}: {text}");
            }
        }
        assert!(explain("load.phase.steps").is_ok_and(|text| text.contains("whole number")));
        assert!(explain("rock.granite").is_ok_and(|text| text.contains("young_modulus")));
        assert!(explain("rock.granite.colour").is_err());
        assert!(explain("[mesh]").is_ok_and(|text| text.contains("h_fracture")));
    }

    #[test]
    fn an_unknown_key_comes_with_the_nearest() {
        let near = explain("yung_modulus").expect_err("unknown");
        assert_eq!(near.first(), Some(&"young_modulus"));
        assert!(explain("qqqqqq").expect_err("unknown").is_empty());
    }

    #[test]
    fn the_overview_names_every_key() {
        let text = overview();
        for section in Document::ALL
            .iter()
            .flat_map(|document| document.sections())
        {
            for key in section.keys {
                assert!(text.contains(key.name), "{}", key.name);
            }
        }
    }
}
