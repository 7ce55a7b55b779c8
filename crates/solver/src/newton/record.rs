//! Settings of a nonlinear solve, and its record.

use kluft_algebra::LinearFailure;
use kluft_mesh::Defect;

use crate::linear::LinearMethod;
use crate::problem::Load;

/// Where a facet point is linearised.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Linearisation {
    /// At the aperture that balances law and surrounding rock.
    #[default]
    Balanced,
    /// At the opening where the last step landed: plain Newton, for comparison.
    Landed,
}

/// When an iteration counts as converged. All measures are free of units.
#[derive(Debug, Clone, Copy)]
pub struct NewtonSettings {
    /// Where facet points are linearised.
    pub linearisation: Linearisation,
    /// Largest out-of-balance force against the largest force.
    pub force: f64,
    /// Largest change of displacement against the largest displacement or opening. Newton's error
    /// is the square of its last step, so this bound is the root of the others.
    pub increment: f64,
    /// Largest closure error, see [`Iteration::closure_error`].
    pub closure: f64,
    /// Iterations after which a step has failed.
    pub max_iterations: usize,
    /// Largest difference, against the largest jump, between a path in one step and in two, where
    /// the laws depend on the path.
    pub path: f64,
    /// How linear systems are solved; chosen by predicted cost if not given.
    pub linear: Option<LinearMethod>,
}

impl Default for NewtonSettings {
    fn default() -> Self {
        Self {
            linearisation: Linearisation::default(),
            force: 1e-9,
            increment: 1e-5,
            closure: 1e-9,
            max_iterations: 25,
            path: 1e-3,
            linear: None,
        }
    }
}

/// Measures of one iteration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Iteration {
    /// Out-of-balance force with the law's own tractions, against the largest force.
    pub force_residual: f64,
    /// Change of displacement against the largest displacement or opening.
    pub increment: f64,
    /// `max(|t_n - sigma_n(b)|, k |w_n - (b - b0)|) / max |sigma_n|`: how far the traction and
    /// opening of the linear solve are from one point of the law.
    pub closure_error: f64,
    /// Smallest aperture (m).
    pub smallest_aperture: f64,
    /// Iterations of the linear solver; 0 if it is direct.
    pub linear_iterations: usize,
}

/// How a load step ended.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// All three tests hold.
    Converged,
    /// The iterations ran out.
    OutOfIterations,
    /// Loads push blocks that nothing holds any more, see [`StepRecord::loose`].
    Loose,
    /// An iterate is not a number or not finite; the facet point where it showed, if there.
    NotFinite(Option<usize>),
    /// The linear system could not be solved.
    Linear(LinearFailure),
}

/// Record of a load step.
#[derive(Debug, Clone, PartialEq)]
pub struct StepRecord {
    /// Load at its end.
    pub load: Load,
    /// Every iteration, in order, of all parts that the step was divided into.
    pub iterations: Vec<Iteration>,
    /// Iterations of each part that converged.
    pub parts: Vec<usize>,
    /// Share of the way from the load before that was walked.
    pub walked: f64,
    /// How it ended.
    pub outcome: Outcome,
    /// Blocks that nothing held when it failed, each with its free motions.
    pub loose: Vec<Defect>,
    /// The facet point with the largest closure error at the end.
    pub worst_facet_point: Option<usize>,
    /// Time spent in factorisations (s).
    pub factorise_seconds: f64,
    /// Time spent in all else (s).
    pub solve_seconds: f64,
}

impl StepRecord {
    pub(super) fn new(load: Load) -> Self {
        Self {
            load,
            iterations: Vec::new(),
            parts: Vec::new(),
            walked: 0.0,
            loose: Vec::new(),
            outcome: Outcome::OutOfIterations,
            worst_facet_point: None,
            factorise_seconds: 0.0,
            solve_seconds: 0.0,
        }
    }

    /// Iterations of the linear solver in the whole step.
    pub fn linear_iterations(&self) -> usize {
        let each = self.iterations.iter();
        each.map(|iteration| iteration.linear_iterations).sum()
    }

    /// Whether the step converged.
    pub fn converged(&self) -> bool {
        self.outcome == Outcome::Converged
    }
}
