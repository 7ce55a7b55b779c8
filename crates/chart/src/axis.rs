//! Axes: range, ticks and their labels.

use std::ops::Range;

use plotters::coord::ranged1d::{
    KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter as Formatter,
};

/// Logarithmic axes of fewer decades have ticks between the powers of ten.
const FEW_DECADES: f64 = 2.0;
/// Free space beyond the outermost values, as a share of their range.
const MARGIN: f64 = 0.05;

/// How values are laid out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Evenly.
    Linear,
    /// By their logarithms; ticks are powers of ten.
    Logarithmic,
}

/// An axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// What it measures, with the unit.
    pub title: String,
    /// Its scale.
    pub scale: Scale,
    /// Values below this are drawn here, and the tick says so: for errors that may be zero.
    pub floor: Option<f64>,
}

impl Axis {
    /// A linear axis.
    pub fn linear(title: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            scale: Scale::Linear,
            floor: None,
        }
    }

    /// A logarithmic axis.
    pub fn logarithmic(title: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            scale: Scale::Logarithmic,
            floor: None,
        }
    }

    /// The same axis, with values below `floor` drawn there.
    #[must_use]
    pub fn from(self, floor: f64) -> Self {
        Self {
            floor: Some(floor),
            ..self
        }
    }

    /// Whether a value has a place on the axis.
    pub(super) fn takes(&self, value: f64) -> bool {
        let value = self.at(value);
        value.is_finite() && (self.scale == Scale::Linear || value > 0.0)
    }

    /// Where a value is drawn.
    pub(super) fn at(&self, value: f64) -> f64 {
        match self.floor {
            Some(floor) if value < floor => floor,
            _ => value,
        }
    }

    /// The range of the axis for values it takes, with so many ticks at most.
    pub(super) fn over(&self, values: impl Iterator<Item = f64>, most_ticks: usize) -> Spanned {
        let forth = |value: f64| self.scale.forth(self.at(value));
        let places: Vec<f64> = values
            .filter(|&value| self.takes(value))
            .map(forth)
            .collect();
        let mut low = places.iter().copied().fold(f64::INFINITY, f64::min);
        let mut high = places.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        if low > high {
            (low, high) = (0.0, 1.0);
        }
        // Lengths of positive numbers compare only from zero on.
        if self.scale == Scale::Linear && low > 0.0 {
            low = 0.0;
        }
        // A chart of one value still has a width.
        let width = (high - low).max(1e-9 * high.abs()).max(f64::MIN_POSITIVE);
        let width = if high > low { width } else { 1.0 };
        Spanned {
            scale: self.scale,
            floor: self.floor,
            most_ticks,
            counts: places.iter().all(|place| place.fract() == 0.0),
            low: low - MARGIN * width,
            high: high + MARGIN * width,
        }
    }
}

impl Scale {
    fn forth(self, value: f64) -> f64 {
        match self {
            Self::Linear => value,
            Self::Logarithmic => value.log10(),
        }
    }

    fn back(self, place: f64) -> f64 {
        match self {
            Self::Linear => place,
            Self::Logarithmic => 10.0_f64.powf(place),
        }
    }
}

/// An axis with its range, which [`Scale`] has been applied to.
#[derive(Debug, Clone, Copy)]
pub(super) struct Spanned {
    scale: Scale,
    floor: Option<f64>,
    most_ticks: usize,
    /// Whether all values are whole, so that ticks between whole numbers would mean nothing.
    counts: bool,
    low: f64,
    high: f64,
}

impl Spanned {
    /// Value at the upper end.
    pub(super) fn top(&self) -> f64 {
        self.scale
            .back(self.high - 0.3 * MARGIN * (self.high - self.low))
    }

    /// Values with a tick.
    fn ticks(&self) -> Vec<f64> {
        let range = self.high - self.low;
        let step = match self.scale {
            Scale::Linear if self.counts => self.nice_step(range).max(1.0),
            Scale::Linear => self.nice_step(range),
            Scale::Logarithmic if self.is_narrow() => return self.ticks_within_a_decade(),
            Scale::Logarithmic if range < FEW_DECADES => return self.ticks_within_decades(),
            Scale::Logarithmic => self.whole_step(range),
        };
        let (first, last) = ((self.low / step).ceil(), (self.high / step).floor());
        let count = (last - first) as usize;
        let ticks = (0..=count).map(|i| (first + i as f64) * step);
        ticks.map(|place| self.scale.back(place)).collect()
    }

    /// 1, 2 and 5 times each power of ten.
    fn ticks_within_decades(&self) -> Vec<f64> {
        let decades = self.low.floor() as i32..=self.high.floor() as i32;
        let ticks = decades.flat_map(|decade| [1.0, 2.0, 5.0].map(|n| n * 10.0_f64.powi(decade)));
        let inside = |tick: &f64| (self.low..=self.high).contains(&tick.log10());
        ticks.filter(inside).collect()
    }

    /// Whether a logarithmic axis is too short for ticks at 1, 2 and 5 times powers of ten.
    fn is_narrow(&self) -> bool {
        self.high - self.low < FEW_DECADES && self.ticks_within_decades().len() < 2
    }

    /// Evenly spaced values.
    fn ticks_within_a_decade(&self) -> Vec<f64> {
        let (low, high) = (self.scale.back(self.low), self.scale.back(self.high));
        // Labels with decimals are long.
        let step = self.nice_step(2.0 * (high - low));
        let (first, last) = ((low / step).ceil(), (high / step).floor());
        (0..=(last - first) as usize)
            .map(|i| (first + i as f64) * step)
            .collect()
    }

    /// Whether values are neither long nor have many zeros.
    fn is_plain(&self) -> bool {
        let (low, high) = (self.scale.back(self.low), self.scale.back(self.high));
        (1e-2..1e5).contains(&low.abs().max(high.abs()))
    }

    /// 1, 2 or 5 times a power of ten, so that a range has few enough ticks.
    fn nice_step(&self, range: f64) -> f64 {
        let power = 10.0_f64.powf((range / self.most_ticks as f64).log10().floor());
        let fits = |step: &f64| range / step <= self.most_ticks as f64;
        let steps = [1.0, 2.0, 5.0, 10.0].map(|factor| factor * power);
        steps.into_iter().find(fits).unwrap_or(10.0 * power)
    }

    /// Whole decades, so that a range has few enough ticks.
    fn whole_step(&self, range: f64) -> f64 {
        (range / self.most_ticks as f64).ceil().max(1.0)
    }

    fn label(&self, value: f64) -> String {
        let text = match self.scale {
            Scale::Linear if value.abs() < 1e-9 * (self.high - self.low) => "0".into(),
            Scale::Linear if self.is_plain() => plain(value),
            Scale::Logarithmic if self.is_narrow() && self.is_plain() => plain(value),
            Scale::Linear | Scale::Logarithmic => multiple_of_power(value),
        };
        match self.floor {
            Some(floor) if value <= floor * 1.000_001 => format!("≤ {text}"),
            _ => text,
        }
    }
}

/// Without the rounding that sums of steps leave.
fn plain(value: f64) -> String {
    let rounded = format!("{value:.9}");
    let text = rounded.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0" } else { text }.replace('-', "−")
}

/// `10⁻³`, or `2·10⁻³`.
fn multiple_of_power(value: f64) -> String {
    // A little more than the logarithm, which may be rounded down.
    let exponent = (value.abs().log10() + 1e-9).floor() as i32;
    let factor = (1e3 * value / 10.0_f64.powi(exponent)).round() / 1e3;
    let power = power_of_ten(exponent);
    match factor {
        1.0 => power,
        -1.0 => format!("−{power}"),
        factor => format!("{}·{power}", plain(factor)),
    }
}

/// `10⁻³`.
fn power_of_ten(exponent: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let raised = exponent.to_string();
    let raised = raised.chars().map(|c| match c.to_digit(10) {
        Some(digit) => DIGITS[digit as usize],
        None => '⁻',
    });
    format!("10{}", raised.collect::<String>())
}

impl Ranged for Spanned {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (from, to): (i32, i32)) -> i32 {
        let share = (self.scale.forth(*value) - self.low) / (self.high - self.low);
        from + (share.clamp(0.0, 1.0) * f64::from(to - from)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        if hint.weight().allow_light_points() {
            return Vec::new();
        }
        self.ticks()
    }

    fn range(&self) -> Range<f64> {
        self.scale.back(self.low)..self.scale.back(self.high)
    }
}

impl Formatter<f64> for Spanned {
    fn format_ext(&self, value: &f64) -> String {
        self.label(*value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_powers_of_ten_at_most_eleven() {
        let axis = Axis::logarithmic("error").over([3e-14, 2e5].into_iter(), 11);
        let ticks = axis.ticks();
        assert!(ticks.len() <= 11 && ticks.len() >= 5, "{ticks:?}");
        let labels: Vec<String> = ticks.iter().map(|&tick| axis.label(tick)).collect();
        assert!(labels.contains(&"10⁻¹²".to_owned()), "{labels:?}");
        assert!(labels.contains(&"10⁰".to_owned()), "{labels:?}");
    }

    #[test]
    fn linear_ticks_are_round_and_start_at_zero() {
        let axis = Axis::linear("iterations").over([3.0, 26.0].into_iter(), 11);
        let labels: Vec<String> = axis.ticks().iter().map(|&tick| axis.label(tick)).collect();
        assert_eq!(labels[0], "0");
        assert_eq!(labels[1], "5");
        assert_eq!(plain(0.1 + 0.2), "0.3");
        assert_eq!(plain(-0.25), "−0.25");
    }

    #[test]
    fn few_decades_have_ticks_between() {
        let axis = Axis::logarithmic("error").over([3e-3, 0.06].into_iter(), 11);
        let labels: Vec<String> = axis.ticks().iter().map(|&tick| axis.label(tick)).collect();
        assert_eq!(labels, ["5·10⁻³", "10⁻²", "2·10⁻²", "5·10⁻²"]);
    }

    #[test]
    fn less_than_a_decade_has_ticks_too() {
        let labels = |low: f64, high: f64| -> Vec<String> {
            let axis = Axis::logarithmic("unknowns").over([low, high].into_iter(), 11);
            axis.ticks().iter().map(|&tick| axis.label(tick)).collect()
        };
        assert_eq!(labels(0.28, 0.42), ["0.3", "0.35", "0.4"]);
        // At most half as many as on a linear axis.
        let wanted = ["1.2", "1.3", "1.4", "1.5", "1.6", "1.7"];
        assert_eq!(labels(1.21e6, 1.7e6), wanted.map(|n| format!("{n}·10⁶")));
    }

    #[test]
    fn small_and_large_linear_values_are_multiples_of_powers() {
        let labels = |low: f64, high: f64| -> Vec<String> {
            let axis = Axis::linear("aperture (m)").over([low, high].into_iter(), 11);
            axis.ticks().iter().map(|&tick| axis.label(tick)).collect()
        };
        assert_eq!(labels(-2e-6, 6e-6)[..3], ["−2·10⁻⁶", "−10⁻⁶", "0"]);
        assert_eq!(labels(1e11, 1e12)[1..3], ["10¹¹", "2·10¹¹"]);
        assert_eq!(labels(0.0, 2.5e-5)[..3], ["0", "5·10⁻⁶", "10⁻⁵"]);
    }

    #[test]
    fn counts_have_no_ticks_between() {
        let axis = Axis::linear("iterations").over([1.0, 3.0].into_iter(), 11);
        assert_eq!(axis.ticks(), [0.0, 1.0, 2.0, 3.0]);
    }

    #[test]
    fn values_below_the_floor_stand_on_it() {
        let axis = Axis::logarithmic("error").from(1e-16);
        assert!(axis.takes(0.0) && !axis.takes(f64::NAN));
        assert_eq!(axis.at(0.0), 1e-16);
        assert_eq!(
            axis.over([0.0, 1.0].into_iter(), 11).label(1e-16),
            "≤ 10⁻¹⁶"
        );
        assert!(!Axis::logarithmic("size").takes(0.0));
    }

    #[test]
    fn an_axis_without_values_or_with_one_has_a_range() {
        for values in [vec![], vec![7.0], vec![0.0]] {
            let axis = Axis::linear("any").over(values.into_iter(), 11);
            assert!(axis.high > axis.low && axis.high.is_finite());
        }
    }
}
