//! Smoothed-aggregation algebraic multigrid for elasticity (Vanek, Mandel, Brezina 1996): a
//! preconditioner of conjugate gradients.
//!
//! Each level groups its nodes into aggregates. The motions that cost next to nothing, which are
//! the rigid ones, are kept exactly on every aggregate and smoothed at its edges; they are the six
//! unknowns of one node of the next level. All levels are stored in single precision, in unknowns
//! that scale their diagonal to the identity; sums of the set-up are in double precision.
//! No result depends on the number of threads.

mod aggregation;
mod block_rows;
mod coarsest;
mod cycle;
mod galerkin;
mod prolongation;
mod scaling;
pub(crate) mod small;
mod smoother;
mod sparse;
mod spectrum;
mod tentative;
#[cfg(test)]
mod tests;

use glam::{DMat3, DVec3};
use rayon::prelude::*;

pub use block_rows::{BlockRows, OwnedBlockRows};
pub(crate) use block_rows::{DROPPED, numbers};
use coarsest::Dense;
use cycle::{Below, Level, Transfer};
use galerkin::Coarse;
use scaling::{Factors, Modes, Selection};
use smoother::{Smoother, Work};
use sparse::{Sparse, Transpose};

/// A level with at most this many scalar unknowns is inverted.
const LARGEST_INVERSE: usize = 600;
/// Blocks whose norm is below this share of the diagonal do not tie nodes together.
const STRENGTH: f32 = 0.02;
/// A next level with more than this share of the nodes is not worth its cost.
const STAGNATION: f64 = 0.8;

/// Why a hierarchy could not be built.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MultigridFailure {
    /// The diagonal block of this row (of those kept) is not positive definite, or not finite.
    NotPositive(usize),
    /// The matrix or the modes of some level have entries that are not finite.
    NotFinite,
}

/// A hierarchy of levels, and the V-cycle over them.
#[derive(Debug, Clone)]
pub struct Multigrid {
    factors: Factors,
    finest: Level<3>,
    coarser: Vec<Level<6>>,
}

/// Size of a level.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LevelSize {
    /// Nodes.
    pub nodes: usize,
    /// Scalar unknowns.
    pub unknowns: usize,
    /// Scalar entries of the matrix, its diagonal blocks included.
    pub entries: usize,
}

/// Vectors for [`Multigrid::apply`].
#[derive(Debug, Clone)]
pub struct Workspace {
    finest: Work<3>,
    coarser: Vec<Work<6>>,
}

impl Multigrid {
    /// Builds the hierarchy of a symmetric positive definite matrix.
    ///
    /// `modes` are the six vectors of each node that cost next to nothing: [`rigid_modes`].
    ///
    /// # Errors
    /// If a diagonal block is not positive definite, or an entry not finite.
    ///
    /// # Panics
    /// If `modes` has not one entry a row.
    pub fn new(matrix: BlockRows<'_>, modes: &[[DVec3; 6]]) -> Result<Self, MultigridFailure> {
        let all: Vec<u32> = (0..matrix.rows() as u32).collect();
        Self::of_sub_block(matrix, &all, modes)
    }

    /// Builds the hierarchy of the rows and columns `kept` (ascending) of a larger matrix, without
    /// a copy of them in double precision; `modes` has one entry for each of them.
    ///
    /// # Errors
    /// If a diagonal block is not positive definite, or an entry not finite.
    ///
    /// # Panics
    /// If `modes` has not one entry a kept row.
    pub fn of_sub_block(
        matrix: BlockRows<'_>,
        kept: &[u32],
        modes: &[[DVec3; 6]],
    ) -> Result<Self, MultigridFailure> {
        assert_eq!(kept.len(), modes.len(), "one set of modes a row");
        let number = block_rows::numbers(matrix.rows(), kept);
        let selection = Selection {
            matrix,
            kept,
            number: &number,
        };
        let factors = scaling::factors(selection)?;
        let scaled = scaling::matrix(selection, &factors);
        let scaled_modes = scaling::modes(selection, &factors, modes);
        let factors = scaling::compact(&factors);
        let (finest, mut next) = level(scaled, &scaled_modes)?;
        let mut coarser = Vec::new();
        while let Some(Coarse { matrix, modes }) = next {
            let (level, below) = level(matrix, &modes)?;
            coarser.push(level);
            next = below;
        }
        Ok(Self {
            factors,
            finest,
            coarser,
        })
    }

    /// Vectors for [`Self::apply`].
    pub fn workspace(&self) -> Workspace {
        let coarser = self.coarser.iter();
        Workspace {
            finest: Work::new(self.finest.matrix.rows()),
            coarser: coarser
                .map(|level| Work::new(level.matrix.rows()))
                .collect(),
        }
    }

    /// `z = M^-1 r`: one V-cycle, a symmetric positive definite map up to single precision.
    ///
    /// Both vectors have one entry a block row; nothing is allocated.
    ///
    /// # Panics
    /// If the lengths of the vectors differ from the number of rows.
    pub fn apply(&self, residual: &[DVec3], correction: &mut [DVec3], workspace: &mut Workspace) {
        assert_eq!(residual.len(), self.factors.len(), "one entry a row");
        assert_eq!(correction.len(), self.factors.len(), "one entry a row");
        let Workspace { finest, coarser } = workspace;
        let unit = unit(residual);
        scaling::to_scaled(&self.factors, residual, unit, &mut finest.right);
        self.finest.cycle(finest, &self.coarser, coarser);
        scaling::from_scaled(&self.factors, &finest.solution, unit, correction);
    }

    /// Bytes of the hierarchy, workspace not included.
    pub fn memory_bytes(&self) -> usize {
        let coarser: usize = self.coarser.iter().map(Level::bytes).sum();
        size_of_val(&self.factors[..]) + self.finest.bytes() + coarser
    }

    /// Sizes of the levels, the finest first.
    pub fn level_sizes(&self) -> Vec<LevelSize> {
        let coarser = self.coarser.iter().map(|level| size(&level.matrix));
        std::iter::once(size(&self.finest.matrix))
            .chain(coarser)
            .collect()
    }
}

/// Six rigid motions at a position, as far as a node there may follow them: translations along and
/// rotations about the axes through `centre`, each projected by `free` (`P` of a held node, the
/// identity of others). Any centre will do; one in the middle of the body rounds least.
pub fn rigid_modes(position: DVec3, centre: DVec3, free: DMat3) -> [DVec3; 6] {
    let arm = position - centre;
    let turn = |axis: DVec3| free * axis.cross(arm);
    [
        free.x_axis,
        free.y_axis,
        free.z_axis,
        turn(DVec3::X),
        turn(DVec3::Y),
        turn(DVec3::Z),
    ]
}

fn size<const N: usize>(matrix: &Sparse<N, N>) -> LevelSize {
    let nodes = matrix.rows();
    LevelSize {
        nodes,
        unknowns: N * nodes,
        entries: N * N * (nodes + matrix.blocks.len()),
    }
}

/// Power of two near the largest component: single precision then neither overflows nor underflows,
/// and the map stays linear to the last bit.
fn unit(vector: &[DVec3]) -> f64 {
    let largest = vector
        .par_iter()
        .with_min_len(4096)
        .map(|v| v.abs().max_element())
        .reduce(|| 0.0, f64::max);
    match largest > 0.0 && largest.is_finite() {
        true => largest.log2().floor().exp2(),
        false => 1.0,
    }
}

/// A level, and the next one if it is worth having.
fn level<const N: usize>(
    matrix: Sparse<N, N>,
    modes: &[Modes<N>],
) -> Result<(Level<N>, Option<Coarse>), MultigridFailure> {
    let bound = spectrum::largest_eigenvalue(&matrix);
    if !bound.is_finite() {
        return Err(MultigridFailure::NotFinite);
    }
    let (below, next) = below(&matrix, modes, bound)?;
    let smoother = Smoother::new(bound);
    let level = Level {
        matrix,
        smoother,
        below,
    };
    Ok((level, next))
}

fn below<const N: usize>(
    matrix: &Sparse<N, N>,
    modes: &[Modes<N>],
    largest_eigenvalue: f64,
) -> Result<(Below<N>, Option<Coarse>), MultigridFailure> {
    if matrix.rows() == 0 {
        return Ok((Below::Nothing, None));
    }
    if N * matrix.rows() <= LARGEST_INVERSE {
        let dense = Dense::new(matrix).ok_or(MultigridFailure::NotFinite)?;
        return Ok((Below::Inverse(dense), None));
    }
    let aggregates = aggregation::aggregate(matrix, STRENGTH);
    if aggregates.count == 0 || aggregates.count as f64 > STAGNATION * matrix.rows() as f64 {
        return Ok((Below::Nothing, None));
    }
    let tentative = tentative::tentative(&aggregates, modes);
    let mut prolongator =
        prolongation::smoothed(matrix, largest_eigenvalue, &aggregates, &tentative);
    let transpose = Transpose::of(&prolongator, aggregates.count);
    let coarse = galerkin::coarse(matrix, &mut prolongator, &transpose, &tentative.modes);
    let transfer = Transfer {
        prolongator,
        transpose,
    };
    Ok((Below::Level(transfer), Some(coarse)))
}
