//! A first guess for a load step: Newton's method in the space of the moves of former steps.
//!
//! States along a path lie close to a space of few dimensions, which the corrections that led to them
//! span. With `y = y_0 + V c` the balance of forces becomes `V^T (loads - K y - fractures) = 0`. The rock
//! enters by the small matrix `V^T K V`, which never changes, and the fractures by the jumps of `V`, so
//! an iteration costs what the facet points cost, whatever the size of the rock. Smooth laws are convex, so
//! this is the state of least energy in the space. What the guess leaves
//! out of balance is orthogonal to the space, and so, in energy, is the correction that removes it: the
//! next direction (Erhel and Guyomarc'h 2000 start conjugate gradients alike).

mod dense;

use faer::Mat;
use glam::{DMat3, DVec3};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::walls::{self, Landed};
use super::{Move, NewtonSettings, interface, largest};
use crate::linear::Tangents;
use crate::problem::Load;
use crate::system::{State, System};

/// Most directions that a guess is made of; beyond, they are condensed to the principal ones of the
/// last moves.
const MOST: usize = 24;
const PRINCIPAL: usize = 12;
/// Moves that are remembered, and the factor by which each counts less than the next.
const REMEMBERED: usize = 48;
const FADING: f64 = 0.95;
/// Iterations in the space; energy of the last move, against the first, that ends them, and that at
/// most may be left.
const ITERATIONS: usize = 8;
const SETTLED: f64 = 1e-18;
const UNSETTLED: f64 = 1e-6;

/// The space.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(super) struct Subspace {
    directions: Vec<Vec<DVec3>>,
    /// Moves of the last steps as coefficients of the directions, the latest first; those of directions
    /// that came later are left out.
    moves: Vec<Vec<f64>>,
    /// What is computed once for each direction.
    known: Vec<Known>,
}

/// What is known of a direction.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Known {
    /// `v_i . K v_j` (J) for the directions up to it.
    energies: Vec<f64>,
    /// Its largest displacement (m).
    size: f64,
}

/// A guess.
pub(super) struct Guess {
    pub(super) state: State,
    pub(super) landed: Vec<Landed>,
    pub(super) last: LastMove,
}

/// The last iteration of a guess.
#[derive(Debug, Clone)]
pub(super) struct LastMove {
    /// The guess as coefficients of the directions.
    coefficients: Vec<f64>,
    /// Closure errors (Pa).
    pub(super) errors: Vec<f64>,
    /// Bound of the displacements of the iteration (m).
    pub(super) increment: f64,
}

/// Where the iteration in the space stands.
struct Trial {
    state: State,
    landed: Vec<Landed>,
    coefficients: Vec<f64>,
    errors: Vec<f64>,
    /// `V^T (loads - K y_0)` (J).
    pull: Vec<f64>,
}

/// Memory that it takes in a run at most, while the principal directions are made (bytes).
pub(crate) fn bytes(unknowns: usize, steps: usize) -> usize {
    const FIRST: usize = 5;
    let directions = (FIRST + steps).min(MOST + PRINCIPAL);
    directions * unknowns * size_of::<DVec3>()
}

impl Subspace {
    /// Whether its directions are of this number of unknowns.
    pub(super) fn fits(&self, unknowns: usize) -> bool {
        let count = self.directions.len();
        let known = self.known.iter().zip(1..);
        self.directions.iter().all(|v| v.len() == unknowns)
            && self.moves.iter().all(|moved| moved.len() <= count)
            && self.known.len() == count
            && known.into_iter().all(|(k, i)| k.energies.len() == i)
    }

    /// Keeps the moves of a step that converged: its guess, and those after it whose forces are known.
    pub(super) fn learn(&mut self, guess: Option<LastMove>, moves: Vec<Move>) {
        if let Some(guess) = guess {
            self.moves.insert(0, guess.coefficients);
        }
        for moved in moves {
            let Some(image) = moved.rock_forces else {
                continue;
            };
            let mut alone = vec![0.0; self.directions.len()];
            alone.push(1.0);
            self.moves.insert(0, alone);
            self.add(moved.unknowns, &image, moved.size);
        }
        self.moves.truncate(REMEMBERED);
    }

    /// Adds a direction `v`, given `K v` (N) and its largest displacement (m).
    fn add(&mut self, direction: Vec<DVec3>, image: &[DVec3], size: f64) {
        self.directions.push(direction);
        let directions = self.directions.par_iter();
        self.known.push(Known {
            energies: directions.map(|other| dot(other, image)).collect(),
            size,
        });
    }

    /// Solves for the load in the space around a state; none if that leads nowhere.
    pub(super) fn guess(
        &mut self,
        system: &System<'_>,
        settings: &NewtonSettings,
        from: &State,
        load: &Load,
    ) -> Option<Guess> {
        if self.directions.is_empty() || !system.is_smooth() {
            return None;
        }
        let mut state = from.clone();
        walls::move_supports(system, &mut state, load);
        if self.directions.len() > MOST {
            self.condense(system, &state);
        }
        let mut trial = self.start(system, state);
        let mut first = None;
        let mut increment = 0.0;
        let mut energy = 0.0;
        for _ in 0..ITERATIONS {
            (energy, increment) = self.iterate(system, settings, &mut trial)?;
            if energy <= SETTLED * *first.get_or_insert(energy) {
                break;
            }
        }
        let is_finite = energy.is_finite() && trial.errors.iter().all(|error| error.is_finite());
        if !is_finite || energy > UNSETTLED * first? {
            return None;
        }
        let unknowns = trial.state.unknowns.par_iter_mut().enumerate();
        unknowns.for_each(|(i, unknown)| *unknown += self.combined(&trial.coefficients, i));
        Some(Guess {
            state: trial.state,
            landed: trial.landed,
            last: LastMove {
                coefficients: trial.coefficients,
                errors: trial.errors,
                increment,
            },
        })
    }

    fn start(&self, system: &System<'_>, state: State) -> Trial {
        let rock = system.rock_forces(&state.unknowns);
        let mut forces = system.load_forces(&state.load);
        let pairs = forces.par_iter_mut().zip(rock);
        pairs.for_each(|(force, rock)| *force -= rock);
        let directions = self.directions.par_iter();
        Trial {
            pull: directions.map(|v| dot(v, &forces)).collect(),
            landed: vec![Landed::default(); state.facet_points.len()],
            coefficients: vec![0.0; self.directions.len()],
            errors: Vec::new(),
            state,
        }
    }

    /// One iteration of Newton's method in the space; returns the energy of the move (J) and a bound of
    /// its displacements (m).
    fn iterate(
        &self,
        system: &System<'_>,
        settings: &NewtonSettings,
        trial: &mut Trial,
    ) -> Option<(f64, f64)> {
        let tangents = walls::tangents(system, &trial.state);
        let (matrix, forces) = self.project(system, &trial.state, &tangents);
        let rock = self.rock_forces(&trial.coefficients);
        let residual: Vec<f64> = (0..rock.len())
            .map(|i| trial.pull[i] - rock[i] - forces[i])
            .collect();
        let change = dense::solve(matrix, &residual)?;
        trial.errors = walls::follow(
            system,
            settings.linearisation,
            &mut trial.state,
            &mut trial.landed,
            &interface(system).jumps(&self.moved(system, &change), &Load::NONE),
            &tangents,
        );
        for (coefficient, change) in trial.coefficients.iter_mut().zip(&change) {
            *coefficient += change;
        }
        let energy = change.iter().zip(&residual).map(|(c, r)| c * r).sum();
        let sizes = self.known.iter().zip(&change);
        Some((energy, sizes.map(|(known, c)| c.abs() * known.size).sum()))
    }

    /// `v_i . K v_j` (J).
    fn energy(&self, i: usize, j: usize) -> f64 {
        self.known[i.max(j)].energies[i.min(j)]
    }

    /// `V^T K V c` (J).
    fn rock_forces(&self, coefficients: &[f64]) -> Vec<f64> {
        let terms = |i: usize| coefficients.iter().enumerate().map(move |(j, c)| (i, j, c));
        (0..coefficients.len())
            .map(|i| terms(i).map(|(i, j, c)| self.energy(i, j) * c).sum())
            .collect()
    }

    /// The tangent, and the forces of the fractures on the tangent planes of the laws, in the space (J).
    fn project(
        &self,
        system: &System<'_>,
        state: &State,
        tangents: &Tangents,
    ) -> (Mat<f64>, Vec<f64>) {
        let interface = interface(system);
        let own = |vector: &[DVec3]| -> Vec<DVec3> {
            let unknowns = interface.unknowns.iter();
            unknowns.map(|&unknown| vector[unknown as usize]).collect()
        };
        let tractions = walls::linearised_tractions(system, state, tangents);
        let mut forces = vec![DVec3::ZERO; state.unknowns.len()];
        interface.add_forces(&tractions, 1.0, &mut forces);
        let forces = own(&forces);
        let stiffness: Vec<DMat3> = interface.stiffness(&tangents.exact);
        let jumps: Vec<Vec<DVec3>> = self.directions.par_iter().map(|v| own(v)).collect();
        let images: Vec<Vec<f64>> = self
            .directions
            .par_iter()
            .map(|v| interface.resistance(&stiffness, v))
            .map(|image| jumps.iter().map(|own| dot(own, &image)).collect())
            .collect();
        let matrix = Mat::from_fn(jumps.len(), jumps.len(), |i, j| {
            self.energy(i, j) + images[i.max(j)][i.min(j)]
        });
        (matrix, jumps.iter().map(|own| dot(own, &forces)).collect())
    }

    /// `V c`, on the unknowns that move facet points only (m).
    fn moved(&self, system: &System<'_>, change: &[f64]) -> Vec<DVec3> {
        let mut moved = vec![DVec3::ZERO; system.discretisation.points.len()];
        for &unknown in &interface(system).unknowns {
            moved[unknown as usize] = self.combined(change, unknown as usize);
        }
        moved
    }

    /// Entry of `V c` (m).
    fn combined(&self, coefficients: &[f64], entry: usize) -> DVec3 {
        let directions = self.directions.iter().zip(coefficients);
        directions.map(|(v, c)| *c * v[entry]).sum()
    }

    /// Replaces the directions by the principal ones of the last moves, by energy (proper orthogonal
    /// decomposition).
    fn condense(&mut self, system: &System<'_>, state: &State) {
        let (matrix, _) = self.project(system, state, &walls::tangents(system, state));
        let scale: Vec<f64> = (0..self.directions.len())
            .map(|i| matrix[(i, i)].max(f64::MIN_POSITIVE).sqrt())
            .collect();
        let scaled = |moved: &Vec<f64>| -> Vec<f64> {
            let mut scaled: Vec<f64> = moved.iter().zip(&scale).map(|(c, s)| c * s).collect();
            scaled.resize(scale.len(), 0.0);
            scaled
        };
        let moves: Vec<Vec<f64>> = self.moves.iter().map(scaled).collect();
        let axes = dense::principal_axes(&moves, FADING, PRINCIPAL);
        let entries = 0..state.unknowns.len();
        let direction = |axis: &Vec<f64>| -> Vec<DVec3> {
            let weights: Vec<f64> = axis.iter().zip(&scale).map(|(a, s)| a / s).collect();
            let entries = entries.clone().into_par_iter();
            entries.map(|i| self.combined(&weights, i)).collect()
        };
        let directions: Vec<Vec<DVec3>> = axes.iter().map(direction).collect();
        let along = |moved: &Vec<f64>| -> Vec<f64> {
            let axes = axes.iter();
            axes.map(|axis| axis.iter().zip(moved).map(|(a, m)| a * m).sum())
                .collect()
        };
        self.moves = moves.iter().map(along).collect();
        self.directions.clear();
        self.known.clear();
        for direction in directions {
            let image = system.rock_forces(&direction);
            let size = largest(&system.displacements(&direction, &Load::NONE));
            self.add(direction, &image, size);
        }
    }
}

/// Scalar product, summed in a fixed order.
fn dot(a: &[DVec3], b: &[DVec3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(*b)).sum()
}
