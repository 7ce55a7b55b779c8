//! The types of the table: sections, keys, and what a key may hold.

use crate::dimension::Dimension;
use crate::plausible::Plausible;
use crate::range::Range;

/// A table of a document.
#[derive(Debug)]
pub struct KeySection {
    /// How documents call it, `[rock.NAME]`; empty for the top of the file.
    pub pattern: &'static str,
    /// What it is, in one sentence without a full stop.
    pub says: &'static str,
    /// Its keys, in the order of the reference.
    pub keys: &'static [Key],
    /// A section all of whose keys may stand here too.
    pub also: Option<&'static KeySection>,
}

/// A key of a section.
#[derive(Debug)]
pub struct Key {
    /// Its name.
    pub name: &'static str,
    /// What it may hold.
    pub kind: Kind,
    /// Whether it must be there, and what holds without it.
    pub need: Need,
    /// A value as TOML; for a section its head.
    pub example: &'static str,
    /// What it means, in one sentence without a full stop.
    pub says: &'static str,
}

/// A number: its dimension, its range, and where it commonly lies.
#[derive(Debug, Clone, Copy)]
pub struct Quantity {
    /// What kind of quantity it is.
    pub dimension: Dimension,
    /// Which numbers are accepted.
    pub range: Range,
    /// Where values commonly lie, if others raise doubts.
    pub plausible: Option<&'static Plausible>,
}

/// What a key may hold.
#[derive(Debug, Clone, Copy)]
pub enum Kind {
    /// A number.
    Number(Quantity),
    /// A whole number.
    Whole(Range),
    /// A truth value.
    Flag,
    /// A text.
    Text,
    /// The path of a file.
    Path,
    /// One of some words; what they are called.
    Choice(&'static str, &'static [&'static str]),
    /// Some of these words, in brackets.
    Choices(&'static [&'static str]),
    /// Texts in brackets.
    Texts,
    /// Two texts in brackets.
    Pair,
    /// Truth values in brackets.
    Flags,
    /// Numbers in brackets.
    Numbers(Quantity),
    /// Three numbers in brackets.
    Vector(Quantity),
    /// Points in brackets, each of three numbers.
    Points(Quantity),
    /// Times with factors, `[time, factor]` in brackets.
    History,
    /// Rows in brackets, each of a coordinate and a value.
    Rows,
    /// A number, or the keys of a section.
    NumberOr(Quantity, &'static KeySection),
    /// Three numbers in brackets, each of which may be the keys of a section instead.
    VectorOr(Quantity, &'static KeySection),
    /// Numbers under names that are free.
    FreeNumbers,
    /// A list of tables.
    Tables(&'static KeySection),
    /// A list of tables or words.
    TablesOrWords(&'static KeySection, &'static [&'static str]),
    /// Lists of numbers under the names of keys; such a section in the place of a list.
    Sweeps(&'static KeySection),
    /// A section of its own, or keys in braces.
    Table(&'static KeySection),
    /// Sections with a name: `[rock.NAME]`.
    Named(&'static KeySection),
    /// Sections in double brackets: `[[fixed_point]]`.
    Listed(&'static KeySection),
}

/// Whether a key must be there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Need {
    /// It must.
    Required,
    /// It or another one of the section must.
    Or(&'static str),
    /// It must, unless this holds.
    Unless(&'static str),
    /// It need not: this value, TOML and JSON alike, holds without it.
    Default(&'static str),
    /// It need not: what holds without it, in words.
    Without(&'static str),
}

/// A section whose keys are free.
pub(crate) static FREE: KeySection = KeySection {
    pattern: "names of your own",
    says: "Numbers under names that are free",
    keys: &[],
    also: None,
};

/// A number of this dimension and range.
pub(crate) const fn quantity(dimension: Dimension, range: Range) -> Quantity {
    Quantity {
        dimension,
        range,
        plausible: None,
    }
}

/// A key that holds a number.
pub(crate) const fn number(dimension: Dimension, range: Range) -> Kind {
    Kind::Number(quantity(dimension, range))
}

/// A key that holds a number whose unlikely values raise doubts.
pub(crate) const fn watched(
    dimension: Dimension,
    range: Range,
    plausible: &'static Plausible,
) -> Kind {
    Kind::Number(Quantity {
        dimension,
        range,
        plausible: Some(plausible),
    })
}

impl Quantity {
    /// A number of any size without a unit.
    pub const PLAIN: Self = quantity(Dimension::One, Range::Finite);
}

impl KeySection {
    /// The key with a name, and the section that has it as its own.
    pub fn find(&'static self, name: &str) -> Option<(&'static KeySection, &'static Key)> {
        let own = self.keys.iter().find(|key| key.name == name);
        own.map(|key| (self, key))
            .or_else(|| self.also.and_then(|also| also.find(name)))
    }

    /// The key with a name.
    pub fn key(&'static self, name: &str) -> Option<&'static Key> {
        self.find(name).map(|(_, key)| key)
    }

    /// All keys that may stand in it, its own first.
    pub fn all_keys(&'static self) -> impl Iterator<Item = &'static Key> {
        let also = self.also.map_or(&[][..], |also| also.keys);
        self.keys.iter().chain(also)
    }
}

impl Key {
    /// The key as an example shows it; a section is its head alone.
    pub fn shown(&self) -> String {
        match self.kind.heads_section(self.example) {
            true => self.example.to_owned(),
            false => format!("{} = {}", self.name, self.example),
        }
    }
}

impl Kind {
    /// The number that it holds, alone or in a list.
    pub fn quantity(&self) -> Option<Quantity> {
        match *self {
            Self::Number(quantity)
            | Self::Numbers(quantity)
            | Self::Vector(quantity)
            | Self::Points(quantity)
            | Self::NumberOr(quantity, _)
            | Self::VectorOr(quantity, _) => Some(quantity),
            Self::Whole(range) => Some(quantity(Dimension::One, range)),
            _ => None,
        }
    }

    /// The section that it holds.
    pub fn section(&self) -> Option<&'static KeySection> {
        match *self {
            Self::NumberOr(_, section)
            | Self::VectorOr(_, section)
            | Self::Tables(section)
            | Self::TablesOrWords(section, _)
            | Self::Sweeps(section)
            | Self::Table(section)
            | Self::Named(section)
            | Self::Listed(section) => Some(section),
            Self::FreeNumbers => Some(&FREE),
            _ => None,
        }
    }

    /// Whether an example of it is the head of a section.
    pub fn heads_section(&self, example: &str) -> bool {
        matches!(self, Self::Table(_) | Self::Named(_) | Self::Listed(_))
            && example.starts_with('[')
    }
}
