//! What comes out of reducing strength, in numbers.

use serde::Serialize;

/// The rock and the fractures at the last stable factor, and how blocks move at the first failing
/// one.
pub const GRIDS: [&str; 3] = [
    "strength_rock.vtu",
    "strength_fractures.vtu",
    "strength_motion.vtu",
];

/// How far strength could be reduced.
#[derive(Debug, Clone, Default, Serialize)]
pub struct StrengthSummary {
    /// Fractures whose strength was reduced.
    pub fractures: Vec<String>,
    /// Largest factor at which everything held.
    pub stable: f64,
    /// Smallest factor at which it did not; none if none was found.
    pub failing: Option<f64>,
    /// What happened there.
    pub failure: Option<String>,
    /// Blocks that nothing held there, with their free motions.
    pub free_blocks: Vec<String>,
    /// How blocks move there; the largest motion of a point is 1.
    pub failing_motions: Vec<MotionSummary>,
    /// How blocks have moved from full strength to the last stable factor.
    pub motions: Vec<MotionSummary>,
    /// The factors that were tried, in order.
    pub trials: Vec<Trial>,
}

/// One factor that was tried.
#[derive(Debug, Clone, Serialize)]
pub struct Trial {
    /// The factor.
    pub factor: f64,
    /// Whether everything held.
    pub stable: bool,
    /// Newton iterations.
    pub newton_iterations: usize,
    /// Largest motion of a point since full strength (m), if everything held.
    pub largest_motion: Option<f64>,
}

/// How a block has moved.
#[derive(Debug, Clone, Serialize)]
pub struct MotionSummary {
    /// Its number, as in `history.csv`.
    pub block: usize,
    /// Volume (m^3).
    pub volume: f64,
    /// Mean displacement (m), or a direction with a size among others.
    pub displacement: [f64; 3],
    /// Mean rotation (radians), or the same over the unit of the displacement (1/m).
    pub rotation: [f64; 3],
}
