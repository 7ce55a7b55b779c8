//! Smoothed-aggregation algebraic multigrid for elasticity (Vanek, Mandel, Brezina 1996): a
//! preconditioner of conjugate gradients.
//!
//! Each level groups its nodes into aggregates. The motions that cost next to nothing, which are
//! the rigid ones, are kept exactly on every aggregate and smoothed at its edges; they are the six
//! unknowns of one node of the next level. Where an aggregate is to fall into parts that move
//! apart, the basis of the next level is handed in: [`Multigrid::with_basis`]. All levels are
//! stored in single precision, in unknowns that scale their diagonal to the identity; sums of the
//! set-up are in double precision. No result depends on the number of threads.

mod aggregation;
mod block_jacobi;
mod block_list;
mod block_step;
mod clusters;
mod coarsest;
mod continuity;
mod cycle;
mod first_coarsening;
mod galerkin;
mod level_rows;
mod lower_levels;
mod mean_field;
mod parts;
mod places;
mod prolongation;
mod setup;
mod smoother;
mod sparse;
mod spectrum;
mod sum_rows;
mod symmetric;
mod tentative;
#[cfg(test)]
mod tests;
mod triple_product;

use glam::{DMat3, DVec3};
use rayon::prelude::*;

use block_jacobi::InverseFactors;
use cycle::Level;
use setup::{FixedHierarchy, NodeMatrix};
use smoother::Work;
use sparse::Sparse;
use sum_rows::SumRows;
use symmetric::SymmetricMatrix;

use crate::block_rows::BlockRows;
use crate::division::Communicator;
use crate::interface::InterfaceBlocks;

pub use crate::failure::MultigridFailure;
pub use block_list::BlockList;
pub use continuity::Continuity;
pub use first_coarsening::{FirstCoarsening, FirstProlongator, LevelPart, NextPart, OwnRows};
pub use level_rows::{LevelRows, OwnClusters, ProlongatorRows};
pub use lower_levels::{CoarsestSolve, LowerLevels};
pub use mean_field::{CoarseBasis, MeanField};

/// A hierarchy of levels, and the V-cycle over them.
#[derive(Debug, Clone)]
pub struct Multigrid {
    fixed: FixedHierarchy,
    /// Storage for the matrix of the first finest level.
    spare: Sparse<3, 3>,
    factors: InverseFactors,
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
        assert_eq!(modes.len(), matrix.rows(), "one set of modes a row");
        let offset: Vec<u32> = (0..=matrix.rows() as u32).collect();
        let nodes = NodeMatrix {
            matrix,
            offset: &offset,
            modes,
        };
        let (fixed, spare) = FixedHierarchy::of(nodes, MeanField::into_basis)?;
        let mut multigrid = Self::prepared(fixed, Sparse::default());
        multigrid.set_levels(&SumRows::of_fixed(matrix), spare)?;
        multigrid.fixed.forget_basis();
        Ok(multigrid)
    }

    /// Prepares the hierarchy of a matrix whose node `n` has the rows `first_row[n]..first_row[n +
    /// 1]`, which may be none, the first of them being its mean motion; it stands after
    /// [`Self::rebuild`]. `modes` has one entry for each node with rows. `basis` makes the motions
    /// of the next level of those of the means.
    ///
    /// # Errors
    /// If a diagonal block is not positive definite, or an entry not finite.
    pub fn with_basis(
        matrix: BlockRows<'_>,
        first_row: &[u32],
        modes: &[[DVec3; 6]],
        basis: impl FnOnce(&MeanField) -> CoarseBasis,
    ) -> Result<Self, MultigridFailure> {
        let nodes = NodeMatrix {
            matrix,
            offset: first_row,
            modes,
        };
        let (fixed, spare) = FixedHierarchy::of(nodes, |means| basis(&means))?;
        Ok(Self::prepared(fixed, spare))
    }

    /// Without levels.
    fn prepared(fixed: FixedHierarchy, spare: Sparse<3, 3>) -> Self {
        Self {
            fixed,
            spare,
            factors: InverseFactors::default(),
            finest: Level::empty(),
            coarser: Vec::new(),
        }
    }

    /// Takes over the blocks of the interface. What depends on the fixed matrix alone stays, also
    /// when the levels cannot be made; it has none then, until other blocks are taken over.
    ///
    /// # Errors
    /// If a diagonal block is not positive definite, or an entry not finite.
    pub fn rebuild(
        &mut self,
        matrix: BlockRows<'_>,
        interface: InterfaceBlocks<'_>,
    ) -> Result<(), MultigridFailure> {
        // The old levels make room for the new ones.
        self.finest = Level::empty();
        self.coarser.clear();
        let spare = std::mem::take(&mut self.spare);
        let rows = SumRows {
            interface: Some(interface),
            ..SumRows::of_fixed(matrix)
        };
        self.set_levels(&rows, spare)
    }

    fn set_levels(
        &mut self,
        rows: &SumRows<'_>,
        spare: Sparse<3, 3>,
    ) -> Result<(), MultigridFailure> {
        let (factors, finest, mut next) = self.fixed.finest(rows, spare)?;
        let mut coarser = Vec::new();
        while let Some(coarse) = next {
            let (level, below) = setup::level(coarse, &Communicator::alone())?;
            coarser.push(level.compact());
            next = below;
        }
        (self.factors, self.finest, self.coarser) = (factors, finest, coarser);
        Ok(())
    }

    /// Smooths for spectra that reach further by `margin` than their bounds say.
    pub fn widen(&mut self, margin: f64) {
        self.finest.smoother = self.finest.smoother.with_margin(margin);
        for level in &mut self.coarser {
            level.smoother = level.smoother.with_margin(margin);
        }
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
        let rows = self.finest.matrix.rows();
        assert_eq!(residual.len(), rows, "one entry a row");
        assert_eq!(correction.len(), rows, "one entry a row");
        let Workspace { finest, coarser } = workspace;
        let unit = unit(&[bytemuck::cast_slice(residual)]);
        let (factors, clusters) = (&self.factors, &self.fixed.clusters);
        factors.to_scaled(clusters, residual, unit, &mut finest.rhs);
        self.finest.cycle(finest, &self.coarser, coarser);
        factors.unscaled(clusters, &finest.solution, unit, correction);
    }

    /// The block Jacobi method: what the clusters alone, each by itself, do about a residual.
    pub fn clusters_alone(&self, residual: &[DVec3]) -> Vec<DVec3> {
        let unit = unit(&[bytemuck::cast_slice(residual)]);
        let (factors, clusters) = (&self.factors, &self.fixed.clusters);
        let mut scaled = vec![[0.0; 3]; residual.len()];
        factors.to_scaled(clusters, residual, unit, &mut scaled);
        let mut correction = vec![DVec3::ZERO; residual.len()];
        factors.unscaled(clusters, &scaled, unit, &mut correction);
        correction
    }

    /// Bytes of the hierarchy, workspace not included.
    pub fn memory_bytes(&self) -> usize {
        let coarser: usize = self.coarser.iter().map(Level::bytes).sum();
        self.fixed.bytes() + self.factors.bytes() + self.finest.bytes() + coarser
    }

    /// Number of clusters: of groups of unknowns that the smoother inverts exactly.
    pub fn cluster_count(&self) -> usize {
        self.fixed.clusters.count()
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

fn size<const N: usize>(matrix: &SymmetricMatrix<N>) -> LevelSize {
    let nodes = matrix.rows();
    LevelSize {
        nodes,
        unknowns: N * nodes,
        entries: N * N * (nodes + matrix.block_count()),
    }
}

/// Power of two near the largest component of some vectors: single precision then neither overflows
/// nor underflows, and the map stays linear to the last bit.
fn unit(vectors: &[&[f64]]) -> f64 {
    let largest = |vector: &&[f64]| {
        let sizes = vector.par_iter().with_min_len(12288).map(|x| x.abs());
        sizes.reduce(|| 0.0, f64::max)
    };
    let largest = vectors.iter().map(largest).fold(0.0, f64::max);
    match largest > 0.0 && largest.is_finite() {
        true => largest.log2().floor().exp2(),
        false => 1.0,
    }
}
