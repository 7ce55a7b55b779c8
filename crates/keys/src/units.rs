//! Quantities written with a unit: `60 GPa`, `0.1 mm`, `20 GPa/m`, `12 degrees`.
//!
//! A unit is a product of symbols with SI prefixes and whole powers, so that it stands for a power
//! of ten times the SI unit. The number is taken as decimal text and its exponent is shifted by
//! that power before it is converted: `0.1 mm` is the same bits as `1e-4`.

use crate::dimension::{Dimension, Exponents};
use crate::names::nearest;

/// Why a text is no quantity of a dimension.
#[derive(Debug, Clone, PartialEq)]
pub enum Unreadable {
    /// It does not begin with a number.
    NoNumber,
    /// Nothing follows the number.
    NoUnit,
    /// The unit is not known; what it may be meant for.
    UnknownUnit(String, Option<&'static str>),
    /// The unit is of another dimension, if of any that is known.
    Other(String, Option<Dimension>),
}

/// What a unit measures.
#[derive(Clone, Copy, PartialEq)]
enum UnitMeasure {
    Si(Exponents),
    Angle,
    Memory,
    Share,
}

/// How much the SI unit is contained in a unit.
#[derive(Clone, Copy)]
enum UnitScale {
    PowerOfTen(i32),
    Factor(f64),
}

/// Reads a number with its unit, as plain numbers of that dimension are given.
///
/// # Errors
/// A text without number or unit, and a unit that is unknown or of another dimension.
pub fn read_quantity(text: &str, dimension: Dimension) -> Result<f64, Unreadable> {
    let (number, unit) = split(text.trim()).ok_or(Unreadable::NoNumber)?;
    let unit = unit.trim();
    if unit.is_empty() {
        return Err(Unreadable::NoUnit);
    }
    let Some((measure, scale)) = read_unit(unit) else {
        let near = nearest(unit, dimension.units().iter().copied());
        return Err(Unreadable::UnknownUnit(unit.to_owned(), near));
    };
    if measure_of(dimension) != Some(measure) {
        let mut known = Dimension::WITH_UNITS.into_iter();
        let is = known.find(|known| measure_of(*known) == Some(measure));
        return Err(Unreadable::Other(unit.to_owned(), is));
    }
    match scale {
        UnitScale::PowerOfTen(power) => shifted(&number, power),
        UnitScale::Factor(factor) => shifted(&number, 0).map(|number| number * factor),
    }
    .ok_or(Unreadable::NoNumber)
}

fn measure_of(dimension: Dimension) -> Option<UnitMeasure> {
    match dimension {
        Dimension::One => Some(UnitMeasure::Share),
        Dimension::Angle => Some(UnitMeasure::Angle),
        Dimension::Memory => Some(UnitMeasure::Memory),
        other => other.exponents().map(UnitMeasure::Si),
    }
}

/// Decimal text of a number: what stands before the exponent, and the exponent.
struct Decimal {
    mantissa: String,
    exponent: i64,
}

/// The decimal number, multiplied by a power of ten before it is rounded to binary.
fn shifted(number: &Decimal, power: i32) -> Option<f64> {
    let exponent = number.exponent.checked_add(i64::from(power))?;
    format!("{}e{exponent}", number.mantissa).parse().ok()
}

/// Parts the number at the front of a text from the rest.
fn split(text: &str) -> Option<(Decimal, &str)> {
    let digits = |text: &str| {
        text.len()
            - text
                .trim_start_matches(|c: char| c.is_ascii_digit() || c == '_')
                .len()
    };
    let sign = usize::from(text.starts_with(['+', '-']));
    let whole = digits(&text[sign..]);
    let mut end = sign + whole;
    if text[end..].starts_with('.') {
        end += 1 + digits(&text[end + 1..]);
    }
    let mantissa = text[..end].replace('_', "");
    if !mantissa.contains(|c: char| c.is_ascii_digit()) {
        return None;
    }
    let mut exponent = 0;
    if let Some(rest) = text[end..].strip_prefix(['e', 'E']) {
        let sign = usize::from(rest.starts_with(['+', '-']));
        let count = digits(&rest[sign..]);
        if count > 0 {
            exponent = rest[..sign + count].replace('_', "").parse().ok()?;
            end += 1 + sign + count;
        }
    }
    Some((Decimal { mantissa, exponent }, &text[end..]))
}

fn read_unit(unit: &str) -> Option<(UnitMeasure, UnitScale)> {
    const BYTES: [(&str, i32); 6] = [
        ("B", 0),
        ("bytes", 0),
        ("kB", 3),
        ("MB", 6),
        ("GB", 9),
        ("TB", 12),
    ];
    const BINARY: [(&str, i32); 4] = [("KiB", 10), ("MiB", 20), ("GiB", 30), ("TiB", 40)];
    if let Some((_, power)) = BYTES.iter().find(|(name, _)| *name == unit) {
        return Some((UnitMeasure::Memory, UnitScale::PowerOfTen(*power)));
    }
    if let Some((_, power)) = BINARY.iter().find(|(name, _)| *name == unit) {
        return Some((UnitMeasure::Memory, UnitScale::Factor(2.0_f64.powi(*power))));
    }
    match unit {
        "%" => Some((UnitMeasure::Share, UnitScale::PowerOfTen(-2))),
        "degrees" | "degree" | "deg" | "°" => Some((UnitMeasure::Angle, UnitScale::PowerOfTen(0))),
        "rad" => Some((UnitMeasure::Angle, UnitScale::Factor(1_f64.to_degrees()))),
        _ => product(unit)
            .map(|(exponents, power)| (UnitMeasure::Si(exponents), UnitScale::PowerOfTen(power))),
    }
}

/// A product of symbols, `GPa/m`, `kg m-3` or `1/m`: its powers, and its power of ten.
fn product(unit: &str) -> Option<(Exponents, i32)> {
    let mut all: Exponents = [0; 3];
    let mut power_of_ten: i32 = 0;
    for (number, part) in unit.split('/').enumerate() {
        // What follows a slash is divided by, up to the next space or dot.
        for (place, factor) in part
            .split([' ', '*', '·'])
            .filter(|factor| !factor.is_empty())
            .enumerate()
        {
            let sign = if number > 0 && place == 0 { -1 } else { 1 };
            if factor == "1" && number == 0 && unit.contains('/') {
                continue;
            }
            let (exponents, ten, power) = symbol_with_power(factor)?;
            for (sum, one) in all.iter_mut().zip(exponents) {
                *sum += sign * power * one;
            }
            power_of_ten += sign * power * ten;
        }
        if part.trim().is_empty() {
            return None;
        }
    }
    Some((all, power_of_ten))
}

/// `mm2`, `m^-3` or `s²`: powers of the symbol, its power of ten, and the power of both.
fn symbol_with_power(factor: &str) -> Option<(Exponents, i32, i32)> {
    let is_letter = |c: char| c.is_alphabetic();
    let end = factor.find(|c| !is_letter(c)).unwrap_or(factor.len());
    let (symbol, power) = factor.split_at(end);
    let power = match power {
        "" => 1,
        "²" => 2,
        "³" => 3,
        digits => {
            let digits = digits.strip_prefix('^').unwrap_or(digits);
            let power = digits.parse::<i8>().ok();
            power.filter(|power| *power != 0)?.into()
        }
    };
    let (exponents, ten) = read_symbol(symbol)?;
    Some((exponents, ten, power))
}

/// A symbol with or without a prefix: its powers and its power of ten.
fn read_symbol(symbol: &str) -> Option<(Exponents, i32)> {
    const PREFIXES: [(&str, i32); 12] = [
        ("n", -9),
        ("u", -6),
        ("µ", -6),
        ("μ", -6),
        ("m", -3),
        ("c", -2),
        ("d", -1),
        ("h", 2),
        ("k", 3),
        ("M", 6),
        ("G", 9),
        ("T", 12),
    ];
    if symbol == "t" {
        return Some(([0, 1, 0], 3));
    }
    let plain = |symbol: &str| match symbol {
        "m" => Some(([1, 0, 0], 0)),
        "g" => Some(([0, 1, 0], -3)),
        "s" => Some(([0, 0, 1], 0)),
        "N" => Some(([1, 1, -2], 0)),
        "Pa" => Some(([-1, 1, -2], 0)),
        "J" => Some(([2, 1, -2], 0)),
        "bar" => Some(([-1, 1, -2], 5)),
        _ => None,
    };
    plain(symbol).or_else(|| {
        PREFIXES.iter().find_map(|(prefix, power)| {
            let (exponents, ten) = plain(symbol.strip_prefix(prefix)?)?;
            Some((exponents, ten + power))
        })
    })
}

#[cfg(test)]
mod tests;
