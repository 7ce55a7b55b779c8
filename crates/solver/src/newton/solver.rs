//! The nonlinear solver and what it keeps from one load step to the next.

use glam::DVec3;
use kluft_algebra::LinearFailure;

use super::extrapolation::Path;
use super::recycling::RecycledSpace;
use super::settings::NewtonSettings;
use crate::linear::{
    LinearMethod, NonsymmetricSolver, Plan, Released, TangentSolver, Unknowns, Workload,
};
use crate::system::System;

/// The nonlinear solver of a system; it keeps what the linear solver prepared.
///
/// The same solver serves a system whose fracture laws are changed between two steps, because the
/// rock, which is all that was prepared, stays.
pub struct Newton {
    pub(super) settings: NewtonSettings,
    pub(super) linear: NonsymmetricSolver,
    pub(super) path: Path,
    /// Corrections of former steps, if the linear solver iterates.
    pub(super) recycled: Option<RecycledSpace>,
}

impl Newton {
    /// Chooses and prepares the linear solver.
    ///
    /// # Errors
    /// If it cannot be prepared.
    pub fn new(system: &System<'_>, settings: NewtonSettings) -> Result<Self, LinearFailure> {
        let unknowns = Unknowns::from(&system.discretisation);
        let workload = Workload::of_system(system, settings.time);
        let plan = Plan::of(unknowns, workload, settings.linear, usize::MAX)?;
        Self::planned(system, settings, plan)
    }

    /// Prepares the linear solver of a plan. Where an iterative one gives up, a direct one goes on,
    /// if the memory of the plan has room for both.
    ///
    /// # Errors
    /// If it cannot be prepared.
    pub fn planned(
        system: &System<'_>,
        settings: NewtonSettings,
        plan: Plan,
    ) -> Result<Self, LinearFailure> {
        let iterates = plan.method == LinearMethod::Iterative;
        let memory = iterates.then(|| plan.memory_left());
        let own = Self::on(system, settings, plan.prepare(system)?, iterates);
        Ok(match memory {
            Some(memory) => Self {
                linear: own.linear.with_fallback(memory),
                ..own
            },
            None => own,
        })
    }

    /// Puts the linear solver of another plan in the place of the present one, whose memory is
    /// given back before; the path of the load steps so far stays known.
    ///
    /// # Errors
    /// If it cannot be prepared.
    pub fn exchange(&mut self, system: &System<'_>, plan: Plan) -> Result<(), LinearFailure> {
        let path = std::mem::take(&mut self.path);
        self.release();
        let own = Self::planned(system, self.settings, plan)?;
        *self = Self { path, ..own };
        Ok(())
    }

    /// Whether a direct solver goes on where an iterative one has given up.
    pub fn has_fallen_back(&self) -> bool {
        self.linear.has_fallen_back()
    }

    /// On top of a linear solver of the system, which may be the caller's own; whether it iterates.
    pub fn on(
        system: &System<'_>,
        settings: NewtonSettings,
        linear: Box<dyn TangentSolver>,
        iterates: bool,
    ) -> Self {
        // A guess in the recycled space knows of no pressures.
        let recycles = iterates && system.coupling().is_none();
        Self {
            recycled: recycles.then(RecycledSpace::default),
            linear: NonsymmetricSolver::new(linear),
            path: Path::default(),
            settings,
        }
    }

    /// Unknowns (m) in answer to small `forces` (N) on top of the last state, to `tolerance` times
    /// their norm; friction keeps its limit.
    ///
    /// # Errors
    /// If the linear solve fails.
    pub fn respond(
        &mut self,
        system: &System<'_>,
        forces: &[DVec3],
        tolerance: f64,
    ) -> Result<Vec<DVec3>, LinearFailure> {
        let solution = self.linear.solve_positive(system, forces, tolerance)?;
        Ok(solution.unknowns)
    }

    /// Gives back the memory of the linear solver and of what it learnt from former steps, for what
    /// is done after the last solve. Solves are refused from then on.
    pub fn release(&mut self) {
        self.linear = NonsymmetricSolver::new(Box::new(Released));
        self.recycled = None;
        self.path = Path::default();
    }
}
