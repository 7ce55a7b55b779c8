//! How levels come about.

use std::sync::Arc;

use glam::DVec3;
use rayon::prelude::*;

use super::aggregation::{self, Reach};
use super::block_jacobi::{self, Factors, InverseFactors};
use super::clusters::Clusters;
use super::coarsest::Dense;
use super::cycle::{Below, Level, Prolongator, Transfer};
use super::galerkin::{self, Coarse, CoarseNodes};
use super::mean_field::{CoarseBasis, MeanField};
use super::prolongation::Unsmoothed;
use super::smoother::Smoother;
use super::sparse::Sparse;
use super::sum_rows::{RowSubset, SumRows};
use super::symmetric::SymmetricMatrix;
use super::triple_product::PartialProduct;
use super::{block_step, parts, spectrum, tentative};
use crate::block_rows::{BlockRows, numbers};
use crate::division::{Communicator, Division};
use crate::failure::MultigridFailure;

/// A level with at most this many scalar unknowns is inverted.
const LARGEST_INVERSE: usize = 400;
/// A next level with more than this share of the nodes is not worth its cost.
const STAGNATION: f64 = 0.8;

/// With more than this share of the rows near to the interface, the others are not worth keeping.
const MOST_NEAR: f64 = 0.5;

/// A level whose matrix has all blocks.
pub(super) type FullLevel<const N: usize> = Level<N, Sparse<N, N>>;

/// What stays when the blocks of the interface change.
#[derive(Debug, Clone, Default)]
pub(super) struct FixedHierarchy {
    pub(super) clusters: Clusters,
    /// Once there is a prolongator, with the rows that the interface changes alone.
    pub(super) basis: CoarseBasis,
    /// To the unknowns of the last finest level. Where the interface changes nothing it stays.
    prolongator: Option<Arc<Prolongator<3>>>,
    /// What the rows far from the interface give to the matrix of the next level, once that is
    /// known.
    far: Option<PartialProduct>,
}

/// A matrix, the rows of each node, and the motions of nodes that cost next to nothing.
#[derive(Clone, Copy)]
pub(super) struct NodeMatrix<'a> {
    pub(super) matrix: BlockRows<'a>,
    /// Node `n` has the rows `offset[n]..offset[n + 1]`, which may be none.
    pub(super) offset: &'a [u32],
    /// Modes of each node with rows.
    pub(super) modes: &'a [[DVec3; 6]],
}

impl FixedHierarchy {
    /// Prepares the hierarchy of a fixed matrix, with the basis that `split` makes of the mean
    /// motions; and storage for the matrix of the first finest level.
    pub(super) fn of(
        nodes: NodeMatrix<'_>,
        split: impl FnOnce(MeanField) -> CoarseBasis,
    ) -> Result<(Self, Sparse<3, 3>), MultigridFailure> {
        let whole = Division::whole(nodes.matrix.rows());
        let (mut hierarchy, means, scaled) = Self::without_basis(nodes, &whole)?;
        hierarchy.basis = split(means);
        Ok((hierarchy, scaled))
    }

    /// The clusters of a matrix, the mean motions and their scaled matrix. Each rank needs the rows
    /// of its division, whose parts have the rows of whole nodes, and makes those of the scaled
    /// matrix.
    pub(super) fn without_basis(
        nodes: NodeMatrix<'_>,
        division: &Division,
    ) -> Result<(Self, MeanField, Sparse<3, 3>), MultigridFailure> {
        let NodeMatrix {
            matrix,
            offset,
            modes,
        } = nodes;
        let has_rows = |node: &u32| offset[*node as usize] < offset[*node as usize + 1];
        let used: Vec<u32> = (0..offset.len() as u32 - 1).filter(has_rows).collect();
        let firsts: Vec<u32> = used.iter().map(|&node| offset[node as usize]).collect();
        let number = numbers(matrix.rows(), &firsts);
        let subset = RowSubset {
            rows: &firsts,
            number: &number,
        };
        let is_whole = firsts.len() == matrix.rows();
        let of_means = SumRows {
            subset: (!is_whole).then_some(subset),
            ..SumRows::of_fixed(matrix)
        };
        let of_firsts = division.of_kept(&firsts);
        let (means, scaled) = MeanField::of((&of_means, &of_firsts), modes, used, offset.len() - 1)
            .map_err(|failure| failure.of_rows(&firsts))?;
        let ties = (&scaled, division.communicator());
        let hierarchy = Self {
            clusters: Clusters::of(ties, means.nodes(), offset),
            ..Self::default()
        };
        Ok((hierarchy, means, scaled))
    }

    /// Whether the next level is worth having.
    pub(super) fn has_next(&self, rows: usize) -> bool {
        let next = self.basis.modes.len();
        3 * rows > LARGEST_INVERSE && next > 0 && next as f64 <= STAGNATION * rows as f64
    }

    /// The finest level of a sum, its matrix in storage that is needed no more, and the next one if
    /// it is worth having.
    pub(super) fn finest(
        &mut self,
        rows: &SumRows<'_>,
        mut matrix: Sparse<3, 3>,
    ) -> Result<(InverseFactors, Level<3>, Option<Coarse>), MultigridFailure> {
        let factors = Factors::of(rows, &self.clusters)?;
        block_jacobi::set_matrix(&mut matrix, rows, &self.clusters, &factors, |_| true);
        let ((matrix, smoother), below, next) = if self.has_next(matrix.rows()) {
            let is_changed = self.is_changed(rows);
            let prolongator = self.prolongator(&is_changed, &factors);
            let product = self.product(&is_changed, &matrix, &prolongator, |_| true);
            // Before the next level asks for memory.
            let half = halved(matrix)?;
            let nodes = (self.basis.nodes(), &Communicator::alone());
            let (next, scaling) = galerkin::coarse(product, nodes);
            let transfer = Transfer {
                prolongator,
                scaling,
            };
            (half, Below::Level(transfer), Some(next))
        } else if matrix.rows() == 0 || 3 * matrix.rows() > LARGEST_INVERSE {
            (halved(matrix)?, Below::Nothing, None)
        } else {
            let dense = Dense::new(&matrix).ok_or(MultigridFailure::NotFinite)?;
            (halved(matrix)?, Below::Inverse(dense), None)
        };
        let level = Level {
            matrix,
            smoother,
            below,
        };
        Ok((factors.compact(), level, next))
    }

    /// Whether the interface adds to a row of each cluster.
    pub(super) fn is_changed(&self, rows: &SumRows<'_>) -> Vec<bool> {
        (0..self.clusters.count())
            .into_par_iter()
            .map(|cluster| rows.is_changed(self.clusters.members.of(cluster)))
            .collect()
    }

    /// The prolongator to the unknowns of a finest level, whose interface changes some clusters.
    /// Levels that have the former one must be gone, or it is copied.
    pub(super) fn prolongator(
        &mut self,
        is_changed: &[bool],
        factors: &Factors,
    ) -> Arc<Prolongator<3>> {
        let clusters = &self.clusters;
        let is_changed = |row: usize| is_changed[clusters.place[row].0 as usize];
        let columns = self.basis.modes.len();
        let basis = &mut self.basis.prolongator;
        if let Some(former) = &mut self.prolongator {
            let all = &mut Arc::make_mut(former).rows;
            let of_clusters = (clusters, factors);
            block_step::smooth_again(all, basis, columns, of_clusters, is_changed);
            return Arc::clone(former);
        }
        let all = block_step::smoothed_by_blocks(basis, columns, clusters, factors);
        *basis = std::mem::take(basis).kept(is_changed);
        let all = Arc::new(Prolongator::of(all, columns));
        self.prolongator = Some(Arc::clone(&all));
        all
    }

    /// What the rows of `A` that are `is_own` give to `P^T A P`, where the interface changes some
    /// clusters.
    pub(super) fn product(
        &mut self,
        is_changed: &[bool],
        matrix: &Sparse<3, 3>,
        prolongator: &Prolongator<3>,
        is_own: impl Fn(usize) -> bool + Sync,
    ) -> PartialProduct {
        let is_changed = |row: usize| is_changed[self.clusters.place[row].0 as usize];
        let is_near =
            |row| is_own(row) && (is_changed(row) || matrix.row(row).any(|(at, _)| is_changed(at)));
        let is_near: Vec<bool> = (0..matrix.rows()).into_par_iter().map(is_near).collect();
        let near = is_near.iter().filter(|near| **near).count();
        let aggregates = prolongator.transpose.columns();
        let of_rows = |is_wanted: &(dyn Fn(usize) -> bool + Sync)| {
            PartialProduct::of_rows(matrix, prolongator, is_wanted)
        };
        if near == 0 || near as f64 > MOST_NEAR * matrix.rows() as f64 {
            return PartialProduct::sum(aggregates, &of_rows(&is_own));
        }
        let far = self.far.take();
        let far = far.unwrap_or_else(|| {
            PartialProduct::sum(aggregates, &of_rows(&|row| is_own(row) && !is_near[row]))
        });
        let near = of_rows(&|row| is_near[row]);
        let whole = PartialProduct::sum(aggregates, std::iter::once(&far).chain(&near));
        self.far = Some(far);
        whole
    }

    /// Frees what only other blocks of the interface would ask for.
    pub(super) fn forget_basis(&mut self) {
        self.basis.prolongator = Sparse::default();
    }

    /// Bytes of storage.
    pub(super) fn bytes(&self) -> usize {
        // The prolongator counts as part of the finest level.
        self.clusters.bytes()
            + self.basis.bytes()
            + self.far.as_ref().map_or(0, PartialProduct::bytes)
    }
}

/// The finest matrix as the cycle keeps it, and its smoother.
fn halved(matrix: Sparse<3, 3>) -> Result<(SymmetricMatrix<3>, Smoother), MultigridFailure> {
    let matrix = SymmetricMatrix::of(matrix);
    let bound = spectrum::largest_eigenvalue_of_halves(&matrix);
    match bound.is_finite() {
        true => Ok((matrix, Smoother::new(bound))),
        false => Err(MultigridFailure::NotFinite),
    }
}

/// A level, and the next one if it is worth having. The ranks divide the work.
pub(super) fn level(
    level: Coarse,
    ranks: &Communicator,
) -> Result<(FullLevel<6>, Option<Coarse>), MultigridFailure> {
    let bound = spectrum::largest_eigenvalue(&level.matrix);
    if !bound.is_finite() {
        return Err(MultigridFailure::NotFinite);
    }
    let (below, next) = below(&level, bound, ranks)?;
    let level = Level {
        matrix: level.matrix,
        smoother: Smoother::new(bound),
        below,
    };
    Ok((level, next))
}

fn below(
    level: &Coarse,
    largest_eigenvalue: f64,
    ranks: &Communicator,
) -> Result<(Below<6>, Option<Coarse>), MultigridFailure> {
    let Coarse {
        matrix,
        modes,
        continuity,
    } = level;
    if 6 * matrix.rows() <= LARGEST_INVERSE {
        let dense = Dense::new(matrix).ok_or(MultigridFailure::NotFinite)?;
        return Ok((Below::Inverse(dense), None));
    }
    let strong = aggregation::strong_neighbours(matrix, modes);
    let whole = aggregation::aggregate(&strong, Reach::Neighbours);
    let aggregates = parts::parts(&whole, level);
    if aggregates.count == 0 || aggregates.count as f64 > STAGNATION * matrix.rows() as f64 {
        return Ok((Below::Nothing, None));
    }
    let tentative = tentative::tentative(&aggregates, modes);
    let unsmoothed = Unsmoothed {
        aggregates: &aggregates,
        tentative: &tentative,
        modes,
    };
    let division = ranks.divide_evenly(matrix.rows());
    let own = division.own();
    let is_own = |row: usize| own.contains(&row);
    let prolongator = unsmoothed.smoothed(matrix, largest_eigenvalue, is_own);
    let prolongator = Prolongator::of(prolongator.completed(&division), aggregates.count);
    let parts = PartialProduct::of_rows(matrix, &prolongator, is_own);
    let product = PartialProduct::sum(aggregates.count, &parts).completed(ranks);
    let nodes = CoarseNodes {
        modes: &tentative.modes,
        continuity: &continuity.of_aggregates(&aggregates, matrix),
    };
    let (coarse, scaling) = galerkin::coarse(product, (nodes, ranks));
    let transfer = Transfer {
        prolongator: Arc::new(prolongator),
        scaling,
    };
    Ok((Below::Level(transfer), Some(coarse)))
}
