//! Newton's method as it stands in textbooks, and the laws as functions of the jump: what the
//! program is compared with.
//!
//! Each facet point is linearised where the last linear solve put it. There is no balance with the
//! rock beside it, no line search and no substep.

use glam::{DMat3, DVec3};
use kluft_solver::{
    Discretisation, FacetPoint, Iteration, LinearFailure, Load, NewtonSettings, NonsymmetricSolver,
    Plan, Problem, Solution, State, StepOutcome, StepRecord, System, Tangents, Unknowns, Workload,
    norm, solution,
};
use lie_core::{FractureLaw, JointHistory, Separation, Tension, TrialState};

/// Stiffness of walls in contact, against that of the rock beside them.
const RIGID: f64 = 1e6;
/// Stiffness against free motions in the matrix, against that of the rock beside a facet point.
const STABILISATION: f64 = 1e-6;
/// Share of the increment allowed where laws have kinks.
const INCREMENT_AT_KINKS: f64 = 1e-2;
/// Error of a linear solver that iterates, against its right-hand side.
const LINEAR_TOLERANCE: f64 = 1e-12;

/// Answer of a fracture law at one jump.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Response {
    /// Traction `t = stress . n` (Pa): what the plus side does to the wall of the minus side.
    pub traction: DVec3,
    /// `dt/dw` (Pa/m), symmetric.
    pub tangent: DMat3,
    /// Energy per area (J/m^2).
    pub potential: f64,
}

/// Share `g` of the shear stiffness that a fracture keeps as it opens, with its first and second
/// derivative by the opening (1/m, 1/m^2): `(1 - z)^2 (1 + 2 z)` with `z = gap / b0` if its tension
/// is cut off.
fn shear_retention(law: &FractureLaw, separation: Separation) -> [f64; 3] {
    let closure = &law.closure;
    let fades = closure.tension == Tension::CutOff && law.friction.is_none();
    let fades = fades && closure.normal_stiffness > 0.0;
    let (gap, range) = (closure.gap(separation), closure.aperture);
    if !fades || gap <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let z = gap / range;
    if z >= 1.0 {
        return [0.0; 3];
    }
    [
        (1.0 - z).powi(2) * (1.0 + 2.0 * z),
        -6.0 * z * (1.0 - z) / range,
        (12.0 * z - 6.0) / (range * range),
    ]
}

/// Elastic response at a separation and `slip` (m): `Psi(b) + g(w_n) K_s |w_s|^2 / 2`, its gradient
/// and its second derivative.
pub fn response_at(
    law: &FractureLaw,
    separation: Separation,
    slip: DVec3,
    normal: DVec3,
) -> Response {
    let across = law.closure.at(separation);
    let [share, slope, curvature] = shear_retention(law, separation);
    let shear = share * law.shear_stiffness;
    let energy = 0.5 * law.shear_stiffness * slip.length_squared();
    let coupling = slope * law.shear_stiffness * slip;
    let across_tangent = across.tangent + curvature * energy;
    Response {
        traction: (across.traction + slope * energy) * normal + shear * slip,
        tangent: DMat3::from_diagonal(DVec3::splat(shear))
            + outer(normal, (across_tangent - shear) * normal)
            + outer(normal, coupling)
            + outer(coupling, normal),
        potential: across.potential + share * energy,
    }
}

/// Response to `jump` (m) across a facet with unit `normal`, of a fracture that never slid.
pub fn response(law: &FractureLaw, jump: DVec3, normal: DVec3) -> Response {
    let opening = jump.dot(normal);
    let slip = jump - opening * normal;
    response_at(law, law.closure.opened(opening), slip, normal)
}

/// Responses of the laws to the jumps of `unknowns` (m).
pub fn responses(system: &System<'_>, unknowns: &[DVec3], load: &Load) -> Vec<Response> {
    let interface = &system.discretisation().interface();
    let jumps = interface.jumps(unknowns, load);
    let points = interface.points().iter().zip(jumps);
    points
        .map(|(point, jump)| {
            let seen = interface.initial_jump(point) + jump;
            response(system.law(point), seen, point.normal)
        })
        .collect()
}

/// Solves one load step from the state before any load to factor 1.
pub fn solve(problem: &Problem, settings: NewtonSettings) -> (StepRecord, Solution) {
    let discretisation = Discretisation::of(problem).unwrap_or_else(|d| panic!("{d:?}"));
    let system = System::assemble(problem, discretisation);
    let load = Load::proportional(1.0);
    let (outcome, iterations, state) = match PlainNewton::new(&system, settings, &load) {
        Ok(mut newton) => {
            let outcome = newton.run();
            (outcome, newton.iterations, newton.state)
        }
        Err(failure) => (
            StepOutcome::Linear(failure),
            Vec::new(),
            system.initial_state(),
        ),
    };
    let converged = outcome == StepOutcome::Converged;
    let record = StepRecord {
        fell_back: false,
        load,
        completed: f64::from(u8::from(converged)),
        bearable: None,
        iterations,
        outcome,
        substeps: Vec::new(),
        unresolved: None,
        path_error: 0.0,
        path_error_at_one_place: 0.0,
        time_error: None,
        rigid_motions: Vec::new(),
        worst_facet_point: None,
        factorise_seconds: 0.0,
        solve_seconds: 0.0,
    };
    let end = if converged {
        state
    } else {
        system.initial_state()
    };
    (record, solution(&system, &end))
}

struct PlainNewton<'a> {
    system: &'a System<'a>,
    settings: NewtonSettings,
    linear: NonsymmetricSolver,
    state: State,
    iterations: Vec<Iteration>,
}

impl<'a> PlainNewton<'a> {
    /// Puts the load on the state before any load.
    fn new(
        system: &'a System<'a>,
        settings: NewtonSettings,
        load: &Load,
    ) -> Result<Self, LinearFailure> {
        let unknowns = Unknowns::from(system.discretisation());
        let workload = Workload::of(system.problem());
        let plan = Plan::of(unknowns, workload, settings.linear, usize::MAX)?;
        let mut state = system.initial_state();
        let interface = &system.discretisation().interface();
        // Without unknowns the jumps are those of prescribed displacements.
        let prescribed = interface.jumps(&state.unknowns, load);
        for (jump, point) in prescribed.into_iter().zip(&mut state.facet_points) {
            point.jump_residual += jump;
        }
        state.load.clone_from(load);
        Ok(Self {
            linear: NonsymmetricSolver::new(plan.prepare(system)?),
            system,
            settings,
            state,
            iterations: Vec::new(),
        })
    }

    fn run(&mut self) -> StepOutcome {
        for _ in 0..self.settings.max_iterations {
            let iteration = match self.iterate() {
                Ok(iteration) => iteration,
                Err(outcome) => return outcome,
            };
            self.iterations.push(iteration);
            if self.is_converged(&iteration) {
                return StepOutcome::Converged;
            }
        }
        StepOutcome::OutOfIterations
    }

    fn iterate(&mut self) -> Result<Iteration, StepOutcome> {
        let system = self.system;
        let tangents = self.tangents();
        let correction = self.correction(&tangents).map_err(StepOutcome::Linear)?;
        for (unknown, change) in self.state.unknowns.iter_mut().zip(&correction) {
            *unknown += *change;
        }
        if !self.state.unknowns.iter().all(|u| u.is_finite()) {
            return Err(StepOutcome::NotFinite(None));
        }
        let interface = &system.discretisation().interface();
        let changes = interface.jumps(&correction, &Load::NONE);
        let errors = self.land(&changes, &tangents);
        let displacements = system.displacements(&correction, &Load::NONE);
        self.measure(largest(&displacements), &errors)
    }

    /// Tangents of the laws where the walls are (Pa/m).
    fn tangents(&self) -> Vec<DMat3> {
        let history = JointHistory::default();
        let points = self.points().zip(&self.state.facet_points);
        points
            .map(|(point, state)| {
                let rigid = RIGID * point.spring;
                let law = self.system.law(point);
                law.tangent(&state.joint, &history, point.normal, rigid)
                    .exact
            })
            .collect()
    }

    /// Change of the unknowns (m) that leaves no force out of balance on the tangent planes.
    fn correction(&mut self, tangents: &[DMat3]) -> Result<Vec<DVec3>, LinearFailure> {
        let system = self.system;
        let stabilisation = if system.is_smooth() {
            0.0
        } else {
            STABILISATION
        };
        let stabilised = self.points().zip(tangents);
        let stabilised: Vec<DMat3> = stabilised
            .map(|(point, tangent)| *tangent + stabilisation * point.spring * DMat3::IDENTITY)
            .collect();
        self.linear.update(system, &Tangents::from(stabilised))?;
        let planes = self.points().zip(&self.state.facet_points).zip(tangents);
        let tractions: Vec<DVec3> = planes
            .map(|((point, state), tangent)| {
                state.joint.traction(point.normal) + *tangent * state.jump_residual
            })
            .collect();
        let rock = system.rock_forces(&self.state.unknowns);
        let residual = system.residual(&rock, &tractions, &self.state.load);
        let solution = self.linear.solve(system, &residual, LINEAR_TOLERANCE)?;
        Ok(solution.unknowns)
    }

    /// Takes the walls to where the linear solve has put them; returns the closure errors (Pa).
    fn land(&mut self, changes: &[DVec3], tangents: &[DMat3]) -> Vec<f64> {
        let system = self.system;
        let points = system.discretisation().interface().points().iter();
        let planes = points.zip(changes).zip(tangents);
        let states = self.state.facet_points.iter_mut();
        planes
            .zip(states)
            .map(|(((point, change), tangent), state)| {
                let jump = state.jump_residual + *change;
                let opening = jump.dot(point.normal);
                let traction = state.joint.traction(point.normal) + *tangent * jump;
                let across = traction.dot(point.normal);
                let landing = TrialState {
                    separation: state.joint.separation.moved(opening),
                    slip: state.joint.slip + jump - opening * point.normal,
                    normal_traction: across,
                    shear: traction - across * point.normal,
                };
                state.joint = system.law(point).state_at(&landing);
                let beyond = landing.separation.beyond(state.joint.separation);
                state.jump_residual = beyond * point.normal + landing.slip - state.joint.slip;
                let apart = landing.normal_traction * point.normal + landing.shear
                    - state.joint.traction(point.normal);
                apart
                    .length()
                    .max(point.spring * state.jump_residual.length())
            })
            .collect()
    }

    /// How far the state is from a solution; `change` is the largest displacement of the iteration
    /// (m).
    fn measure(&self, change: f64, errors: &[f64]) -> Result<Iteration, StepOutcome> {
        let (system, state) = (self.system, &self.state);
        let tractions = system.law_tractions(state);
        if let Some(broken) = tractions.iter().position(|traction| !traction.is_finite()) {
            return Err(StepOutcome::NotFinite(Some(broken)));
        }
        let rock = system.rock_forces(&state.unknowns);
        let residual = norm(&system.residual(&rock, &tractions, &state.load));
        let joints = || state.facet_points.iter().map(|point| point.joint);
        let openings = joints().map(|joint| joint.separation.opening.abs());
        let displacements = system.displacements(&state.unknowns, &state.load);
        let size = openings.fold(largest(&displacements), f64::max);
        let apertures = joints().map(|joint| joint.separation.aperture);
        let error = errors.iter().copied().fold(0.0, f64::max);
        Ok(Iteration {
            pressure_increment: 0.0,
            mass_error: 0.0,
            force_residual: ratio(residual, system.force_scale(&rock, &tractions, &state.load)),
            increment: ratio(change, size),
            closure_error: ratio(error, largest(&tractions)),
            smallest_aperture: apertures.fold(f64::INFINITY, f64::min),
            linear_iterations: 0,
            share: 1.0,
        })
    }

    fn is_converged(&self, iteration: &Iteration) -> bool {
        let settings = &self.settings;
        let share = if self.system.is_smooth() {
            1.0
        } else {
            INCREMENT_AT_KINKS
        };
        iteration.force_residual <= settings.force
            && iteration.closure_error <= settings.closure
            && (!self.system.is_nonlinear() || iteration.increment <= share * settings.increment)
    }

    fn points(&self) -> std::slice::Iter<'_, FacetPoint> {
        self.system.discretisation().interface().points().iter()
    }
}

fn largest(vectors: &[DVec3]) -> f64 {
    vectors.iter().map(|v| v.length()).fold(0.0, f64::max)
}

/// `value / scale`, and 0 where there is nothing to compare with nothing.
fn ratio(value: f64, scale: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value / scale }
}

/// `a b^T`.
fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}
