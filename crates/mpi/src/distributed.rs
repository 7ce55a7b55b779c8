//! The linear solver whose rows are divided among ranks: PETSc's conjugate gradients and V-cycle on
//! Kluft's levels.

use std::sync::Arc;

use glam::{DMat3, DVec3};
use kluft_solver::multigrid::{BlockList, FirstCoarsening, LevelPart, NextPart};
use kluft_solver::{
    Communicator, FixedPart, InterfaceBlocks, LinearFailure, LinearSolution, SolverHistory, System,
    TangentSolver, first_coarsening, first_guess, norm, serves,
};

use crate::levels::Levels;
use crate::lines::EntryShape;
use crate::partition::Partition;
use crate::parts::SolverParts;
use crate::petsc::{Matrix, PetscFailure, Preconditioner, Solver, World};

/// Iterations after which a linear solve has failed.
const MAX_ITERATIONS: usize = 2000;
/// Residual, as a share of the right-hand side, at which an iteration that gains nothing more is
/// taken for one that rounding ended.
const ROUNDED: f64 = 1e-3;
/// How often the spectrum may turn out wider than it was taken for, and by which factor.
const MOST_WIDENINGS: usize = 4;
const WIDENING: f64 = 1.4;
/// A matrix with at most this many scalar unknowns is factorised if it has no next level.
const LARGEST_FACTOR: usize = 6000;

/// Solver of a system on all ranks. Every rank knows all unknowns, and has its own rows.
pub struct Distributed {
    world: Arc<World>,
    communicator: Communicator,
    partition: Arc<Partition>,
    coarsening: FirstCoarsening,
    /// The stiffness of the rock, the rows of this rank.
    rock: Arc<Matrix>,
    solver: Option<Solver>,
    /// Stiffness of the fractures, one block for each of the interface's columns.
    stiffness: Option<Vec<DMat3>>,
    /// The one that the levels were made with.
    built_for: Option<Vec<DMat3>>,
    /// By how much the spectrum turned out to reach further than it was taken for.
    margin: f64,
}

impl Distributed {
    /// Prepares the solver of a system, and lets that hold the rows that it needs.
    ///
    /// # Errors
    /// If the rock is not positive definite, and those of PETSc.
    pub fn new(world: &Arc<World>, system: &mut System<'_>) -> Result<Self, LinearFailure> {
        let (coarsening, owner) = first_coarsening(system)?;
        let communicator = system.division().communicator().clone();
        let partition = Partition::of(owner, &communicator);
        let rock = system.rock_rows();
        let rock = matrix(world, &partition, |row, blocks| {
            blocks.extend(partition.numbered(rock.row(row as usize)));
        })?;
        Ok(Self {
            world: Arc::clone(world),
            communicator,
            partition: Arc::new(partition),
            coarsening,
            rock: Arc::new(rock),
            solver: None,
            stiffness: None,
            built_for: None,
            margin: 1.0,
        })
    }

    /// Who owns which rows.
    pub fn partition(&self) -> &Arc<Partition> {
        &self.partition
    }

    /// Makes the levels anew for a stiffness of the fractures.
    fn rebuild_for(
        &mut self,
        fixed: FixedPart<'_>,
        stiffness: Vec<DMat3>,
    ) -> Result<(), LinearFailure> {
        (self.built_for, self.solver) = (None, None);
        let blocks = InterfaceBlocks {
            pattern: fixed.interface,
            blocks: &stiffness,
        };
        let parts = self.parts(fixed, blocks)?;
        let own = self.partition.own.len();
        self.solver = Some(Solver::new(&self.world, own, parts)?);
        self.built_for = Some(stiffness);
        Ok(())
    }

    fn parts(
        &mut self,
        fixed: FixedPart<'_>,
        blocks: InterfaceBlocks<'_>,
    ) -> Result<SolverParts<Matrix>, LinearFailure> {
        let rows = fixed.matrix.rows();
        let LevelPart {
            largest_eigenvalue,
            inverse,
            prolongator,
            next,
        } = self.part(fixed, blocks)?;
        let inverse = self.inverse(inverse)?;
        let levels = match self.coarsening.has_next(rows) {
            true => self.levels(prolongator, next)?,
            false => Levels::none(),
        };
        let bounds = std::iter::once(largest_eigenvalue).chain(levels.largest_eigenvalues);
        Ok(SolverParts {
            rock: Arc::clone(&self.rock),
            fractures: self.fractures(blocks)?,
            inverse,
            prolongators: levels.prolongators,
            matrices: levels.matrices,
            coarsest: levels.coarsest,
            largest_eigenvalues: bounds.map(|bound| self.margin * bound).collect(),
            is_small: 3 * rows <= LARGEST_FACTOR,
        })
    }

    /// What the rows of this rank give to the levels.
    fn part(
        &mut self,
        fixed: FixedPart<'_>,
        blocks: InterfaceBlocks<'_>,
    ) -> Result<LevelPart, LinearFailure> {
        let partition = Arc::clone(&self.partition);
        let rows = self
            .coarsening
            .factorised(fixed.matrix, blocks, &partition.own);
        let rows = self.communicator.agreed(rows)?;
        let complete = |vector: &mut [[f32; 3]]| partition.complete(vector);
        let part = self.coarsening.part(&rows, complete);
        match part.largest_eigenvalue.is_finite() {
            true => Ok(part),
            false => Err(LinearFailure::NotFinite),
        }
    }

    fn levels(
        &self,
        prolongator: BlockList<3, 6>,
        next: NextPart,
    ) -> Result<Levels, LinearFailure> {
        let lower = self.coarsening.levels_below(next, &self.communicator)?;
        let basis = self.coarsening.basis();
        let mut movers = vec![u32::MAX; basis.modes().len()];
        for &row in &self.partition.own {
            for (node, _) in basis.row(row as usize) {
                movers[node] = movers[node].min(row);
            }
        }
        let owners = self.owners(&movers);
        Ok(Levels::of(&self.world, owners, prolongator, &lower)?)
    }

    /// Rank of the first row that each node of the next level moves, from the first ones of this
    /// rank.
    fn owners(&self, first: &[u32]) -> Vec<u32> {
        let mut all = self.communicator.gathered(first);
        let (lowest, others) = all.split_at_mut(first.len());
        for of_rank in others.chunks_exact(first.len().max(1)) {
            let pairs = lowest.iter_mut().zip(of_rank);
            pairs.for_each(|(lowest, row)| *lowest = (*row).min(*lowest));
        }
        let owner = |row: &u32| self.partition.owner.get(*row as usize).copied();
        lowest.iter().map(|row| owner(row).unwrap_or(0)).collect()
    }

    fn inverse(&self, rows: BlockList<3, 3>) -> Result<Matrix, PetscFailure> {
        let number = |row: u32| self.partition.number[row as usize];
        Matrix::square(&self.world, &rows, number)
    }

    /// The rows of this rank of what the fractures have in the tangent.
    fn fractures(&self, added: InterfaceBlocks<'_>) -> Result<Matrix, PetscFailure> {
        matrix(&self.world, &self.partition, |row, blocks| {
            if let Ok(index) = added.pattern.rows.binary_search(&row) {
                blocks.extend(self.partition.numbered(added.row(index)));
            }
        })
    }

    /// Takes a new stiffness of the fractures into the tangent: the rows of this rank that have
    /// some of it.
    fn update_fractures(
        &mut self,
        fixed: FixedPart<'_>,
        stiffness: &[DMat3],
    ) -> Result<(), LinearFailure> {
        let blocks = InterfaceBlocks {
            pattern: fixed.interface,
            blocks: stiffness,
        };
        let partition = Arc::clone(&self.partition);
        let rank = self.world.rank() as u32;
        let rows = blocks.pattern.rows.iter().enumerate();
        let own = rows.filter(|(_, row)| partition.owner[**row as usize] == rank);
        let rows = own.map(|(index, &row)| {
            let entries = partition.numbered(blocks.row(index)).collect();
            (partition.number[row as usize], entries)
        });
        Ok(self.solver()?.update(rows)?)
    }

    fn solver(&mut self) -> Result<&mut Solver, LinearFailure> {
        let missing = || LinearFailure::Analysis("no tangent was given".into());
        self.solver.as_mut().ok_or_else(missing)
    }

    /// The entries of this rank.
    fn own(&self, vector: &[DVec3]) -> Vec<[f64; 3]> {
        let own = self.partition.own.iter();
        own.map(|&row| vector[row as usize].to_array()).collect()
    }

    /// The entries of all ranks, each in its place.
    fn all(&self, own: &[[f64; 3]]) -> Vec<DVec3> {
        let mut vector = vec![DVec3::ZERO; self.partition.all.len()];
        self.partition
            .gather(bytemuck::cast_slice(own), &mut vector);
        vector
    }

    fn clusters_alone(&mut self, rest: &[DVec3]) -> Result<Vec<DVec3>, LinearFailure> {
        let own = self.own(rest);
        let alone = self.solver()?.apply(Preconditioner::Clusters, &own)?;
        Ok(self.all(&alone))
    }

    /// The correction for a residual, and its iterations.
    fn correction(
        &mut self,
        fixed: FixedPart<'_>,
        residual: &[DVec3],
        wanted: f64,
    ) -> Result<(Vec<DVec3>, usize), LinearFailure> {
        let own = self.own(residual);
        let mut iterations = 0;
        for attempt in 0..=MOST_WIDENINGS {
            let (solution, solved) = self.solver()?.solve(&own, wanted, MAX_ITERATIONS)?;
            iterations += solved.iterations;
            if !solved.residual.is_finite() {
                return Err(LinearFailure::NotFinite);
            }
            // Rounding ends an iteration; whether it came far enough, Newton's tests tell.
            if solved.converged || solved.residual <= wanted.max(ROUNDED) {
                return Ok((self.all(&solution), iterations));
            }
            let built_for = match &self.built_for {
                Some(built_for) if self.stiffness.as_ref() == Some(built_for) => built_for.clone(),
                _ => break,
            };
            if !solved.broke || attempt == MOST_WIDENINGS {
                break;
            }
            self.margin *= WIDENING;
            self.rebuild_for(fixed, built_for)?;
        }
        Err(LinearFailure::Stalled(iterations))
    }
}

/// The matrix of unknowns of which `row` adds the blocks of one to a list, by the global numbers of
/// their columns.
fn matrix(
    world: &Arc<World>,
    partition: &Partition,
    row: impl Fn(u32, &mut Vec<(i64, [[f64; 3]; 3])>),
) -> Result<Matrix, PetscFailure> {
    let own = &partition.own;
    let sizes = (EntryShape::square(3), [own.len(); 2]);
    Matrix::by_rows(world, sizes, |at, blocks| row(own[at], blocks))
}

impl TangentSolver for Distributed {
    fn update(&mut self, fixed: FixedPart<'_>, stiffness: Vec<DMat3>) -> Result<(), LinearFailure> {
        let built_for = self.built_for.as_deref();
        if !built_for.is_some_and(|built_for| serves(fixed, built_for, &stiffness)) {
            self.rebuild_for(fixed, stiffness.clone())?;
        } else if self.stiffness.as_ref() != Some(&stiffness) {
            self.update_fractures(fixed, &stiffness)?;
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
        let stiffness = self.stiffness.clone().unwrap_or_default();
        let partition = Arc::clone(&self.partition);
        let multiply = |vector: &[DVec3], product: &mut [DVec3]| {
            partition.multiply(fixed, &stiffness, (vector, product));
        };
        let mut failure = None;
        let alone = |rest: &[DVec3]| {
            let alone = self.clusters_alone(rest);
            alone.unwrap_or_else(|error| {
                failure = Some(error);
                vec![DVec3::ZERO; rest.len()]
            })
        };
        let (mut unknowns, residual) = first_guess(alone, fixed.interface.rows, multiply, rhs);
        if let Some(failure) = failure {
            return Err(failure);
        }
        let size = norm(&residual);
        if size == 0.0 {
            return Ok(LinearSolution {
                unknowns,
                iterations: 0,
            });
        }
        let wanted = tolerance * norm(rhs) / size;
        let (correction, iterations) = self.correction(fixed, &residual, wanted)?;
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
        if let Some(stiffness) = history.preconditioned {
            self.rebuild_for(fixed, stiffness)?;
        }
        match history.stiffness {
            Some(stiffness) => self.update(fixed, stiffness),
            None => Ok(()),
        }
    }

    fn rebuild(&mut self, fixed: FixedPart<'_>) -> Result<bool, LinearFailure> {
        match self.stiffness.clone() {
            Some(stiffness) if self.built_for.as_ref() != Some(&stiffness) => {
                self.rebuild_for(fixed, stiffness)?;
                Ok(true)
            }
            _ => Ok(false),
        }
    }

    fn multiply(
        &self,
        fixed: FixedPart<'_>,
        stiffness: &[DMat3],
        vector: &[DVec3],
        product: &mut [DVec3],
    ) {
        self.partition.multiply(fixed, stiffness, (vector, product));
    }

    fn precondition(
        &mut self,
        _: FixedPart<'_>,
        rhs: &[DVec3],
    ) -> Result<Vec<DVec3>, LinearFailure> {
        let own = self.own(rhs);
        let cycled = self.solver()?.apply(Preconditioner::Cycle, &own)?;
        Ok(self.all(&cycled))
    }
}
