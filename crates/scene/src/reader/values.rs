//! Values of keys: numbers with and without units, words, flags.

use kluft_keys::{Kind, Need, Quantity, Range, Unreadable, nearest, read_quantity};
use toml::Spanned;
use toml::de::DeValue;

use super::Section;

impl<'a, 'i> Section<'a, 'i> {
    /// A number as the table of keys describes it.
    pub fn number(&self, key: &'static str) -> Option<f64> {
        let number = self.number_in(key, self.quantity(key).range)?;
        let is_whole = matches!(self.known(key)?.kind, Kind::Whole(_));
        if is_whole && number.fract() != 0.0 {
            let remedy = format!("write a whole number, e.g. {}", self.known(key)?.shown());
            let problem = format!("`{key}` = {number} in {}", self.name());
            self.refuse(key, problem, remedy);
            return None;
        }
        Some(number)
    }

    /// A number of another range, which follows from other keys or is checked by the caller.
    pub fn number_in(&self, key: &'static str, range: Range) -> Option<f64> {
        let quantity = self.quantity(key);
        self.number_of(key, Quantity { range, ..quantity })
    }

    /// A number of another kind, which follows from other keys.
    pub(super) fn number_of(&self, key: &'static str, quantity: Quantity) -> Option<f64> {
        let value = self.get(key)?;
        self.as_number(key, value, quantity)
    }

    /// What the table of keys says of a number.
    pub(crate) fn quantity(&self, key: &'static str) -> Quantity {
        let quantity = self.known(key).and_then(|key| key.kind.quantity());
        debug_assert!(quantity.is_some(), "{key} is no number");
        quantity.unwrap_or(Quantity::PLAIN)
    }

    /// A value as a number, with a doubt where it is hardly meant.
    pub(super) fn as_number(
        &self,
        key: &str,
        value: &Spanned<DeValue<'i>>,
        quantity: Quantity,
    ) -> Option<f64> {
        let number = self.as_plausible_number(key, value, quantity)?;
        self.doubt(key, value, (number, quantity));
        Some(number)
    }

    /// Keeps what is odd about a value.
    pub(super) fn doubt(
        &self,
        key: &str,
        value: &Spanned<DeValue<'i>>,
        (number, quantity): (f64, Quantity),
    ) {
        let doubt = quantity
            .plausible
            .and_then(|plausible| plausible.doubt(number, quantity.dimension));
        if let Some(doubt) = doubt {
            let doubt = format!("`{key}` = {number} in {} {doubt}", self.name());
            self.source.warn(&value.span(), &doubt);
        }
    }

    fn as_plausible_number(
        &self,
        key: &str,
        value: &Spanned<DeValue<'i>>,
        quantity: Quantity,
    ) -> Option<f64> {
        let number = match value.get_ref() {
            DeValue::String(text) if !quantity.dimension.units().is_empty() => {
                self.with_unit(key, value, (text, quantity))?
            }
            other => {
                let number = plain_number(other);
                if number.is_none() {
                    self.no_number(key, value, quantity);
                }
                number?
            }
        };
        if let Some(refusal) = quantity.range.refusal(number) {
            self.report(
                &value.span(),
                format!("`{key}` = {} in {}", readable(number), self.name()),
                format!("{key} {refusal}"),
            );
            return None;
        }
        Some(number)
    }

    /// Reports a value that is no number, or a whole one of too many digits.
    fn no_number(&self, key: &str, value: &Spanned<DeValue<'i>>, quantity: Quantity) {
        if value.get_ref().as_integer().is_none() {
            return self.wrong_type(key, value, &wanted(quantity));
        }
        let problem = format!("`{key}` in {} is too large a number", self.name());
        let remedy = "write it with a decimal point or an exponent, e.g. 1e20";
        self.report(&value.span(), problem, remedy.into());
    }

    /// Reads a number that is written with its unit.
    fn with_unit(
        &self,
        key: &str,
        value: &Spanned<DeValue<'i>>,
        (text, quantity): (&str, Quantity),
    ) -> Option<f64> {
        let dimension = quantity.dimension;
        let why = match read_quantity(text, dimension) {
            Ok(number) => return Some(number),
            Err(why) => why,
        };
        let place = format!("`{key}` in {}", self.name());
        let units = dimension.units().join(", ");
        let known = format!("{} in {units}", dimension.name());
        let (problem, remedy) = match why {
            Unreadable::NoNumber => (
                format!("{place} is of type string, and begins with no number"),
                format!("write {}", wanted(quantity)),
            ),
            Unreadable::NoUnit => (
                format!("{place} is of type string, and names no unit"),
                format!("write {}", wanted(quantity)),
            ),
            Unreadable::UnknownUnit(unit, near) => (
                format!("{place} has the unknown unit `{unit}`"),
                match near {
                    Some(near) => format!("did you mean `{near}`? write {known}"),
                    None => format!("write {known}"),
                },
            ),
            Unreadable::Other(unit, is) => (
                match is {
                    Some(is) => format!("{place}: `{unit}` is the unit of {}", is.name()),
                    None => format!("{place}: `{unit}` is not the unit of {}", dimension.name()),
                },
                format!("write {known}"),
            ),
        };
        self.report(&value.span(), problem, remedy);
        None
    }

    /// A truth value.
    pub fn flag(&self, key: &'static str) -> Option<bool> {
        let value = self.get(key)?;
        let flag = value.get_ref().as_bool();
        if flag.is_none() {
            self.wrong_type(key, value, "true or false");
        }
        flag
    }

    /// A text in quotes.
    pub fn text(&self, key: &'static str) -> Option<&'a str> {
        let value = self.get(key)?;
        let text = value.get_ref().as_str();
        if text.is_none() {
            self.wrong_type(key, value, "text in quotes");
        }
        text
    }

    /// One of the words that the table of keys has for it; another is reported with the nearest.
    pub fn choice(&self, key: &'static str) -> Option<&'static str> {
        let Some(Kind::Choice(what, words)) = self.known(key).map(|key| key.kind) else {
            debug_assert!(false, "{key} is no choice");
            return None;
        };
        let word = self.text(key)?;
        let found = words.iter().find(|known| **known == word).copied();
        if found.is_none() {
            let near = nearest(word, words.iter().copied());
            let near = near.map(|near| format!("did you mean \"{near}\"? "));
            let known = alternatives(words, self.known(key)?.need);
            let remedy = near.unwrap_or_default() + "write " + &known;
            self.refuse(key, format!("unknown {what} \"{word}\""), remedy);
        }
        found
    }
}

/// Words in quotes, the default marked: `"nodal" (the default) or "gauss"`.
fn alternatives(words: &[&str], need: Need) -> String {
    let quoted = words.iter().map(|word| {
        let word = format!("\"{word}\"");
        match matches!(need, Need::Default(default) if default == word) {
            true => word + " (the default)",
            false => word,
        }
    });
    let mut quoted: Vec<String> = quoted.collect();
    let last = quoted.pop().unwrap_or_default();
    match quoted.is_empty() {
        true => last,
        false => format!("{} or {last}", quoted.join(", ")),
    }
}

/// How a number is written.
fn wanted(quantity: Quantity) -> String {
    let dimension = quantity.dimension;
    match (dimension.unit(), dimension.units()) {
        (_, []) | ("", _) => "a number".into(),
        (unit, [.., last]) => {
            format!("a number (in {unit}), or with its unit as text, e.g. \"1.5 {last}\"")
        }
    }
}

/// A number, with a power of ten where it would have many digits.
fn readable(number: f64) -> String {
    match number.abs() {
        0.0 | 1e-6..1e17 => number.to_string(),
        _ => format!("{number:e}"),
    }
}

fn plain_number(value: &DeValue<'_>) -> Option<f64> {
    if let Some(float) = value.as_float() {
        return float.as_str().parse().ok();
    }
    let integer = value.as_integer()?;
    i64::from_str_radix(integer.as_str(), integer.radix())
        .ok()
        .map(|number| number as f64)
}
