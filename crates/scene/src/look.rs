//! Looks at values that vary where they are asked for.

use glam::DVec3;
use kluft_mesh::Defect;

use crate::field::FieldEntry;
use crate::scene::Scene;
use crate::warning::Doubt;

/// What was found so far.
pub(crate) struct Look<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) defects: Vec<Defect>,
    decisions: &'a mut Vec<String>,
    pub(crate) warnings: Vec<String>,
}

/// What a value that varies does over its places.
pub(crate) struct Seen {
    low: f64,
    high: f64,
    pub(crate) mean: f64,
    /// Largest distance from a sample (m).
    reach: Option<f64>,
}

impl<'a> Look<'a> {
    /// Tells `decisions` what is seen.
    pub(crate) fn of(scene: &'a Scene, decisions: &'a mut Vec<String>) -> Self {
        Self {
            scene,
            defects: Vec::new(),
            decisions,
            warnings: Vec::new(),
        }
    }

    /// Looks at a value at all its places (m) and times; none if one is refused.
    pub(crate) fn at(
        &mut self,
        entry: &FieldEntry,
        places: &[DVec3],
        times: &[f64],
    ) -> Option<Seen> {
        let mut seen = Seen {
            low: f64::INFINITY,
            high: f64::NEG_INFINITY,
            mean: 0.0,
            reach: None,
        };
        let mut refused: Vec<(DVec3, String)> = Vec::new();
        for &time in times {
            for &place in places {
                let value = entry.field.at(place, time);
                let distance = entry.field.reach(place);
                match refusal(entry, value, distance) {
                    Some(refusal) => refused.push((place, refusal)),
                    None => {
                        seen.low = seen.low.min(value);
                        seen.high = seen.high.max(value);
                        seen.mean += value;
                        seen.reach = distance.map(|d| seen.reach.map_or(d, |other| other.max(d)));
                    }
                }
            }
        }
        seen.mean /= (places.len() * times.len()) as f64;
        let Some((place, refusal)) = refused.first() else {
            self.tell(entry, &seen, places.len());
            return Some(seen);
        };
        let [x, y, z] = place.to_array();
        let others = match refused.len() {
            1 => String::new(),
            count => format!(", and at {} more points", count - 1),
        };
        let problem = format!(
            "`{}` from {}: {refusal} at ({x:.6}, {y:.6}, {z:.6}){others}",
            entry.key, entry.origin
        );
        self.defects
            .push(Defect::new(&entry.place, problem, remedy(entry)));
        None
    }

    fn tell(&mut self, entry: &FieldEntry, seen: &Seen, count: usize) {
        let dimension = entry.quantity.dimension;
        let reach = seen.reach.map_or(String::new(), |reach| {
            format!(", at most {reach:.3e} m from a sample")
        });
        let unit = match dimension.unit() {
            "" => String::new(),
            unit => format!(" {unit}"),
        };
        let line = format!(
            "{}: {:.4e} to {:.4e}{unit} at {count} points, by {}{reach}",
            entry.title, seen.low, seen.high, entry.origin
        );
        if !self.decisions.contains(&line) {
            self.decisions.push(line);
        }
        let plausible = entry.quantity.plausible;
        let doubts = [seen.low, seen.high].map(|value| {
            let doubt = plausible.and_then(|plausible| plausible.doubt(value, dimension));
            doubt.map(|doubt| format!("{}: a `{}` of {value:e} {doubt}", entry.place, entry.key))
        });
        let told = doubts.into_iter().flatten();
        let told = told.filter_map(|text| self.scene.warning(Doubt::Values, &text));
        self.warnings.extend(told.take(1));
    }
}

/// Why a value is none, `distance` (m) from the nearest sample.
fn refusal(entry: &FieldEntry, value: f64, distance: Option<f64>) -> Option<String> {
    let reach = entry.reach.unwrap_or(f64::INFINITY);
    if let Some(distance) = distance.filter(|distance| *distance > reach) {
        return Some(format!("the nearest sample is {distance:.4e} m away"));
    }
    if value.is_nan() && entry.file.is_none() && entry.origin.starts_with("a table") {
        return Some("there is no row".into());
    }
    if value.is_nan() && entry.file.is_some() {
        return Some("there are no samples around".into());
    }
    let refusal = entry.quantity.range.refusal(value)?;
    Some(format!("the value {value:e} {refusal},"))
}

fn remedy(entry: &FieldEntry) -> &'static str {
    match entry.field {
        kluft_solver::Field::Table(_) => {
            "add rows that reach there, or write beyond = \"nearest\"; a value out of range needs \
             other rows"
        }
        kluft_solver::Field::Samples(_) if entry.reach.is_some() => {
            "add samples there, or raise `reach`; a value out of range needs other samples"
        }
        kluft_solver::Field::Samples(_) => {
            "add samples there, or write beyond = \"nearest\", which goes on with the last values; \
             a value out of range needs other samples"
        }
        _ => "let the expression have a value in range there: max(a, b) and min(a, b) bound it",
    }
}
