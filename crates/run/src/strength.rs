//! The factor of safety: strength is reduced until blocks move.

use kluft_io::write_vtu;
use kluft_scene::StrengthReduction;
use kluft_solver::{
    BlockMotion, Newton, State, StepOutcome, StepRecord, System, block_motions, solution,
};
use lie_core::FractureLaw;
use serde::Serialize;

use crate::failures;
use crate::grids::{fracture_grid, real_field, rock_grid};
use crate::observer::{Stage, StepStart};
use crate::stages::{Interruption, Run};

/// The rock and the fractures at the last stable factor.
pub const GRIDS: [&str; 2] = ["strength_rock.vtu", "strength_fractures.vtu"];

/// By what the factor grows as long as nothing fails.
const GROWTH: f64 = 1.25;

/// How far strength could be reduced.
#[derive(Debug, Clone, Default, Serialize)]
pub struct StrengthSummary {
    /// Fractures whose strength was reduced.
    pub fractures: Vec<String>,
    /// Largest factor at which everything held.
    pub stable: f64,
    /// Smallest factor at which it did not; none if none was found.
    pub failing: Option<f64>,
    /// What happened there.
    pub failure: Option<String>,
    /// Blocks that nothing held there, with their free motions.
    pub free_blocks: Vec<String>,
    /// How blocks have moved from full strength to the last stable factor.
    pub motions: Vec<MotionSummary>,
    /// The factors that were tried, in order.
    pub trials: Vec<Trial>,
}

/// One factor that was tried.
#[derive(Debug, Clone, Serialize)]
pub struct Trial {
    /// The factor.
    pub factor: f64,
    /// Whether everything held.
    pub stable: bool,
    /// Newton iterations.
    pub newton_iterations: usize,
    /// Largest motion of a point since full strength (m), if everything held.
    pub largest_motion: Option<f64>,
}

/// How a block has moved.
#[derive(Debug, Clone, Serialize)]
pub struct MotionSummary {
    /// Its number, as in `history.csv`.
    pub block: usize,
    /// Volume (m^3).
    pub volume: f64,
    /// Mean displacement (m).
    pub displacement: [f64; 3],
    /// Mean rotation (radians).
    pub rotation: [f64; 3],
}

/// A search under way.
struct Search<'a> {
    asked: &'a StrengthReduction,
    /// The laws at full strength.
    laws: Vec<FractureLaw>,
    is_weakened: Vec<bool>,
    /// Displacement of all points at full strength (m).
    begin: Vec<glam::DVec3>,
    found: StrengthSummary,
}

impl Search<'_> {
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
        let names = &system.problem().mesh.fractures;
        let laws = system.laws().to_vec();
        let is_weakened = asked.chosen(names, &laws);
        let chosen = names.iter().zip(&is_weakened).filter(|(_, own)| **own);
        let mut search = Search {
            found: StrengthSummary {
                fractures: chosen.map(|(name, _)| name.clone()).collect(),
                stable: 1.0,
                ..StrengthSummary::default()
            },
            begin: system.total_displacements(&state),
            asked,
            laws,
            is_weakened,
        };
        while let Some(factor) = search.next() {
            self.go_on_if_asked()?;
            system.weaken(&search.laws, factor, |fracture| {
                search.is_weakened[fracture]
            });
            let mut trial = state.clone();
            let record = self.try_factor(system, newton, &mut trial, factor);
            if record.outcome == StepOutcome::Stopped {
                return Err(Interruption::Stopped);
            }
            let found = &mut search.found;
            let motion = record.converged().then(|| {
                let now = system.total_displacements(&trial);
                let moved = now.iter().zip(&search.begin);
                moved
                    .map(|(now, begin)| now.distance(*begin))
                    .fold(0.0, f64::max)
            });
            found.trials.push(Trial {
                factor,
                stable: record.converged(),
                newton_iterations: record.iterations.len(),
                largest_motion: motion,
            });
            if record.converged() {
                (state, found.stable) = (trial, factor);
            } else {
                found.failing = Some(factor);
                let motions = record.rigid_motions.iter();
                found.free_blocks = motions
                    .map(|block| format!("{}: {}: {}", block.place, block.problem, block.remedy))
                    .collect();
                found.failure = Some(failures::of_outcome(system, &record));
            }
        }
        system.weaken(&search.laws, search.found.stable, |f| search.is_weakened[f]);
        self.write_strength(system, &state, search)
    }

    fn try_factor(
        &mut self,
        system: &System<'_>,
        newton: &mut Newton,
        state: &mut State,
        factor: f64,
    ) -> StepRecord {
        let steps = system.problem().schedule.steps.len();
        self.observer.step_begins(StepStart {
            number: steps,
            count: steps,
            what: &format!("strength over {factor:.4}"),
        });
        let record = self.stage(Stage::Solve, |run| {
            newton.settle(system, state, |number, iteration| {
                run.ask_after(number, iteration)
            })
        });
        self.summary.seconds.factorise += record.factorise_seconds;
        self.summary.seconds.solve += record.solve_seconds;
        record
    }

    fn write_strength(
        &mut self,
        system: &System<'_>,
        state: &State,
        search: Search<'_>,
    ) -> Result<(), Interruption> {
        let Search {
            begin, mut found, ..
        } = search;
        let solution = solution(system, state);
        let pairs = solution.displacements.iter().zip(&begin);
        let moved: Vec<glam::DVec3> = pairs.map(|(now, begin)| *now - *begin).collect();
        let motions = block_motions(system, &moved);
        found.motions = motions.iter().enumerate().map(motion).collect();
        self.observer.note("strength", &says(&found));
        for block in &found.free_blocks {
            self.observer.note("strength", block);
        }
        self.summary.strength_reduction = Some(found);
        if self.output.is_kept() {
            let nodes = solution.facet_nodes(system.problem(), system.discretisation().interface());
            let mut rock = rock_grid(system, &solution, None);
            let field = real_field("moved", moved.iter().map(|u| u.to_array()));
            rock.point_fields.push(field);
            let fractures = fracture_grid(system, &nodes, None);
            self.output.write(GRIDS[0], |path| write_vtu(path, rock))?;
            self.output
                .write(GRIDS[1], |path| write_vtu(path, fractures))?;
        }
        Ok(self.write_summary()?)
    }
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
