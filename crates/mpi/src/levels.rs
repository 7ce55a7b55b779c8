//! The levels as PETSc takes them. Each rank makes all below the finest one, see [`LowerLevels`],
//! and keeps the rows that it owns: of matrices and prolongators in single precision, by functions
//! for their products, of the inverse of the last matrix in a matrix of PETSc.

use std::sync::Arc;

use kluft_solver::multigrid::{
    CoarsestSolve, FirstProlongator, LevelRows, LowerLevels, ProlongatorRows,
};

use crate::parts::{LocalMap, MappedMatrix};
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

    fn number(&self) -> impl Fn(u32) -> i64 {
        |node| self.number[node as usize]
    }
}

/// All levels below the finest one.
pub struct Levels {
    /// Prolongators from them, the largest level first.
    pub prolongators: Vec<MappedMatrix>,
    /// Their matrices.
    pub matrices: Vec<MappedMatrix>,
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

    /// With the prolongator from the first of the levels that all ranks have made; `owners` are the
    /// ranks of the nodes of that one.
    ///
    /// # Errors
    /// Those of PETSc.
    pub fn of(
        world: &Arc<World>,
        owners: Vec<u32>,
        to_finest: FirstProlongator,
        mut lower: LowerLevels,
    ) -> Result<Self, PetscFailure> {
        let mut nodes = LevelNodes::of(world, owners);
        let rows = to_finest.from(&mut lower, &nodes.own);
        let mut prolongators = vec![transfers(rows, nodes.number())];
        let mut matrices = vec![products(lower.take_rows(0, &nodes.own), nodes.number())];
        for level in 1..lower.count() {
            let above = nodes;
            nodes = LevelNodes::of(world, owners_below(&above.owner, &lower, level));
            let rows = lower.take_prolongator(level - 1, &above.own, &nodes.own);
            prolongators.push(transfers(rows, nodes.number()));
            matrices.push(products(lower.take_rows(level, &nodes.own), nodes.number()));
        }
        let coarsest = match lower.coarsest_solve() {
            CoarsestSolve::Inverse => {
                let (rows, number) = (lower.inverse(&nodes.own), nodes.number());
                let inverse = Matrix::by_rows(world, rows.rows(), |row, blocks| {
                    let entries = rows.row(row);
                    blocks.extend(entries.map(|(column, block)| (number(column), *block)));
                });
                Some(inverse?)
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

/// Products with rows of a level's matrix; `number` gives a node its global number.
pub fn products<const N: usize>(rows: LevelRows<N>, number: impl Fn(u32) -> i64) -> MappedMatrix {
    let ghosts = rows.ghosts().iter().map(|&node| number(node)).collect();
    let (own, others) = (N * rows.rows(), N * rows.ghosts().len());
    let mut room = Vec::new();
    let product = LocalMap {
        own,
        ghosts: others,
        image: own,
        function: Box::new(move |own, ghosts, product| {
            let vectors = [own, ghosts].map(bytemuck::cast_slice);
            rows.multiply(vectors, bytemuck::cast_slice_mut(product), &mut room);
        }),
    };
    MappedMatrix {
        rows: own,
        columns: own,
        block: N,
        ghosts,
        product: Some(product),
        transposed: None,
    }
}

/// The way from the next level, and down to it; `number` gives a node of that its global number.
fn transfers<const N: usize>(
    rows: ProlongatorRows<N>,
    number: impl Fn(u32) -> i64,
) -> MappedMatrix {
    let ghosts: Vec<i64> = rows.ghosts().iter().map(|&node| number(node)).collect();
    let [fine, coarse] = rows.size();
    let (fine, coarse, others) = (N * fine, 6 * coarse, 6 * ghosts.len());
    let rows = Arc::new(rows);
    let down = Arc::clone(&rows);
    let product = LocalMap {
        own: coarse,
        ghosts: others,
        image: fine,
        function: Box::new(move |own, ghosts, fine| {
            let vectors = [own, ghosts].map(bytemuck::cast_slice);
            rows.prolong(vectors, bytemuck::cast_slice_mut(fine));
        }),
    };
    let transposed = LocalMap {
        own: fine,
        ghosts: 0,
        image: coarse + others,
        function: Box::new(move |fine, _, coarse| {
            let fine = bytemuck::cast_slice(fine);
            down.restrict(fine, bytemuck::cast_slice_mut(coarse));
        }),
    };
    MappedMatrix {
        rows: fine,
        columns: coarse,
        block: 6,
        ghosts,
        product: Some(product),
        transposed: Some(transposed),
    }
}
