//! What grids say of themselves.

use crate::summary::Summary;

/// Units of the fields of grids; the others have none.
const UNITS: [(&str, &str); 18] = [
    ("displacement", "m"),
    ("stress", "Pa"),
    ("principal_stress", "Pa"),
    ("stress_error", "Pa"),
    ("aperture", "m"),
    ("opening", "m"),
    ("jump", "m"),
    ("slip", "m"),
    ("traction", "Pa"),
    ("normal_traction", "Pa"),
    ("total_normal_traction", "Pa"),
    ("aperture_uncertainty", "m"),
    ("pressure", "Pa"),
    ("hydraulic_aperture", "m"),
    ("transmissivity", "m3"),
    ("flux", "m2/s"),
    ("x, y, z", "m"),
    ("TimeValue", "time of the scene"),
];

/// The program, the title, the units, and the numbers of rocks and fractures.
pub fn facts(summary: &Summary, rocks: &[&str], fractures: &[String]) -> Vec<(String, i32)> {
    let mut facts = vec![(format!("kluft {}", summary.kluft), 1)];
    if !summary.title.is_empty() {
        facts.push((format!("title {}", summary.title), 1));
    }
    let units = UNITS.iter();
    facts.extend(units.map(|(field, unit)| (format!("unit of {field}: {unit}"), 1)));
    let numbered =
        |kind: &str, number: usize, name: &str| (format!("{kind} {name}"), number as i32);
    let rocks = rocks.iter().enumerate();
    facts.extend(rocks.map(|(number, name)| numbered("rock", number, name)));
    let fractures = fractures.iter().enumerate();
    facts.extend(fractures.map(|(number, name)| numbered("fracture", number, name)));
    facts
}
