//! `report.html`: a run on one page that needs no other file.

mod curves;
mod fractures;
mod iterations;
mod numbers;
mod probe_curves;
mod strength;

use kluft_chart::Chart;
use kluft_report::{Frame, Page, Surface};
use kluft_scene::counted;
use rayon::prelude::*;

pub use iterations::Iterations;
pub use strength::StrengthShown;

use crate::ending::Ending;
use crate::summary::{StepSummary, Summary};

/// Its name in the folder of the results.
pub const NAME: &str = "report.html";
/// What such pages are known by.
const MAKER: &str = "Kluft run";
/// Bytes of the scene that are shown.
const SCENE: usize = 200_000;
/// Most decisions and warnings.
const MOST_LINES: usize = 100;
/// Fields that are drawn where they are, with their names and units.
const FIELDS: [(&str, &str, &str); 5] = [
    ("aperture", "Aperture", "m"),
    ("normal_traction", "Normal traction", "Pa"),
    ("slip", "Slip", "m"),
    ("pressure", "Fluid pressure", "Pa"),
    ("hydraulic_aperture", "Hydraulic aperture", "m"),
];
/// Pictures of a page.
const MOST_PICTURES: usize = 4;

/// What there is to show of the last load step.
#[derive(Debug, Clone)]
pub struct Shown {
    /// The fractures with the fields that are drawn.
    pub surface: Surface,
    /// Lowest and highest coordinates of the body (m).
    pub body: [[f64; 3]; 2],
}

/// The fields that pages draw.
pub fn fields() -> [&'static str; 5] {
    FIELDS.map(|(name, ..)| name)
}

/// What a page tells.
pub struct Told<'a> {
    /// The numbers of the run.
    pub summary: &'a Summary,
    /// The text of `history.csv`.
    pub history: &'a str,
    /// The text of `probes.csv`.
    pub probes: &'a str,
    /// How Newton's method went.
    pub iterations: &'a Iterations,
    /// What can be drawn.
    pub shown: Option<&'a Shown>,
    /// What can be drawn of a reduction of strength.
    pub strength: Option<&'a StrengthShown>,
    /// The text of the scene.
    pub scene: Option<&'a str>,
}

/// Whether a text is such a page.
pub fn is_page(text: &str) -> bool {
    Page::is_by(text, MAKER)
}

impl Told<'_> {
    /// The page.
    pub fn html(&self) -> String {
        let summary = self.summary;
        let title = match summary.title.is_empty() {
            true => "A run of Kluft",
            false => &summary.title,
        };
        let mut page = Page::new(title, MAKER);
        self.lead(&mut page);
        self.pictures(&mut page);
        fractures::add(&mut page, summary);
        if let Some(found) = &summary.strength_reduction {
            strength::add(&mut page, found, self.strength);
        }
        let curves = curves::of_history(self.history);
        let curves = curves.into_iter().chain(curves::of_sources(&summary.steps));
        let curves = probe_curves::of_probes(self.probes)
            .into_iter()
            .chain(curves);
        charts(&mut page, "Curves", &curves.collect::<Vec<_>>());
        numbers::add_steps(&mut page, &summary.steps);
        if let Some(found) = &summary.permeability {
            numbers::add_permeability(&mut page, found);
        }
        let iterations = self.iterations.chart();
        charts(&mut page, "Convergence", iterations.as_slice());
        numbers::add_accuracy(&mut page, summary);
        if !summary.decisions.is_empty() {
            page.heading("Decisions");
            lines(&mut page, &summary.decisions);
        }
        numbers::add_provenance(&mut page, summary);
        if let Some(scene) = self.scene {
            let end = (0..=SCENE.min(scene.len())).rfind(|&end| scene.is_char_boundary(end));
            let shown = &scene[..end.unwrap_or(0)];
            page.folded("Scene", shown);
            if shown.len() < scene.len() {
                page.remark("The rest of the scene is in its file.");
            }
        }
        page.into_html()
    }

    /// How it ended, and what one should know before anything else.
    fn lead(&self, page: &mut Page) {
        let summary = self.summary;
        let is_converged = |step: &&StepSummary| step.completed >= 1.0;
        let steps = summary.steps.iter().filter(is_converged).count();
        let ended = match &summary.ending {
            Some(Ending::Stopped) => "Stopped",
            Some(Ending::NotConverged(_)) => "Not converged",
            Some(Ending::Solved | Ending::NothingLeft) => "Solved",
            None => "Not finished",
        };
        page.text(&format!(
            "{ended}: {}, {} unknowns, {} cells, {} fracture facets; {:.2} s on {}.",
            counted(steps, "load step"),
            summary.unknowns.total,
            summary.mesh.cells,
            summary.mesh.fracture_facets,
            summary.seconds.total,
            counted(summary.threads, "thread")
        ));
        if let Some(Ending::NotConverged(why)) = &summary.ending {
            page.warning(why);
        }
        for warning in summary.warnings.iter().take(MOST_LINES) {
            page.warning(&format!("Warning: {warning}"));
        }
    }

    fn pictures(&self, page: &mut Page) {
        let Some(shown) = self.shown.filter(|shown| !shown.surface.is_empty()) else {
            return;
        };
        let frame = Frame::of(&shown.surface, shown.body);
        let pictures = FIELDS.par_iter();
        let pictures = pictures.filter_map(|(name, title, unit)| frame.picture(name, title, unit));
        let mut pictures: Vec<_> = pictures.collect();
        pictures.truncate(MOST_PICTURES);
        page.heading("Fractures after the last load step");
        page.pictures(&pictures);
        page.remark(&format!(
            "{}. Tension is positive. results.vtm opens in ParaView.",
            frame.caption()
        ));
    }
}

/// A section of charts, if there are any.
fn charts(page: &mut Page, heading: &str, charts: &[Chart]) {
    if charts.is_empty() {
        return;
    }
    page.heading(heading);
    let drawn = charts.iter();
    page.charts(drawn.map(|chart| (chart.title.as_str(), chart.narrow_svg())));
}

fn lines(page: &mut Page, lines: &[String]) {
    page.list(lines.iter().take(MOST_LINES).map(String::as_str));
    if lines.len() > MOST_LINES {
        let left = lines.len() - MOST_LINES;
        page.remark(&format!("{left} more are in summary.json."));
    }
}

#[cfg(test)]
mod tests;
