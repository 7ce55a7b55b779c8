//! Newton's method in the recycled space.
//!
//! To project the tangent costs as much as many evaluations of the laws, so it is done again only
//! where the former one leads too slowly.

use faer::Mat;
use rayon::prelude::*;

use super::space::RecycledSpace;
use crate::newton::dense;
use crate::newton::facet_points::{self, interface};
use crate::newton::iterate::LastCorrection;
use crate::newton::last_trial::LastTrial;
use crate::problem::Load;
use crate::system::{State, System};

/// Most iterations in the space.
const MOST_ITERATIONS: usize = 12;
/// Energy of the last correction, against the first, that ends the iterations.
const CONVERGED_ENERGY: f64 = 1e-18;
/// Energy of a correction, against the one before, above which the tangent is projected again.
const SLOW: f64 = 1e-2;
/// Energy of the last correction, against the first, that a guess may have at most.
const LARGEST_ENERGY: f64 = 1e-6;

/// A guess.
pub(in crate::newton) struct GalerkinGuess {
    pub(in crate::newton) state: State,
    pub(in crate::newton) last_trials: Vec<LastTrial>,
    pub(in crate::newton) last: LastCorrection,
}

/// What the iterations in the space work on.
struct ReducedIterate {
    state: State,
    last_trials: Vec<LastTrial>,
    coefficients: Vec<f64>,
    errors: Vec<f64>,
    /// `V^T (loads - K y_0)` (J).
    projected_residual: Vec<f64>,
    /// Tangent in the space, `V^T (K + fractures) V` (J); none if it is to be made.
    matrix: Option<Mat<f64>>,
}

/// Measures of a correction in the space.
#[derive(Default)]
struct Measures {
    /// Its energy (J).
    energy: f64,
    /// Bound of its displacements (m).
    displacement: f64,
}

impl RecycledSpace {
    /// Solves for the load in the space around a state, if laws are smooth; none if that leads
    /// nowhere.
    pub(in crate::newton) fn solve(
        &self,
        system: &System<'_>,
        from: &State,
        load: &Load,
    ) -> Option<GalerkinGuess> {
        if self.directions.is_empty() || !system.is_smooth() {
            return None;
        }
        let mut state = from.clone();
        facet_points::move_supports(system, &mut state, load);
        let mut iterate = self.start(system, state);
        let last = self.iterate_to_convergence(system, &mut iterate)?;
        Some(self.guess(iterate, &last))
    }

    fn start(&self, system: &System<'_>, state: State) -> ReducedIterate {
        let rock = system.rock_forces(&state.unknowns);
        let mut forces = system.load_forces(&state.load);
        let pairs = forces.par_iter_mut().zip(rock);
        pairs.for_each(|(force, rock)| *force -= rock);
        ReducedIterate {
            projected_residual: self.projected(&forces),
            last_trials: vec![LastTrial::default(); state.facet_points.len()],
            coefficients: vec![0.0; self.directions.len()],
            errors: Vec::new(),
            matrix: None,
            state,
        }
    }

    /// The last correction of the iterations; none if they lead nowhere.
    fn iterate_to_convergence(
        &self,
        system: &System<'_>,
        iterate: &mut ReducedIterate,
    ) -> Option<Measures> {
        let mut first = None;
        let mut last = Measures {
            energy: f64::INFINITY,
            ..Measures::default()
        };
        for _ in 0..MOST_ITERATIONS {
            let former = last.energy;
            last = self.iterate(system, iterate)?;
            if last.energy <= CONVERGED_ENERGY * *first.get_or_insert(last.energy) {
                break;
            }
            if last.energy > SLOW * former {
                iterate.matrix = None;
            }
        }
        let is_finite =
            last.energy.is_finite() && iterate.errors.iter().all(|error| error.is_finite());
        if !is_finite || last.energy > LARGEST_ENERGY * first? {
            return None;
        }
        Some(last)
    }

    /// One iteration of Newton's method in the space.
    fn iterate(&self, system: &System<'_>, iterate: &mut ReducedIterate) -> Option<Measures> {
        let planes = facet_points::linearised(
            system,
            &iterate.state,
            facet_points::Linearisation::Tangents,
        );
        let matrix = iterate.matrix.take();
        let matrix = matrix.unwrap_or_else(|| {
            let stiffness = interface(system).stiffness(&planes.tangents.exact);
            self.tangent(system, &stiffness, true)
        });
        let rock = self.rock_forces(&iterate.coefficients);
        let fractures = self.fracture_forces(system, &iterate.state, &planes.tangents);
        let residual: Vec<f64> = (0..rock.len())
            .map(|i| iterate.projected_residual[i] - rock[i] - fractures[i])
            .collect();
        let change = dense::solve(matrix.clone(), &residual)?;
        iterate.matrix = Some(matrix);
        let correction = self.combined_on_fractures(system, &change);
        iterate.errors = facet_points::follow(
            system,
            &mut iterate.state,
            &mut iterate.last_trials,
            &interface(system).jumps(&correction, &Load::NONE),
            &planes,
        );
        for (coefficient, change) in iterate.coefficients.iter_mut().zip(&change) {
            *coefficient += change;
        }
        let sizes = self.known.iter().zip(&change);
        Some(Measures {
            energy: change.iter().zip(&residual).map(|(c, r)| c * r).sum(),
            displacement: sizes.map(|(known, c)| c.abs() * known.size).sum(),
        })
    }

    /// The state that the coefficients stand for.
    fn guess(&self, iterate: ReducedIterate, last: &Measures) -> GalerkinGuess {
        let mut state = iterate.state;
        let unknowns = state.unknowns.par_iter_mut().enumerate();
        unknowns.for_each(|(i, unknown)| *unknown += self.combined(&iterate.coefficients, i));
        GalerkinGuess {
            state,
            last_trials: iterate.last_trials,
            last: LastCorrection {
                coefficients: iterate.coefficients,
                errors: iterate.errors,
                displacement: last.displacement,
            },
        }
    }
}
