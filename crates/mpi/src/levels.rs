//! The levels below the finest one as matrices of PETSc. Each rank makes all of them, see
//! [`LowerLevels`], and gives PETSc the rows that it owns.

use std::sync::Arc;

use kluft_solver::multigrid::{BlockList, CoarsestSolve, LowerLevels};
use kluft_solver::small::{product, transpose};

use crate::lines::EntryShape;
use crate::petsc::{Matrix, PetscFailure, World};

/// Nodes that a rank should have of a level; ranks next to each other give theirs to one of them
/// where they would have fewer, so that small levels need few messages.
const FEWEST_NODES: usize = 32;

/// The nodes of a level and the ranks that own them.
#[derive(Debug)]
struct LevelNodes {
    owner: Vec<u32>,
    /// Global number of each node; those of a rank are consecutive, rank by rank.
    number: Vec<i64>,
    /// Nodes of this rank, ascending.
    own: Vec<u32>,
}

impl LevelNodes {
    /// Gives each node to the rank of the first one above that it moves, `owner`, or the first rank
    /// if there is none.
    fn of(world: &World, mut owner: Vec<u32>) -> Self {
        let count = owner.len();
        let neighbours = (FEWEST_NODES * world.ranks()).div_ceil(count.max(1)) as u32;
        for rank in &mut owner {
            *rank = match *rank {
                u32::MAX => 0,
                rank => rank - rank % neighbours.max(1),
            };
        }
        let mut next = vec![0_i64; world.ranks() + 1];
        for &rank in &owner {
            next[rank as usize + 1] += 1;
        }
        for rank in 0..world.ranks() {
            next[rank + 1] += next[rank];
        }
        let number = owner.iter().map(|&rank| {
            let next = &mut next[rank as usize];
            *next += 1;
            *next - 1
        });
        let is_own = |node: &u32| owner[*node as usize] as usize == world.rank();
        Self {
            number: number.collect(),
            own: (0..count as u32).filter(is_own).collect(),
            owner,
        }
    }

    /// The matrix of a level, whose nodes these are.
    fn matrix(
        &self,
        world: &Arc<World>,
        lower: &LowerLevels,
        level: usize,
    ) -> Result<Matrix, PetscFailure> {
        let sizes = (EntryShape::square(6), [self.own.len(); 2]);
        Matrix::by_rows(world, sizes, |row, blocks| {
            let entries = lower.matrix_row(level, self.own[row]);
            blocks.extend(self.numbered(entries));
        })
    }

    /// The prolongator to a level, whose nodes these are, from those `above`.
    fn prolongator(
        &self,
        world: &Arc<World>,
        lower: &LowerLevels,
        (level, above): (usize, &Self),
    ) -> Result<Matrix, PetscFailure> {
        let sizes = [above.own.len(), self.own.len()];
        let sizes = (EntryShape::of_prolongator(6), sizes);
        Matrix::by_rows(world, sizes, |row, blocks| {
            let entries = lower.prolongator_row(level - 1, above.own[row]);
            blocks.extend(self.numbered(entries));
        })
    }

    /// Blocks by the global numbers of their columns.
    fn numbered<B>(
        &self,
        blocks: impl Iterator<Item = (u32, B)>,
    ) -> impl Iterator<Item = (i64, B)> {
        blocks.map(|(node, block)| (self.number[node as usize], block))
    }
}

/// All levels below the finest one.
pub struct Levels {
    /// Prolongators from them, the largest level first.
    pub prolongators: Vec<Matrix>,
    /// Their matrices.
    pub matrices: Vec<Matrix>,
    /// The inverse of the matrix of the last one, if it is solved by that.
    pub coarsest: Option<Matrix>,
    /// Upper bounds of the spectra of their matrices.
    pub largest_eigenvalues: Vec<f64>,
}

impl Levels {
    /// None: the finest level is all there is.
    pub fn none() -> Self {
        Self {
            prolongators: Vec::new(),
            matrices: Vec::new(),
            coarsest: None,
            largest_eigenvalues: Vec::new(),
        }
    }

    /// From the rows of this rank of the prolongator to the first of the levels that all ranks have
    /// made; `owners` are the ranks of the nodes of that one.
    ///
    /// # Errors
    /// Those of PETSc.
    pub fn of(
        world: &Arc<World>,
        owners: Vec<u32>,
        rows: BlockList<3, 6>,
        lower: &LowerLevels,
    ) -> Result<Self, PetscFailure> {
        let mut nodes = LevelNodes::of(world, owners);
        let sizes = [rows.rows(), nodes.own.len()];
        let sizes = (EntryShape::of_prolongator(3), sizes);
        let to_first = Matrix::by_rows(world, sizes, |row, blocks| {
            let scaled = rows.row(row).map(|(column, block)| {
                let factor = &lower.factors()[column as usize];
                (column, product(block, &transpose(factor)))
            });
            blocks.extend(nodes.numbered(scaled));
        })?;
        drop(rows);
        let mut prolongators = vec![to_first];
        let mut matrices = vec![nodes.matrix(world, lower, 0)?];
        for level in 1..lower.count() {
            let above = nodes;
            nodes = LevelNodes::of(world, owners_below(&above.owner, lower, level));
            prolongators.push(nodes.prolongator(world, lower, (level, &above))?);
            matrices.push(nodes.matrix(world, lower, level)?);
        }
        let coarsest = match lower.coarsest_solve() {
            CoarsestSolve::Inverse => {
                let number = |node: u32| nodes.number[node as usize];
                Some(Matrix::square(world, &lower.inverse(&nodes.own), number)?)
            }
            CoarsestSolve::Smoothing => None,
        };
        let bounds = (0..lower.count()).map(|level| lower.largest_eigenvalue(level));
        Ok(Self {
            prolongators,
            matrices,
            coarsest,
            largest_eigenvalues: bounds.collect(),
        })
    }
}

/// Rank of the first node above that each node of a level moves; none where it moves none.
fn owners_below(above: &[u32], lower: &LowerLevels, level: usize) -> Vec<u32> {
    let mut owners = vec![u32::MAX; lower.nodes(level)];
    for (node, &rank) in above.iter().enumerate() {
        for &below in lower.movers(level - 1, node) {
            let owner = &mut owners[below as usize];
            *owner = if *owner == u32::MAX { rank } else { *owner };
        }
    }
    owners
}
