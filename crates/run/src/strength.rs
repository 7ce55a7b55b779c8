//! The factor of safety: strength is reduced until blocks move.

use std::path::Path;

use kluft_io::write_vtu;
use kluft_report::Surface;
use kluft_scene::StrengthReduction;
use kluft_solver::{
    BlockMotion, Newton, Solution, State, StepOutcome, StepRecord, System, block_motions, solution,
};
use lie_core::FractureLaw;

use crate::failures;
use crate::grids::{fracture_grid, in_plane, real_field, rock_grid};
use crate::measures::factor_of_safety;
use crate::observer::{Stage, StepStart};
use crate::output::box_of;
use crate::page::StrengthShown;
use crate::stages::{Interruption, Run};
use crate::strength_motion::{self, FailedTrial};
use crate::strength_summary::{GRIDS, MotionSummary, StrengthSummary, Trial};

/// By what the factor grows as long as nothing fails.
const GROWTH: f64 = 1.25;

/// What came of a factor.
struct TriedFactor {
    factor: f64,
    /// At rest if everything held, else where the iterations ended.
    state: State,
    record: StepRecord,
}

/// A search under way.
struct Search<'a> {
    asked: &'a StrengthReduction,
    /// The laws at full strength.
    laws: Vec<FractureLaw>,
    is_weakened: Vec<bool>,
    /// Displacement of all points at full strength (m).
    begin: Vec<glam::DVec3>,
    /// The smallest factor so far that did not hold.
    failed: Option<FailedTrial>,
    found: StrengthSummary,
}

impl<'a> Search<'a> {
    /// From a state at full strength on.
    fn of(asked: &'a StrengthReduction, system: &System<'_>, state: &State) -> Self {
        let names = &system.problem().mesh.fractures;
        let laws = system.laws().to_vec();
        let is_weakened = asked.chosen(names, &laws);
        let chosen = names.iter().zip(&is_weakened).filter(|(_, own)| **own);
        Self {
            found: StrengthSummary {
                fractures: chosen.map(|(name, _)| name.clone()).collect(),
                stable: 1.0,
                ..StrengthSummary::default()
            },
            begin: system.total_displacements(state),
            failed: None,
            asked,
            laws,
            is_weakened,
        }
    }

    /// Takes over what came of a factor from a stable state `before` it: a state, at rest if
    /// everything held.
    fn take(&mut self, system: &System<'_>, before: &State, trial: &TriedFactor) {
        let TriedFactor {
            factor,
            state,
            record,
        } = trial;
        let found = &mut self.found;
        let motion = record.converged().then(|| {
            let now = system.total_displacements(state);
            let moved = now.iter().zip(&self.begin);
            let lengths = moved.map(|(now, begin)| now.distance(*begin));
            lengths.fold(0.0, f64::max)
        });
        found.trials.push(Trial {
            factor: *factor,
            stable: record.converged(),
            newton_iterations: record.iterations.len(),
            largest_motion: motion,
        });
        if record.converged() {
            found.stable = *factor;
            return;
        }
        found.failing = Some(*factor);
        let blocks = record.rigid_motions.iter().map(|body| &body.told);
        let blocks = blocks.map(|b| format!("{}: {}: {}", b.place, b.problem, b.remedy));
        found.free_blocks = blocks.collect();
        found.failure = Some(failures::of_outcome(system, record));
        let [reached, began] = [state, before].map(|state| system.total_displacements(state));
        self.failed = Some(FailedTrial {
            bodies: record.rigid_motions.clone(),
            moved: std::iter::zip(reached, began)
                .map(|(to, from)| to - from)
                .collect(),
        });
    }

    /// The next factor, if the answer is not accurate enough.
    fn next(&self) -> Option<f64> {
        let stable = self.found.stable;
        match self.found.failing {
            None if stable >= self.asked.most => None,
            None => Some(f64::min(GROWTH * stable, self.asked.most)),
            Some(failing) if failing - stable <= self.asked.accuracy * stable => None,
            Some(failing) => Some(0.5 * (stable + failing)),
        }
    }
}

impl Run<'_> {
    /// Reduces strength from the state after the last load step on, and writes what came out.
    ///
    /// # Errors
    /// An observer who stops it, and files that cannot be written.
    pub(crate) fn reduce_strength(
        &mut self,
        system: &mut System<'_>,
        newton: &mut Newton,
        mut state: State,
    ) -> Result<(), Interruption> {
        let Some(asked) = &self.request.scene.strength_reduction else {
            return Ok(());
        };
        let mut search = Search::of(asked, system, &state);
        while let Some(factor) = search.next() {
            self.go_on_if_asked()?;
            system.weaken(&search.laws, factor, |fracture| {
                search.is_weakened[fracture]
            });
            let trial = self.try_factor(system, newton, &state, factor);
            if trial.record.outcome == StepOutcome::Stopped {
                return Err(Interruption::Stopped);
            }
            search.take(system, &state, &trial);
            if trial.record.converged() {
                state = trial.state;
            }
        }
        system.weaken(&search.laws, search.found.stable, |f| search.is_weakened[f]);
        self.write_strength(system, &state, search)
    }

    fn try_factor(
        &mut self,
        system: &System<'_>,
        newton: &mut Newton,
        before: &State,
        factor: f64,
    ) -> TriedFactor {
        let steps = system.problem().schedule.steps.len();
        self.observer.step_begins(StepStart {
            number: steps,
            count: steps,
            what: &format!("strength over {factor:.4}"),
        });
        let mut state = before.clone();
        let (record, end) = self.stage(Stage::Solve, |run| {
            newton.settle(system, &mut state, |number, iteration| {
                run.ask_after(number, iteration)
            })
        });
        self.summary.seconds.factorise += record.factorise_seconds;
        self.summary.seconds.solve += record.solve_seconds;
        TriedFactor {
            factor,
            state: end.unwrap_or(state),
            record,
        }
    }

    fn write_strength(
        &mut self,
        system: &System<'_>,
        state: &State,
        search: Search<'_>,
    ) -> Result<(), Interruption> {
        let Search {
            begin,
            failed,
            mut found,
            ..
        } = search;
        let solution = solution(system, state);
        let pairs = solution.displacements.iter().zip(&begin);
        let moved: Vec<glam::DVec3> = pairs.map(|(now, begin)| *now - *begin).collect();
        found.motions = motions(system, &moved);
        let failed = failed.map(|failed| {
            let motion = failed.motion(system);
            found.failing_motions = motions(system, &motion);
            (failed, motion)
        });
        self.observer.note("strength", &says(&found));
        for block in &found.free_blocks {
            self.observer.note("strength", block);
        }
        self.summary.measures.push(factor_of_safety(found.stable));
        self.summary.strength_reduction = Some(found);
        if self.output.is_kept() {
            self.write_stable(system, &solution, &moved)?;
            self.write_failed(system, failed)?;
        }
        Ok(self.write_summary()?)
    }

    /// Writes the state at the last stable factor.
    fn write_stable(
        &mut self,
        system: &System<'_>,
        solution: &Solution,
        moved: &[glam::DVec3],
    ) -> Result<(), Interruption> {
        let mesh = &system.problem().mesh;
        let nodes = solution.facet_nodes(system.problem(), system.discretisation().interface());
        let mut rock = rock_grid(system, solution, None, None);
        let field = real_field("moved", moved.iter().map(|u| u.to_array()));
        rock.point_fields.push(field);
        let fractures = in_plane(mesh, fracture_grid(system, &nodes, None));
        self.strength_shown = self.request.report.then(|| StrengthShown {
            stable: Surface::of(&fractures, &["slip"]),
            failing: None,
            body: box_of(&rock.points),
        });
        let rock = in_plane(mesh, rock);
        self.output.write(GRIDS[0], |path| write_vtu(path, rock))?;
        let write = |path: &Path| write_vtu(path, fractures);
        Ok(self.output.write(GRIDS[1], write)?)
    }

    /// Writes how blocks move at the first failing factor, if one failed.
    fn write_failed(
        &mut self,
        system: &System<'_>,
        failed: Option<(FailedTrial, Vec<glam::DVec3>)>,
    ) -> Result<(), Interruption> {
        let Some((failed, motion)) = failed else {
            return Ok(());
        };
        if let Some(shown) = &mut self.strength_shown {
            let fractures = strength_motion::fracture_grid(system, &motion);
            shown.failing = Some(Surface::of(&fractures, &["motion"]));
        }
        let rock = failed.rock_grid(system, &motion);
        Ok(self.output.write(GRIDS[2], |path| write_vtu(path, rock))?)
    }
}

/// How blocks move with all points.
fn motions(system: &System<'_>, points: &[glam::DVec3]) -> Vec<MotionSummary> {
    let motions = block_motions(system, points);
    motions.iter().enumerate().map(motion).collect()
}

fn motion((index, motion): (usize, &BlockMotion)) -> MotionSummary {
    MotionSummary {
        block: index + 1,
        volume: motion.volume,
        displacement: motion.displacement.to_array(),
        rotation: motion.rotation.to_array(),
    }
}

fn says(found: &StrengthSummary) -> String {
    match (found.failing, &found.failure) {
        (Some(failing), Some(failure)) => format!(
            "stable at a factor of {:.4}, failing at {failing:.4}: {failure}",
            found.stable
        ),
        _ => format!(
            "stable at a factor of {:.4}, where the search ends",
            found.stable
        ),
    }
}
