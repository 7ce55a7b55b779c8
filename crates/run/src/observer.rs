//! What a run tells while it works, and how it is stopped.

use std::ops::ControlFlow;
use std::time::Duration;

use kluft_solver::Iteration;

use crate::outcome::StepResult;

/// A stage of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// gmsh makes the mesh.
    Mesh,
    /// The mesh is read and checked, and meets the scene.
    Read,
    /// Sectors, unknowns and the pattern of the matrix.
    Enrich,
    /// Stiffness of the rock and loads.
    Assemble,
    /// The linear solvers' costs are predicted.
    ChooseSolver,
    /// The linear solver prepares what it needs once a run.
    PrepareSolver,
    /// The linear solver takes up where a former run stopped.
    RestoreSolver,
    /// A load step is solved.
    Solve,
    /// Errors are estimated.
    Estimate,
    /// Results are written.
    Write,
}

impl Stage {
    /// What a run does in it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Mesh => "meshing (gmsh)",
            Self::Read => "reading",
            Self::Enrich => "enriching",
            Self::Assemble => "assembling",
            Self::ChooseSolver => "choosing a solver",
            Self::PrepareSolver => "preparing the solver",
            Self::RestoreSolver => "factorising",
            Self::Solve => "factorising and solving",
            Self::Estimate => "estimating the error",
            Self::Write => "writing",
        }
    }
}

/// A load step about to be solved.
#[derive(Debug, Clone, Copy)]
pub struct StepStart<'a> {
    /// Its number, from 1.
    pub number: usize,
    /// Number of all load steps.
    pub count: usize,
    /// Its phase, time and load factors in words.
    pub what: &'a str,
}

/// Who follows a run. Every method does nothing unless it is given; `()` follows silently.
///
/// The methods are called on a thread of the pool that the run was given, one at a time.
pub trait Observer: Send {
    /// A stage begins.
    fn stage_begins(&mut self, _stage: Stage) {}

    /// A stage has ended, after this time.
    fn stage_ends(&mut self, _stage: Stage, _took: Duration) {}

    /// A fact or a decision, `kind` in one word.
    fn note(&mut self, _kind: &str, _text: &str) {}

    /// Something that only who looks closely wants to know.
    fn detail(&mut self, _kind: &str, _text: &str) {}

    /// A load step begins.
    fn step_begins(&mut self, _step: StepStart<'_>) {}

    /// An iteration of Newton's method has ended. `Break` stops the run; the converged steps are
    /// kept.
    fn iteration(&mut self, _number: usize, _iteration: &Iteration) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    /// Whether to go on with the next load step of a flow in rigid rock, which takes no iterations.
    /// `Break` stops the run; the steps before are kept.
    fn goes_on(&mut self) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    /// A load step has converged. Called only if the run was asked to keep results.
    fn step_ends(&mut self, _result: &StepResult) {}
}

impl Observer for () {}
