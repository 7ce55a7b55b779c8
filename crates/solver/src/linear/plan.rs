//! Which linear solver a problem gets.

use std::str::FromStr;

use super::{Analysis, Condensed, LinearFailure, NodeOrder, TangentSolver, Whole};
use crate::problem::Problem;
use crate::system::{Discretisation, System};

/// The linear solvers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LinearMethod {
    /// Cholesky factorisation of the whole tangent, whenever it changes.
    Direct,
    /// Cholesky factorisation of the rock, once; what changes is solved for the jumps alone.
    Condensed,
}

impl FromStr for LinearMethod {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        match name {
            "direct" => Ok(Self::Direct),
            "condensed" => Ok(Self::Condensed),
            other => Err(format!("there is no solver `{other}`")),
        }
    }
}

/// The chosen solver and what is known of it before any value is computed.
pub struct Plan {
    /// What was chosen.
    pub method: LinearMethod,
    analysis: Analysis,
}

impl Plan {
    /// Chooses the solver unless `forced` does.
    ///
    /// # Errors
    /// If the ordering or the analysis fails.
    pub fn of(
        _problem: &Problem,
        discretisation: &Discretisation,
        forced: Option<LinearMethod>,
    ) -> Result<Self, LinearFailure> {
        let Discretisation {
            points,
            pattern,
            interface,
            ..
        } = discretisation;
        let order = NodeOrder::of(pattern, points)?;
        let method = forced.unwrap_or(LinearMethod::Condensed);
        let last: &[u32] = match method {
            LinearMethod::Direct => &[],
            LinearMethod::Condensed => &interface.unknowns,
        };
        Ok(Self {
            analysis: Analysis::of(pattern, points, &order, last)?,
            method,
        })
    }

    /// Number of entries of the Cholesky factor.
    pub fn factor_entries(&self) -> usize {
        self.analysis.factor_entries()
    }

    /// Prepares the solver.
    ///
    /// # Errors
    /// If it cannot be prepared.
    pub fn prepare(self, system: &System<'_>) -> Result<Box<dyn TangentSolver>, LinearFailure> {
        Ok(match self.method {
            LinearMethod::Direct => Box::new(Whole::new(system, self.analysis)),
            LinearMethod::Condensed => Box::new(Condensed::new(system, self.analysis)?),
        })
    }
}
