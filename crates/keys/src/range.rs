//! Which numbers a key accepts.

use std::fmt;

/// Which numbers a key accepts; all of them are finite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Range {
    /// Any finite number.
    Finite,
    /// Greater than zero.
    Positive,
    /// Zero or greater.
    NotNegative,
    /// Above the first bound and below the second.
    Between(f64, f64),
    /// From the first bound to the second.
    Within(f64, f64),
}

impl Range {
    /// What a value must be and is not, as the end of a sentence.
    pub fn refusal(self, value: f64) -> Option<String> {
        let fits = match self {
            Self::Finite => true,
            Self::Positive => value > 0.0,
            Self::NotNegative => value >= 0.0,
            Self::Between(low, high) => low < value && value < high,
            Self::Within(low, high) => low <= value && value <= high,
        };
        let takes_small = matches!(self, Self::Finite | Self::Positive | Self::NotNegative);
        if value.is_subnormal() && (fits || takes_small) {
            return Some(format!(
                "is too small a number: write 0, or more than {:e}",
                f64::MIN_POSITIVE
            ));
        }
        if value.is_finite() && fits {
            return None;
        }
        Some(match self {
            Self::Finite => "must be a finite number".into(),
            Self::Positive => "must be a finite number greater than 0".into(),
            Self::NotNegative => "must be a finite number, 0 or greater".into(),
            Self::Between(low, high) => {
                format!(
                    "must be more than {} and less than {}",
                    brief(low),
                    brief(high)
                )
            }
            Self::Within(low, high) => {
                format!("must be from {} to {}", brief(low), brief(high))
            }
        })
    }
}

/// A bound, with a power of ten where it has many digits.
fn brief(bound: f64) -> String {
    match bound.abs() {
        1e7.. if bound.fract() == 0.0 => format!("{bound:e}"),
        _ => bound.to_string(),
    }
}

impl fmt::Display for Range {
    /// `> 0`, `0 to 89`; nothing for any number.
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Finite => Ok(()),
            Self::Positive => write!(out, "> 0"),
            Self::NotNegative => write!(out, ">= 0"),
            Self::Between(low, high) => write!(out, "> {}, < {}", brief(*low), brief(*high)),
            Self::Within(low, high) => write!(out, "{} to {}", brief(*low), brief(*high)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_refused_is_told_with_the_numbers_that_serve() {
        for (range, value, says) in [
            (
                Range::Within(3.0, 100.0),
                2.0,
                Some("must be from 3 to 100"),
            ),
            (Range::Within(3.0, 100.0), 3.0, None),
            (Range::Within(3.0, 100.0), 100.0, None),
            (
                Range::Between(-1.0, 0.5),
                0.5,
                Some("must be more than -1 and less than 0.5"),
            ),
            (
                Range::Within(1.0, 1e15),
                1e300,
                Some("must be from 1 to 1e15"),
            ),
            (
                Range::Within(1.0, 1e15),
                1e-310,
                Some("must be from 1 to 1e15"),
            ),
            (Range::Positive, 1e-310, Some("too small a number")),
            (
                Range::Finite,
                f64::INFINITY,
                Some("must be a finite number"),
            ),
            (Range::NotNegative, 0.0, None),
        ] {
            let refusal = range.refusal(value);
            match says {
                None => assert_eq!(refusal, None, "{value} in {range:?}"),
                Some(says) => {
                    let refusal = refusal.unwrap_or_default();
                    assert!(refusal.contains(says), "{value} in {range:?}: {refusal}");
                }
            }
        }
    }
}
