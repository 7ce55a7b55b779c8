//! The linear solver of a run that ranks share, and whether there is room for it.

use kluft_solver::{LinearMethod, Plan, System, Workload};

use crate::failures;
use crate::memory;
use crate::observer::Stage;
use crate::ranks::Ranks;
use crate::stages::{Interruption, Run, solved};

impl Run<'_> {
    /// The iterative solver with its rows divided, unless one of the ranks has no room for its
    /// part.
    pub fn plan_for_ranks(
        &mut self,
        ranks: Ranks<'_>,
        system: &System<'_>,
        limit: usize,
    ) -> Result<Plan, Interruption> {
        let discretisation = system.discretisation();
        let workload = Workload::of(system.problem());
        let points = discretisation.points().len();
        let workload = workload.with_extra_memory(&system.problem().mesh, points);
        let forced = Some(LinearMethod::Iterative);
        let plan = self.stage(Stage::ChooseSolver, |_| {
            Plan::of(discretisation.into(), workload, forced, limit)
        });
        let plan = solved(plan, system)?;
        let blocks = discretisation.pattern().blocks.columns.len();
        let own = (ranks.solver_bytes)(points, blocks, ranks.count());
        let needed = workload.extra.with(workload.extra.iterative + own);
        self.summary.predicted_memory_bytes = (memory::used_bytes() + needed) as u64;
        let fits = match needed <= limit {
            true => Ok(()),
            false => Err(vec![failures::rank_too_large(ranks, needed, limit)]),
        };
        ranks.agree(fits)?;
        self.choice.why = match ranks.count() {
            1 => "linear solver: iterative, on one rank".to_owned(),
            count => format!("linear solver: iterative, its rows divided among {count} ranks"),
        };
        self.choose(&plan);
        Ok(plan)
    }
}
