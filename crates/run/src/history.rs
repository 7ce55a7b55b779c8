//! `history.csv`: how fractures, parts of the surface and blocks fare, load step by load step.

use glam::DVec3;
use kluft_io::printable::cell;
use kluft_solver::{
    BlockMotion, Solution, State, Step, SurfaceResultant, System, block_motions, surface_resultants,
};

use crate::spread::Spread;
use crate::summary::FractureSummary;

/// Its name in the folder of the results.
pub const NAME: &str = "history.csv";

/// The columns; what a row does not have is empty.
const COLUMNS: [&str; 34] = [
    "step",
    "time",
    "phase",
    "kind",
    "name",
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

/// Whether a text is a table of this kind.
pub fn is_history(text: &str) -> bool {
    text.lines().next() == Some(COLUMNS.join(",").as_str())
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
        let mut table = csv::Writer::from_writer(Vec::new());
        // Writing to memory cannot fail.
        if self.text.is_empty() {
            let _ = table.write_record(COLUMNS);
        }
        for row in entry.rows() {
            let _ = table.write_record(COLUMNS.map(|column| row.get(column)));
        }
        let bytes = table.into_inner().unwrap_or_default();
        self.text.push_str(&String::from_utf8_lossy(&bytes));
    }
}

/// Values by the names of their columns.
struct Row(Vec<(String, String)>);

impl Row {
    fn get(&self, column: &str) -> String {
        let found = self.0.iter().find(|(name, _)| name == column);
        found.map_or_else(String::new, |(_, value)| value.clone())
    }

    fn number(&mut self, column: &str, value: f64) {
        self.0.push((column.to_owned(), format!("{value:e}")));
    }

    fn spread(&mut self, column: &str, spread: Spread) {
        for (part, value) in [
            ("min", spread.min),
            ("mean", spread.mean),
            ("max", spread.max),
        ] {
            self.number(&format!("{column}_{part}"), value);
        }
    }

    fn vector(&mut self, column: &str, vector: DVec3) {
        for (axis, value) in ["x", "y", "z"].into_iter().zip(vector.to_array()) {
            self.number(&format!("{column}_{axis}"), value);
        }
    }
}

impl Entry<'_> {
    fn rows(&self) -> Vec<Row> {
        let mut step = self.row("step", "");
        step.number("newton_iterations", self.newton_iterations as f64);
        let fractures = self
            .fractures
            .iter()
            .map(|(name, summary)| self.fracture(name, summary));
        let surfaces = self.parts.surfaces.iter().map(|(name, resultant)| {
            let mut row = self.row("boundary", name);
            row.number("area", resultant.area);
            row.vector("force", resultant.force);
            row.vector("displacement", resultant.displacement);
            row.number("displacement", resultant.displacement.length());
            row
        });
        let blocks = self.parts.blocks.iter().enumerate().map(|(index, motion)| {
            let mut row = self.row("block", &(index + 1).to_string());
            row.number("volume", motion.volume);
            row.vector("displacement", motion.displacement);
            row.number("displacement", motion.displacement.length());
            row.vector("rotation", motion.rotation);
            row.number("rotation", motion.rotation.length());
            row
        });
        [step]
            .into_iter()
            .chain(fractures)
            .chain(surfaces)
            .chain(blocks)
            .collect()
    }

    fn row(&self, kind: &str, name: &str) -> Row {
        let of_step = [
            ("step", self.number.to_string()),
            ("time", format!("{:e}", self.step.load.time)),
            (
                "phase",
                cell(self.step.phase.as_deref().unwrap_or_default()),
            ),
            ("kind", kind.to_owned()),
            ("name", cell(name)),
        ];
        Row(of_step
            .map(|(column, value)| (column.to_owned(), value))
            .to_vec())
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
        row
    }
}
