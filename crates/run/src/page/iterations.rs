//! How Newton's method went.

use kluft_chart::{Axis, Chart, Series};
use kluft_solver::Iteration;
use serde::{Deserialize, Serialize};

/// Iterations that are kept; a run of more is charted up to there.
const MOST: usize = 400;

/// The measures of convergence after the iterations of a run.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Iterations {
    /// Force out of balance, increment, error of closure.
    measures: Vec<[f64; 3]>,
}

impl Iterations {
    /// Adds an iteration.
    pub fn add(&mut self, iteration: &Iteration) {
        if self.measures.len() < MOST {
            let Iteration {
                force_residual,
                increment,
                closure_error,
                ..
            } = *iteration;
            self.measures
                .push([force_residual, increment, closure_error]);
        }
    }

    /// Forgets what came before.
    pub fn clear(&mut self) {
        self.measures.clear();
    }

    /// The measures over the iterations of all load steps; none of linear problems.
    pub fn chart(&self) -> Option<Chart> {
        // One iteration is a linear solve.
        if self.measures.len() < 2 {
            return None;
        }
        let names = ["force out of balance", "increment", "error of closure"];
        let series = names.iter().enumerate().map(|(which, name)| {
            let points = (1..).zip(&self.measures);
            let points = points.map(|(i, measures)| (f64::from(i), measures[which]));
            Series::line(*name, points.filter(|point| point.1.is_finite()).collect())
        });
        let floor = 1e-16;
        let axes = (
            Axis::linear("iterations of all steps"),
            Axis::logarithmic("relative measure").from(floor),
        );
        Some(Chart {
            series: series.collect(),
            ..Chart::new("Newton's method", axes.0, axes.1)
        })
    }
}
