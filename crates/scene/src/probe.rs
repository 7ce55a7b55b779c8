//! Reads probes.

use glam::DVec3;

use crate::reader::Section;
use crate::setting::Setting;

/// Most points of a probe.
const MOST_POINTS: usize = 100_000;

/// What a probe is on.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ProbedPart {
    /// Points in the rock.
    Rock,
    /// A fracture.
    Fracture(String),
    /// A part of the outer surface.
    Boundary(String),
}

/// What is written down of what.
#[derive(Debug, Clone)]
pub struct ProbeEntry {
    /// What it is on.
    pub part: ProbedPart,
    /// Where its points are (m); none for the mean over the whole part by area.
    pub points: Vec<DVec3>,
    /// Whether the mean is written, of the points or the part.
    pub mean: bool,
}

impl ProbeEntry {
    /// The part of the surface that it is on.
    pub(crate) fn boundary(&self) -> Option<&str> {
        match &self.part {
            ProbedPart::Boundary(name) => Some(name),
            _ => None,
        }
    }
}

/// Reads a probe.
pub(crate) fn read_probe(section: &Section<'_, '_>, setting: Setting) -> Option<ProbeEntry> {
    let part = read_part(section);
    if setting.is_rigid() && !matches!(part, ProbedPart::Fracture(_)) {
        let key = if section.has("boundary") {
            "boundary"
        } else {
            "at"
        };
        let problem = format!(
            "{}: rigid rock neither moves nor is stressed",
            section.title
        );
        let remedy = "name the `fracture` that it is on, or remove it; rock that deforms has a \
                      young_modulus";
        section.refuse(key, problem, remedy);
    }
    let has_points = section.has("at") || section.has("from");
    if has_points || part == ProbedPart::Rock {
        return read_points(section, part);
    }
    if section.flag("mean") == Some(false) {
        let problem = "`mean = false` without points: a probe of a whole surface is a mean".into();
        section.refuse("mean", problem, "remove it, or give `at` or `from`");
    }
    Some(ProbeEntry {
        part,
        points: Vec::new(),
        mean: true,
    })
}

fn read_part(section: &Section<'_, '_>) -> ProbedPart {
    let [fracture, boundary] = ["fracture", "boundary"].map(|key| section.text(key));
    for key in ["at", "from", "fracture"] {
        if boundary.is_some() && section.has(key) {
            let problem = format!("both `boundary` and `{key}` are given");
            let remedy = "keep one: `boundary` is the mean over that part of the surface";
            section.refuse(key, problem, remedy);
        }
    }
    match (boundary, fracture) {
        (Some(name), _) => ProbedPart::Boundary(name.to_owned()),
        (None, Some(name)) => ProbedPart::Fracture(name.to_owned()),
        (None, None) => ProbedPart::Rock,
    }
}

fn read_points(section: &Section<'_, '_>, part: ProbedPart) -> Option<ProbeEntry> {
    let mean = section.flag("mean").unwrap_or(false);
    if section.has("at") && section.has("from") {
        let problem = "both `at` and `from` are given".into();
        section.refuse("from", problem, "keep one: a point, or a line");
    }
    let points = match section.has("at") {
        true => vec![section.vector("at")?.into()],
        false => read_lines(section)?,
    };
    Some(ProbeEntry { part, points, mean })
}

/// The points of a line, or of the lines of a plane.
fn read_lines(section: &Section<'_, '_>) -> Option<Vec<DVec3>> {
    section.require("from");
    if section.has("from") {
        section.require("to");
    }
    let (from, to) = (section.vector("from"), section.vector("to"));
    let count = section.number("count").unwrap_or(11.0) as usize;
    let (across, rows) = match section.has("across") {
        true => (
            section.vector("across")?,
            section.number("rows").unwrap_or(11.0) as usize,
        ),
        false => ([0.0; 3], 1),
    };
    let points = count.saturating_mul(rows);
    if points > MOST_POINTS {
        let problem = format!("the probe has {points} points");
        section.refuse("count", problem, format!("write at most {MOST_POINTS}"));
        return None;
    }
    let (from, to) = (DVec3::from(from?), DVec3::from(to?));
    if from == to {
        let problem = "`from` and `to` are one point".into();
        section.refuse("to", problem, "give another end, or one point by `at`");
    }
    if section.has("across") && across == [0.0; 3] {
        let problem = "`across` has no length".into();
        section.refuse(
            "across",
            problem,
            "give the way to the last line, or remove it",
        );
    }
    let share = |index: usize, of: usize| index as f64 / of.max(2).saturating_sub(1) as f64;
    let points = (0..rows).flat_map(|row| {
        let start = from + share(row, rows) * DVec3::from(across);
        (0..count).map(move |i| start + share(i, count) * (to - from))
    });
    Some(points.collect())
}
