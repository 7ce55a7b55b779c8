//! The choice of the linear solver: before the first load step, and again when it is known what
//! load steps take.

use kluft_solver::{LinearFailure, LinearMethod, Plan, System, Workload};

use crate::choice::Choice;
use crate::decisions;
use crate::failures;
use crate::memory;
use crate::observer::Stage;
use crate::resume::FormerRun;
use crate::stages::{Interruption, Run, newton_settings, solved};
use crate::steps::Prepared;

impl Run<'_> {
    /// Chooses the linear solver for so many load steps, the former run's if there was one, and
    /// refuses what would not fit in memory.
    pub fn plan(
        &mut self,
        system: &System<'_>,
        steps: usize,
        former: Option<&FormerRun>,
    ) -> Result<Plan, Interruption> {
        let asked = self.request.scene.solver;
        let available = memory::available_bytes().unwrap_or(usize::MAX);
        let limit = asked.memory_limit.map_or(available, |limit| limit as usize);
        if let Some(ranks) = self.request.ranks {
            return self.plan_for_ranks(ranks, system, limit / ranks.on_machine.max(1));
        }
        let before = former.map(|former| &former.progress.choice);
        let forced = before.and_then(Choice::method).or(asked.linear);
        self.choice.memory = limit;
        let workload = self
            .workload(system)
            .left(steps, self.choice.observed, None);
        let plan = solved(self.plan_within(system, workload, forced), system)?;
        let prediction = plan.prediction();
        self.summary.predicted_memory_bytes =
            (memory::used_bytes() + prediction.memory_bytes) as u64;
        if prediction.memory_bytes > limit {
            return Err(failures::too_large(&plan, &asked, limit).into());
        }
        match before {
            Some(before) => {
                self.choice = Choice {
                    memory: limit,
                    ..before.clone()
                }
            }
            None => self.begin_with(&plan),
        }
        Ok(plan)
    }

    /// Notes what was chosen for a body: the first one, or one that goes on from another.
    fn begin_with(&mut self, plan: &Plan) {
        let why = decisions::of_plan(plan, &self.request.scene.solver);
        if self.finished.is_empty() {
            self.choose(plan);
            self.choice.why = why;
        } else if self.choice.method() != Some(plan.method) {
            let number = self.finished.len() + 1;
            self.choose_instead(plan, format!("from step {number} on, {why}"));
        }
    }

    /// Tells that another solver takes the place of the one before.
    fn choose_instead(&mut self, plan: &Plan, why: String) {
        self.observer.note("decided", &why);
        self.summary.decisions.push(why);
        self.choose(plan);
    }

    /// Notes what was chosen.
    pub fn choose(&mut self, plan: &Plan) {
        self.choice.solver = plan.method.to_string();
    }

    /// What all load steps of a system ask for. Until the last of them a solver stands beside the
    /// estimate.
    fn workload(&self, system: &System<'_>) -> Workload {
        let settings = newton_settings(&self.request.scene.solver);
        let points = system.discretisation().points().len();
        let workload = Workload::of_system(system, settings.time);
        workload.with_extra_memory(&system.problem().mesh, points)
    }

    fn plan_within(
        &mut self,
        system: &System<'_>,
        workload: Workload,
        forced: Option<LinearMethod>,
    ) -> Result<Plan, LinearFailure> {
        let limit = self.choice.memory;
        let unknowns = system.discretisation().into();
        self.stage(Stage::ChooseSolver, |_| {
            Plan::of(unknowns, workload, forced, limit)
        })
    }

    /// Chooses again after the load step that was solved last, for those that are left until `end`:
    /// after the second load step of a body, and whenever twice as many are solved.
    ///
    /// Only counts of iterations decide, so that a run gives the same results whatever the machine
    /// does besides.
    ///
    /// # Errors
    /// If another solver is chosen and cannot be prepared.
    pub(crate) fn choose_again(
        &mut self,
        prepared: &mut Prepared<'_, '_>,
        end: usize,
    ) -> Result<(), Interruption> {
        let done = self.finished.len();
        let (Some(last), Some(present)) = (self.finished.last(), self.choice.method()) else {
            return Ok(());
        };
        if done == prepared.first + 1 {
            return Ok(());
        }
        self.choice
            .observe(last.newton_iterations, last.linear_iterations);
        let observed = self.choice.observed;
        let is_given = self.request.scene.solver.linear.is_some() || self.request.ranks.is_some();
        let is_time = observed.steps.is_power_of_two() && done < end;
        if is_given || !is_time || prepared.newton.has_fallen_back() {
            return Ok(());
        }
        let system = prepared.system;
        let workload = self.workload(system);
        let workload = workload.left(end - done, observed, Some(present));
        // A choice that cannot be made leaves what there is.
        let Ok(plan) = self.plan_within(system, workload, None) else {
            return Ok(());
        };
        if plan.method == present || plan.prediction().memory_bytes > self.choice.memory {
            return Ok(());
        }
        let why = decisions::of_other_plan(&plan, present, done + 1);
        self.choose_instead(&plan, why);
        let exchanged = self.stage(Stage::PrepareSolver, |_| {
            prepared.newton.exchange(system, plan)
        });
        solved(exchanged, system)
    }
}
