//! Reads probes.

use glam::DVec3;

use crate::reader::Section;

/// Most points of a probe.
const MOST_POINTS: usize = 100_000;

/// Points whose values are written down.
#[derive(Debug, Clone)]
pub struct ProbeEntry {
    /// Where they are (m).
    pub points: Vec<DVec3>,
    /// The fracture on which they are; none in the rock.
    pub fracture: Option<String>,
    /// Whether their mean is written.
    pub mean: bool,
}

/// Reads a probe.
pub(crate) fn read_probe(section: &Section<'_, '_>) -> Option<ProbeEntry> {
    let fracture = section.text("fracture").map(str::to_owned);
    let mean = section.flag("mean").unwrap_or(false);
    if section.has("at") && section.has("from") {
        let problem = "both `at` and `from` are given".into();
        section.refuse("from", problem, "keep one: a point, or a line");
    }
    if section.has("at") {
        let points = vec![section.vector("at")?.into()];
        return Some(ProbeEntry {
            points,
            fracture,
            mean,
        });
    }
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
    if count * rows > MOST_POINTS {
        let problem = format!("the probe has {} points", count * rows);
        section.refuse("count", problem, format!("write at most {MOST_POINTS}"));
    }
    let (from, to) = (DVec3::from(from?), DVec3::from(to?));
    let share = |index: usize, of: usize| index as f64 / of.max(2).saturating_sub(1) as f64;
    let points = (0..rows).flat_map(|row| {
        let start = from + share(row, rows) * DVec3::from(across);
        (0..count).map(move |i| start + share(i, count) * (to - from))
    });
    Some(ProbeEntry {
        points: points.collect(),
        fracture,
        mean,
    })
}
