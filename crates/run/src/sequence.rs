//! One body after the other, where phases remove and add volumes: each has a system of its own and
//! goes on from what the one before has left.

use std::borrow::Cow;

use kluft_scene::{StageBinding, Staged};
use kluft_solver::StageEnd;

use crate::doubts;
use crate::observer::Stage;
use crate::resume::FormerRun;
use crate::stages::{Interruption, Run};
use crate::steps::Prepared;

impl Run<'_> {
    /// From the mesh to the results of all load steps that are left, body by body.
    ///
    /// # Errors
    /// As [`Self::solve`], for each body.
    pub fn solve_stages(&mut self, mut former: Option<FormerRun>) -> Result<(), Interruption> {
        let scene = self.request.scene;
        let (staged, bodies) = self.read_mesh(former.as_ref(), |_, draft| {
            let staged = scene.staged(scene.taken(draft))?;
            let bodies = staged.check()?;
            Ok((staged, bodies))
        })?;
        self.summary.decisions.extend(bodies);
        self.summary.decisions.extend_from_slice(&staged.decisions);
        self.doubts.clone_from(&staged.warnings);
        let done = former
            .as_ref()
            .map_or(0, |former| former.progress.steps.len());
        let mut stages = 0..staged.count();
        let first = stages.rfind(|&stage| done > staged.steps(stage).start);
        let mut end = former
            .as_mut()
            .and_then(|former| former.progress.stage.take())
            .map(Cow::into_owned);
        for stage in first.unwrap_or(0)..staged.count() {
            let mut began = end.take();
            if let Some(before) = &mut began {
                staged.renew(stage, before);
            }
            end = Some(self.solve_stage(&staged, (stage, began.as_ref()), former.take())?);
        }
        Ok(())
    }

    /// Number of load steps that are solved, by this run or the former one that it goes on from.
    fn done(&self, former: Option<&FormerRun>) -> usize {
        former.map_or(self.finished.len(), |former| former.progress.steps.len())
    }

    /// Solves the load steps of one body; returns what it leaves.
    fn solve_stage(
        &mut self,
        staged: &Staged<'_>,
        (stage, before): (usize, Option<&StageEnd>),
        former: Option<FormerRun>,
    ) -> Result<StageEnd, Interruption> {
        let StageBinding { mut binding, cells } =
            self.stage(Stage::Read, |_| staged.bind(stage, before))?;
        if stage > 0 {
            self.observer.note("stage", staged.says(stage));
        }
        self.count_mesh(&binding.problem.mesh);
        self.note_mesh();
        let warnings = std::mem::take(&mut binding.warnings);
        let new = warnings
            .into_iter()
            .filter(|text| !self.doubts.contains(text));
        let new: Vec<String> = new.collect();
        self.doubts.extend(new);
        let assembled = self.assemble(&binding.problem);
        let mut system = assembled.map_err(|why| match why {
            Interruption::Defects(defects) => staged.in_stage(stage, defects).into(),
            other => other,
        })?;
        if let Some(before) = before {
            system.go_on_from(before, &cells);
        }
        let steps = staged.steps(stage);
        if steps.is_empty() {
            return Ok(system.leave(&system.initial_state(), &cells));
        }
        let left = steps.end - self.done(former.as_ref());
        let plan = self.plan(&system, left, former.as_ref())?;
        if self.finished.is_empty() {
            self.summary.decisions.append(&mut binding.decisions);
            self.decide(&binding);
        }
        if stage == 0 {
            let unbalanced = doubts::of_initial_stress(self.request.scene, &system);
            self.doubts.extend(unbalanced);
        }
        self.probes.all.clone_from(&binding.probes);
        self.summary.warnings.clone_from(&self.doubts);
        let mut prepared = match former {
            Some(former) => self.go_on(&mut system, plan, former.progress)?,
            None if self.finished.is_empty() => self.begin(&mut system, plan)?,
            None => self.enter(&mut system, plan)?,
        };
        prepared.stage = before;
        prepared.first = steps.start;
        self.solve_until(&mut prepared, steps.end)?;
        let end = prepared.system.leave(&prepared.state, &cells);
        if stage + 1 == staged.count() {
            let Prepared {
                mut newton, state, ..
            } = prepared;
            self.reduce_strength(&mut system, &mut newton, state)?;
        }
        Ok(end)
    }
}
