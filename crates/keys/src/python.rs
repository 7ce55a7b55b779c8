//! The table as classes of Python, for the package `kluft`.

use std::fmt::Write;

use crate::document::Document;
use crate::table::{Key, KeySection, Kind, Need};

/// Columns of a line of documentation.
const WIDTH: usize = 100;

const HEAD: &str = "\
\"\"\"The sections of a scene as classes; made from the table of keys, do not edit.

Every class takes the keys of its section as keywords. Numbers are in the unit that is given; a text
has its unit with it: `\"60 GPa\"`. What is left out has the value of a scene file without the key.
\"\"\"

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any, Literal, TypeAlias

Quantity: TypeAlias = float | str
\"\"\"A number in SI units, or a text with a number and its unit.\"\"\"


class Section:
    \"\"\"Keys of a section with their values.\"\"\"

    def __init__(self, **keys: Any) -> None:
        self.tables: dict[str, Any] = {key: value for key, value in keys.items() if value is not None}
        \"\"\"The keys that are given.\"\"\"

    def __repr__(self) -> str:
        keys = \", \".join(f\"{key}={value!r}\" for key, value in self.tables.items())
        return f\"{type(self).__name__}({keys})\"
";

/// The module `kluft.keys`: a class for each section of a scene that a run obeys.
pub fn python() -> String {
    let sections = Document::Scene.sections().into_iter();
    let studies = Document::Study.sections();
    let own =
        sections.filter(|section| !studies.iter().any(|other| std::ptr::eq(*other, *section)));
    let own: Vec<&KeySection> = own.collect();
    let mut out = HEAD.to_owned();
    // A class stands below those that it names, so that readers meet small ones first.
    for section in own.iter().rev() {
        write_class(&mut out, section);
    }
    let mut names: Vec<&str> = own.iter().map(|section| class_name(section)).collect();
    names.retain(|name| *name != ROOT);
    names.sort_unstable();
    out.push_str("\n\n__all__ = [\n");
    for name in names {
        let _ = writeln!(out, "    \"{name}\",");
    }
    out.push_str("]\n");
    out
}

/// The class of the top of a scene.
const ROOT: &str = "SceneSections";

/// The class of a section.
fn class_name(section: &KeySection) -> &'static str {
    match section.pattern {
        "" => ROOT,
        "[mesh]" => "MeshSource",
        "[mesh.adapt]" => "Adapt",
        "[rock.NAME]" => "Rock",
        "[fracture.NAME]" => "Fracture",
        "[boundary.NAME]" => "Boundary",
        "[boundary.NAME.fluid_pressure]" => "FluidPressure",
        "[fluid.initial_pressure]" => "InitialPressure",
        "[source.pressure]" => "SourcePressure",
        "a value that varies" => "Varying",
        "[probe.NAME]" => "Probe",
        "[[fixed_point]]" => "FixedPoint",
        "displacement" => "Displacement",
        "[body]" => "Body",
        "[fluid]" => "Fluid",
        "[[source]]" => "Source",
        "[initial_stress]" => "InitialStress",
        "[initial_stress.XX]" => "StressProfile",
        "[load]" => "Load",
        "[[load.phase]]" => "Phase",
        "[solver]" => "Solver",
        "[strength_reduction]" => "StrengthReduction",
        "[warnings]" => "Warnings",
        "[oracle.NAME]" => "Oracle",
        // Shown by a test to occur nowhere.
        _ => "Unnamed",
    }
}

fn write_class(out: &mut String, section: &'static KeySection) {
    let keys: Vec<&Key> = section
        .all_keys()
        .filter(|key| key.name != "study")
        .collect();
    let _ = write!(out, "\n\nclass {}(Section):\n", class_name(section));
    let _ = writeln!(out, "    \"\"\"{}.", section.says.replace('\\', "\\\\"));
    out.push_str("\n    Args:\n");
    for key in &keys {
        write_meaning(out, key);
    }
    out.push_str("    \"\"\"\n\n    def __init__(\n        self,\n        *,\n");
    for key in &keys {
        let _ = writeln!(
            out,
            "        {}: {} | None = None,",
            argument(key.name),
            annotation(&key.kind)
        );
    }
    out.push_str("    ) -> None:\n        super().__init__(\n");
    for key in &keys {
        let _ = match argument(key.name) {
            same if same == key.name => writeln!(out, "            {same}={same},"),
            other => writeln!(out, "            **{{\"{}\": {other}}},", key.name),
        };
    }
    out.push_str("        )\n");
}

/// The name of the argument for a key: with an underscore behind what is a word of Python's own.
fn argument(name: &str) -> String {
    match name {
        "from" | "in" | "is" | "as" | "global" | "lambda" | "with" => format!("{name}_"),
        name => name.to_owned(),
    }
}

/// A key with its unit, meaning, range and need.
fn write_meaning(out: &mut String, key: &Key) {
    let quantity = key.kind.quantity();
    let unit = quantity.map_or("", |quantity| quantity.dimension.unit());
    let unit = match unit {
        "" => String::new(),
        unit => format!(" ({unit})"),
    };
    let range = quantity.map_or(String::new(), |quantity| quantity.range.to_string());
    let range = match range.as_str() {
        "" => range,
        range => format!("; {range}"),
    };
    let need = match key.need {
        Need::Required => "Required".to_owned(),
        Need::Or(other) => format!("This or `{other}` is required"),
        Need::Unless(holds) => format!("Required, unless {holds}"),
        Need::Default(value) => format!("Without it {value}"),
        Need::Without(what) => format!("Without it: {what}"),
    };
    let text = format!("{}: {}{unit}{range}. {need}.", argument(key.name), key.says);
    wrap(out, &text.replace('\\', "\\\\"));
}

/// A paragraph below `Args:`; what follows its first line is set in.
fn wrap(out: &mut String, text: &str) {
    let mut line = " ".repeat(7);
    for word in text.split(' ') {
        if line.chars().count() + 1 + word.chars().count() > WIDTH {
            let _ = writeln!(out, "{line}");
            line = " ".repeat(11);
        }
        line.push(' ');
        line.push_str(word);
    }
    let _ = writeln!(out, "{line}");
}

/// What a key takes.
fn annotation(kind: &Kind) -> String {
    let literal = |words: &[&str]| {
        let quoted: Vec<String> = words.iter().map(|word| format!("\"{word}\"")).collect();
        format!("Literal[{}]", quoted.join(", "))
    };
    let number = |dimension: crate::dimension::Dimension| match dimension.units().is_empty() {
        true => "float",
        false => "Quantity",
    };
    let one = |section: &KeySection| format!("{} | Mapping[str, Any]", class_name(section));
    match *kind {
        Kind::Number(quantity) => number(quantity.dimension).to_owned(),
        Kind::Whole(_) => "int".to_owned(),
        Kind::Flag => "bool".to_owned(),
        Kind::Text => "str".to_owned(),
        Kind::Path => "str | os.PathLike[str]".to_owned(),
        Kind::Choice(_, words) => literal(words),
        Kind::Choices(words) => format!("Sequence[{}]", literal(words)),
        Kind::Pair | Kind::Texts => "Sequence[str]".to_owned(),
        Kind::Flags => "Sequence[bool]".to_owned(),
        Kind::Numbers(quantity) | Kind::Vector(quantity) => {
            format!("Sequence[{}]", number(quantity.dimension))
        }
        Kind::Points(_) | Kind::History | Kind::Rows => "Sequence[Sequence[float]]".to_owned(),
        Kind::NumberOr(quantity, section) => {
            format!("{} | {}", number(quantity.dimension), one(section))
        }
        Kind::VectorOr(quantity, section) => {
            let entry = format!("{} | {}", number(quantity.dimension), one(section));
            format!("Sequence[{entry}]")
        }
        Kind::FreeNumbers => "Mapping[str, float]".to_owned(),
        Kind::Tables(_) | Kind::TablesOrWords(..) | Kind::Sweeps(_) => "Any".to_owned(),
        Kind::Table(section) => one(section),
        Kind::Named(section) => format!("Mapping[str, {}]", one(section)),
        Kind::Listed(section) => format!("Sequence[{}]", one(section)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_section_has_a_class_of_its_own() {
        let module = python();
        assert!(!module.contains("Unnamed"), "a section without a name");
        let lines = module.lines();
        let classes =
            lines.filter(|line| line.starts_with("class ") && line.ends_with("(Section):"));
        let classes: Vec<&str> = classes.collect();
        for class in &classes {
            assert_eq!(
                classes.iter().filter(|other| *other == class).count(),
                1,
                "{class}"
            );
        }
        for found in [
            "class Rock(",
            "young_modulus: Quantity | Varying | Mapping[str, Any] | None",
            "class SceneSections(",
            "**{\"from\": from_},",
        ] {
            assert!(module.contains(found), "{found}");
        }
    }
}
