//! Numbers as people read them.

/// To three digits, with an exponent only where it helps.
pub(super) fn short(number: f64) -> String {
    digits(number, 3)
}

/// To some digits, with an exponent only where it helps.
pub(super) fn digits(number: f64, count: usize) -> String {
    if number == 0.0 {
        return "0".into();
    }
    let last = count - 1;
    let text = format!("{number:.last$e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    let trimmed = |text: &str| match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text.to_owned(),
    };
    if (-3..5).contains(&exponent) {
        let decimals = (last as i32 - exponent).max(0) as usize;
        return trimmed(&format!("{number:.decimals$}"));
    }
    format!("{}e{exponent}", trimmed(mantissa))
}

/// A share in percent.
pub(super) fn percent(share: f64) -> String {
    format!("{} %", short(100.0 * share))
}

/// A duration: seconds, or minutes and hours.
pub(super) fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 120.0 => format!("{} s", short(s)),
        s if s < 7200.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}

/// What settings are called that differ in nothing.
pub(super) fn or_the_scene(name: String) -> String {
    match name.is_empty() {
        true => "the scene".into(),
        false => name,
    }
}

/// The unit of a measure or of a key of fractures, in brackets after a space; nothing if it has
/// none.
pub(super) fn unit(name: &str) -> &'static str {
    let ends = |endings: &[&str]| endings.iter().any(|ending| name.ends_with(ending));
    match name {
        _ if ends(&["_stiffness"]) => " (Pa/m)",
        _ if ends(&["aperture", "opening", "slip", "closure"]) => " (m)",
        _ if ends(&["traction", "pressure", "strength", "cohesion"]) => " (Pa)",
        _ if ends(&["_angle"]) => " (degrees)",
        _ if ends(&["volume"]) => " (m³)",
        _ if ends(&["stress_intensity"]) => " (Pa √m)",
        _ if ends(&["fracture_energy"]) => " (J/m²)",
        _ if ends(&["energy"]) => " (J)",
        _ => "",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_digits() {
        let texts = [
            0.0, 0.012_34, 1.0, 12.0, 123.4, 12_345.0, 1e6, 1.234e-9, -0.5, 9.996,
        ];
        let texts = texts.map(short);
        let wanted = [
            "0", "0.0123", "1", "12", "123", "12345", "1e6", "1.23e-9", "-0.5", "10",
        ];
        assert_eq!(texts, wanted);
        assert_eq!(percent(0.01), "1 %");
        assert_eq!(duration(600.0), "10 min");
    }
}
