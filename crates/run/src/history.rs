//! `history.csv`: how fractures, parts of the surface and blocks fare, load step by load step.

use glam::DVec3;
use kluft_solver::{
    BlockMotion, Solution, State, Step, SurfaceResultant, System, block_motions, surface_resultants,
};

use crate::flow_history::{self, FlowEntry, OF_FLOW};
use crate::rows::{self, HEAD, Row};
use crate::summary::FractureSummary;

/// Its name in the folder of the results.
pub const NAME: &str = "history.csv";

/// The columns behind those that every row begins with.
const COLUMNS: [&str; 29] = [
    "area",
    "volume",
    "aperture_min",
    "aperture_mean",
    "aperture_max",
    "normal_traction_min",
    "normal_traction_mean",
    "normal_traction_max",
    "shear_traction_min",
    "shear_traction_mean",
    "shear_traction_max",
    "slip_min",
    "slip_mean",
    "slip_max",
    "open_area",
    "sliding_area",
    "closed_area",
    "force_x",
    "force_y",
    "force_z",
    "displacement_x",
    "displacement_y",
    "displacement_z",
    "displacement",
    "rotation_x",
    "rotation_y",
    "rotation_z",
    "rotation",
    "newton_iterations",
];

/// The columns, of rock without and with a fluid.
fn columns(has_flow: bool) -> Vec<&'static str> {
    let mut all = [&HEAD[..], &COLUMNS].concat();
    if has_flow {
        // Sources share a column with blocks.
        all.extend(OF_FLOW.iter().filter(|column| **column != "volume"));
    }
    all
}

/// Whether a text is a table of this kind.
pub fn is_history(text: &str) -> bool {
    let kinds = [columns(false), columns(true), flow_history::columns()];
    let head = text.lines().next();
    kinds
        .iter()
        .any(|kind| head == Some(kind.join(",").as_str()))
}

/// What one load step adds.
pub struct Entry<'a> {
    /// Number of the load step, from 1.
    pub number: usize,
    /// The load step.
    pub step: &'a Step,
    /// Its Newton iterations.
    pub newton_iterations: usize,
    /// Each fracture with its name.
    pub fractures: &'a [(String, FractureSummary)],
    /// Parts of the surface, and blocks.
    pub parts: Parts<'a>,
    /// What flows, if there is a fluid.
    pub flow: Option<FlowEntry<'a>>,
}

/// What whole parts feel and do.
pub struct Parts<'a> {
    /// Each part of the outer surface with its name.
    surfaces: Vec<(&'a str, SurfaceResultant)>,
    /// Each block, numbered from 1 in the order of the lowest cell.
    blocks: Vec<BlockMotion>,
}

impl<'a> Parts<'a> {
    /// Those of a state and its solution.
    pub fn of(system: &System<'a>, state: &State, solution: &Solution) -> Self {
        let displacements = &solution.displacements;
        let (surfaces, blocks) = rayon::join(
            || surface_resultants(system, state, displacements),
            || block_motions(system, displacements),
        );
        let names = system.problem().mesh.boundaries.iter();
        let names = names.map(|boundary| boundary.name.as_str());
        Self {
            surfaces: names.zip(surfaces).collect(),
            blocks,
        }
    }
}

/// A table that grows by load steps.
#[derive(Debug, Default)]
pub struct History {
    text: String,
}

impl History {
    /// Goes on with the table of a former run.
    pub fn from_text(text: String) -> Self {
        Self { text }
    }

    /// The table so far, for the file and for checkpoints.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The whole table.
    pub fn into_text(self) -> String {
        self.text
    }

    /// Adds the rows of a load step.
    pub fn add(&mut self, entry: &Entry<'_>) {
        let columns = columns(entry.flow.is_some());
        rows::add_to(&mut self.text, &columns, &entry.rows());
    }
}

impl Entry<'_> {
    fn rows(&self) -> Vec<Row> {
        let mut step = self.row("step", "");
        step.number("newton_iterations", self.newton_iterations as f64);
        let flow = self.flow.as_ref();
        flow.inspect(|flow| flow.add_balance(&mut step));
        let sources = flow.map(|flow| flow.sources((self.number, self.step)));
        let fractures = self.fractures.iter();
        let surfaces = self.parts.surfaces.iter();
        let blocks = self.parts.blocks.iter().enumerate();
        [step]
            .into_iter()
            .chain(fractures.map(|(name, summary)| self.fracture(name, summary)))
            .chain(surfaces.map(|(name, resultant)| self.surface(name, resultant)))
            .chain(blocks.map(|(index, motion)| self.block(index, motion)))
            .chain(sources.into_iter().flatten())
            .collect()
    }

    fn row(&self, kind: &str, name: &str) -> Row {
        Row::of((self.number, self.step), kind, name)
    }

    fn surface(&self, name: &str, resultant: &SurfaceResultant) -> Row {
        let mut row = self.row("boundary", name);
        row.number("area", resultant.area);
        row.vector("force", resultant.force);
        row.vector("displacement", resultant.displacement);
        row.number("displacement", resultant.displacement.length());
        row
    }

    fn block(&self, index: usize, motion: &BlockMotion) -> Row {
        let mut row = self.row("block", &(index + 1).to_string());
        row.number("volume", motion.volume);
        row.vector("displacement", motion.displacement);
        row.number("displacement", motion.displacement.length());
        row.vector("rotation", motion.rotation);
        row.number("rotation", motion.rotation.length());
        row
    }

    fn fracture(&self, name: &str, summary: &FractureSummary) -> Row {
        let mut row = self.row("fracture", name);
        row.number("area", summary.area);
        row.spread("aperture", summary.aperture);
        row.spread("normal_traction", summary.normal_traction);
        row.spread("shear_traction", summary.shear_traction);
        row.spread("slip", summary.slip);
        row.number("open_area", summary.open_area);
        row.number("sliding_area", summary.sliding_area);
        row.number("closed_area", summary.closed_area);
        row.vector("force", DVec3::from(summary.force));
        if let Some(flow) = &self.flow {
            flow.add_conduit(&mut row, name);
        }
        row
    }
}
