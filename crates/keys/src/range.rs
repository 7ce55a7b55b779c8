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
        if value.is_finite() && fits {
            return None;
        }
        Some(match self {
            Self::Finite => "must be a finite number".into(),
            Self::Positive => "must be a finite number greater than 0".into(),
            Self::NotNegative => "must be a finite number, 0 or greater".into(),
            Self::Between(low, high) | Self::Within(low, high) => {
                format!("must lie between {low} and {high}")
            }
        })
    }
}

impl fmt::Display for Range {
    /// `> 0`, `0 to 89`; nothing for any number.
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Finite => Ok(()),
            Self::Positive => write!(out, "> 0"),
            Self::NotNegative => write!(out, ">= 0"),
            Self::Between(low, high) => write!(out, "> {low}, < {high}"),
            Self::Within(low, high) => write!(out, "{low} to {high}"),
        }
    }
}
