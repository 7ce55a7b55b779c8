//! Which linear solver a problem gets: the one with the least predicted time among those that fit,
//! and a direct one, because it is exact, where that takes next to no time.

use kluft_algebra::{Analysis, LinearFailure, NodeOrder};

use crate::linear::condensed::Condensed;
use crate::linear::cost::{Prediction, Unknowns, in_solid, iterative, predict};
use crate::linear::direct::Direct;
use crate::linear::iterative::Iterative;
use crate::linear::method::LinearMethod;
use crate::linear::tangent_solver::TangentSolver;
use crate::linear::workload::Workload;
use crate::system::System;

/// Predictions of two solvers may be wrong by this factor against each other.
const UNCERTAIN: f64 = 1.5;
/// Where the iterative solver gives up, a direct one is hopeless if in a solid body it would take
/// so many times what that should have; in thin ones it takes less.
const HOPELESS: f64 = 20.0;

/// The chosen solver and what is known of it before any value is computed.
pub struct Plan {
    /// What was chosen.
    pub method: LinearMethod,
    /// What all solvers that were considered would cost.
    pub predictions: Vec<Prediction>,
    analysis: Option<Analysis>,
    /// Memory for all that the solver needs (bytes).
    limit: usize,
}

impl Plan {
    /// Chooses the solver unless `forced` does. If none fits in `memory_bytes`, the one that needs
    /// least is chosen; see [`Plan::prediction`].
    ///
    /// # Errors
    /// If the ordering or the analysis fails.
    pub fn of(
        unknowns: Unknowns<'_>,
        workload: Workload,
        forced: Option<LinearMethod>,
        memory_bytes: usize,
    ) -> Result<Self, LinearFailure> {
        let iterative = iterative(unknowns, workload);
        let is_wanted = |method| forced.is_none_or(|forced| forced == method);
        let analysed = [LinearMethod::Direct, LinearMethod::Condensed];
        let analysed = analysed.into_iter().filter(|&method| match forced {
            Some(forced) => forced == method,
            // To analyse one that would lose in a solid body takes as long as many iterations.
            None => {
                let in_solid = in_solid(unknowns, workload, method);
                workload.present == Some(method) || in_solid < iterative.seconds
            }
        });
        let analysed: Vec<LinearMethod> = analysed.collect();
        let mut predictions = vec![iterative];
        let mut analyses = Vec::new();
        if !analysed.is_empty() {
            let graph = unknowns.pattern.node_graph(unknowns.points);
            let order = NodeOrder::of(&graph, &unknowns.points.offset)?;
            for method in analysed {
                let analysis = analysis(unknowns, &order, method)?;
                predictions.push(predict(unknowns, workload, method, &analysis));
                analyses.push((method, analysis));
            }
        }
        let candidates = || predictions.iter().filter(|p| is_wanted(p.method));
        let fitting = candidates().filter(|p| p.memory_bytes <= memory_bytes);
        let fastest =
            fitting.min_by(|a, b| a.effective_seconds().total_cmp(&b.effective_seconds()));
        let smallest = candidates().min_by_key(|p| p.memory_bytes);
        let fastest = fastest.map(|fastest| worth(fastest, &predictions, workload));
        let method = fastest.or(smallest).map_or(iterative.method, |p| p.method);
        let analysis = analyses.into_iter().find(|(of, _)| *of == method);
        Ok(Self {
            method,
            predictions,
            analysis: analysis.map(|(_, analysis)| analysis),
            limit: memory_bytes,
        })
    }

    /// A direct solver of a system, unless it needs more than `memory_bytes` or takes hopelessly
    /// long.
    pub(crate) fn direct_within(system: &System<'_>, memory_bytes: usize) -> Option<Self> {
        let unknowns = Unknowns::from(&system.discretisation);
        let workload = Workload::of_system(system, 1.0);
        let method = LinearMethod::Direct;
        let limit = HOPELESS * iterative(unknowns, workload).seconds;
        if in_solid(unknowns, workload, method) >= limit {
            return None;
        }
        let plan = Self::of(unknowns, workload, Some(method), memory_bytes).ok()?;
        (plan.prediction().memory_bytes <= memory_bytes).then_some(plan)
    }

    /// Memory (bytes) that the chosen solver leaves for another one.
    pub(crate) fn memory_left(&self) -> usize {
        self.limit.saturating_sub(self.prediction().memory_bytes)
    }

    /// What the chosen solver will cost.
    pub fn prediction(&self) -> &Prediction {
        let chosen = self.predictions.iter().find(|p| p.method == self.method);
        chosen.unwrap_or(&self.predictions[0])
    }

    /// Prepares the solver.
    ///
    /// # Errors
    /// If it cannot be prepared.
    pub fn prepare(self, system: &System<'_>) -> Result<Box<dyn TangentSolver>, LinearFailure> {
        let fixed = system.fixed_part();
        Ok(match (self.method, self.analysis) {
            (LinearMethod::Direct, Some(analysis)) => Box::new(Direct::new(fixed, analysis)),
            (LinearMethod::Condensed, Some(analysis)) => {
                let springs = system.discretisation.interface.springs();
                Box::new(Condensed::new(fixed, springs, analysis)?)
            }
            _ => Box::new(Iterative::new(system)?),
        })
    }
}

/// The fastest solver, or the one that stands, unless that takes so much longer that a prediction
/// can tell.
fn worth<'a>(
    fastest: &'a Prediction,
    predictions: &'a [Prediction],
    workload: Workload,
) -> &'a Prediction {
    let mut present = predictions.iter();
    let present = present.find(|p| workload.present == Some(p.method));
    present
        .filter(|present| present.seconds < UNCERTAIN * fastest.seconds)
        .unwrap_or(fastest)
}

fn analysis(
    unknowns: Unknowns<'_>,
    order: &NodeOrder,
    method: LinearMethod,
) -> Result<Analysis, LinearFailure> {
    let last: &[u32] = match method {
        LinearMethod::Condensed => unknowns.jumps,
        _ => &[],
    };
    let is_last = |block: usize| last.binary_search(&(block as u32)).is_ok();
    let order = order.with_last(&unknowns.points.offset, is_last);
    let blocks = &unknowns.pattern.blocks;
    Analysis::of(&blocks.row_offset, &blocks.columns, order)
}
