//! The first coarsening of a matrix whose rows many processes share: what a multigrid framework
//! needs of the rows of one of them.
//!
//! With the clusters `C` of unknowns, `A = R + S` of a fixed matrix and an interface, `A_CC = L
//! L^T`, and the basis `P` of the fixed one, that is the matrix `L^-1 A L^-T` of scaled unknowns
//! and a bound of its spectrum, the prolongator `L^-1 R P` to these unknowns, and what the rows
//! give to the matrix of the next level. What all of them give makes the [`LowerLevels`].

use std::sync::Arc;

use glam::DVec3;
use rayon::prelude::*;

use super::block_jacobi::{self, Factors};
use super::cycle::{Prolongator, Transfer};
use super::level_rows::{LevelRows, OwnClusters, ProlongatorRows};
use super::lower_levels::LowerLevels;
use super::mean_field::{CoarseBasis, MeanField};
use super::setup::{FixedHierarchy, NodeMatrix};
use super::sparse::Sparse;
use super::spectrum;
use super::sum_rows::SumRows;
use super::triple_product::PartialProduct;
use crate::block_pattern::BlockPattern;
use crate::block_rows::BlockRows;
use crate::division::{Communicator, Division};
use crate::failure::MultigridFailure;
use crate::interface::InterfaceBlocks;

/// Clusters and basis, made once for a fixed matrix.
#[derive(Debug, Clone)]
pub struct FirstCoarsening {
    fixed: FixedHierarchy,
}

/// Rows of some whole clusters, those of one process, with the clusters factorised that they couple
/// to.
pub struct OwnRows<'a> {
    rows: SumRows<'a>,
    own: &'a [u32],
    is_own: Vec<bool>,
    factors: Factors,
}

/// What some rows give to a hierarchy. The lists have one row for each of them.
#[derive(Debug, Clone)]
pub struct LevelPart {
    /// `L` of the clusters of these rows.
    pub clusters: OwnClusters,
    /// `L^-1 A L^-T`.
    pub matrix: LevelRows<3>,
    /// Upper bound of its eigenvalues.
    pub largest_eigenvalue: f64,
    /// `L^-1 R P`; columns are nodes of the next level. Once it is gone the next one is made in
    /// its memory.
    pub prolongator: FirstProlongator,
    /// What they add to the matrix of the next level.
    pub next: NextPart,
}

/// Some rows of the prolongator to the finest level, from unknowns of the next one that are not
/// scaled.
#[derive(Debug, Clone)]
pub struct FirstProlongator {
    all: Arc<Prolongator<3>>,
    own: Vec<u32>,
}

/// What some rows add to the matrix of the next level.
#[derive(Debug, Clone)]
pub struct NextPart(PartialProduct);

impl FirstCoarsening {
    /// Prepares the coarsening of a fixed matrix, but for its basis, which is made of the mean
    /// motions; other arguments are those of [`super::Multigrid::with_basis`]. The matrix needs the
    /// rows that `division` gives this rank: those of whole nodes.
    ///
    /// # Errors
    /// If a diagonal block is not positive definite, or an entry not finite.
    pub fn of(
        (matrix, division): (BlockRows<'_>, &Division),
        first_row: &[u32],
        modes: &[[DVec3; 6]],
    ) -> Result<(Self, MeanField), MultigridFailure> {
        let nodes = NodeMatrix {
            matrix,
            offset: first_row,
            modes,
        };
        let (fixed, means, _) = FixedHierarchy::without_basis(nodes, division)?;
        Ok((Self { fixed }, means))
    }

    /// Takes the motions of the next level. Those of the rows that [`Self::factorised`] has to do
    /// with must be there.
    pub fn set_basis(&mut self, basis: CoarseBasis) {
        self.fixed.basis = basis;
    }

    /// Rank of each row: that of the lowest row of its cluster.
    pub fn owners(&self, division: &Division) -> Vec<u32> {
        let clusters = &self.fixed.clusters;
        let lowest = clusters.place.par_iter().map(|(cluster, _)| {
            let members = clusters.members.of(*cluster as usize);
            division.owner(members[0] as usize) as u32
        });
        lowest.collect()
    }

    /// Rows of the clusters that have or are coupled to one of the rows `own`, ascending, in a
    /// matrix with this pattern.
    pub fn beside(&self, own: &[u32], pattern: &BlockPattern) -> Vec<u32> {
        let clusters = &self.fixed.clusters;
        let mut is_beside = vec![false; clusters.count()];
        for column in own.iter().flat_map(|&row| pattern.row(row as usize)) {
            let (cluster, _) = clusters.place[pattern.columns[column] as usize];
            is_beside[cluster as usize] = true;
        }
        let rows = 0..clusters.place.len() as u32;
        rows.filter(|&row| is_beside[clusters.place[row as usize].0 as usize])
            .collect()
    }

    /// Whether two rows are those of one cluster.
    pub fn is_within_cluster(&self, row: u32, column: u32) -> bool {
        let cluster = |row: u32| self.fixed.clusters.place[row as usize].0;
        cluster(row) == cluster(column)
    }

    /// Number of nodes of the next level.
    pub fn next_nodes(&self) -> usize {
        self.fixed.basis.modes.len()
    }

    /// Whether the next level of a matrix with so many rows is worth having.
    pub fn has_next(&self, rows: usize) -> bool {
        self.fixed.has_next(rows)
    }

    /// Factorises the clusters of the rows `own`, ascending, and those that they couple to. The
    /// matrix needs these rows, and of those that they couple to the blocks within their clusters.
    ///
    /// # Errors
    /// If a diagonal block is not positive definite.
    pub fn factorised<'a>(
        &self,
        matrix: BlockRows<'a>,
        interface: InterfaceBlocks<'a>,
        own: &'a [u32],
    ) -> Result<OwnRows<'a>, MultigridFailure> {
        let rows = SumRows {
            interface: Some(interface),
            ..SumRows::of_fixed(matrix)
        };
        let clusters = &self.fixed.clusters;
        let mut is_own = vec![false; rows.count()];
        let mut is_wanted = vec![false; clusters.count()];
        for &row in own {
            is_own[row as usize] = true;
            rows.for_each(row as usize, |column, _| {
                is_wanted[clusters.place[column as usize].0 as usize] = true;
            });
        }
        Ok(OwnRows {
            factors: Factors::of_some(&rows, clusters, |cluster| is_wanted[cluster])?,
            rows,
            own,
            is_own,
        })
    }

    /// What rows give to the hierarchy. `complete` replaces the entries of a vector that belong to
    /// other rows by what their owners have there.
    pub fn part(&mut self, rows: &OwnRows<'_>, complete: impl FnMut(&mut [[f32; 3]])) -> LevelPart {
        let is_changed = self.fixed.is_changed(&rows.rows);
        let prolongator = self.fixed.prolongator(&is_changed, &rows.factors);
        let mut matrix = Sparse::default();
        let is_own = |row: usize| rows.is_own[row];
        let clusters = &self.fixed.clusters;
        block_jacobi::set_matrix(&mut matrix, &rows.rows, clusters, &rows.factors, is_own);
        let next = self
            .fixed
            .product(&is_changed, &matrix, &prolongator, is_own);
        let largest_eigenvalue = spectrum::largest_eigenvalue_of_rows(&matrix, complete);
        LevelPart {
            clusters: OwnClusters::of(&self.fixed.clusters, &rows.factors, rows.own),
            matrix: LevelRows::of(matrix, rows.own),
            largest_eigenvalue,
            prolongator: FirstProlongator {
                all: prolongator,
                own: rows.own.to_vec(),
            },
            next: NextPart(next.without_empty()),
        }
    }

    /// The levels below, from what the rows of each process give to the next one.
    ///
    /// # Errors
    /// If an entry is not finite.
    pub fn levels_below(
        &self,
        NextPart(own): NextPart,
        communicator: &Communicator,
    ) -> Result<LowerLevels, MultigridFailure> {
        let parts = own.gathered(communicator);
        LowerLevels::of(parts, self.fixed.basis.nodes(), communicator)
    }
}

impl FirstProlongator {
    /// Nodes of the next level that move the row with a place among these, ascending.
    pub fn movers(&self, place: usize) -> &[u32] {
        let rows = &self.all.rows;
        &rows.columns[rows.range(self.own[place] as usize)]
    }

    /// The way from the levels below, of whose first one this process has the nodes `own`. Its
    /// scaling is no longer there.
    pub fn from(self, lower: &mut LowerLevels, own: &[u32]) -> ProlongatorRows<3> {
        let transfer = Transfer {
            prolongator: self.all,
            scaling: lower.take_scaling(),
        };
        ProlongatorRows::of(transfer, self.own, own)
    }
}
