//! The iterative solver: conjugate gradients on all unknowns.
//!
//! The preconditioner is a symmetric block Gauss-Seidel step over two blocks: the intact rock, by
//! one cycle of a multigrid that is set up once a run, and the jumps, by a polynomial of their own
//! small block. Only the jumps see the stiffness of the fractures.

use glam::{DMat3, DVec3};
use rayon::prelude::*;

use super::jump_block::JumpBlock;
use super::{LinearFailure, LinearSolution, SolverHistory, TangentSolver};
use crate::conjugate_gradients::{
    ConjugateGradientOutcome, ConjugateGradientSettings, PER_TASK, conjugate_gradients,
};
use crate::multigrid::{BlockRows, Multigrid, MultigridFailure, Workspace, rigid_modes};
use crate::system::{System, norm};

/// Iterations after which a linear solve has failed.
const MAX_ITERATIONS: usize = 2000;

/// Residual, as a share of the right-hand side, at which an iteration that gains nothing more is
/// taken for one that rounding ended.
const ROUNDED: f64 = 1e-3;

/// How often the spectrum of the jumps may turn out wider than it was taken for.
const MOST_WIDENINGS: usize = 4;
/// Steps of the first guess, and the factor by which each must reduce the residual.
const MOST_GUESSES: usize = 6;
const HELPS: f64 = 0.3;

/// Iterative solver of a system.
pub struct Iterative {
    multigrid: Multigrid,
    workspace: Workspace,
    /// Unknowns of the intact rock, ascending: all that no facet point moves with.
    rock: Vec<u32>,
    jumps: JumpBlock,
    /// Stiffness of the fractures, one block for each of the interface's columns; none before the first.
    stiffness: Option<Vec<DMat3>>,
}

impl Iterative {
    /// Sets up the multigrid of the rock.
    ///
    /// # Errors
    /// If the rock is not positive definite.
    pub fn new(system: &System<'_>) -> Result<Self, LinearFailure> {
        let jumps = &system.discretisation.interface.unknowns;
        let count = system.discretisation.points.len() as u32;
        let rock: Vec<u32> = (0..count)
            .filter(|unknown| jumps.binary_search(unknown).is_err())
            .collect();
        let rows = system.rock_rows();
        let multigrid = Multigrid::of_sub_block(rows, &rock, &modes(system, &rock));
        let multigrid = multigrid.map_err(|failure| explain(&failure, &rock))?;
        Ok(Self {
            workspace: multigrid.workspace(),
            jumps: JumpBlock::of(system, &rock)?,
            stiffness: None,
            multigrid,
            rock,
        })
    }
}

/// Rigid motions of the rock at each of `rock`'s unknowns.
fn modes(system: &System<'_>, rock: &[u32]) -> Vec<[DVec3; 6]> {
    let nodes = &system.problem.mesh.nodes;
    let points = &system.discretisation.points;
    let (low, high) = nodes.iter().fold(
        (DVec3::INFINITY, DVec3::NEG_INFINITY),
        |(low, high), node| (low.min(*node), high.max(*node)),
    );
    let centre = 0.5 * (low + high);
    rock.par_iter()
        .map(|&unknown| {
            let unknown = unknown as usize;
            // A jump that is held everywhere has no part in a motion of the rock.
            let free = match (
                system.discretisation.supports.hold(unknown),
                points.sector(unknown),
            ) {
                (_, (1.., _)) => DMat3::ZERO,
                (Some(hold), _) => hold.free,
                (None, _) => DMat3::IDENTITY,
            };
            rigid_modes(nodes[points.node[unknown] as usize], centre, free)
        })
        .collect()
}

fn explain(failure: &MultigridFailure, rock: &[u32]) -> LinearFailure {
    match failure {
        MultigridFailure::NotPositive(row) => LinearFailure::Indefinite(rock[*row] as usize),
        MultigridFailure::NotFinite => LinearFailure::NotFinite,
    }
}

impl TangentSolver for Iterative {
    fn update(&mut self, system: &System<'_>, tangents: &[DMat3]) -> Result<(), LinearFailure> {
        let stiffness = system.discretisation.interface.stiffness(tangents);
        if self.stiffness.as_ref() != Some(&stiffness) {
            self.stiffness = None;
            self.jumps.update(&stiffness)?;
            self.stiffness = Some(stiffness);
        }
        Ok(())
    }

    fn solve(
        &mut self,
        system: &System<'_>,
        right: &[DVec3],
        tolerance: f64,
    ) -> Result<LinearSolution, LinearFailure> {
        let rows = system.rock_rows();
        let interface = &system.discretisation.interface;
        let stiffness = self.stiffness.as_deref().unwrap_or_default();
        let multiply = |vector: &[DVec3], product: &mut [DVec3]| {
            rows.multiply(vector, product);
            interface.add_product(stiffness, vector, product);
        };
        let (mut unknowns, residual) = first_guess(&self.jumps, multiply, right);
        let size = norm(&residual);
        let wanted = tolerance * norm(right) / size;
        let mut correction = vec![DVec3::ZERO; right.len()];
        let mut parts = Parts::new(self.rock.len());
        let mut iterations = 0;
        for attempt in 0..=MOST_WIDENINGS {
            let report = conjugate_gradients(
                multiply,
                |residual, correction| {
                    let workspace = &mut self.workspace;
                    precondition(
                        (&self.multigrid, workspace),
                        (&self.rock, &self.jumps, rows),
                        &mut parts,
                        (residual, correction),
                    );
                },
                &residual,
                &mut correction,
                ConjugateGradientSettings {
                    tolerance: wanted,
                    max_iterations: MAX_ITERATIONS,
                },
            );
            iterations += report.iterations;
            let last = report.residuals.last().copied().unwrap_or(f64::NAN);
            match report.outcome {
                ConjugateGradientOutcome::NotFinite => return Err(LinearFailure::NotFinite),
                // Rounding ends an iteration; whether it came far enough, Newton's tests tell.
                _ if last <= wanted.max(ROUNDED) => break,
                ConjugateGradientOutcome::Breakdown if attempt < MOST_WIDENINGS => {
                    self.jumps.widen();
                }
                _ => return Err(LinearFailure::Stalled(iterations)),
            }
        }
        for (unknown, change) in unknowns.iter_mut().zip(&correction) {
            *unknown += *change;
        }
        Ok(LinearSolution {
            unknowns,
            iterations,
        })
    }

    fn history(&self) -> SolverHistory {
        SolverHistory {
            stiffness: self.stiffness.clone(),
            spectrum: Some(self.jumps.spectrum()),
        }
    }

    fn restore(&mut self, history: SolverHistory) -> Result<(), LinearFailure> {
        if let Some(stiffness) = history.stiffness {
            self.jumps.update(&stiffness)?;
            self.stiffness = Some(stiffness);
        }
        if let Some(spectrum) = history.spectrum {
            self.jumps.take_spectrum(spectrum);
        }
        Ok(())
    }

    fn precondition(
        &mut self,
        system: &System<'_>,
        right: &[DVec3],
    ) -> Result<Vec<DVec3>, LinearFailure> {
        let mut parts = Parts::new(self.rock.len());
        let mut correction = vec![DVec3::ZERO; right.len()];
        precondition(
            (&self.multigrid, &mut self.workspace),
            (&self.rock, &self.jumps, system.rock_rows()),
            &mut parts,
            (right, &mut correction),
        );
        Ok(correction)
    }
}

/// Jumps alone, node by node, as long as that helps much; with the forces that remain.
///
/// Newton may leave the walls of a stiff facet so far from where its law is linearised that their
/// forces exceed all others by more digits than there are. The guess moves those walls and leaves
/// forces of an ordinary size.
fn first_guess(
    jumps: &JumpBlock,
    multiply: impl Fn(&[DVec3], &mut [DVec3]),
    right: &[DVec3],
) -> (Vec<DVec3>, Vec<DVec3>) {
    let mut guess = vec![DVec3::ZERO; right.len()];
    let mut residual = right.to_vec();
    let mut size = norm(right);
    for _ in 0..MOST_GUESSES {
        let mut next = guess.clone();
        let scaled = jumps.scaled(&jumps.gather(&residual));
        for (&unknown, entry) in jumps.unknowns().iter().zip(scaled) {
            next[unknown as usize] += entry;
        }
        let mut remaining = vec![DVec3::ZERO; right.len()];
        multiply(&next, &mut remaining);
        for (image, force) in remaining.iter_mut().zip(right) {
            *image = *force - *image;
        }
        let length = norm(&remaining);
        if length >= HELPS * size {
            break;
        }
        (guess, residual, size) = (next, remaining, length);
    }
    (guess, residual)
}

/// Vectors over the unknowns of the rock.
struct Parts {
    rock: Vec<DVec3>,
    correction: Vec<DVec3>,
}

impl Parts {
    fn new(length: usize) -> Self {
        Self {
            rock: vec![DVec3::ZERO; length],
            correction: vec![DVec3::ZERO; length],
        }
    }
}

/// Writes `entries` of the unknowns `places` (ascending) into a vector over all unknowns, and zero elsewhere.
fn spread(places: &[u32], entries: &[DVec3], vector: &mut [DVec3]) {
    let tasks = vector.par_chunks_mut(PER_TASK).enumerate();
    tasks.for_each(|(task, chunk)| {
        let start = task * PER_TASK;
        let before = |end: usize| places.partition_point(|&place| (place as usize) < end);
        let own = before(start)..before(start + chunk.len());
        chunk.fill(DVec3::ZERO);
        for (&place, entry) in places[own.clone()].iter().zip(&entries[own]) {
            chunk[place as usize - start] = *entry;
        }
    });
}

/// One symmetric step: jumps, rock, jumps.
fn precondition(
    (multigrid, workspace): (&Multigrid, &mut Workspace),
    (rock, jumps, rows): (&[u32], &JumpBlock, BlockRows<'_>),
    parts: &mut Parts,
    (residual, correction): (&[DVec3], &mut [DVec3]),
) {
    let forces = jumps.gather(residual);
    let first = jumps.solve(&forces);
    let gathered = parts.rock.par_iter_mut().zip(rock);
    gathered.for_each(|(force, &unknown)| *force = residual[unknown as usize]);
    jumps.subtract_from_rock(rows, &first, &mut parts.rock);
    multigrid.apply(&parts.rock, &mut parts.correction, workspace);
    spread(rock, &parts.correction, correction);
    let second = jumps.solve(&jumps.remaining(rows, &forces, &first, correction));
    for ((&unknown, first), second) in jumps.unknowns().iter().zip(first).zip(second) {
        correction[unknown as usize] = first + second;
    }
}
