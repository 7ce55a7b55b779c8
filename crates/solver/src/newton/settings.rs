//! Settings of a nonlinear solve.

use crate::linear::LinearMethod;

/// When an iteration counts as converged. All measures are free of units.
#[derive(Debug, Clone, Copy)]
pub struct NewtonSettings {
    /// Largest out-of-balance force against the largest force.
    pub force: f64,
    /// Largest change of displacement against the largest displacement or opening. Newton's error
    /// is the square of its last correction, so this bound is the root of the others.
    pub increment: f64,
    /// Largest closure error, see [`Iteration::closure_error`](super::Iteration::closure_error).
    pub closure: f64,
    /// Iterations after which an increment has failed.
    pub max_iterations: usize,
    /// Largest difference, against the largest jump, between a path in one increment and in two,
    /// where the laws depend on the path.
    pub path: f64,
    /// Largest difference between a time step of a flow in one increment and in two: of what fills
    /// the fractures at other places, and of pressures, against what has moved since the run began.
    /// Steps are taken as they are given from 1 on.
    pub time: f64,
    /// What nodes of a flow may miss, summed up, against what moves.
    pub mass: f64,
    /// How linear systems are solved; chosen by predicted cost if not given.
    pub linear: Option<LinearMethod>,
}

impl Default for NewtonSettings {
    fn default() -> Self {
        Self {
            force: 1e-9,
            increment: 1e-5,
            closure: 1e-9,
            max_iterations: 25,
            path: 1e-3,
            time: 1e-2,
            mass: 1e-10,
            linear: None,
        }
    }
}
