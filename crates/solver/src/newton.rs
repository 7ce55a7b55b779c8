//! Newton's method that does not see the cutoff.
//!
//! The law stiffens so fast that plain Newton, linearising at the opening where its last step
//! landed, overshoots. Here each facet point is linearised at the aperture that balances the law
//! with the rock around it: after the linear solve gives opening `w` and traction `t`, the monotone
//! scalar equation `sigma_n(w~) + k w~ = t + k w` gives `w~`, and the tangent is taken there. The
//! iteration sees loads and stiffnesses only, whatever the cutoff.
//!
//! `k` is the stiffness of the rock as the facet point feels it, measured by the secant through the
//! last two linear solves of the step, `-dt/dw`, between 0 and `E/h`; 0 for the first. Too large a
//! `k` overshoots towards closure, where the tangent is enormous and the way back is long; too
//! small a `k` comes down from the open side step by step. A fixed `E/h` fails for joints that are
//! soft against their elements.

use std::time::Instant;

use glam::{DMat3, DVec3};
use lie_core::Separation;
use rayon::prelude::*;

use crate::interface::{FacetPoint, Interface};
use crate::linear::{DirectSolver, LinearFailure};
use crate::system::{Discretisation, FacetPointState, State, System, norm};

/// Where a facet point is linearised.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Linearisation {
    /// At the aperture that balances law and surrounding rock.
    #[default]
    Balanced,
    /// At the opening where the last step landed: plain Newton, for comparison.
    Landed,
}

/// When an iteration counts as converged. All measures are free of units.
#[derive(Debug, Clone, Copy)]
pub struct NewtonSettings {
    /// Where facet points are linearised.
    pub linearisation: Linearisation,
    /// Largest out-of-balance force against the largest force.
    pub force: f64,
    /// Largest change of displacement against the largest displacement or opening. Newton's error
    /// is the square of its last step, so this bound is the root of the others.
    pub increment: f64,
    /// Largest closure error, see [`Iteration::closure_error`].
    pub closure: f64,
    /// Iterations after which a step has failed.
    pub max_iterations: usize,
}

impl Default for NewtonSettings {
    fn default() -> Self {
        Self {
            linearisation: Linearisation::default(),
            force: 1e-9,
            increment: 1e-5,
            closure: 1e-9,
            max_iterations: 50,
        }
    }
}

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
    /// Smallest aperture (m).
    pub smallest_aperture: f64,
}

/// How a load step ended.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// All three tests hold.
    Converged,
    /// The iterations ran out.
    OutOfIterations,
    /// An iterate is not a number or not finite; the facet point where it showed, if there.
    NotFinite(Option<usize>),
    /// The linear system could not be solved.
    Linear(LinearFailure),
}

/// Record of a load step.
#[derive(Debug, Clone, PartialEq)]
pub struct StepRecord {
    /// Factor on the loads.
    pub load: f64,
    /// Every iteration, in order.
    pub iterations: Vec<Iteration>,
    /// How it ended.
    pub outcome: Outcome,
    /// The facet point with the largest closure error at the end.
    pub worst_facet_point: Option<usize>,
    /// Time spent in factorisations (s).
    pub factorise_seconds: f64,
    /// Time spent in all else (s).
    pub solve_seconds: f64,
}

impl StepRecord {
    /// Whether the step converged.
    pub fn converged(&self) -> bool {
        self.outcome == Outcome::Converged
    }
}

/// The nonlinear solver of a system; it keeps the factorisation.
pub struct Newton<'a> {
    system: &'a System<'a>,
    settings: NewtonSettings,
    direct: DirectSolver,
    places: Vec<(usize, usize)>,
    is_nonlinear: bool,
}

/// Where the last linear solve of a step put a facet point.
#[derive(Debug, Clone, Copy, Default)]
struct Landing {
    /// Separation of the walls; none before the first solve.
    separation: Option<Separation>,
    /// Normal traction on the tangent plane (Pa).
    traction: f64,
}

impl Landing {
    /// Stiffness of the surrounding rock as two landings tell it, `-dt/dw`; 0 where they tell
    /// nothing.
    fn spring_to(&self, landed: Separation, traction: f64) -> f64 {
        let spring = self
            .separation
            .map(|before| (self.traction - traction) / landed.beyond(before));
        spring.filter(|spring| spring.is_finite()).unwrap_or(0.0)
    }
}

impl<'a> Newton<'a> {
    /// Orders and analyses the system.
    ///
    /// # Errors
    /// If the analysis fails.
    pub fn new(system: &'a System<'a>, settings: NewtonSettings) -> Result<Self, LinearFailure> {
        let Discretisation {
            points, pattern, ..
        } = &system.discretisation;
        let fractures = &system.problem.fractures;
        Ok(Self {
            direct: DirectSolver::new(&system.rock, pattern, points)?,
            places: system.interface_places(),
            is_nonlinear: fractures.iter().any(|f| !f.law.closure.is_linear()),
            system,
            settings,
        })
    }

    /// Number of entries of the Cholesky factor.
    pub fn factor_entries(&self) -> usize {
        self.direct.factor_entries()
    }

    /// Solves one load step from `state`, calling `observe` after each iteration. `state` is
    /// replaced if the step converges and kept if not.
    pub fn step(
        &mut self,
        state: &mut State,
        load: f64,
        mut observe: impl FnMut(usize, &Iteration),
    ) -> StepRecord {
        let start = Instant::now();
        let mut trial = state.clone();
        self.move_supports(&mut trial, load);
        let mut landings = vec![Landing::default(); trial.facet_points.len()];
        let mut record = StepRecord {
            load,
            iterations: Vec::new(),
            outcome: Outcome::OutOfIterations,
            worst_facet_point: None,
            factorise_seconds: 0.0,
            solve_seconds: 0.0,
        };
        while record.iterations.len() < self.settings.max_iterations {
            match self.iterate(&mut trial, &mut landings, &mut record) {
                Ok(iteration) => {
                    record.iterations.push(iteration);
                    observe(record.iterations.len(), &iteration);
                    if self.is_converged(&iteration) {
                        record.outcome = Outcome::Converged;
                        *state = trial;
                        break;
                    }
                }
                Err(outcome) => {
                    record.outcome = outcome;
                    break;
                }
            }
        }
        record.solve_seconds = start.elapsed().as_secs_f64() - record.factorise_seconds;
        record
    }

    fn is_converged(&self, iteration: &Iteration) -> bool {
        let settings = &self.settings;
        iteration.force_residual <= settings.force
            && iteration.closure_error <= settings.closure
            && (!self.is_nonlinear || iteration.increment <= settings.increment)
    }

    fn iterate(
        &mut self,
        state: &mut State,
        landings: &mut [Landing],
        record: &mut StepRecord,
    ) -> Result<Iteration, Outcome> {
        let tangents = self.tangents(state);
        let start = Instant::now();
        self.update_factor(&tangents).map_err(Outcome::Linear)?;
        record.factorise_seconds += start.elapsed().as_secs_f64();
        let tractions = self.linearised_tractions(state, &tangents);
        let residual = self
            .system
            .residual(&state.unknowns, &tractions, state.load);
        let correction = self.direct.solve(&residual);
        for (unknown, change) in state.unknowns.iter_mut().zip(&correction) {
            *unknown += *change;
        }
        if !state.unknowns.iter().all(|unknown| unknown.is_finite()) {
            return Err(Outcome::NotFinite(None));
        }
        let change = self.system.displacements(&correction, 0.0);
        let errors = self.follow(state, landings, &self.interface().jumps(&correction, 0.0));
        self.assess(state, &change, &errors, record)
    }

    fn interface(&self) -> &Interface {
        &self.system.discretisation.interface
    }

    /// Takes the state to another load factor: prescribed displacements move walls that are held.
    fn move_supports(&self, state: &mut State, load: f64) {
        let step = load - state.load;
        state.load = load;
        for (point, state) in self.interface().points.iter().zip(&mut state.facet_points) {
            let jump = step * point.prescribed;
            let opening = jump.dot(point.normal);
            state.mismatch += opening;
            state.shear += self.system.law(point).shear_stiffness * (jump - opening * point.normal);
        }
    }

    /// Slopes of the laws at the apertures of the state.
    fn tangents(&self, state: &State) -> Vec<DMat3> {
        let points = self.interface().points.par_iter().zip(&state.facet_points);
        points
            .map(|(point, state)| {
                let law = self.system.law(point);
                law.at(state.separation, DVec3::ZERO, point.normal).tangent
            })
            .collect()
    }

    /// Tractions on the tangent planes of the laws.
    fn linearised_tractions(&self, state: &State, tangents: &[DMat3]) -> Vec<DVec3> {
        let points = self.interface().points.par_iter().zip(&state.facet_points);
        points
            .zip(tangents)
            .map(|((point, state), tangent)| {
                let beyond = *tangent * (state.mismatch * point.normal);
                self.system.law_traction(point, state) + beyond
            })
            .collect()
    }

    fn update_factor(&mut self, tangents: &[DMat3]) -> Result<(), LinearFailure> {
        if self.direct.is_current() && !self.is_nonlinear {
            return Ok(());
        }
        let stiffness = self.interface().stiffness(tangents);
        let row_offset = &self.system.discretisation.pattern.row_offset;
        for (&(row, place), block) in self.places.iter().zip(&stiffness) {
            let rock = self.system.rock.blocks[row_offset[row] + place];
            self.direct.set_block(row, place, rock + *block);
        }
        self.direct.factorise()
    }

    /// Moves all facet points by the change of their jumps to where they are linearised next;
    /// returns their closure errors (Pa).
    fn follow(&self, state: &mut State, landings: &mut [Landing], changes: &[DVec3]) -> Vec<f64> {
        let points = self.interface().points.par_iter().zip(changes);
        points
            .zip(state.facet_points.par_iter_mut().zip(landings))
            .map(|((point, change), (state, landing))| {
                self.follow_point(point, *change, state, landing)
            })
            .collect()
    }

    fn follow_point(
        &self,
        point: &FacetPoint,
        change: DVec3,
        state: &mut FacetPointState,
        landing: &mut Landing,
    ) -> f64 {
        let law = self.system.law(point);
        let closure = &law.closure;
        let opening = change.dot(point.normal);
        state.shear += law.shear_stiffness * (change - opening * point.normal);
        let here = closure.at(state.separation);
        let beyond = state.mismatch + opening;
        let traction = here.traction + here.tangent * beyond;
        let landed = state.separation.moved(beyond);
        let spring = landing.spring_to(landed, traction).clamp(0.0, point.spring);
        *landing = Landing {
            separation: Some(landed),
            traction,
        };
        let balances = self.settings.linearisation == Linearisation::Balanced;
        state.separation = if closure.is_linear() || !balances {
            landed
        } else {
            closure.balanced(spring, traction + spring * landed.opening)
        };
        state.mismatch = landed.beyond(state.separation);
        let of_law = closure.at(state.separation).traction;
        (traction - of_law)
            .abs()
            .max(point.spring * state.mismatch.abs())
    }

    /// Measures how far the state is from a solution.
    fn assess(
        &self,
        state: &State,
        change: &[DVec3],
        errors: &[f64],
        record: &mut StepRecord,
    ) -> Result<Iteration, Outcome> {
        let points = || self.interface().points.iter().zip(&state.facet_points);
        let tractions: Vec<DVec3> = points()
            .map(|(point, state)| self.system.law_traction(point, state))
            .collect();
        if let Some(broken) = tractions.iter().position(|traction| !traction.is_finite()) {
            return Err(Outcome::NotFinite(Some(broken)));
        }
        let normal = points()
            .zip(&tractions)
            .map(|((point, _), t)| t.dot(point.normal).abs());
        let largest_normal = normal.fold(0.0, f64::max);
        let residual = norm(
            &self
                .system
                .residual(&state.unknowns, &tractions, state.load),
        );
        let scale = self
            .system
            .force_scale(&state.unknowns, &tractions, state.load);
        let displacements = self.system.displacements(&state.unknowns, state.load);
        let worst = (0..errors.len()).max_by(|&a, &b| errors[a].total_cmp(&errors[b]));
        record.worst_facet_point = worst;
        let separations = || state.facet_points.iter().map(|point| point.separation);
        let apertures = separations().map(|separation| separation.aperture);
        // A body that does not move may still hold joints closed by its initial stress.
        let opening = separations()
            .map(|separation| separation.opening.abs())
            .fold(0.0, f64::max);
        Ok(Iteration {
            force_residual: ratio(residual, scale),
            increment: ratio(largest(change), largest(&displacements).max(opening)),
            closure_error: ratio(worst.map_or(0.0, |worst| errors[worst]), largest_normal),
            smallest_aperture: apertures.fold(f64::INFINITY, f64::min),
        })
    }
}

fn largest(vectors: &[DVec3]) -> f64 {
    vectors.iter().map(|v| v.length()).fold(0.0, f64::max)
}

/// `value / scale`, and 0 where there is nothing to compare with nothing.
fn ratio(value: f64, scale: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value / scale }
}
