//! The table as a page of the reference.

use std::fmt::Write;

use crate::document::Document;
use crate::scene::FIELD;
use crate::table::{Key, KeySection, Kind, Need};

/// The reference page of a document, in Markdown.
pub fn page(document: Document) -> String {
    let mut out = format!("# {}\n\n{}\n", heading(document), introduction(document));
    let elsewhere = elsewhere(document);
    let (own, others): (Vec<_>, Vec<_>) = document.sections().into_iter().partition(|section| {
        let mut others = elsewhere.iter().flat_map(|other| other.sections());
        !others.any(|other| std::ptr::eq(other, *section))
    });
    for section in own {
        write_section(&mut out, section, document);
    }
    if let [other] = elsewhere
        && !others.is_empty()
    {
        let name = other.name();
        let _ = writeln!(
            out,
            "\n## Other sections\n\nThey are in the [keys of a {name}](keys-{name}.md):\n"
        );
        for section in others {
            let _ = writeln!(out, "- `{}`: {}", section.pattern, section.says);
        }
    }
    if document == Document::Network {
        let _ = writeln!(
            out,
            "\n# Columns of a list\n\n{}.\n",
            Document::List.root().says
        );
        write_table(&mut out, Document::List.root().keys);
    }
    out
}

/// The document on whose page sections stand that this one has too.
fn elsewhere(document: Document) -> &'static [Document] {
    match document {
        Document::Scene => &[Document::Study],
        Document::Network => &[Document::Scene],
        Document::Study | Document::List => &[],
    }
}

fn heading(document: Document) -> &'static str {
    match document {
        Document::Scene => "Keys of a scene",
        Document::Network => "Keys of a network description",
        Document::Study => "Keys of a study",
        Document::List => "Columns of a list",
    }
}

fn introduction(document: Document) -> &'static str {
    match document {
        Document::Scene => {
            "\
A scene is a TOML file; paths in it are relative to it, and unknown keys are errors.
Plain numbers are in the unit of the table. A number with a unit is written as text,
`young_modulus = \"60 GPa\"`, and may have any unit of the same dimension. `kluft explain KEY`
says the same in a terminal, `kluft schema` lets an editor complete and check keys.

This page is made from the table of keys in `crates/keys`."
        }
        Document::Network => {
            "\
A description for `kluft network` is a TOML file. Plain numbers are in the unit of the table; a
number with a unit is written as text, `h = \"50 cm\"`.

This page is made from the table of keys in `crates/keys`."
        }
        Document::Study => {
            "\
The table `[study]` of a scene says what `kluft study` sweeps.

This page is made from the table of keys in `crates/keys`."
        }
        Document::List => "A list is a CSV file.",
    }
}

fn write_section(out: &mut String, section: &'static KeySection, document: Document) {
    let head = match section.pattern {
        "" => "Top of the file".to_owned(),
        pattern if pattern.starts_with('[') => format!("`{pattern}`"),
        pattern => capital(pattern),
    };
    let _ = writeln!(out, "\n## {head}\n\n{}.\n", section.says);
    write_table(out, section.keys);
    if let Some(also) = section.also {
        let place = match document {
            Document::Scene => "above",
            _ => "in the keys of a scene",
        };
        let _ = writeln!(
            out,
            "\nTo these come the keys of `{}` {place}.",
            also.pattern
        );
    }
}

fn write_table(out: &mut String, keys: &[Key]) {
    out.push_str("| key | holds | unit | range | default | meaning |\n|---|---|---|---|---|---|\n");
    for key in keys {
        let quantity = key.kind.quantity();
        let unit = quantity.map_or("", |quantity| quantity.dimension.unit());
        let range = quantity.map_or(String::new(), |quantity| quantity.range.to_string());
        let _ = writeln!(
            out,
            "| `{}` | {} | {unit} | {range} | {} | {}, e.g. `{}` |",
            key.name,
            holds(&key.kind),
            need(key.need),
            key.says,
            key.example
        );
    }
}

/// What a key may hold, in words.
pub(crate) fn holds(kind: &Kind) -> String {
    let words = |words: &[&str]| format!("`\"{}\"`", words.join("\"`, `\""));
    match *kind {
        Kind::Number(_) => "number".into(),
        Kind::Whole(_) => "whole number".into(),
        Kind::Flag => "`true` or `false`".into(),
        Kind::Text => "text".into(),
        Kind::Path => "path".into(),
        Kind::Choice(_, known) => words(known),
        Kind::Choices(known) => format!("list of {}", words(known)),
        Kind::Pair => "two texts in brackets".into(),
        Kind::Texts => "list of names".into(),
        Kind::Flags => "list of `true` and `false`".into(),
        Kind::Numbers(_) => "list of numbers".into(),
        Kind::Vector(_) => "`[x, y, z]`".into(),
        Kind::Points(_) => "list of `[x, y, z]`".into(),
        Kind::Rows => "list of `[coordinate, value]`".into(),
        Kind::VectorOr(_, section) => {
            format!("`[x, y, z]` of numbers or {}", reference(section))
        }
        Kind::History => "list of `[time, factor]`".into(),
        Kind::NumberOr(_, section) => format!("number or {}", reference(section)),
        Kind::FreeNumbers => "table of numbers".into(),
        Kind::Tables(_) => "list of tables of numbers".into(),
        Kind::TablesOrWords(_, known) => format!("list of tables, {}", words(known)),
        Kind::Sweeps(section) => format!("lists of numbers or {}", names(section)),
        Kind::Table(_) => "section".into(),
        Kind::Named(_) => "sections with a name".into(),
        Kind::Listed(_) => "sections".into(),
    }
}

/// A section in braces: its keys, or what it is called where others have it too.
fn reference(section: &KeySection) -> String {
    match std::ptr::eq(section, &FIELD) {
        true => format!(
            "[{0}](#{1})",
            section.pattern,
            section.pattern.replace(' ', "-")
        ),
        false => names(section),
    }
}

fn names(section: &KeySection) -> String {
    let names: Vec<&str> = section.keys.iter().map(|key| key.name).collect();
    format!("`{{ {} }}`", names.join(", "))
}

/// Whether a key must be there, and what holds without it.
pub(crate) fn need(need: Need) -> String {
    match need {
        Need::Required => "required".into(),
        Need::Or(other) => format!("this or `{other}`"),
        Need::Unless(holds) => format!("required, unless {holds}"),
        Need::Default(value) => format!("`{value}`"),
        Need::Without(what) => what.into(),
    }
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters
        .next()
        .map(|letter| letter.to_uppercase().to_string());
    first.unwrap_or_default() + letters.as_str()
}
