//! How levels come about.

use glam::DVec3;
use rayon::prelude::*;

use super::clusters::Clusters;
use super::coarsest::Dense;
use super::copies::Copies;
use super::cycle::{Below, Level, Transfer};
use super::galerkin::{self, Coarse};
use super::prolongation;
use super::scaling::{self, Factors, InverseFactors, Modes};
use super::smoother::Smoother;
use super::sparse::{Sparse, Transpose};
use super::tangent::{Kept, TangentRows};
use super::triple_product::Part;
use super::{BlockRows, MultigridFailure, aggregation, numbers, spectrum, tentative};
use crate::assembly::Frame;

/// A level with at most this many scalar unknowns is inverted.
const LARGEST_INVERSE: usize = 400;
/// Blocks whose norm is below this share of the diagonal do not tie nodes together.
pub(super) const STRENGTH: f32 = 0.02;
/// A next level with more than this share of the nodes is not worth its cost.
const STAGNATION: f64 = 0.8;

/// With more than this share of the rows near to fractures, the others are not worth keeping.
const MOST_NEAR: f64 = 0.5;

/// What stays when the stiffness of the fractures changes.
#[derive(Debug, Clone, Default)]
pub(super) struct Base {
    pub(super) clusters: Clusters,
    /// Motions of the next level's nodes, one row an unknown, in unknowns that are not scaled and as if
    /// fractures had no stiffness.
    pub(super) basis: Sparse<3, 6>,
    /// Modes of the next level's nodes.
    pub(super) modes: Vec<Modes<6>>,
    /// What the rows far from fractures give to the matrix of the next level, once that is known.
    far: Option<Part>,
}

/// What is large of a finest level.
#[derive(Debug, Clone, Default)]
pub(super) struct Storage {
    matrix: Sparse<3, 3>,
    prolongator: Sparse<3, 6>,
    restrictor: Sparse<3, 6>,
}

impl Storage {
    /// That of a level which is needed no more.
    pub(super) fn of(level: Level<3>) -> Self {
        let (prolongator, restrictor) = match level.below {
            Below::Level(transfer) => (transfer.prolongator, transfer.restrictor),
            _ => Default::default(),
        };
        Self {
            matrix: level.matrix,
            prolongator,
            restrictor,
        }
    }
}

/// The mean displacements, and the motions of their aggregates.
pub(super) struct Means {
    pub(super) prolongator: Sparse<3, 6>,
    pub(super) transpose: Transpose,
    pub(super) modes: Vec<Modes<6>>,
}

impl Means {
    /// Aggregates rows that are all clusters of their own; and their scaled matrix.
    fn of(
        rows: &TangentRows<'_>,
        modes: &[[DVec3; 6]],
    ) -> Result<(Self, Sparse<3, 3>), MultigridFailure> {
        let single = Clusters::single(rows.count());
        let factors = Factors::of(rows, &single)?;
        let mut matrix = Sparse::default();
        scaling::set_matrix(&mut matrix, rows, &single, &factors);
        let modes = scaling::modes(&factors, modes);
        let bound = spectrum::largest_eigenvalue(&matrix);
        if !bound.is_finite() {
            return Err(MultigridFailure::NotFinite);
        }
        let aggregates = aggregation::aggregate(&matrix, STRENGTH);
        let tentative = tentative::tentative(&aggregates, &modes);
        let mut prolongator = prolongation::smoothed(&matrix, bound, &aggregates, &tentative);
        scaling::unscale(&factors, &mut prolongator);
        let means = Self {
            transpose: Transpose::of(&prolongator, aggregates.count),
            modes: tentative.modes,
            prolongator,
        };
        Ok((means, matrix))
    }
}

impl Base {
    /// Prepares the hierarchy of a matrix; with a `frame`, that of rock which fractures cut.
    pub(super) fn of(
        matrix: BlockRows<'_>,
        modes: &[[DVec3; 6]],
        frame: Option<Frame<'_>>,
    ) -> Result<(Self, Storage), MultigridFailure> {
        let whole: Vec<u32> = (0..=matrix.rows() as u32).collect();
        let node_offset = frame.map_or(&whole[..], |frame| &frame.points.offset);
        let owns = |node: &u32| node_offset[*node as usize] < node_offset[*node as usize + 1];
        let nodes: Vec<u32> = (0..node_offset.len() as u32 - 1).filter(owns).collect();
        let firsts: Vec<u32> = nodes
            .iter()
            .map(|&node| node_offset[node as usize])
            .collect();
        let number = numbers(matrix.rows(), &firsts);
        let kept = Kept {
            rows: &firsts,
            number: &number,
        };
        let is_whole = firsts.len() == matrix.rows();
        let of_means = TangentRows {
            kept: (!is_whole).then_some(kept),
            ..TangentRows::of_rock(matrix)
        };
        let (means, scaled) =
            Means::of(&of_means, modes).map_err(|failure| failure.of_rows(&firsts))?;
        let clusters = Clusters::of(&scaled, &nodes, node_offset);
        let (basis, modes) = match frame {
            None => (means.prolongator, means.modes),
            Some(frame) => {
                let row_of_node = numbers(node_offset.len() - 1, &nodes);
                let copies = Copies::of(frame, &means, &nodes, &row_of_node);
                (copies.prolongator(), copies.modes())
            }
        };
        let base = Self {
            clusters,
            basis,
            modes,
            far: None,
        };
        let storage = Storage {
            matrix: scaled,
            ..Storage::default()
        };
        Ok((base, storage))
    }

    /// Whether the next level is worth having.
    fn has_next(&self, rows: usize) -> bool {
        let next = self.modes.len();
        3 * rows > LARGEST_INVERSE && next > 0 && next as f64 <= STAGNATION * rows as f64
    }

    /// The finest level of a tangent, in the storage of a former one, and the next one if it is worth having.
    pub(super) fn finest(
        &mut self,
        rows: &TangentRows<'_>,
        storage: Storage,
    ) -> Result<(InverseFactors, Level<3>, Option<Coarse>), MultigridFailure> {
        let Storage {
            mut matrix,
            mut prolongator,
            restrictor,
        } = storage;
        let factors = Factors::of(rows, &self.clusters)?;
        scaling::set_matrix(&mut matrix, rows, &self.clusters, &factors);
        let bound = spectrum::largest_eigenvalue(&matrix);
        if !bound.is_finite() {
            return Err(MultigridFailure::NotFinite);
        }
        let (below, next) = if self.has_next(matrix.rows()) {
            let (target, columns) = (&mut prolongator, self.modes.len());
            scaling::set_prolongator(target, &self.basis, columns, &self.clusters, &factors);
            let transpose = Transpose::of(&prolongator, columns);
            let product = self.product(rows, &matrix, &prolongator, &transpose);
            let (transfer, next) =
                descend(product, prolongator, &transpose, restrictor, &self.modes);
            (Below::Level(transfer), Some(next))
        } else if matrix.rows() == 0 || 3 * matrix.rows() > LARGEST_INVERSE {
            (Below::Nothing, None)
        } else {
            let dense = Dense::new(&matrix).ok_or(MultigridFailure::NotFinite)?;
            (Below::Inverse(dense), None)
        };
        let level = Level {
            matrix,
            smoother: Smoother::new(bound),
            below,
        };
        Ok((factors.compact(), level, next))
    }

    /// `P^T A P`.
    fn product(
        &mut self,
        rows: &TangentRows<'_>,
        matrix: &Sparse<3, 3>,
        prolongator: &Sparse<3, 6>,
        transpose: &Transpose,
    ) -> Part {
        let has_springs: Vec<bool> = (0..self.clusters.count())
            .into_par_iter()
            .map(|cluster| rows.has_springs(self.clusters.members.of(cluster)))
            .collect();
        let has_springs = |row: usize| has_springs[self.clusters.place[row].0 as usize];
        let is_near = |row| has_springs(row) || matrix.row(row).any(|(at, _)| has_springs(at));
        let is_near: Vec<bool> = (0..matrix.rows()).into_par_iter().map(is_near).collect();
        let near = is_near.iter().filter(|near| **near).count();
        if near == 0 || near as f64 > MOST_NEAR * matrix.rows() as f64 {
            return Part::whole(matrix, prolongator, transpose);
        }
        let of_rows =
            |near: bool| Part::of_rows(matrix, prolongator, transpose, |row| is_near[row] == near);
        let aggregates = transpose.columns();
        let far = self.far.take();
        let far = far.unwrap_or_else(|| Part::sum(aggregates, &of_rows(false)));
        let near = of_rows(true);
        let whole = Part::sum(aggregates, std::iter::once(&far).chain(&near));
        self.far = Some(far);
        whole
    }

    /// Without what only another stiffness of fractures would ask for.
    pub(super) fn without_basis(self) -> Self {
        Self {
            basis: Sparse::default(),
            ..self
        }
    }

    /// Bytes of storage.
    pub(super) fn bytes(&self) -> usize {
        self.clusters.bytes()
            + self.basis.bytes()
            + size_of_val(&self.modes[..])
            + self.far.as_ref().map_or(0, Part::bytes)
    }
}

/// A level, and the next one if it is worth having.
pub(super) fn level(
    matrix: Sparse<6, 6>,
    modes: &[Modes<6>],
) -> Result<(Level<6>, Option<Coarse>), MultigridFailure> {
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

fn below(
    matrix: &Sparse<6, 6>,
    modes: &[Modes<6>],
    largest_eigenvalue: f64,
) -> Result<(Below<6>, Option<Coarse>), MultigridFailure> {
    if 6 * matrix.rows() <= LARGEST_INVERSE {
        let dense = Dense::new(matrix).ok_or(MultigridFailure::NotFinite)?;
        return Ok((Below::Inverse(dense), None));
    }
    let aggregates = aggregation::aggregate(matrix, STRENGTH);
    if aggregates.count == 0 || aggregates.count as f64 > STAGNATION * matrix.rows() as f64 {
        return Ok((Below::Nothing, None));
    }
    let tentative = tentative::tentative(&aggregates, modes);
    let prolongator = prolongation::smoothed(matrix, largest_eigenvalue, &aggregates, &tentative);
    let transpose = Transpose::of(&prolongator, aggregates.count);
    let product = Part::whole(matrix, &prolongator, &transpose);
    let storage = Sparse::default();
    let (transfer, coarse) = descend(product, prolongator, &transpose, storage, &tentative.modes);
    Ok((Below::Level(transfer), Some(coarse)))
}

/// The way to the level of `P^T A P`, whose nodes have these modes, and that level. `restrictor` is storage.
fn descend<const N: usize>(
    product: Part,
    mut prolongator: Sparse<N, 6>,
    transpose: &Transpose,
    mut restrictor: Sparse<N, 6>,
    modes: &[Modes<6>],
) -> (Transfer<N>, Coarse) {
    let coarse = galerkin::coarse(&product, &mut prolongator, modes);
    drop(product);
    transpose.arrange(&prolongator, &mut restrictor);
    let transfer = Transfer {
        prolongator,
        restrictor,
    };
    (transfer, coarse)
}
