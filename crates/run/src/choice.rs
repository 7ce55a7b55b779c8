//! Which linear solver a run has, why, and what it learns of it.

use kluft_solver::{LinearMethod, Observed};
use serde::{Deserialize, Serialize};

/// Which linear solver a run has.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Choice {
    /// Its name.
    pub solver: String,
    /// Why the first one was chosen.
    pub why: String,
    /// What load steps have taken.
    pub observed: Observed,
    /// Memory for all that a solver needs (bytes).
    #[serde(skip)]
    pub memory: usize,
}

impl Choice {
    /// The solver, if it is one that can be chosen.
    pub fn method(&self) -> Option<LinearMethod> {
        self.solver.parse().ok()
    }

    /// Learns from a load step that continued a path: its linear solves and linear iterations.
    pub fn observe(&mut self, solves: usize, iterations: usize) {
        if let Some(method) = self.method() {
            self.observed.add(method, solves, iterations);
        }
    }
}
