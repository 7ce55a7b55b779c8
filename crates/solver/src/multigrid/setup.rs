//! How levels come about.

use glam::DVec3;

use super::clusters::Clusters;
use super::coarsest::Dense;
use super::copies::{Copies, Topology};
use super::cycle::{Below, Level, Transfer};
use super::galerkin::{self, Coarse};
use super::prolongation;
use super::scaling::{self, Factors, InverseFactors, Modes};
use super::small::{add, narrow, product, widen};
use super::smoother::Smoother;
use super::sparse::{Accumulator, Sparse, Transpose, rows_per_task};
use super::tangent::{Kept, Springs, TangentRows, rows_of};
use super::triple_product::Part;
use super::{BlockRows, MultigridFailure, aggregation, numbers, spectrum, tentative};

/// A level with at most this many scalar unknowns is inverted.
const LARGEST_INVERSE: usize = 400;
/// Blocks whose norm is below this share of the diagonal do not tie nodes together.
pub(super) const STRENGTH: f32 = 0.02;
/// A next level with more than this share of the nodes is not worth its cost.
const STAGNATION: f64 = 0.8;

/// What stays when the stiffness of the fractures changes.
#[derive(Debug, Clone, Default)]
pub(super) struct Base {
    pub(super) clusters: Clusters,
    /// Motions of the next level's nodes, one row an unknown, in unknowns that are not scaled.
    pub(super) basis: Sparse<3, 6>,
    /// Modes of the next level's nodes; none, if there is no next level.
    pub(super) modes: Vec<Modes<6>>,
    /// The rock's part of the next level.
    rock: Option<Part>,
}

/// The finest level before the next one is made.
pub(super) struct Parts {
    factors: Factors,
    pub(super) storage: Storage,
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
    ) -> Result<(Self, Factors, Sparse<3, 3>), MultigridFailure> {
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
        Ok((means, factors, matrix))
    }
}

impl Base {
    /// Prepares the hierarchy of a matrix; with a `topology`, that of rock which fractures cut.
    pub(super) fn of(
        matrix: BlockRows<'_>,
        modes: &[[DVec3; 6]],
        topology: Option<Topology<'_>>,
    ) -> Result<(Self, Parts), MultigridFailure> {
        let rows = TangentRows {
            rock: matrix,
            springs: None,
            kept: None,
        };
        let whole: Vec<u32> = (0..=matrix.rows() as u32).collect();
        let node_offset = topology.map_or(&whole[..], |topology| &topology.frame.points.offset);
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
            ..rows
        };
        let (means, factors, scaled) =
            Means::of(&of_means, modes).map_err(|failure| failure.of_rows(&firsts))?;
        let clusters = Clusters::of(&scaled, &nodes, node_offset);
        let (basis, modes) = match topology {
            None => (means.prolongator, means.modes),
            Some(topology) => {
                let row_of_node = numbers(node_offset.len() - 1, &nodes);
                let copies = Copies::of(topology, &means, &nodes, &row_of_node);
                (copies.prolongator(), copies.modes())
            }
        };
        let mut base = Self {
            clusters,
            basis,
            modes,
            rock: None,
        };
        let is_single = base.clusters.count() == scaled.rows();
        let storage = Storage {
            matrix: scaled,
            ..Storage::default()
        };
        let parts = match is_single {
            true if is_whole => base.parts_with(storage, factors),
            _ => {
                drop(factors);
                base.parts(&rows, storage)?
            }
        };
        if base.has_next(matrix.rows()) {
            let (matrix, prolongator) = (&parts.storage.matrix, &parts.storage.prolongator);
            let transpose = Transpose::of(prolongator, base.modes.len());
            base.rock = Some(Part::whole(matrix, prolongator, &transpose));
        }
        Ok((base, parts))
    }

    fn has_next(&self, rows: usize) -> bool {
        let next = self.modes.len();
        3 * rows > LARGEST_INVERSE && next > 0 && next as f64 <= STAGNATION * rows as f64
    }

    /// The finest level of a tangent, in the storage of a former one.
    pub(super) fn parts(
        &self,
        rows: &TangentRows<'_>,
        mut storage: Storage,
    ) -> Result<Parts, MultigridFailure> {
        let factors = Factors::of(rows, &self.clusters)?;
        scaling::set_matrix(&mut storage.matrix, rows, &self.clusters, &factors);
        Ok(self.parts_with(storage, factors))
    }

    /// The finest level whose matrix stands.
    fn parts_with(&self, mut storage: Storage, factors: Factors) -> Parts {
        let (target, columns) = (&mut storage.prolongator, self.modes.len());
        scaling::set_prolongator(target, &self.basis, columns, &self.clusters, &factors);
        Parts { factors, storage }
    }

    /// The finest level, and the next one if it is worth having.
    pub(super) fn finest(
        &self,
        parts: Parts,
        springs: Option<Springs<'_>>,
    ) -> Result<(InverseFactors, Level<3>, Option<Coarse>), MultigridFailure> {
        let Parts { factors, storage } = parts;
        let Storage {
            matrix,
            prolongator,
            mut restrictor,
        } = storage;
        let bound = spectrum::largest_eigenvalue(&matrix);
        if !bound.is_finite() {
            return Err(MultigridFailure::NotFinite);
        }
        let (below, next) = match &self.rock {
            None if matrix.rows() == 0 || 3 * matrix.rows() > LARGEST_INVERSE => {
                (Below::Nothing, None)
            }
            None => (
                Below::Inverse(Dense::new(&matrix).ok_or(MultigridFailure::NotFinite)?),
                None,
            ),
            Some(rock) => {
                let (next, factors) = match springs.map(|springs| self.of_springs(springs)) {
                    Some(springs) => {
                        let sum = Part::sum(self.modes.len(), &[rock, &springs]);
                        Coarse::of(&sum, &self.modes)
                    }
                    None => Coarse::of(rock, &self.modes),
                };
                let transpose = Transpose::of(&prolongator, self.modes.len());
                transpose.arrange(&prolongator, &mut restrictor);
                let transfer = Transfer {
                    restrictor,
                    prolongator,
                    factors: factors.iter().map(narrow).collect(),
                };
                (Below::Level(transfer), Some(next))
            }
        };
        let level = Level {
            matrix,
            smoother: Smoother::new(bound),
            below,
        };
        Ok((factors.compact(), level, next))
    }

    /// `P^T S P` of the springs.
    fn of_springs(&self, springs: Springs<'_>) -> Part {
        let rows = springs.rows;
        let copies = self.modes.len();
        let prolongator = self.basis.of_rows(rows);
        let transpose = Transpose::of(&prolongator, copies);
        let image = Sparse::build(
            rows.len(),
            rows_per_task::<3>(),
            || Accumulator::<3, 6>::new(copies),
            |sums, row| {
                for (column, _) in springs.row(row) {
                    let columns = &self.basis.columns[self.basis.range(column as usize)];
                    columns.iter().for_each(|&column| sums.touch(column));
                }
                sums.take_count()
            },
            #[inline(always)]
            |sums, row, columns, blocks| {
                for (at, block) in springs.row(row) {
                    // In double precision: a spring and the motions of its walls differ by many digits.
                    let left = rows_of(block);
                    for (column, value) in self.basis.row(at as usize) {
                        add(sums.at(column as u32), 1.0, &product(&left, &widen(value)));
                    }
                }
                sums.take(columns, blocks);
            },
        );
        Part::of_image(&prolongator, &transpose, &(0..rows.len()), &image)
    }

    /// Without what only another stiffness of fractures would ask for.
    pub(super) fn without_rock(self) -> Self {
        Self {
            basis: Sparse::default(),
            rock: None,
            ..self
        }
    }

    /// Bytes of storage.
    pub(super) fn bytes(&self) -> usize {
        self.clusters.bytes()
            + self.basis.bytes()
            + size_of_val(&self.modes[..])
            + self.rock.as_ref().map_or(0, Part::bytes)
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
    let mut prolongator =
        prolongation::smoothed(matrix, largest_eigenvalue, &aggregates, &tentative);
    let transpose = Transpose::of(&prolongator, aggregates.count);
    let coarse = galerkin::coarse(matrix, &mut prolongator, &transpose, &tentative.modes);
    let mut restrictor = Sparse::default();
    transpose.arrange(&prolongator, &mut restrictor);
    let transfer = Transfer {
        restrictor,
        prolongator,
        factors: Vec::new(),
    };
    Ok((Below::Level(transfer), Some(coarse)))
}
