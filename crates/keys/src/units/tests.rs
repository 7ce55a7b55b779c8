//! Units: exact numbers, dimensions and refusals.

use super::*;
use Dimension::*;

#[test]
fn quantities_are_the_decimal_numbers_to_the_last_bit() {
    for (text, dimension, value) in [
        ("60 GPa", Stress, 60e9),
        ("0.1 mm", Length, 1e-4),
        ("0.7 mm", Length, 7e-4),
        ("123.456 um", Length, 123.456e-6),
        ("5 µm", Length, 5e-6),
        ("5μm", Length, 5e-6),
        ("20 GPa/m", StressPerLength, 20e9),
        ("30 MPa/km", StressPerLength, 30e3),
        ("1.7 MPa/mm", StressPerLength, 1.7e9),
        ("2700 kg/m3", Density, 2700.0),
        ("2.7 g/cm3", Density, 2700.0),
        ("2.7 t/m^3", Density, 2700.0),
        ("2_700 kg m-3", Density, 2700.0),
        ("9.81 m/s2", Acceleration, 9.81),
        ("-9.81 m/s²", Acceleration, -9.81),
        ("1e2 J/m2", EnergyPerArea, 100.0),
        ("100 N/m", EnergyPerArea, 100.0),
        ("0.3 m2/m3", PerLength, 0.3),
        ("0.3 1/m", PerLength, 0.3),
        ("0.3 m^-1", PerLength, 0.3),
        ("12 degrees", Angle, 12.0),
        ("12°", Angle, 12.0),
        ("3 bar", Stress, 3e5),
        ("5 N/mm2", Stress, 5e6),
        ("-.5e-1 MPa", Stress, -5e4),
        ("4 GB", Memory, 4e9),
        ("2 GiB", Memory, 2147483648.0),
        ("1 %", One, 0.01),
        ("  7   kPa ", Stress, 7e3),
    ] {
        assert_eq!(read_quantity(text, dimension), Ok(value), "{text}");
    }
    let angle = read_quantity("0.5 rad", Angle).expect("an angle");
    assert_eq!(angle, 0.5_f64.to_degrees());
}

#[test]
fn what_is_no_quantity_of_the_dimension_says_why() {
    let other = |unit: &str, is| Err(Unreadable::Other(unit.into(), is));
    let unknown = |unit: &str, near| Err(Unreadable::UnknownUnit(unit.into(), near));
    for (text, dimension, found) in [
        ("60 m", Stress, other("m", Some(Length))),
        ("60 GPa/m", Stress, other("GPa/m", Some(StressPerLength))),
        ("60 N", Stress, other("N", None)),
        ("3 degrees", Length, other("degrees", Some(Angle))),
        ("3 s", Time, other("s", None)),
        ("60 GPA", Stress, unknown("GPA", Some("GPa"))),
        ("60 furlongs", Length, unknown("furlongs", None)),
        ("0,1 mm", Length, unknown(",1 mm", None)),
        ("60", Stress, Err(Unreadable::NoUnit)),
        ("1e9", Stress, Err(Unreadable::NoUnit)),
        ("", Stress, Err(Unreadable::NoNumber)),
        ("GPa", Stress, Err(Unreadable::NoNumber)),
        ("nan m", Length, Err(Unreadable::NoNumber)),
        ("inf m", Length, Err(Unreadable::NoNumber)),
        (
            "1e99999999999999999999 m",
            Length,
            Err(Unreadable::NoNumber),
        ),
    ] {
        assert_eq!(read_quantity(text, dimension), found, "{text}");
    }
    for text in [
        "1 m//m", "1 /", "1 m/", "1 m0", "1 m^", "1 1", "1 kt", "1 m^999", "1 e", "1 -", "1 _",
    ] {
        assert!(read_quantity(text, Length).is_err(), "{text}");
    }
}

#[test]
fn the_units_that_messages_name_are_known() {
    for dimension in Dimension::WITH_UNITS {
        for unit in dimension.units() {
            assert!(
                read_quantity(&format!("1 {unit}"), dimension).is_ok(),
                "{unit}"
            );
        }
    }
}

/// Decimal shifting is what the reader of floats does with the same number in SI units.
#[test]
fn every_prefix_is_exact() {
    let mut state = 1_u64;
    for (unit, power) in [
        ("nm", -9),
        ("um", -6),
        ("mm", -3),
        ("cm", -2),
        ("m", 0),
        ("km", 3),
    ] {
        for _ in 0..200 {
            state = state
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            let digits = format!("{}.{}", state >> 54, state >> 33 & 0xffff);
            let wanted: f64 = format!("{digits}e{power}").parse().expect("a number");
            assert_eq!(
                read_quantity(&format!("{digits} {unit}"), Length),
                Ok(wanted)
            );
        }
    }
}
