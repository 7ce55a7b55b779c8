//! The iterative solver: conjugate gradients on all unknowns, preconditioned by a multigrid of rock and
//! fractures. What it knows of the rock is set up once a run; a new stiffness of the fractures changes
//! the diagonal blocks of the nodes on them and the levels below.

use glam::{DMat3, DVec3};

use super::{LinearFailure, LinearSolution, SolverHistory, TangentSolver};
use crate::assembly::trace;
use crate::conjugate_gradients::{
    ConjugateGradientOutcome, ConjugateGradientSettings, conjugate_gradients,
};
use crate::interface::Interface;
use crate::multigrid::{Multigrid, MultigridFailure, Springs, Workspace, rigid_modes};
use crate::system::{System, norm};

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
/// Factor by which the stiffness of a fracture may change in any direction; and the share of the stiffness of
/// the rock beside it which that stiffness is added to, because less does not matter.
const ALIKE: f64 = 2.0;
const BESIDE: f64 = 0.1;
/// Share of the fractures' unknowns that may change so much before the multigrid is made anew.
const TOLERATED: f64 = 0.02;

/// Iterative solver of a system.
pub struct Iterative {
    multigrid: Multigrid,
    workspace: Workspace,
    /// Stiffness of the fractures, one block for each of the interface's columns; none before the first.
    stiffness: Option<Vec<DMat3>>,
    /// The one that the multigrid was made with.
    made_with: Option<Vec<DMat3>>,
    /// By how much the spectrum turned out to reach further than it was taken for.
    margin: f64,
}

impl Iterative {
    /// Sets up the multigrid of the rock.
    ///
    /// # Errors
    /// If the rock is not positive definite.
    pub fn new(system: &System<'_>) -> Result<Self, LinearFailure> {
        let frame = system.discretisation.frame(system.problem);
        let multigrid = Multigrid::of_fractured(system.rock_rows(), &modes(system), frame);
        let multigrid = multigrid.map_err(explain)?;
        Ok(Self {
            workspace: multigrid.workspace(),
            multigrid,
            stiffness: None,
            made_with: None,
            margin: 1.0,
        })
    }

    /// Makes the multigrid anew for a stiffness of the fractures.
    fn refresh(&mut self, system: &System<'_>, stiffness: Vec<DMat3>) -> Result<(), LinearFailure> {
        self.made_with = None;
        let springs = springs(&system.discretisation.interface, &stiffness);
        let refreshed = self.multigrid.refresh(system.rock_rows(), springs);
        refreshed.map_err(explain)?;
        self.multigrid.widen(self.margin);
        self.workspace = self.multigrid.workspace();
        self.made_with = Some(stiffness);
        Ok(())
    }

    /// Whether the multigrid was made with a stiffness of the fractures that is much like `stiffness`.
    fn serves(&self, system: &System<'_>, stiffness: &[DMat3]) -> bool {
        let Some(made_with) = &self.made_with else {
            return false;
        };
        let interface = &system.discretisation.interface;
        let rows = system.rock_rows();
        let numbered = interface.unknowns.iter().enumerate();
        let changed = numbered.filter(|&(row, unknown)| {
            let columns = interface.columns.of(row);
            let place = columns.partition_point(|column| column < unknown);
            let own = interface.columns.offset[row] + place;
            let rock = trace(rows.diagonal(*unknown as usize)) / 3.0;
            !are_alike(made_with[own], stiffness[own], BESIDE * rock)
        });
        changed.count() as f64 <= TOLERATED * interface.unknowns.len() as f64
    }
}

/// Whether the stiffness of a fracture changes by less than a factor of [`ALIKE`] in every direction, when `rock`
/// is added to it. A sum of entries would not tell that walls begin to slide in one direction.
fn are_alike(old: DMat3, new: DMat3, rock: f64) -> bool {
    let [old, new] = [old, new].map(|block| block + rock * DMat3::IDENTITY);
    is_positive(ALIKE * old - new) && is_positive(ALIKE * new - old)
}

/// Whether a symmetric block is positive definite, by its leading minors.
fn is_positive(block: DMat3) -> bool {
    let [x, y] = [block.x_axis, block.y_axis];
    x.x > 0.0 && x.x * y.y > x.y * y.x && block.determinant() > 0.0
}

fn springs<'a>(interface: &'a Interface, stiffness: &'a [DMat3]) -> Springs<'a> {
    Springs {
        rows: &interface.unknowns,
        columns: &interface.columns,
        blocks: stiffness,
    }
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
            let hold = discretisation.supports.hold(points.of_node(node).start);
            let free = hold.map_or(DMat3::IDENTITY, |hold| hold.free);
            rigid_modes(nodes[node], centre, free)
        })
        .collect()
}

fn explain(failure: MultigridFailure) -> LinearFailure {
    match failure {
        MultigridFailure::NotPositive(row) => LinearFailure::Indefinite(row),
        MultigridFailure::NotFinite => LinearFailure::NotFinite,
    }
}

impl TangentSolver for Iterative {
    fn update(&mut self, system: &System<'_>, tangents: &[DMat3]) -> Result<(), LinearFailure> {
        let stiffness = system.discretisation.interface.stiffness(tangents);
        if !self.serves(system, &stiffness) {
            self.refresh(system, stiffness.clone())?;
        }
        self.stiffness = Some(stiffness);
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
        let (mut unknowns, residual) =
            first_guess(&self.multigrid, &interface.unknowns, multiply, right);
        let size = norm(&residual);
        let wanted = tolerance * norm(right) / size;
        let mut correction = vec![DVec3::ZERO; right.len()];
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
                    if attempt < MOST_WIDENINGS && self.made_with == self.stiffness =>
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
            preconditioned: self.made_with.clone(),
            margin: Some(self.margin),
        }
    }

    fn restore(
        &mut self,
        system: &System<'_>,
        history: SolverHistory,
    ) -> Result<(), LinearFailure> {
        self.margin = history.margin.unwrap_or(1.0);
        self.stiffness = history.stiffness;
        let made_with = history.preconditioned;
        made_with.map_or(Ok(()), |stiffness| self.refresh(system, stiffness))
    }

    fn renew(&mut self, system: &System<'_>) -> Result<bool, LinearFailure> {
        match &self.stiffness {
            Some(stiffness) if self.made_with.as_ref() != Some(stiffness) => {
                self.refresh(system, stiffness.clone())?;
                Ok(true)
            }
            _ => Ok(false),
        }
    }

    fn precondition(
        &mut self,
        _: &System<'_>,
        right: &[DVec3],
    ) -> Result<Vec<DVec3>, LinearFailure> {
        let mut correction = vec![DVec3::ZERO; right.len()];
        self.multigrid
            .apply(right, &mut correction, &mut self.workspace);
        Ok(correction)
    }
}

/// Jumps alone, node by node, as long as that helps much; with the forces that remain.
///
/// Newton may leave the walls of a stiff facet so far from where its law is linearised that their
/// forces exceed all others by more digits than there are. The guess moves those walls and leaves
/// forces of an ordinary size.
fn first_guess(
    multigrid: &Multigrid,
    jumps: &[u32],
    multiply: impl Fn(&[DVec3], &mut [DVec3]),
    right: &[DVec3],
) -> (Vec<DVec3>, Vec<DVec3>) {
    let mut guess = vec![DVec3::ZERO; right.len()];
    let mut residual = right.to_vec();
    let mut size = norm(right);
    let mut elsewhere = right.to_vec();
    for &unknown in jumps {
        elsewhere[unknown as usize] = DVec3::ZERO;
    }
    // Moves of jumps leave most forces elsewhere as they are.
    if norm(&elsewhere) >= HELPS * size {
        return (guess, residual);
    }
    for _ in 0..MOST_GUESSES {
        let mut next = guess.clone();
        let alone = multigrid.clusters_alone(&residual);
        for &unknown in jumps {
            next[unknown as usize] += alone[unknown as usize];
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linear::AnyTangent;
    use crate::multigrid::fractured_tests::{problem, remaining, system};

    /// What a multigrid for walls glued at random cannot solve for loose ones is solved with one of their own.
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
            margin: None,
        };
        outdated.restore(&system, history).expect("definite");
        let mut right = vec![DVec3::ZERO; system.discretisation.points.len()];
        right[interface.unknowns[0] as usize] = DVec3::new(1.0, -2.0, 0.5);
        let stalled = outdated.solve(&system, &right, 1e-8);
        assert!(matches!(stalled, Err(LinearFailure::Stalled(_))));
        let mut renewing = AnyTangent::new(Box::new(outdated));
        let solved = renewing.solve_positive(&system, &right, 1e-8);
        let solved = solved.expect("solved").unknowns;
        assert!(remaining(&system, &loose, &solved, &right) < 1e-7);
    }

    /// `old` and `new` on orthogonal axes that no coordinate follows.
    fn alike(old: DVec3, new: DVec3) -> bool {
        let turn = DMat3::from_euler(glam::EulerRot::XYZ, 0.3, 0.7, 1.1);
        let turned = |diagonal| turn * DMat3::from_diagonal(diagonal) * turn.transpose();
        are_alike(turned(old), turned(new), 1.0)
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
