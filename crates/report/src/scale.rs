//! The scale of a picture: which values get which colour, and how they are written.

/// Values that differ by less than this share of the largest are one value: the rest is rounding.
const SAME: f32 = 1e-6;
/// The scale is that of all values but a hundredth at either end, if those stretch it so much.
const STRETCH: f32 = 3.0;

/// Values at the ends of a scale.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    low: f32,
    high: f32,
    /// Whether values lie below and above.
    beyond: [bool; 2],
}

impl Scale {
    /// The scale of values; none if none of them is a number.
    pub fn of(values: &[f32]) -> Option<Self> {
        let mut values: Vec<f32> = values.iter().copied().filter(|x| x.is_finite()).collect();
        let last = values.len().checked_sub(1)?;
        let mut at = |place: usize| *values.select_nth_unstable_by(place, f32::total_cmp).1;
        let (min, max) = (at(0), at(last));
        let (low, high) = (at(last / 100), at(last - last / 100));
        if high > low && max - min > STRETCH * (high - low) {
            let beyond = [min < low, max > high];
            return Some(Self { low, high, beyond });
        }
        let beyond = [false; 2];
        let (low, high) = (min, max);
        Some(Self { low, high, beyond })
    }

    /// Whether all values are one.
    pub fn is_one(&self) -> bool {
        self.high - self.low <= SAME * self.high.abs().max(self.low.abs())
    }

    /// The share of the scale below a value.
    pub fn share(&self, value: f32) -> f32 {
        match self.is_one() {
            true => 0.5,
            false => (value - self.low) / (self.high - self.low),
        }
    }

    /// The ends in words; one if all values are one.
    pub fn words(&self, unit: &str) -> Vec<String> {
        let (low, high) = (f64::from(self.low), f64::from(self.high));
        let (factor, unit) = prefixed(low.abs().max(high.abs()), unit);
        let largest = low.abs().max(high.abs());
        // Rounding beside values that count.
        let shown = |value: f64| {
            if value.abs() > f64::from(SAME) * largest {
                value
            } else {
                0.0
            }
        };
        let number = |value: f64| significant(shown(value) / factor).replace('-', "−");
        let mark = |is_beyond: bool, sign: &str| {
            if is_beyond {
                format!("{sign} ")
            } else {
                String::new()
            }
        };
        match self.is_one() {
            true => vec![format!("{} {unit}", number(0.5 * (low + high)))],
            false => vec![
                format!("{}{} {unit}", mark(self.beyond[0], "≤"), number(low)),
                format!("{}{} {unit}", mark(self.beyond[1], "≥"), number(high)),
            ],
        }
    }
}

/// A multiple of a unit that suits a size, and its name.
pub fn prefixed(size: f64, unit: &str) -> (f64, String) {
    const PREFIXES: [(f64, &str); 7] = [
        (1e9, "G"),
        (1e6, "M"),
        (1e3, "k"),
        (1.0, ""),
        (1e-3, "m"),
        (1e-6, "µ"),
        (1e-9, "n"),
    ];
    // Nobody writes millipascals or kilometres of aperture.
    let suits = |factor: f64| match unit {
        "m" => factor <= 1.0,
        "Pa" => factor >= 1.0,
        _ => factor == 1.0,
    };
    let mut prefixes = PREFIXES.iter().filter(|(factor, _)| suits(*factor));
    let found = prefixes.find(|(factor, _)| size >= *factor);
    let (factor, prefix) = found.unwrap_or(&(1.0, ""));
    (*factor, format!("{prefix}{unit}"))
}

/// A value with three digits that count, in a multiple of its unit.
pub fn quantity(value: f64, unit: &str) -> String {
    let (factor, unit) = prefixed(value.abs(), unit);
    let text = format!("{} {unit}", significant(value / factor).replace('-', "−"));
    text.trim_end().to_owned()
}

/// Three digits that count.
fn significant(value: f64) -> String {
    let scientific = format!("{value:.2e}");
    let exponent = scientific
        .rsplit('e')
        .next()
        .and_then(|text| text.parse().ok());
    match exponent {
        _ if value == 0.0 => "0".into(),
        Some(exponent @ -3..6) => {
            let digits = i32::max(2 - exponent, 0) as usize;
            format!("{value:.digits$}")
        }
        _ => scientific,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_have_units_that_suit() {
        let words = |values: &[f32], unit: &str| Scale::of(values).expect("numbers").words(unit);
        assert_eq!(words(&[9.5e-5, 1e-5], "m"), ["10.0 µm", "95.0 µm"]);
        assert_eq!(words(&[-7e6, 0.0], "Pa"), ["−7.00 MPa", "0 MPa"]);
        assert_eq!(words(&[2.5e-4; 3], "m"), ["250 µm"]);
        assert_eq!(words(&[0.0; 3], "m"), ["0 m"]);
        assert_eq!(words(&[1e-13, 9e5], "Pa"), ["0 kPa", "900 kPa"]);
        assert_eq!(words(&[1.0, f32::NAN, 1.000_000_1], "m"), ["1.00 m"]);
    }

    #[test]
    fn numbers_have_three_digits_that_count() {
        let wanted = [
            (0.0, "m", "0 m"),
            (9.999_6e-6, "m", "10.0 µm"),
            (-6.25e6, "Pa", "−6.25 MPa"),
            (123.456, "m", "123 m"),
            (1.5e-14, "m2", "1.50e−14 m2"),
            (0.25, "", "0.250"),
            (f64::NAN, "m", "NaN m"),
        ];
        for (value, unit, text) in wanted {
            assert_eq!(quantity(value, unit), text);
        }
    }

    #[test]
    fn a_few_values_far_off_do_not_take_the_colours() {
        let mut values: Vec<f32> = (0..1000).map(|i| 1.0 + i as f32 / 1000.0).collect();
        values.extend([1e6, -1e6]);
        let scale = Scale::of(&values).expect("numbers");
        let words = scale.words("m");
        assert!(
            words[0].starts_with("≤ 1.01") && words[1].starts_with("≥ 1.99"),
            "{words:?}"
        );
        assert!(scale.share(1.5) > 0.4 && scale.share(1.5) < 0.6);
    }

    #[test]
    fn without_a_number_there_is_no_scale() {
        assert_eq!(Scale::of(&[]), None);
        assert_eq!(Scale::of(&[f32::NAN]), None);
    }
}
