//! What linear solvers cost, predicted before any value is computed.
//!
//! Times are predicted from operations and bytes moved, at fixed rates of an ordinary machine, so
//! the predictions are the same everywhere; only their ratios matter.

use kluft_algebra::{Analysis, ScalarCholesky};

use crate::linear::method::LinearMethod;
use crate::linear::workload::Workload;
use crate::space::pattern::Pattern;
use crate::space::sector_nodes::SectorNodes;
use crate::system::Discretisation;

/// Operations of a factorisation in a second (1/s).
const OPERATIONS: f64 = 3e10;
/// Time to order and to analyse an unknown (s).
const ANALYSIS: f64 = 5e-6;
/// Bytes read in a second (1/s).
const BYTES: f64 = 2e10;
/// Cholesky factors of solid bodies take about this times the square of the unknowns (operations).
const SOLID: f64 = 18.0;
/// Time below which a direct solver is taken even if the iterative one is faster (s).
const QUICK: f64 = 0.1;
/// Weight of so short a time.
const NEGLIGIBLE: f64 = 1e-3;

/// What there is to solve for.
#[derive(Debug, Clone, Copy)]
pub struct Unknowns<'a> {
    /// Who couples with whom.
    pub pattern: &'a Pattern,
    /// Numbering.
    pub points: &'a SectorNodes,
    /// Unknowns that the fractures act on, ascending.
    pub jumps: &'a [u32],
}

impl<'a> From<&'a Discretisation> for Unknowns<'a> {
    fn from(discretisation: &'a Discretisation) -> Self {
        Self {
            pattern: &discretisation.pattern,
            points: &discretisation.points,
            jumps: &discretisation.interface.unknowns,
        }
    }
}

/// Predicted cost of a solver.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prediction {
    /// The solver.
    pub method: LinearMethod,
    /// Time of all linear solves of the run on an ordinary machine (s).
    pub seconds: f64,
    /// Memory that solver and error estimate need beside mesh and matrix (bytes).
    pub memory_bytes: usize,
    /// Entries of its Cholesky factor; 0 if it has none.
    pub factor_entries: usize,
    /// Operations of its factorisation; 0 if it has none.
    pub operations: f64,
}

impl Prediction {
    /// Cost of factorising a flow in rigid rock, of this analysis and number of pressures, so often
    /// and of solving it so often.
    pub fn of_rigid_flow(
        factor: &ScalarCholesky,
        pressures: usize,
        [factorisations, solves]: [usize; 2],
    ) -> Self {
        let factorise = ANALYSIS * pressures as f64 + factor.factor_operations() / OPERATIONS;
        let substitute = 16.0 * factor.factor_entries() as f64 / BYTES;
        Self {
            method: LinearMethod::Direct,
            seconds: factorisations as f64 * factorise + solves as f64 * substitute,
            memory_bytes: factor.memory_bytes(),
            factor_entries: factor.factor_entries(),
            operations: factor.factor_operations(),
        }
    }

    /// The time that counts: direct solvers are exact to rounding, so one that is over in no time
    /// is as good as any.
    pub(super) fn effective_seconds(&self) -> f64 {
        let is_exact = self.method != LinearMethod::Iterative;
        if is_exact && self.seconds < QUICK {
            self.seconds * NEGLIGIBLE
        } else {
            self.seconds
        }
    }
}

/// Time of the factorisations of a direct solver in a solid body, without an analysis (s).
pub(super) fn in_solid(unknowns: Unknowns<'_>, workload: Workload, method: LinearMethod) -> f64 {
    let factorise = SOLID * (3.0 * unknowns.points.len() as f64).powi(2) / OPERATIONS;
    match method {
        LinearMethod::Condensed => factorise + 3.0 * dense(unknowns),
        _ => workload.factorisations() * factorise,
    }
}

/// Time to factorise the condensed problem (s).
fn dense(unknowns: Unknowns<'_>) -> f64 {
    (3.0 * unknowns.jumps.len() as f64).powi(3) / 3.0 / OPERATIONS
}

pub(super) fn predict(
    unknowns: Unknowns<'_>,
    workload: Workload,
    method: LinearMethod,
    analysis: &Analysis,
) -> Prediction {
    let solves = workload.solves();
    let factorise = analysis.factor_operations() / OPERATIONS;
    let substitute = 16.0 * analysis.factor_entries() as f64 / BYTES;
    let jumps = 3.0 * unknowns.jumps.len() as f64;
    let dense = dense(unknowns);
    let stands = workload.present == Some(method);
    let (seconds, extra) = match method {
        LinearMethod::Condensed => {
            let iterations = 8.0 * 16.0 * jumps.powi(2) / BYTES;
            let each = workload.substitutions() * (substitute + iterations.min(dense));
            let once = if stands { 0.0 } else { factorise + 3.0 * dense };
            (once + solves * each, 24.0 * jumps.powi(2))
        }
        _ => {
            let factorise = workload.factorisations() * factorise;
            let substitute = workload.substitutions() * substitute;
            (factorise + solves * substitute, 0.0)
        }
    };
    let analyse = ANALYSIS * 3.0 * unknowns.points.len() as f64;
    Prediction {
        method,
        seconds: seconds + if stands { 0.0 } else { analyse },
        memory_bytes: workload.extra.with(
            analysis.memory_bytes() + extra as usize + workload.flow_bytes(unknowns.points.len()),
        ),
        factor_entries: analysis.factor_entries(),
        operations: analysis.factor_operations(),
    }
}

/// Time and memory of the multigrid, both by the number of blocks of the matrix: measured.
pub(super) fn iterative(unknowns: Unknowns<'_>, workload: Workload) -> Prediction {
    const SETUP_BYTES: f64 = 8_500.0;
    const ITERATION_BYTES: f64 = 400.0;
    const MEMORY_BYTES: f64 = 200.0;
    let blocks = unknowns.pattern.blocks.columns.len() as f64;
    let set_up = match workload.present {
        Some(LinearMethod::Iterative) => 0.0,
        _ => SETUP_BYTES,
    };
    Prediction {
        method: LinearMethod::Iterative,
        seconds: blocks * (set_up + workload.iterations() * ITERATION_BYTES) / BYTES,
        memory_bytes: workload.extra.with(
            (blocks * MEMORY_BYTES) as usize
                + workload.flow_bytes(unknowns.points.len())
                + workload.extra.iterative,
        ),
        factor_entries: 0,
        operations: 0.0,
    }
}
