//! What a run returns.

use kluft_io::Grid;

use crate::ending::Ending;
use crate::summary::{FractureSummary, StepSummary, Summary};

/// Everything that came out of a run, the steps that converged before a failure included.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// How it ended.
    pub ending: Ending,
    /// Its numbers, as `summary.json` holds them.
    pub summary: Summary,
    /// The history of its load steps, as `history.csv` holds it; empty if neither files nor results
    /// were asked for, and in rigid rock.
    pub history: String,
    /// The results of the load steps that it solved, if it was asked to keep them.
    pub steps: Vec<StepResult>,
}

/// The results of a converged load step.
#[derive(Debug, Clone)]
pub struct StepResult {
    /// How it was solved.
    pub summary: StepSummary,
    /// The numbers of each fracture, by name.
    pub fractures: Vec<(String, FractureSummary)>,
    /// The rock, with one copy of a node for each of its sectors: displacement (m), stress (Pa).
    pub rock: Grid,
    /// The fractures, each facet with points of its own: aperture, jump (m), traction (Pa).
    pub fracture_grid: Grid,
}
