//! The levels below the finest one as matrices of PETSc. Each rank makes all of them, see
//! [`LowerLevels`], and gives PETSc the rows that it owns.

use std::sync::Arc;

use kluft_solver::multigrid::{BlockList, CoarsestSolve, LevelPart, LowerLevels};
use kluft_solver::small::{product, transpose};

use crate::petsc::{Matrix, PetscFailure, World};

/// Nodes that a rank should have of a level; ranks next to each other give theirs to one of them
/// where they would have fewer, so that small levels need few messages.
const FEWEST_NODES: usize = 32;

/// Row, column and entries of a block.
type BlockRecord = [f64; 38];

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
    /// Gives each of `count` nodes to the rank of the first one above that it moves. `movers` tells
    /// which nodes move one above.
    fn of<I: IntoIterator<Item = u32>>(
        world: &World,
        owner_above: &[u32],
        count: usize,
        movers: impl Fn(usize) -> I,
    ) -> Self {
        let mut owner = vec![u32::MAX; count];
        for (above, rank) in owner_above.iter().enumerate() {
            for node in movers(above) {
                let owner = &mut owner[node as usize];
                *owner = if *owner == u32::MAX { *rank } else { *owner };
            }
        }
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

    /// The rows of a matrix between these nodes, on this rank.
    fn matrix(&self, world: &Arc<World>, rows: &BlockList<6, 6>) -> Result<Matrix, PetscFailure> {
        Matrix::of_level(world, rows, |node| self.number[node as usize])
    }

    /// The rows of the prolongator from these nodes, on this rank.
    fn prolongator<const M: usize>(
        &self,
        world: &Arc<World>,
        rows: &BlockList<M, 6>,
    ) -> Result<Matrix, PetscFailure> {
        let number = |node: u32| self.number[node as usize];
        Matrix::prolongator(world, rows, self.own.len(), number)
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

    /// From what the rows of this rank give to the hierarchy, and the levels that those of all
    /// ranks make. `owner` is that of the rows, `movers` tells which nodes of the next level move
    /// one. Takes the prolongator to the first level, scaled, out of the part.
    ///
    /// # Errors
    /// Those of PETSc.
    pub fn of(
        world: &Arc<World>,
        owner: &[u32],
        part: &mut LevelPart,
        lower: &LowerLevels,
        movers: impl Fn(usize) -> Vec<u32>,
    ) -> Result<Self, PetscFailure> {
        let mut prolongator = std::mem::take(&mut part.prolongator);
        for (block, &column) in prolongator.blocks.iter_mut().zip(&prolongator.columns) {
            *block = product(block, &transpose(&lower.factors()[column as usize]));
        }
        let mut nodes = LevelNodes::of(world, owner, lower.nodes(0), movers);
        let mut prolongators = vec![nodes.prolongator(world, &prolongator)?];
        drop(prolongator);
        let mut matrices = vec![nodes.matrix(world, &lower.matrix(0, &nodes.own))?];
        for level in 1..lower.count() {
            let above = nodes;
            nodes = LevelNodes::of(world, &above.owner, lower.nodes(level), |node| {
                lower.movers(level - 1, node).iter().copied()
            });
            let rows = lower.prolongator(level - 1, &above.own);
            prolongators.push(nodes.prolongator(world, &rows)?);
            matrices.push(nodes.matrix(world, &lower.matrix(level, &nodes.own))?);
        }
        let coarsest = match lower.coarsest_solve() {
            CoarsestSolve::Inverse => Some(nodes.matrix(world, &lower.inverse(&nodes.own))?),
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

/// What the rows of each rank give to the matrix of the next level.
///
/// # Errors
/// Those of MPI.
pub fn gathered_parts(
    world: &World,
    own: &BlockList<6, 6>,
) -> Result<Vec<BlockList<6, 6>>, PetscFailure> {
    let mut records: Vec<BlockRecord> = Vec::with_capacity(own.columns.len());
    for row in 0..own.rows() {
        for (column, block) in own.row(row) {
            let mut record = [0.0; 38];
            (record[0], record[1]) = (row as f64, f64::from(column));
            record[2..].copy_from_slice(block.as_flattened());
            records.push(record);
        }
    }
    let counts = world.gather(&[records.len() as u64])?;
    let counts: Vec<i32> = counts.into_iter().map(|count| count as i32).collect();
    let all = world.gather_records(&records, &counts)?;
    drop(records);
    let mut rest = all.as_slice();
    let parts = counts.iter().map(|&count| {
        let (part, tail) = rest.split_at(count as usize);
        rest = tail;
        part_of(part, own.rows())
    });
    Ok(parts.collect())
}

fn part_of(records: &[BlockRecord], rows: usize) -> BlockList<6, 6> {
    let mut part = BlockList {
        offset: vec![0; rows + 1],
        ..BlockList::default()
    };
    for record in records {
        part.offset[record[0] as usize + 1] += 1;
        part.columns.push(record[1] as u32);
        let mut block = [[0.0; 6]; 6];
        block.as_flattened_mut().copy_from_slice(&record[2..]);
        part.blocks.push(block);
    }
    for row in 0..rows {
        part.offset[row + 1] += part.offset[row];
    }
    part
}
