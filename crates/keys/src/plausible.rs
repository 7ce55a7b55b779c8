//! Values that are possible, but hardly meant.

use crate::dimension::Dimension;
use crate::units::read_quantity;

/// Where the values of a key commonly lie.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plausible {
    /// Values below are hardly meant.
    pub low: f64,
    /// Values above are hardly meant.
    pub high: f64,
    /// From the first to the second, a value in another unit is taken to be meant in it.
    pub usual: (f64, f64),
    /// Units that are mistaken for that of plain numbers, the likeliest first.
    pub units: &'static [&'static str],
}

impl Plausible {
    /// What is odd about a value of this dimension, as the end of a sentence, with the unit that it
    /// looks like. Zero stands for "none" and is never odd.
    pub fn doubt(&self, value: f64, dimension: Dimension) -> Option<String> {
        if value == 0.0 || (self.low..=self.high).contains(&value) {
            return None;
        }
        let (low, high) = (brief(self.low), brief(self.high));
        let unit = match dimension.unit() {
            "" => String::new(),
            unit => format!(" {unit}"),
        };
        let usual = format!("is hardly meant: values lie between {low} and {high}{unit}");
        let meant = self.units.iter().find_map(|other| {
            let text = format!("{value} {other}");
            let read = read_quantity(&text, dimension).ok()?;
            let is_usual = self.usual.0 <= read && read <= self.usual.1;
            is_usual.then(|| {
                let value = brief(value);
                format!(
                    "; {value} looks like {other}: {value} {other} = {}{unit}",
                    brief(read)
                )
            })
        });
        Some(usual + &meant.unwrap_or_default())
    }
}

/// A number that a person can read.
fn brief(number: f64) -> String {
    match number.abs() {
        0.0 | 1e-3..1e5 => {
            let rounded: f64 = format!("{number:.5e}").parse().unwrap_or(number);
            rounded.to_string()
        }
        _ => {
            let text = format!("{number:.5e}");
            let (digits, power) = text.split_once('e').unwrap_or((&text, "0"));
            let digits = digits.trim_end_matches('0').trim_end_matches('.');
            format!("{digits}e{power}")
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::scene;

    fn doubt(key: &str, value: f64) -> Option<String> {
        let sections = [&scene::ROCK, &scene::FRACTURE, &scene::BODY];
        let key = sections
            .iter()
            .find_map(|section| section.key(key))
            .expect("a key");
        let quantity = key.kind.quantity().expect("a quantity");
        quantity
            .plausible
            .expect("doubts")
            .doubt(value, quantity.dimension)
    }

    #[test]
    fn doubtful_values_name_the_unit_that_they_look_like() {
        for (key, value, says) in [
            ("young_modulus", 40.0, "40 looks like GPa: 40 GPa = 4e10 Pa"),
            ("young_modulus", 50e3, "looks like MPa"),
            ("young_modulus", 50e15, "between 1e6 and 1e12 Pa"),
            (
                "density",
                2.7,
                "2.7 looks like g/cm3: 2.7 g/cm3 = 2700 kg/m3",
            ),
            ("density", 27000.0, "between 500 and 8000"),
            ("poisson_ratio", 0.499, "between 0 and 0.49"),
            ("poisson_ratio", -0.2, "between 0 and 0.49"),
            ("normal_stiffness", 20.0, "20 looks like GPa/m"),
            ("normal_stiffness", 1e16, "between 1e6 and 1e15 Pa/m"),
            (
                "friction_angle",
                0.5,
                "0.5 looks like rad: 0.5 rad = 28.6479 degrees",
            ),
            ("friction_angle", 70.0, "between 1 and 60 degrees"),
            ("aperture", 0.2, "0.2 looks like mm: 0.2 mm = 2e-4 m"),
            ("aperture", 100.0, "100 looks like um: 100 um = 1e-4 m"),
            ("aperture", 1e-9, "between 1e-8 and 0.1 m"),
            ("gravity", 981.0, "981 looks like cm/s2"),
            ("gravity", 1.0, "between 9.7 and 9.9 m/s2"),
        ] {
            let text = doubt(key, value).unwrap_or_default();
            assert!(text.contains(says), "{key} = {value}: {text}");
        }
    }

    #[test]
    fn common_values_and_zero_raise_no_doubt() {
        for (key, value) in [
            ("young_modulus", 50e9),
            ("density", 0.0),
            ("density", 2700.0),
            ("poisson_ratio", 0.0),
            ("poisson_ratio", 0.25),
            ("normal_stiffness", 0.0),
            ("normal_stiffness", 1e11),
            ("friction_angle", 0.0),
            ("friction_angle", 30.0),
            ("aperture", 1e-4),
            ("gravity", 9.81),
        ] {
            assert_eq!(doubt(key, value), None, "{key} = {value}");
        }
    }
}
