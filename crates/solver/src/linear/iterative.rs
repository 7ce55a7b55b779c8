//! The iterative solver: conjugate gradients on all unknowns, preconditioned by a multigrid of rock
//! and fractures. What it knows of the rock is set up once a run; a new stiffness of the fractures
//! changes the diagonal blocks of the nodes on them and the levels below.

use glam::{DMat3, DVec3};
use kluft_algebra::multigrid::{FirstCoarsening, Multigrid, Workspace, rigid_modes};
use kluft_algebra::{
    Communicator, ConjugateGradientOutcome, ConjugateGradientSettings, FixedPart, InterfaceBlocks,
    LinearFailure, conjugate_gradients, norm, trace,
};
use rayon::prelude::*;

use crate::linear::split_aggregates::SplitAggregates;
use crate::linear::tangent_solver::{LinearSolution, SolverHistory, TangentSolver};
use crate::system::System;

/// Iterations after which a linear solve has failed.
const MAX_ITERATIONS: usize = 2000;

/// Residual, as a share of the right-hand side, at which an iteration that gains nothing more is
/// taken for one that rounding ended.
const ROUNDED: f64 = 1e-3;

/// How often the spectrum may turn out wider than it was taken for, and by which factor.
const MOST_WIDENINGS: usize = 4;
const WIDENING: f64 = 1.4;
/// Steps of the first guess, and the factor by which each must reduce the residual.
const MOST_GUESSES: usize = 6;
const HELPS: f64 = 0.3;
/// Factor by which the stiffness of a fracture may change in any direction; and the share of the
/// stiffness of the rock beside it which that stiffness is added to, because less does not matter.
const FACTOR_OF_CHANGE: f64 = 2.0;
const BESIDE: f64 = 0.1;
/// Share of the fractures' unknowns that may change so much before the multigrid is made anew.
const TOLERATED: f64 = 0.02;

/// Iterative solver of a system.
pub struct Iterative {
    multigrid: Multigrid,
    workspace: Workspace,
    /// Stiffness of the fractures, one block for each of the interface's columns; none before the
    /// first.
    stiffness: Option<Vec<DMat3>>,
    /// The one that the multigrid was made with.
    built_for: Option<Vec<DMat3>>,
    /// By how much the spectrum turned out to reach further than it was taken for.
    margin: f64,
}

impl Iterative {
    /// Sets up the multigrid of the rock.
    ///
    /// # Errors
    /// If the rock is not positive definite.
    pub fn new(system: &System<'_>) -> Result<Self, LinearFailure> {
        let space = system.discretisation.space(system.problem);
        let multigrid = Multigrid::with_basis(
            system.rock_rows(),
            &space.points.offset,
            &modes(system),
            |means| SplitAggregates::of(space, means, &Communicator::alone()).basis(|_| true),
        )?;
        Ok(Self {
            workspace: multigrid.workspace(),
            multigrid,
            stiffness: None,
            built_for: None,
            margin: 1.0,
        })
    }

    /// Makes the multigrid anew for a stiffness of the fractures.
    fn rebuild_for(
        &mut self,
        fixed: FixedPart<'_>,
        stiffness: Vec<DMat3>,
    ) -> Result<(), LinearFailure> {
        self.built_for = None;
        let blocks = InterfaceBlocks {
            pattern: fixed.interface,
            blocks: &stiffness,
        };
        self.multigrid.rebuild(fixed.matrix, blocks)?;
        self.multigrid.widen(self.margin);
        self.workspace = self.multigrid.workspace();
        self.built_for = Some(stiffness);
        Ok(())
    }
}

/// Whether a preconditioner that was made for a stiffness of the fractures, `built_for`, serves
/// another one that is much like it.
pub fn serves(fixed: FixedPart<'_>, built_for: &[DMat3], stiffness: &[DMat3]) -> bool {
    let interface = fixed.interface;
    let numbered = interface.rows.par_iter().enumerate();
    let changed = numbered.filter(|&(row, unknown)| {
        let columns = interface.columns.of(row);
        let place = columns.partition_point(|column| column < unknown);
        let own = interface.columns.offset[row] + place;
        let rock = trace(fixed.diagonal(row)) / 3.0;
        !is_spectrally_close(built_for[own], stiffness[own], BESIDE * rock)
    });
    changed.count() as f64 <= TOLERATED * interface.rows.len() as f64
}

/// Clusters of unknowns and the motions of cut aggregates, for a solver that divides the rows among
/// ranks; and the rank of each row. Lets the system hold the rows that this rank needs for it.
///
/// # Errors
/// If the rock is not positive definite.
pub fn first_coarsening(
    system: &mut System<'_>,
) -> Result<(FirstCoarsening, Vec<u32>), LinearFailure> {
    let division = system.division().clone();
    let (mut coarsening, means) = FirstCoarsening::of(
        (system.rock_rows(), &division),
        &system.discretisation.points.offset,
        &modes(system),
    )?;
    let owner = coarsening.owners(&division);
    let rank = division.communicator().rank() as u32;
    let rows = 0..owner.len() as u32;
    let own: Vec<u32> = rows.filter(|&row| owner[row as usize] == rank).collect();
    let wanted = coarsening.beside(&own, &system.discretisation.pattern.blocks);
    let space = system.discretisation.space(system.problem);
    let is_wanted = |row: usize| wanted.binary_search(&(row as u32)).is_ok();
    let split = SplitAggregates::of(space, &means, division.communicator());
    coarsening.set_basis(split.basis(is_wanted));
    let is_own = |row: u32| owner[row as usize] == rank;
    let is_needed = |row, column| is_own(row) || coarsening.is_within_cluster(row, column);
    system.add_rows(&wanted, is_needed);
    Ok((coarsening, owner))
}

/// Whether the stiffness of a fracture changes by less than a factor of [`FACTOR_OF_CHANGE`] in
/// every direction, when `rock` is added to it. A sum of entries would not tell that walls begin to
/// slide in one direction.
fn is_spectrally_close(old: DMat3, new: DMat3, rock: f64) -> bool {
    let [old, new] = [old, new].map(|block| block + rock * DMat3::IDENTITY);
    is_positive(FACTOR_OF_CHANGE * old - new) && is_positive(FACTOR_OF_CHANGE * new - old)
}

/// Whether a symmetric block is positive definite, by its leading minors.
fn is_positive(block: DMat3) -> bool {
    let [x, y] = [block.x_axis, block.y_axis];
    x.x > 0.0 && x.x * y.y > x.y * y.x && block.determinant() > 0.0
}

/// Rigid motions of the rock at each node with unknowns.
fn modes(system: &System<'_>) -> Vec<[DVec3; 6]> {
    let nodes = &system.problem.mesh.nodes;
    let discretisation = &system.discretisation;
    let points = &discretisation.points;
    let (low, high) = nodes.iter().fold(
        (DVec3::INFINITY, DVec3::NEG_INFINITY),
        |(low, high), node| (low.min(*node), high.max(*node)),
    );
    let centre = 0.5 * (low + high);
    let firsts = (0..nodes.len()).filter(|&node| !points.of_node(node).is_empty());
    firsts
        .map(|node| {
            let constraint = discretisation
                .supports
                .constraint(points.of_node(node).start);
            let free = constraint.map_or(DMat3::IDENTITY, |constraint| constraint.free);
            rigid_modes(nodes[node], centre, free)
        })
        .collect()
}

impl TangentSolver for Iterative {
    fn update(&mut self, fixed: FixedPart<'_>, stiffness: Vec<DMat3>) -> Result<(), LinearFailure> {
        let built_for = self.built_for.as_deref();
        if !built_for.is_some_and(|built_for| serves(fixed, built_for, &stiffness)) {
            self.rebuild_for(fixed, stiffness.clone())?;
        }
        self.stiffness = Some(stiffness);
        Ok(())
    }

    fn solve(
        &mut self,
        fixed: FixedPart<'_>,
        rhs: &[DVec3],
        tolerance: f64,
    ) -> Result<LinearSolution, LinearFailure> {
        let stiffness = self.stiffness.as_deref().unwrap_or_default();
        let multiply =
            |vector: &[DVec3], product: &mut [DVec3]| fixed.multiply(stiffness, vector, product);
        let (mut unknowns, residual) = first_guess(
            |rest| self.multigrid.clusters_alone(rest),
            fixed.interface.rows,
            multiply,
            rhs,
        );
        let size = norm(&residual);
        let wanted = tolerance * norm(rhs) / size;
        let mut correction = vec![DVec3::ZERO; rhs.len()];
        let mut iterations = 0;
        for attempt in 0..=MOST_WIDENINGS {
            let report = conjugate_gradients(
                multiply,
                |residual, correction| {
                    self.multigrid
                        .apply(residual, correction, &mut self.workspace);
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
                ConjugateGradientOutcome::Breakdown
                    if attempt < MOST_WIDENINGS && self.built_for == self.stiffness =>
                {
                    self.margin *= WIDENING;
                    self.multigrid.widen(self.margin);
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
            preconditioned: self.built_for.clone(),
            margin: Some(self.margin),
            ..SolverHistory::default()
        }
    }

    fn restore(
        &mut self,
        fixed: FixedPart<'_>,
        history: SolverHistory,
    ) -> Result<(), LinearFailure> {
        self.margin = history.margin.unwrap_or(1.0);
        self.stiffness = history.stiffness;
        let built_for = history.preconditioned;
        built_for.map_or(Ok(()), |stiffness| self.rebuild_for(fixed, stiffness))
    }

    fn rebuild(&mut self, fixed: FixedPart<'_>) -> Result<bool, LinearFailure> {
        match &self.stiffness {
            Some(stiffness) if self.built_for.as_ref() != Some(stiffness) => {
                self.rebuild_for(fixed, stiffness.clone())?;
                Ok(true)
            }
            _ => Ok(false),
        }
    }

    fn precondition(
        &mut self,
        _: FixedPart<'_>,
        rhs: &[DVec3],
    ) -> Result<Vec<DVec3>, LinearFailure> {
        let mut correction = vec![DVec3::ZERO; rhs.len()];
        self.multigrid
            .apply(rhs, &mut correction, &mut self.workspace);
        Ok(correction)
    }
}

/// Jumps alone, node by node, as long as that helps much; with the forces that remain.
/// `clusters_alone` is the block Jacobi method of the tangent.
///
/// Newton may leave the walls of a stiff facet so far from where its law is linearised that their
/// forces exceed all others by more digits than there are. The guess moves those walls and leaves
/// forces of an ordinary size.
pub fn first_guess(
    mut clusters_alone: impl FnMut(&[DVec3]) -> Vec<DVec3>,
    jumps: &[u32],
    multiply: impl Fn(&[DVec3], &mut [DVec3]),
    rhs: &[DVec3],
) -> (Vec<DVec3>, Vec<DVec3>) {
    let mut guess = vec![DVec3::ZERO; rhs.len()];
    let mut residual = rhs.to_vec();
    let mut size = norm(rhs);
    let mut elsewhere = rhs.to_vec();
    for &unknown in jumps {
        elsewhere[unknown as usize] = DVec3::ZERO;
    }
    // Moves of jumps leave most forces elsewhere as they are.
    if norm(&elsewhere) >= HELPS * size {
        return (guess, residual);
    }
    for _ in 0..MOST_GUESSES {
        let mut next = guess.clone();
        let alone = clusters_alone(&residual);
        for &unknown in jumps {
            next[unknown as usize] += alone[unknown as usize];
        }
        let mut remaining = vec![DVec3::ZERO; rhs.len()];
        multiply(&next, &mut remaining);
        for (image, force) in remaining.iter_mut().zip(rhs) {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linear::fractured_tests::{problem, remaining, system};
    use crate::linear::nonsymmetric::NonsymmetricSolver;

    /// What a multigrid for walls glued at random cannot solve for loose ones is solved with one of
    /// their own.
    #[test]
    fn a_multigrid_that_does_not_serve_is_made_anew() {
        let problem = problem(|z| z);
        let system = system(&problem);
        let interface = &system.discretisation.interface;
        let stiffness = |of: fn(usize) -> f64| {
            let points = 0..interface.points.len();
            let tangents = points.map(|point| of(point) * DMat3::IDENTITY);
            interface.stiffness(&tangents.collect::<Vec<_>>())
        };
        let loose = stiffness(|_| 1e-3);
        let mut outdated = Iterative::new(&system).expect("definite");
        let history = SolverHistory {
            stiffness: Some(loose.clone()),
            preconditioned: Some(stiffness(|point| 10_f64.powi(point as i32 % 16))),
            ..SolverHistory::default()
        };
        outdated
            .restore(system.fixed_part(), history)
            .expect("definite");
        let mut rhs = vec![DVec3::ZERO; system.discretisation.points.len()];
        rhs[interface.unknowns[0] as usize] = DVec3::new(1.0, -2.0, 0.5);
        let stalled = outdated.solve(system.fixed_part(), &rhs, 1e-8);
        assert!(matches!(stalled, Err(LinearFailure::Stalled(_))));
        let mut renewing = NonsymmetricSolver::new(Box::new(outdated));
        let solved = renewing.solve_positive(&system, &rhs, 1e-8);
        let solved = solved.expect("solved").unknowns;
        assert!(remaining(&system, &loose, &solved, &rhs) < 1e-7);
    }

    /// One stiffness (Pa/m) of all facet points, in all directions.
    fn uniform(system: &System<'_>, size: f64) -> Vec<DMat3> {
        let interface = &system.discretisation.interface;
        interface.stiffness(&vec![size * DMat3::IDENTITY; interface.points.len()])
    }

    /// What a step is divided for: the next substep has a tangent of its own.
    #[test]
    fn a_tangent_that_is_refused_leaves_a_solver_for_others() {
        let problem = problem(|z| z);
        let system = system(&problem);
        let interface = &system.discretisation.interface;
        let stiffness = |size: f64| uniform(&system, size);
        let mut rhs = vec![DVec3::ZERO; system.discretisation.points.len()];
        rhs[interface.unknowns[0] as usize] = DVec3::new(1.0, -2.0, 0.5);
        let fixed = system.fixed_part();
        let mut solver = Iterative::new(&system).expect("definite");
        for former in [None, Some(1e6)] {
            if let Some(former) = former {
                solver.update(fixed, stiffness(former)).expect("definite");
            }
            let refused = solver.update(fixed, stiffness(-1e3));
            assert!(
                matches!(refused, Err(LinearFailure::Indefinite(_))),
                "{refused:?}"
            );
            solver.update(fixed, stiffness(1.0)).expect("definite");
            let solved = solver.solve(fixed, &rhs, 1e-8).expect("solved").unknowns;
            assert!(remaining(&system, &stiffness(1.0), &solved, &rhs) < 1e-7);
        }
    }

    /// A run that is continued makes at once what another made step by step.
    #[test]
    fn levels_do_not_depend_on_those_before_them() {
        let problem = problem(|z| z);
        let system = system(&problem);
        let stiffness = |size: f64| uniform(&system, size);
        let fixed = system.fixed_part();
        let count = system.discretisation.points.len();
        let forces: Vec<DVec3> = (0..count)
            .map(|at| DVec3::new((at as f64).sin(), 1.0, (at as f64).cos()))
            .collect();
        let cycled = |former: &[f64]| {
            let mut solver = Iterative::new(&system).expect("definite");
            for &size in former {
                let _ = solver.update(fixed, stiffness(size));
            }
            solver.update(fixed, stiffness(1.0)).expect("definite");
            solver.precondition(fixed, &forces).expect("cycled")
        };
        let at_once = cycled(&[]);
        for former in [&[1e6][..], &[1e6, -1e3], &[-1e3, 1e-6]] {
            assert!(cycled(former) == at_once, "{former:?}");
        }
    }

    /// `old` and `new` on orthogonal axes that no coordinate follows.
    fn alike(old: DVec3, new: DVec3) -> bool {
        let turn = DMat3::from_euler(glam::EulerRot::XYZ, 0.3, 0.7, 1.1);
        let turned = |diagonal| turn * DMat3::from_diagonal(diagonal) * turn.transpose();
        is_spectrally_close(turned(old), turned(new), 1.0)
    }

    #[test]
    fn a_stiffness_may_change_twofold_in_every_direction() {
        let old = DVec3::new(1e6, 100.0, 100.0);
        assert!(alike(old, old));
        for (factor, is_alike) in [(1.9, true), (2.1, false), (0.55, true), (0.45, false)] {
            assert_eq!(alike(old, factor * old), is_alike, "{factor}");
        }
    }

    #[test]
    fn walls_that_begin_to_slide_in_one_direction_are_told() {
        let sticking = DVec3::new(1e6, 1e6, 1e6);
        let sliding = DVec3::new(1e6, 1e6, 0.0);
        assert!(!alike(sticking, sliding) && !alike(sliding, sticking));
    }

    #[test]
    fn what_is_soft_against_the_rock_does_not_matter() {
        assert!(alike(DVec3::ZERO, DVec3::splat(0.9)));
        assert!(!alike(DVec3::ZERO, DVec3::new(0.0, 0.0, 1.1)));
    }
}
