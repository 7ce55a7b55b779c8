//! The stages from a problem to a prepared solver: unknowns, matrix, linear solver.

use kluft_scene::in_terms_of_scene;
use kluft_solver::{Discretisation, Newton, Plan, Problem, System};

use crate::observer::Stage;
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
