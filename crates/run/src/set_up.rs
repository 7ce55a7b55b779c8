//! The stages from a problem to a prepared solver: unknowns, matrix, linear solver.

use kluft_scene::in_terms_of_scene;
use kluft_solver::{Discretisation, Newton, Plan, Problem, System, Workload};

use crate::decisions;
use crate::failures;
use crate::memory;
use crate::observer::Stage;
use crate::resume::FormerRun;
use crate::stages::{Interruption, Run, newton_settings, solved};
use crate::summary::UnknownSummary;

impl Run<'_> {
    /// Enriches the problem and assembles what stays the same for the whole run.
    pub fn assemble<'p>(&mut self, problem: &'p Problem) -> Result<System<'p>, Interruption> {
        let discretisation = self
            .stage(Stage::Enrich, |_| Discretisation::of(problem))
            .map_err(in_terms_of_scene)?;
        self.summary.unknowns = UnknownSummary {
            total: discretisation.unknown_count(),
            jump: 3 * discretisation.points().jump_count(),
        };
        let unknowns = &self.summary.unknowns;
        let text = format!(
            "{} unknowns, {} of them jumps",
            unknowns.total, unknowns.jump
        );
        self.note_timed("enriched", &text);
        let ranks = self.request.ranks;
        let system = self.stage(Stage::Assemble, |_| match ranks {
            Some(ranks) => System::divided(problem, discretisation, ranks.communicator),
            None => System::assemble(problem, discretisation),
        });
        self.note_timed("assembled", "rock and loads, once for the run");
        Ok(system)
    }

    /// Chooses the linear solver, the former run's if there was one, and refuses what would not fit
    /// in memory.
    pub fn plan(
        &mut self,
        system: &System<'_>,
        former: Option<&FormerRun>,
    ) -> Result<Plan, Interruption> {
        let asked = self.request.scene.solver;
        let available = memory::available_bytes().unwrap_or(usize::MAX);
        let limit = asked.memory_limit.map_or(available, |limit| limit as usize);
        if let Some(ranks) = self.request.ranks {
            return self.plan_for_ranks(ranks, system, limit / ranks.on_machine.max(1));
        }
        let before = former.and_then(|former| former.progress.choice.0.parse().ok());
        let plan = self.stage(Stage::ChooseSolver, |_| {
            let discretisation = system.discretisation();
            let workload = Workload::of_system(system, newton_settings(&asked).time);
            let points = discretisation.points().len();
            let workload = workload.with_extra_memory(&system.problem().mesh, points);
            let unknowns = discretisation.into();
            Plan::of(unknowns, workload, before.or(asked.linear), limit)
        });
        let plan = solved(plan, system)?;
        let prediction = plan.prediction();
        self.summary.predicted_memory_bytes =
            (memory::used_bytes() + prediction.memory_bytes) as u64;
        if prediction.memory_bytes > limit {
            return Err(failures::too_large(&plan, &asked, limit).into());
        }
        self.choice = match former {
            Some(former) => former.progress.choice.clone(),
            None => (plan.method.to_string(), decisions::of_plan(&plan, &asked)),
        };
        Ok(plan)
    }

    /// Prepares what the linear solver needs once a run.
    pub fn set_up(&mut self, system: &mut System<'_>, plan: Plan) -> Result<Newton, Interruption> {
        let name = plan.method.name();
        let settings = newton_settings(&self.request.scene.solver);
        let ranks = self.request.ranks;
        let newton = self.stage(Stage::PrepareSolver, |_| match ranks {
            Some(ranks) => {
                let solver = (ranks.solver)(system)?;
                Ok(Newton::on(system, settings, solver, true))
            }
            None => Newton::planned(system, settings, plan),
        });
        self.note_timed("prepared", &format!("{name} solver, once for the run"));
        solved(newton, system)
    }
}
