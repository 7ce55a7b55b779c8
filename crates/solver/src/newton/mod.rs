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

mod bookmark;
mod extrapolation;
mod line_search;
mod loose;
mod march;
mod record;
mod subspace;
mod walls;

use std::time::Instant;

use glam::DVec3;
use kluft_algebra::{LinearFailure, norm};

use crate::assembly::interface::Interface;
use crate::linear::{LinearMethod, NonsymmetricSolver, Plan, Unknowns, Workload};
use crate::problem::Load;
use crate::system::{State, StateScales, System};
use extrapolation::Path;
use subspace::{LastMove, Subspace};
use walls::Landed;

pub use bookmark::RestartState;
pub use record::{Iteration, Linearisation, NewtonSettings, Outcome, StepRecord};
pub(crate) use subspace::bytes as subspace_bytes;

/// Largest error of a linear solve against its right-hand side while the state still changes.
const LOOSEST_SOLVE: f64 = 1e-3;

/// What a linear solve may leave out of balance, as a share of what the test of the forces allows.
const SOLVED: f64 = 0.1;

/// Share of the largest sizes of a path that still counts once the loads are gone: what is left then
/// is rounding, and would be compared with nothing but itself.
const REMEMBERED: f64 = 1e-3;

/// Share of the largest increment allowed where walls are reined in.
const REINED: f64 = 1e-2;

/// Share of the traction that would close an open fracture, below which the errors of its own count as
/// small.
const OPEN: f64 = 1e-3;

/// Iterations before blocks that fly are looked for, those that they may fly, and the force out of
/// balance, against the largest, that makes them.
const PATIENCE: usize = 8;
const FLIGHTS: usize = 3;
const UNBALANCED: f64 = 1e-4;

/// The nonlinear solver of a system; it keeps what the linear solver prepared.
///
/// The same solver serves a system whose fracture laws are changed between two steps, because the
/// rock, which is all that was prepared, stays.
pub struct Newton {
    settings: NewtonSettings,
    linear: NonsymmetricSolver,
    path: Path,
    /// Moves of former steps, if the linear solver iterates.
    subspace: Option<Subspace>,
}

/// What a step works on.
#[derive(Clone)]
struct Trial {
    state: State,
    landed: Vec<Landed>,
    /// Forces by which the rock resists the unknowns (N).
    rock_forces: Vec<DVec3>,
    /// StateScales that its errors are measured against.
    sizes: StateScales,
    /// Largest error allowed in the next linear solve, against its right-hand side.
    looseness: f64,
    /// Errors after the last iteration, see `line_search`.
    merit: Option<f64>,
    /// The guess that it began with, if it was made in the subspace.
    guess: Option<LastMove>,
    /// Its moves, if they are to be remembered.
    moves: Vec<Move>,
}

/// What a linear solve does to the unknowns.
#[derive(Debug, Clone)]
struct Move {
    /// Change of the unknowns (m).
    unknowns: Vec<DVec3>,
    /// Forces by which the rock resists it (N), if they are to be remembered.
    rock_forces: Option<Vec<DVec3>>,
    /// Its largest displacement (m).
    size: f64,
}

impl Move {
    fn of(system: &System<'_>, unknowns: Vec<DVec3>, is_remembered: bool) -> Self {
        Self {
            rock_forces: is_remembered.then(|| system.rock_forces(&unknowns)),
            size: largest(&system.displacements(&unknowns, &Load::NONE)),
            unknowns,
        }
    }

    fn scaled(&self, share: f64) -> Self {
        let scaled = |vector: &Vec<DVec3>| vector.iter().map(|entry| share * *entry).collect();
        Self {
            unknowns: scaled(&self.unknowns),
            rock_forces: self.rock_forces.as_ref().map(scaled),
            size: share * self.size,
        }
    }
}

impl Newton {
    /// Chooses and prepares the linear solver.
    ///
    /// # Errors
    /// If it cannot be prepared.
    pub fn new(system: &System<'_>, settings: NewtonSettings) -> Result<Self, LinearFailure> {
        let unknowns = Unknowns::from(&system.discretisation);
        let workload = Workload::of_system(system);
        let plan = Plan::of(unknowns, workload, settings.linear, usize::MAX)?;
        Self::planned(system, settings, plan)
    }

    /// Prepares the linear solver of a plan.
    ///
    /// # Errors
    /// If it cannot be prepared.
    pub fn planned(
        system: &System<'_>,
        settings: NewtonSettings,
        plan: Plan,
    ) -> Result<Self, LinearFailure> {
        let recycles = plan.method == LinearMethod::Iterative;
        Ok(Self {
            subspace: recycles.then(Subspace::default),
            linear: NonsymmetricSolver::new(plan.prepare(system)?),
            path: Path::default(),
            settings,
        })
    }

    /// Solves one load step from `state` to `load`, calling `observe` after each iteration. `state` is
    /// replaced if the step converges and kept if not. A step that the laws make too difficult or too
    /// coarse is divided.
    pub fn step(
        &mut self,
        system: &System<'_>,
        state: &mut State,
        load: &Load,
        mut observe: impl FnMut(usize, &Iteration),
    ) -> StepRecord {
        let start = Instant::now();
        let mut record = StepRecord::new(load.clone());
        record.outcome = self.march(system, state, load, &mut record, &mut observe);
        record.solve_seconds = start.elapsed().as_secs_f64() - record.factorise_seconds;
        record
    }

    /// Unknowns (m) in answer to small `forces` (N) on top of the last state, to `tolerance` times their
    /// norm; friction keeps its limit.
    ///
    /// # Errors
    /// If the linear solve fails.
    pub fn respond(
        &mut self,
        system: &System<'_>,
        forces: &[DVec3],
        tolerance: f64,
    ) -> Result<Vec<DVec3>, LinearFailure> {
        Ok(self
            .linear
            .solve_positive(system, forces, tolerance)?
            .unknowns)
    }

    /// Solves from one state to a load without dividing the way.
    fn attempt(
        &mut self,
        system: &System<'_>,
        state: &State,
        load: &Load,
        record: &mut StepRecord,
        observe: &mut dyn FnMut(usize, &Iteration),
    ) -> Result<State, Outcome> {
        let mut trial = self.start(system, state, load);
        record.loose.clear();
        let outcome = self.settle(system, &mut trial, record, observe);
        if outcome == Outcome::Converged {
            if let Some(subspace) = self.subspace.as_mut() {
                subspace.learn(trial.guess, trial.moves);
            }
            let state = &mut trial.state;
            walls::commit(system, state);
            state.reached = trial.sizes.or_share(1.0, state.reached);
            return Ok(trial.state);
        }
        if record.loose.is_empty() && !system.is_smooth() {
            record.loose = loose::find(system, &trial.state);
        }
        Err(outcome)
    }

    /// Iterates until the tests hold, or it is clear that they will not.
    fn settle(
        &mut self,
        system: &System<'_>,
        trial: &mut Trial,
        record: &mut StepRecord,
        observe: &mut dyn FnMut(usize, &Iteration),
    ) -> Outcome {
        let mut flights = 0;
        match self.judge_guess(system, trial, record) {
            Ok(Some(iteration)) => {
                record.iterations.push(iteration);
                observe(record.iterations.len(), &iteration);
                return Outcome::Converged;
            }
            Ok(None) => {}
            Err(outcome) => return outcome,
        }
        for count in 1..=self.settings.max_iterations {
            let iteration = match self.iterate(system, trial, count, record) {
                Ok(iteration) => iteration,
                Err(outcome) => return outcome,
            };
            record.iterations.push(iteration);
            observe(record.iterations.len(), &iteration);
            if self.is_converged(system, &iteration) {
                return Outcome::Converged;
            }
            if count >= PATIENCE && !system.is_smooth() && iteration.force_residual > UNBALANCED {
                record.loose = loose::find(system, &trial.state);
                flights = if record.loose.is_empty() {
                    0
                } else {
                    flights + 1
                };
            }
            if flights == FLIGHTS {
                return Outcome::Loose;
            }
        }
        Outcome::OutOfIterations
    }

    /// The first guess for a step.
    fn start(&mut self, system: &System<'_>, state: &State, load: &Load) -> Trial {
        let mut guess = state.clone();
        system.restate(&mut guess);
        let subspace = self.subspace.as_mut();
        let found = subspace.and_then(|s| s.guess(system, &self.settings, &guess, load));
        let (guess, landed, last) = if let Some(found) = found {
            (found.state, found.landed, Some(found.last))
        } else {
            self.path.continue_through(system, &mut guess, load);
            walls::move_supports(system, &mut guess, load);
            let landed = vec![Landed::default(); guess.facet_points.len()];
            (guess, landed, None)
        };
        let rock_forces = system.rock_forces(&guess.unknowns);
        let tractions = system.law_tractions(&guess);
        let force = system.force_scale(&rock_forces, &tractions, load);
        Trial {
            landed,
            guess: last,
            moves: Vec::new(),
            sizes: StateScales {
                force: force.max(REMEMBERED * guess.reached.force),
                ..guess.reached
            },
            rock_forces,
            looseness: if system.is_nonlinear() {
                LOOSEST_SOLVE
            } else {
                SOLVED * self.settings.force
            },
            merit: None,
            state: guess,
        }
    }

    /// The last iteration of a guess in the subspace, if it leaves nothing to do: no more than a linear
    /// solve would.
    fn judge_guess(
        &self,
        system: &System<'_>,
        trial: &mut Trial,
        record: &mut StepRecord,
    ) -> Result<Option<Iteration>, Outcome> {
        let Some(guess) = &trial.guess else {
            return Ok(None);
        };
        let (errors, increment) = (guess.errors.clone(), guess.increment);
        let iteration = assess(system, trial, increment, &errors, record)?;
        if system.is_nonlinear() {
            trial.looseness = iteration.force_residual.clamp(1e-8, LOOSEST_SOLVE);
        }
        let is_exact = iteration.force_residual <= SOLVED * self.settings.force;
        Ok((is_exact && self.is_converged(system, &iteration)).then_some(iteration))
    }

    fn is_converged(&self, system: &System<'_>, iteration: &Iteration) -> bool {
        let settings = &self.settings;
        // The error of a reined iteration falls by a factor, not as a square.
        let increment = if system.is_smooth() {
            settings.increment
        } else {
            REINED * settings.increment
        };
        iteration.force_residual <= settings.force
            && iteration.closure_error <= settings.closure
            && (!system.is_nonlinear() || iteration.increment <= increment)
    }

    fn iterate(
        &mut self,
        system: &System<'_>,
        trial: &mut Trial,
        count: usize,
        record: &mut StepRecord,
    ) -> Result<Iteration, Outcome> {
        let tangents = walls::tangents(system, &trial.state);
        let start = Instant::now();
        let updated = if system.is_smooth() {
            self.linear.update(system, &tangents)
        } else {
            self.linear
                .update(system, &walls::reined(system, &tangents))
        };
        updated.map_err(Outcome::Linear)?;
        record.factorise_seconds += start.elapsed().as_secs_f64();
        let tractions = walls::linearised_tractions(system, &trial.state, &tangents);
        let residual = system.residual(&trial.rock_forces, &tractions, &trial.state.load);
        let tolerance = self.tolerance(trial, &residual, carried(system, &trial.state));
        let solution = self.linear.solve(system, &residual, tolerance);
        let solution = solution.map_err(Outcome::Linear)?;
        let is_remembered = self.subspace.is_some() && system.is_smooth();
        let moved = Move::of(system, solution.unknowns, is_remembered);
        let former = (count, trial.merit);
        let mut iteration = self.advance(system, trial, (&moved, &tangents), former, record)?;
        iteration.linear_iterations = solution.iterations;
        if is_remembered {
            trial.moves.push(moved);
        }
        trial.looseness = iteration.increment.clamp(1e-8, LOOSEST_SOLVE);
        Ok(iteration)
    }

    /// Error allowed in a linear solve, against its right-hand side: enough for what the
    /// linearisation is worth, and for the test of the forces. A residual above rounding is always
    /// reduced: tractions may still move where forces are in balance.
    fn tolerance(&self, trial: &Trial, residual: &[DVec3], carried: Option<f64>) -> f64 {
        let (size, scale) = (norm(residual), trial.sizes.force);
        let wanted = trial.looseness * size.min(scale).min(carried.unwrap_or(scale));
        let enough = SOLVED * self.settings.force * scale;
        let tolerance = wanted.max(enough);
        let rounding = 1e-3 * self.settings.force * scale;
        if size <= rounding {
            1.0
        } else {
            (tolerance / size).min(0.1)
        }
    }
}

/// Norm (N) of what fractures with kinks in their laws carry. It may be a small part of the loads; solves
/// that are exact against the loads only would let it stick, slide and open at random.
fn carried(system: &System<'_>, state: &State) -> Option<f64> {
    if system.is_smooth() {
        return None;
    }
    let mut forces = vec![DVec3::ZERO; state.unknowns.len()];
    interface(system).add_forces(&system.law_tractions(state), 1.0, &mut forces);
    Some(norm(&forces)).filter(|size| *size > 0.0)
}

fn interface<'a>(system: &'a System<'_>) -> &'a Interface {
    &system.discretisation.interface
}

/// Measures how far a trial is from a solution; `change` is the largest displacement of its iteration (m).
fn assess(
    system: &System<'_>,
    trial: &mut Trial,
    change: f64,
    errors: &[f64],
    record: &mut StepRecord,
) -> Result<Iteration, Outcome> {
    let state = &trial.state;
    let tractions = system.law_tractions(state);
    if let Some(broken) = tractions.iter().position(|traction| !traction.is_finite()) {
        return Err(Outcome::NotFinite(Some(broken)));
    }
    let residual = norm(&system.residual(&trial.rock_forces, &tractions, &state.load));
    let worst = (0..errors.len()).max_by(|&a, &b| errors[a].total_cmp(&errors[b]));
    record.worst_facet_point = worst;
    let apertures = state.facet_points.iter();
    let apertures = apertures.map(|point| point.joint.separation.aperture);
    let smallest_aperture = apertures.fold(f64::INFINITY, f64::min);
    let sizes = sizes(system, trial, &tractions).or_share(REMEMBERED, state.reached);
    trial.sizes = sizes;
    Ok(Iteration {
        force_residual: ratio(residual, sizes.force),
        increment: ratio(change, sizes.displacement),
        closure_error: ratio(worst.map_or(0.0, |worst| errors[worst]), sizes.traction),
        smallest_aperture,
        linear_iterations: 0,
    })
}

/// How large the quantities of a state are.
fn sizes(system: &System<'_>, trial: &Trial, tractions: &[DVec3]) -> StateScales {
    let state = &trial.state;
    let displacements = system.displacements(&state.unknowns, &state.load);
    // A body that does not move may still hold joints closed by its initial stress.
    let openings = state.facet_points.iter();
    let openings = openings.map(|point| point.joint.separation.opening.abs());
    StateScales {
        force: system.force_scale(&trial.rock_forces, tractions, &state.load),
        displacement: openings.fold(largest(&displacements), f64::max),
        traction: largest(tractions).max(OPEN * rebound(system, state)),
    }
}

/// Traction (Pa) that would close the widest of the fractures again, if any may be free of traction.
fn rebound(system: &System<'_>, state: &State) -> f64 {
    if system.is_smooth() {
        return 0.0;
    }
    let points = interface(system).points.iter().zip(&state.facet_points);
    points
        .map(|(point, state)| point.spring * state.joint.separation.opening.abs())
        .fold(0.0, f64::max)
}

fn largest(vectors: &[DVec3]) -> f64 {
    vectors.iter().map(|v| v.length()).fold(0.0, f64::max)
}

/// `value / scale`, and 0 where there is nothing to compare with nothing.
fn ratio(value: f64, scale: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value / scale }
}
