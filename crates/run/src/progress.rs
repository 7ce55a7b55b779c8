//! When a run writes its checkpoint, and what it says there.

use std::borrow::Cow;
use std::path::Path;
use std::time::Instant;

use kluft_mesh::Defect;

use crate::checkpoint::{self, FlowRestart, Origins, Progress};
use crate::stages::Run;
use crate::steps::Prepared;

impl Run<'_> {
    /// Whether something is solved after the load steps that are finished, of so many in all.
    pub(crate) fn has_more_to_solve(&self, steps: usize) -> bool {
        self.finished.len() < steps || self.request.scene.strength_reduction.is_some()
    }

    /// Lets the run be resumed after the load step that was solved last, unless it is the last one
    /// of all: what a reduction of strength adds to begins with that one, and its warnings, flow
    /// and pictures are those of a run that was never interrupted.
    pub(crate) fn write_checkpoint(&mut self, prepared: &Prepared<'_, '_>) -> Result<(), Defect> {
        let steps = prepared.system.problem().schedule.steps.len();
        if !self.keeps_checkpoints() || self.finished.len() >= steps {
            return Ok(());
        }
        self.write_progress(Progress {
            stage: prepared.stage.map(Cow::Borrowed),
            restart: Some(prepared.newton.restart_state(&prepared.state)),
            ..self.progress()
        })
    }

    /// Tells later runs that nothing is left. Only the end of a run does, once its results are
    /// whole: a run that dies before solves the last load step again.
    pub(crate) fn write_last_checkpoint(&mut self) -> Result<(), Defect> {
        if !self.keeps_checkpoints() || self.finished_steps() == 0 {
            return Ok(());
        }
        self.write_progress(self.progress())
    }

    /// Lets a flow in rigid rock be resumed after the load step that was solved last.
    pub(crate) fn write_flow_checkpoint(&mut self, restart: FlowRestart) -> Result<(), Defect> {
        if !self.keeps_checkpoints() {
            return Ok(());
        }
        self.write_progress(Progress {
            flow_restart: Some(restart),
            ..self.progress()
        })
    }

    /// Number of load steps whose results are there.
    fn finished_steps(&self) -> usize {
        match self.request.scene.is_rigid() {
            true => self.output.sums().len(),
            false => self.finished.len(),
        }
    }

    fn keeps_checkpoints(&self) -> bool {
        self.output.is_kept() && self.request.origin.is_some() && !self.has_own_mesh
    }

    fn write_progress(&mut self, progress: Progress<'_>) -> Result<(), Defect> {
        let start = Instant::now();
        // What a checkpoint speaks of lasts before it does.
        self.output.sync()?;
        let write = |path: &Path| checkpoint::write(path, &self.identity, &progress);
        let written = self.output.write(checkpoint::NAME, write);
        let written = written.and_then(|()| self.output.sync());
        self.summary.seconds.write += start.elapsed().as_secs_f64();
        if written.is_ok() {
            self.checkpointed = self.output.sums().len();
        }
        written
    }

    /// What is finished, without how to go on.
    fn progress<'a>(&self) -> Progress<'a> {
        let summary = &self.summary;
        // A step that did not converge is no finished one.
        let steps = summary.steps.iter().take(self.finished_steps());
        Progress {
            choice: self.choice.clone(),
            steps: self.finished.clone(),
            flows: steps.clone().map(|step| step.flow.clone()).collect(),
            step_fractures: steps.map(|step| step.fractures.clone()).collect(),
            files: self.output.sums().to_vec(),
            fractures: summary.fractures.clone(),
            history: match self.request.scene.is_rigid() {
                true => self.flow_history.text().to_owned(),
                false => self.history.text().to_owned(),
            },
            probes: self.probes.text.clone(),
            measures: summary.measures.clone(),
            stress_error: summary.stress_error,
            iterations: self.iterations.clone(),
            seconds: summary.seconds.clone(),
            peak_memory_bytes: summary.peak_memory_bytes,
            origins: Origins {
                meshes: summary.meshes.clone(),
                decisions: summary.decisions.clone(),
                gmsh: summary.provenance.gmsh.clone(),
            },
            stage: None,
            restart: None,
            flow_restart: None,
        }
    }
}
