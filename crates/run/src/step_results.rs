//! What is taken of a load step that was solved: estimates, numbers, grids, histories.

use std::io::Write;
use std::path::Path;

use kluft_io::{Grid, write_atomically};
use kluft_solver::{Determinacy, Estimator, FacetResult, Solution, System, determinacy, solution};

use crate::accuracy::{self, Accuracy, Duals};
use crate::doubts;
use crate::flow::SolvedFlow;
use crate::flow_history::FlowEntry;
use crate::fluid_step;
use crate::fractures::fractures;
use crate::grids::{fracture_grid, in_plane, rock_grid};
use crate::history::{self, Entry, Parts};
use crate::measures::{energy, measures};
use crate::observer::Stage;
use crate::outcome::StepResult;
use crate::pieces::Piece;
use crate::probes::{self, Solved, SolvedFluid, SolvedRock};
use crate::stages::{Interruption, Run};
use crate::steps::Prepared;
use crate::summary::{StepFracture, Summary};
use crate::undetermined;
use crate::unresolved;

/// What the grids of a load step hold.
struct Written<'a> {
    solution: &'a Solution,
    nodes: &'a [FacetResult],
    accuracy: &'a Accuracy,
    facets: Option<&'a [Determinacy]>,
    flow: Option<&'a SolvedFlow>,
}

impl Run<'_> {
    /// Estimates the error of a load step, sums it up and writes its results.
    pub(crate) fn take_results(
        &mut self,
        prepared: &mut Prepared<'_, '_>,
    ) -> Result<(), Interruption> {
        let system = prepared.system;
        let is_last = self.finished.len() == system.problem().schedule.steps.len();
        let duals = self.last_solves(prepared, is_last);
        let solution = solution(system, &prepared.state);
        let accuracy = self.estimate(prepared, &solution, duals);
        let interface = system.discretisation().interface();
        let nodes = solution.facet_nodes(system.problem(), interface);
        let mut fractures = fractures(system.problem(), interface, &solution, &nodes);
        accuracy.note_in(&mut fractures);
        let facets = determinacy(system, &prepared.state);
        if let Some(facets) = &facets {
            undetermined::note_in(&mut fractures, system, facets);
        }
        if let Some(step) = self.summary.steps.last_mut() {
            step.fractures = StepFracture::all(&fractures);
        }
        self.summary.fractures = fractures;
        self.summary.stress_error = accuracy.relative;
        // Closed forms speak of the end of the loads.
        let oracles = if is_last { &self.oracles[..] } else { &[] };
        self.summary.measures = measures(system, &solution, &self.summary.fractures, oracles);
        self.summary.measures.push(energy(accuracy.energy));
        let flow = self.take_flow(system, (&prepared.state, &nodes), prepared.flow)?;
        self.permeability_after_step(system.problem(), prepared.fluid, &nodes)?;
        self.warn_after_step(system, &solution, &nodes);
        let written = Written {
            solution: &solution,
            nodes: &nodes,
            accuracy: &accuracy,
            facets: facets.as_deref(),
            flow: flow.as_ref(),
        };
        let mut parts = None;
        let has_history = self.output.is_kept() || self.request.keep_results;
        self.write_grids(prepared, &written, || {
            parts = has_history.then(|| Parts::of(system, &prepared.state, &solution));
        })?;
        self.write_sources()?;
        self.probe(prepared, (&solution, &nodes), flow.as_ref())?;
        match parts {
            Some(parts) => self.write_history(prepared, parts),
            None => Ok(()),
        }
    }

    /// Sums up what is doubtful about the run so far.
    fn warn_after_step(&mut self, system: &System<'_>, solution: &Solution, nodes: &[FacetResult]) {
        let scene = self.request.scene;
        let (problem, fractures) = (system.problem(), &self.summary.fractures);
        let of_result = doubts::of_result(scene, problem, solution, nodes, fractures);
        let unclear = undetermined::warnings(scene, fractures);
        let jumps = nodes.iter().map(|node| node.jump.length());
        let largest = jumps.fold(0.0, f64::max);
        let unresolved = [
            unresolved::warning(scene, &self.finished),
            unresolved::warning_of_sums(scene, &self.finished, largest),
            unresolved::warning_of_time(scene, &self.finished),
        ];
        self.summary.warnings = [self.doubts.clone(), of_result, unclear].concat();
        self.summary
            .warnings
            .extend(unresolved.into_iter().flatten());
    }

    /// What the errors of the jumps of the last load step are estimated by. To estimate and to
    /// write takes memory too: that of the solver is given back once nothing is solved any more.
    fn last_solves(&mut self, prepared: &mut Prepared<'_, '_>, is_last: bool) -> Option<Duals> {
        let Prepared {
            system,
            newton,
            state,
            ..
        } = prepared;
        let duals = self.stage(Stage::Estimate, |_| {
            let duals = || accuracy::duals(system, newton, state);
            is_last.then(duals).flatten()
        });
        if self.is_over(system) {
            newton.release();
        }
        duals
    }

    /// Whether nothing is solved any more.
    fn is_over(&self, system: &System<'_>) -> bool {
        !self.has_more_to_solve(system.problem().schedule.steps.len())
    }

    /// Estimates the error of a load step, and those of the jumps by their duals.
    fn estimate(
        &mut self,
        prepared: &mut Prepared<'_, '_>,
        solution: &Solution,
        duals: Option<Duals>,
    ) -> Accuracy {
        let Prepared {
            system, estimator, ..
        } = prepared;
        let accuracy = self.stage(Stage::Estimate, |_| {
            let estimator = estimator.get_or_insert_with(|| Estimator::of(system));
            accuracy::of(system, estimator, solution, duals.as_ref())
        });
        if self.is_over(system) {
            *estimator = None;
        }
        accuracy
    }

    /// Writes the grids of the load step that was solved last; `meanwhile` is done while the disk
    /// takes them.
    fn write_grids(
        &mut self,
        prepared: &Prepared<'_, '_>,
        written: &Written<'_>,
        meanwhile: impl FnOnce(),
    ) -> Result<(), Interruption> {
        let system = prepared.system;
        let problem = system.problem();
        let &Written {
            solution,
            nodes,
            accuracy,
            facets,
            flow,
        } = written;
        let time = prepared.state.load.time;
        let ranks = self.request.ranks.filter(|ranks| ranks.count() > 1);
        self.stage(Stage::Write, |run| {
            let rock_of = |cells: Option<&[u32]>| {
                let grid = rock_grid(system, solution, Some(accuracy), cells);
                in_plane(&problem.mesh, grid)
            };
            let fractures = || {
                let mut grid = fracture_grid(system, nodes, Some(accuracy));
                grid.cell_fields.extend(facets.map(undetermined::field));
                if let Some(flow) = flow {
                    fluid_step::add_to(&mut grid, flow, nodes);
                }
                in_plane(&problem.mesh, grid)
            };
            if let Some(ranks) = ranks {
                meanwhile();
                let piece = Piece::of(system, &(ranks.owner)(), ranks.rank());
                let rock = || rock_of(Some(&piece.cells));
                let grids = (rock, fractures);
                return run.output.write_pieces(time, grids, &piece, ranks);
            }
            let rock = || rock_of(None);
            let of_one = |defect| vec![defect];
            if !run.request.keep_results {
                let written = run.output.write_step(time, rock, fractures, meanwhile);
                return written.map_err(of_one);
            }
            let (rock, fractures) = rayon::join(rock, fractures);
            let (of_rock, of_fractures) = (|| rock.clone(), || fractures.clone());
            let written = run
                .output
                .write_step(time, of_rock, of_fractures, meanwhile);
            run.keep(rock, fractures);
            written.map_err(of_one)
        })?;
        Ok(())
    }

    /// Adds the load step that was solved last to the values of probes.
    fn probe(
        &mut self,
        prepared: &Prepared<'_, '_>,
        (solution, nodes): (&Solution, &[FacetResult]),
        flow: Option<&SolvedFlow>,
    ) -> Result<(), Interruption> {
        let number = self.finished.len();
        let system = prepared.system;
        let solved = Solved {
            number,
            step: &system.problem().schedule.steps[number - 1],
            mesh: &system.problem().mesh,
            rock: Some(SolvedRock {
                system,
                solution,
                nodes,
            }),
            fluid: flow.map(|flow| SolvedFluid {
                fields: &flow.fields,
                apertures: &[],
            }),
        };
        self.write_probes(&solved)
    }

    /// Adds a load step to the values of probes, if there are any.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub(crate) fn write_probes(&mut self, solved: &Solved<'_>) -> Result<(), Interruption> {
        if self.probes.all.is_empty() || !self.output.is_kept() {
            return Ok(());
        }
        self.probes.add(solved);
        let text = &self.probes.text;
        let write = |path: &Path| write_atomically(path, |out| out.write_all(text.as_bytes()));
        Ok(self.output.write(probes::NAME, write)?)
    }

    /// Adds the load step that was solved last to the history.
    fn write_history(
        &mut self,
        prepared: &Prepared<'_, '_>,
        parts: Parts<'_>,
    ) -> Result<(), Interruption> {
        let system = prepared.system;
        let number = self.finished.len();
        let last = self.finished.last();
        self.history.add(&Entry {
            number,
            step: &system.problem().schedule.steps[number - 1],
            newton_iterations: last.map_or(0, |last| last.newton_iterations),
            fractures: &self.summary.fractures,
            parts,
            flow: of_flow(&self.summary),
        });
        if !self.output.is_kept() {
            return Ok(());
        }
        let text = self.history.text();
        let write = |path: &Path| write_atomically(path, |out| out.write_all(text.as_bytes()));
        Ok(self.output.write(history::NAME, write)?)
    }

    /// Keeps the results of the load step that was solved last.
    pub fn keep(&mut self, rock: Grid, fracture_grid: Grid) {
        let Some(summary) = self.summary.steps.last() else {
            return;
        };
        let result = StepResult {
            summary: summary.clone(),
            fractures: self.summary.fractures.clone(),
            rock,
            fracture_grid,
        };
        self.observer.step_ends(&result);
        self.kept.push(result);
    }
}

/// The flow after the load step that was solved last, if there is one.
fn of_flow(summary: &Summary) -> Option<FlowEntry<'_>> {
    Some(FlowEntry {
        flow: summary.steps.last()?.flow.as_ref()?,
        conduits: &summary.flow.as_ref()?.fractures,
    })
}
