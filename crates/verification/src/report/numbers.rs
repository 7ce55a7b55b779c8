//! Numbers in words.

/// A share as a percentage of three digits.
pub fn percent(share: f64) -> String {
    format!("{} %", digits(100.0 * share))
}

/// A number of three digits; very small and very large ones with their power of ten.
pub fn digits(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let power = value.abs().log10().floor();
    if !(-3.0..6.0).contains(&power) {
        return format!("{value:.2e}");
    }
    format!("{value:.*}", (2.0 - power).max(0.0) as usize)
}

/// What nodes miss at most of what moves, as a share, which is 0 where rounding explains all of it.
pub fn missed(share: f64) -> String {
    match share == 0.0 {
        true => "What nodes miss of what moves is below rounding.".to_owned(),
        false => format!("But for rounding, nodes never miss more than {share:.0e} of what moves."),
    }
}

/// The largest of some numbers; not a number if one of them is not.
pub fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    let larger = |most: f64, value: f64| {
        if most.is_nan() || most >= value {
            most
        } else {
            value
        }
    };
    values.into_iter().fold(0.0, larger)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_rounding_explains_is_no_number() {
        assert!(missed(0.0).contains("below rounding"));
        assert!(missed(3.2e-12).contains("3e-12"));
        assert!(missed(f64::NAN).contains("NaN"));
    }
}
