//! What is known of a load step once it has been solved, or not.

use crate::space::rigid_modes::FreeBody;
use kluft_algebra::LinearFailure;

use crate::problem::Load;

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
    /// Largest change of a pressure, against the largest since the step began; 0 without a flow
    /// that follows the walls.
    pub pressure_increment: f64,
    /// What nodes of the flow miss, against what moves; 0 without one.
    pub mass_error: f64,
    /// Smallest aperture (m).
    pub smallest_aperture: f64,
    /// Iterations of the linear solver; 0 if it is direct.
    pub linear_iterations: usize,
    /// The share of the load step that its increment leads to: less than 1 in parts of a step.
    pub share: f64,
}

/// How a load step ended.
#[derive(Debug, Clone, PartialEq)]
pub enum StepOutcome {
    /// All three tests hold.
    Converged,
    /// The iterations ran out.
    OutOfIterations,
    /// Loads push blocks that nothing holds any more, see [`StepRecord::rigid_motions`].
    RigidBodyMotion,
    /// An iterate is not a number or not finite; the facet point where it showed, if there.
    NotFinite(Option<usize>),
    /// The linear system could not be solved.
    Linear(LinearFailure),
    /// The observer of the iterations stopped it.
    Stopped,
}

impl StepOutcome {
    /// Whether no other attempt at an increment that ends so would end otherwise: loads push blocks
    /// whatever the linear solver, and the observer stops the step.
    pub(super) fn is_beyond_attempts(&self) -> bool {
        matches!(self, Self::RigidBodyMotion | Self::Stopped)
    }

    /// Why an increment fails after two attempts at it. Numbers and linear solves fail where an
    /// attempt goes astray, so they are the reason only if both did.
    pub(super) fn and(self, later: Self) -> Self {
        let rank = |outcome: &Self| match outcome {
            Self::Linear(_) => 0,
            Self::NotFinite(None) => 1,
            Self::NotFinite(Some(_)) => 2,
            _ => 3,
        };
        match rank(&later) > rank(&self) || rank(&later) == 3 {
            true => later,
            false => self,
        }
    }
}

/// A part of a load step that does not tell where the loads lead: walls jump or fall to another
/// place there, and another number of load steps may lead to another equilibrium.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UnresolvedPath {
    /// Why it does not.
    pub cause: UnresolvedCause,
    /// The facet point where it is.
    pub facet_point: Option<usize>,
}

/// Why a path is not resolved, the worst last.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub enum UnresolvedCause {
    /// One increment and two, however short, differ by so much in their jumps, against the largest,
    /// or walls slip by so much in one until they meet.
    Differs(f64),
    /// One increment leads to an equilibrium, and two shorter ones to none.
    HalvesDoNotEnd,
    /// No increment, however short, leads to an equilibrium; walls relaxed to one.
    Snaps,
    /// Blocks fall through open gaps, and only friction on the walls that stop them tells where
    /// they come to rest.
    Falls,
}

/// Record of a load step.
#[derive(Debug, Clone, PartialEq)]
pub struct StepRecord {
    /// Load at its end.
    pub load: Load,
    /// Every iteration, in order, of all substeps.
    pub iterations: Vec<Iteration>,
    /// Iterations of each substep that converged.
    pub substeps: Vec<usize>,
    /// Share of the step, from the load before to that at its end, that was solved.
    pub completed: f64,
    /// Share of the step beyond which no equilibrium is left, whatever the path, if its end is
    /// beyond that: an upper bound of what fractures can bear.
    pub bearable: Option<f64>,
    /// How it ended.
    pub outcome: StepOutcome,
    /// The part of it, if any, whose path is least resolved.
    pub unresolved: Option<UnresolvedPath>,
    /// Estimate of how far its increments lead the jumps off the path of the loads (m): the sum
    /// over its substeps of the largest difference of a jump in one increment and in two, or slip
    /// of walls until they meet in one. 0 where the path does not matter.
    pub path_error: f64,
    /// What the differences of its substeps add up to at the facet point where they do most (m).
    pub path_error_at_one_place: f64,
    /// Largest difference of a time step of its flow in one increment and in two that exceeds what
    /// is allowed, however short the step was divided; see
    /// [`NewtonSettings::time`](super::NewtonSettings::time).
    pub time_error: Option<f64>,
    /// Whether the iterative linear solver gave up in it, and a direct one went on.
    pub fell_back: bool,
    /// Blocks that nothing held when it failed, each with its free motions.
    pub rigid_motions: Vec<FreeBody>,
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
            substeps: Vec::new(),
            completed: 0.0,
            bearable: None,
            unresolved: None,
            path_error: 0.0,
            path_error_at_one_place: 0.0,
            time_error: None,
            fell_back: false,
            rigid_motions: Vec::new(),
            outcome: StepOutcome::OutOfIterations,
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
        self.outcome == StepOutcome::Converged
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An attempt that goes astray tells less than one that came to no end; of those that went
    /// astray the one tells most that names a place.
    #[test]
    fn an_increment_fails_for_what_its_attempts_have_in_common() {
        let stalled = StepOutcome::Linear(LinearFailure::Stalled(60));
        let [placed, nowhere] = [Some(3), None].map(StepOutcome::NotFinite);
        let endless = StepOutcome::OutOfIterations;
        for astray in [&stalled, &placed, &nowhere] {
            for (first, later) in [(astray, &endless), (&endless, astray)] {
                assert_eq!(first.clone().and(later.clone()), endless);
            }
            assert_eq!(astray.clone().and(astray.clone()), *astray);
            let pushed = StepOutcome::RigidBodyMotion;
            assert_eq!(astray.clone().and(pushed.clone()), pushed);
        }
        for (first, later) in [
            (&stalled, &placed),
            (&placed, &stalled),
            (&placed, &nowhere),
        ] {
            assert_eq!(first.clone().and(later.clone()), placed);
        }
        let stopped = StepOutcome::Stopped;
        assert_eq!(endless.and(stopped.clone()), stopped);
    }
}
