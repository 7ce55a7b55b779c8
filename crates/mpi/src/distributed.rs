//! The linear solver whose rows are divided among ranks: PETSc's conjugate gradients and V-cycle on
//! Kluft's levels and products.

use std::sync::Arc;

use glam::{DMat3, DVec3};
use kluft_solver::multigrid::{
    FirstCoarsening, FirstProlongator, LevelPart, LevelRows, NextPart, OwnClusters,
};
use kluft_solver::{
    Communicator, FixedPart, InterfaceBlocks, LinearFailure, LinearSolution, SolverHistory, System,
    TangentSolver, first_coarsening, first_guess, norm, serves,
};

use crate::levels::{Levels, products};
use crate::partition::Partition;
use crate::parts::{LocalMap, MappedMatrix, SolverParts};
use crate::petsc::{Matrix, PetscFailure, Solver, World};

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
    solver: Option<Solver>,
    /// Rows of other ranks that those of this one couple to, ascending, once there is a solver.
    ghosts: Arc<[u32]>,
    /// Clusters of this rank in the matrix that the levels were made of.
    clusters: Option<Arc<OwnClusters>>,
    /// Stiffness of the fractures, one block for each of the interface's columns.
    stiffness: Option<Arc<[DMat3]>>,
    /// The one that the levels were made with.
    built_for: Option<Arc<[DMat3]>>,
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
        Ok(Self {
            world: Arc::clone(world),
            communicator,
            partition: Arc::new(partition),
            coarsening,
            solver: None,
            ghosts: Arc::default(),
            clusters: None,
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
        stiffness: Arc<[DMat3]>,
    ) -> Result<(), LinearFailure> {
        (self.built_for, self.solver) = (None, None);
        let blocks = InterfaceBlocks {
            pattern: fixed.interface,
            blocks: &stiffness,
        };
        let parts = self.parts(fixed, blocks)?;
        self.solver = Some(Solver::new(&self.world, parts)?);
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
            clusters,
            matrix,
            largest_eigenvalue,
            prolongator,
            next,
        } = self.part(fixed, blocks)?;
        let is_small = 3 * rows <= LARGEST_FACTOR;
        let (levels, whole) = match self.coarsening.has_next(rows) {
            true => (self.levels(prolongator, next)?, None),
            false if is_small => (Levels::none(), Some(self.whole(&matrix)?)),
            false => (Levels::none(), None),
        };
        let number = |row: u32| self.partition.number[row as usize];
        let finest = products(matrix, number);
        let bounds = std::iter::once(largest_eigenvalue).chain(levels.largest_eigenvalues);
        let clusters = Arc::new(clusters);
        self.clusters = Some(Arc::clone(&clusters));
        self.ghosts = self.ghosts(fixed).into();
        Ok(SolverParts {
            system: self.system(),
            scaling: scaling(clusters, self.partition.own.len()),
            matrices: std::iter::once(finest).chain(levels.matrices).collect(),
            prolongators: levels.prolongators,
            coarsest: levels.coarsest,
            whole,
            largest_eigenvalues: bounds.map(|bound| self.margin * bound).collect(),
        })
    }

    /// The tangent, whose products each solve makes.
    fn system(&self) -> MappedMatrix {
        let partition = &self.partition;
        let ghosts = self.ghosts.iter();
        let rows = 3 * partition.own.len();
        MappedMatrix {
            rows,
            columns: rows,
            block: 3,
            ghosts: ghosts.map(|&row| partition.number[row as usize]).collect(),
            product: None,
            transposed: None,
        }
    }

    /// The rows of other ranks that those of this one couple to, ascending.
    fn ghosts(&self, fixed: FixedPart<'_>) -> Vec<u32> {
        let rank = self.world.rank() as u32;
        let mut is_ghost = vec![false; self.partition.owner.len()];
        for &row in &self.partition.own {
            for (column, _) in fixed.matrix.row(row as usize) {
                is_ghost[column as usize] = self.partition.owner[column as usize] != rank;
            }
        }
        let rows = 0..is_ghost.len() as u32;
        rows.filter(|&row| is_ghost[row as usize]).collect()
    }

    /// A small scaled matrix, entry by entry.
    fn whole(&self, matrix: &LevelRows<3>) -> Result<Matrix, PetscFailure> {
        let own = &self.partition.own;
        let number = |place: usize| {
            let ghost = || matrix.ghosts()[place - own.len()];
            self.partition.number[own.get(place).copied().unwrap_or_else(ghost) as usize]
        };
        Matrix::by_rows(&self.world, own.len(), |row, blocks| {
            blocks.extend(matrix.row(row).map(|(place, block)| (number(place), block)));
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
        prolongator: FirstProlongator,
        next: NextPart,
    ) -> Result<Levels, LinearFailure> {
        let lower = self.coarsening.levels_below(next, &self.communicator)?;
        let mut first = vec![u32::MAX; self.coarsening.next_nodes()];
        for (place, &row) in self.partition.own.iter().enumerate() {
            for &node in prolongator.movers(place) {
                let first = &mut first[node as usize];
                *first = row.min(*first);
            }
        }
        let owners = self.owners(&first);
        Ok(Levels::of(&self.world, owners, prolongator, lower)?)
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

    /// What the clusters alone, each by itself, do about forces.
    fn clusters_alone(&self, rest: &[DVec3]) -> Vec<DVec3> {
        let own: Vec<DVec3> = bytemuck::cast_vec(self.own(rest));
        let clusters = self.clusters.as_ref();
        let alone = clusters.map_or_else(Vec::new, |clusters| clusters.alone(&own));
        self.all(bytemuck::cast_slice(&alone))
    }

    /// The correction for a residual, whose entries of this rank are given, and its iterations.
    fn correction(
        &mut self,
        fixed: FixedPart<'_>,
        own: &[[f64; 3]],
        wanted: f64,
    ) -> Result<(Vec<DVec3>, usize), LinearFailure> {
        let stiffness = self.stiffness.clone().unwrap_or_default();
        let ghosts = Arc::clone(&self.ghosts);
        let partition = Arc::clone(&self.partition);
        let mut iterations = 0;
        for attempt in 0..=MOST_WIDENINGS {
            let product = Box::new(product(fixed, &stiffness, [&partition.own, &ghosts]));
            let (solution, solved) = self.solver()?.solve(product, own, wanted, MAX_ITERATIONS)?;
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

/// Products with the tangent, from the entries in the rows `own` and `ghosts`.
fn product<'a>(
    fixed: FixedPart<'a>,
    stiffness: &'a [DMat3],
    [own, ghosts]: [&'a [u32]; 2],
) -> impl FnMut(&[f64], &[f64], &mut [f64]) + Send + 'a {
    let mut vector = vec![DVec3::ZERO; fixed.matrix.rows()];
    move |own_entries, ghost_entries, product| {
        for (rows, entries) in [(own, own_entries), (ghosts, ghost_entries)] {
            let entries: &[DVec3] = bytemuck::cast_slice(entries);
            for (&row, entry) in rows.iter().zip(entries) {
                vector[row as usize] = *entry;
            }
        }
        let products = fixed.products(stiffness, own, &vector);
        product.copy_from_slice(bytemuck::cast_slice(&products));
    }
}

/// The way of so many rows to scaled unknowns, and back.
fn scaling(clusters: Arc<OwnClusters>, rows: usize) -> [LocalMap<'static>; 2] {
    let back = Arc::clone(&clusters);
    let map = |function| LocalMap {
        own: 3 * rows,
        ghosts: 0,
        image: 3 * rows,
        function,
    };
    [
        map(Box::new(move |residual, _, scaled| {
            let scaled = bytemuck::cast_slice_mut(scaled);
            clusters.to_scaled(bytemuck::cast_slice(residual), scaled);
        })),
        map(Box::new(move |scaled, _, correction| {
            let correction = bytemuck::cast_slice_mut(correction);
            back.unscaled(bytemuck::cast_slice(scaled), correction);
        })),
    ]
}

impl TangentSolver for Distributed {
    fn update(&mut self, fixed: FixedPart<'_>, stiffness: Vec<DMat3>) -> Result<(), LinearFailure> {
        let stiffness: Arc<[DMat3]> = stiffness.into();
        let built_for = self.built_for.as_deref();
        if !built_for.is_some_and(|built_for| serves(fixed, built_for, &stiffness)) {
            self.rebuild_for(fixed, Arc::clone(&stiffness))?;
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
        let alone = |rest: &[DVec3]| self.clusters_alone(rest);
        let (mut unknowns, residual) = first_guess(alone, fixed.interface.rows, multiply, rhs);
        let wanted = tolerance * norm(rhs) / norm(&residual);
        // Nothing is left to solve; PETSc refuses such a tolerance.
        if wanted.is_nan() || wanted >= 1.0 {
            return Ok(LinearSolution {
                unknowns,
                iterations: 0,
            });
        }
        let own = self.own(&residual);
        drop(residual);
        let (correction, iterations) = self.correction(fixed, &own, wanted)?;
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
            stiffness: self.stiffness.as_deref().map(<[DMat3]>::to_vec),
            preconditioned: self.built_for.as_deref().map(<[DMat3]>::to_vec),
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
            self.rebuild_for(fixed, stiffness.into())?;
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
        let cycled = self.solver()?.precondition(&own)?;
        Ok(self.all(&cycled))
    }
}
