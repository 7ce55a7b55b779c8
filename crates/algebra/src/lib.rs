//! Linear algebra on sparse symmetric matrices of 3x3 blocks, as elasticity makes them, with
//! nothing of meshes or fractures in it. What depends on these is handed in: the graph of nodes,
//! the rows of each node, motions that cost next to nothing, the blocks of an interface.
//!
//! No result depends on the number of threads: every sum has a fixed order. All vectors have one
//! 3-vector a block row.
//!
//! # Rooms
//!
//! | files | what they hold |
//! |---|---|
//! | `lists`, `ownership`, `division`, `thread_ranks`, `vectors`, `small`, `dense_kernels` | compressed rows, who owns which rows, rows of processes, processes for tests, sums over vectors, small dense blocks, dense kernels on threads of their own |
//! | `block_pattern`, `block_matrix`, `block_rows`, `interface` | a block matrix, its pattern, its view row by row, and what an interface adds to it |
//! | `conjugate_gradients`, `gmres` | iterations, with any preconditioner |
//! | `cholesky/`, `schur` | nested dissection, symbolic analysis, factor, substitution, of blocks and of scalars; the dense problem that is left of it |
//! | `multigrid/` | smoothed aggregation, a preconditioner |
//!
//! # Example
//!
//! A chain of springs of stiffness 1, held at both ends, is pulled in its middle.
//!
//! ```
//! use glam::{DMat3, DVec3};
//! use kluft_algebra::{
//!     Analysis, BlockMatrix, BlockPattern, Cholesky, ConjugateGradientOutcome,
//!     ConjugateGradientSettings, Lists, NodeOrder, conjugate_gradients,
//! };
//!
//! let beside: Vec<Vec<u32>> = vec![vec![0, 1], vec![0, 1, 2], vec![1, 2]];
//! let graph = Lists::collect(&beside);
//! let pattern = BlockPattern::new(graph.offset.clone(), graph.entries.clone());
//! let (own, other) = (2.0 * DMat3::IDENTITY, -DMat3::IDENTITY);
//! let matrix = BlockMatrix {
//!     blocks: vec![own, other, other, own, other, other, own],
//! };
//! let rows = matrix.rows(&pattern);
//! let rhs = [DVec3::ZERO, DVec3::X, DVec3::ZERO];
//!
//! // Every node has one row.
//! let order = NodeOrder::of(&graph, &[0, 1, 2, 3])?.all(&[0, 1, 2, 3]);
//! let analysis = Analysis::of(&pattern.row_offset, &pattern.columns, order)?;
//! let mut cholesky = Cholesky::new(analysis, rows);
//! cholesky.factorise()?;
//! let direct = cholesky.solve(&rhs);
//! assert!((direct[1] - DVec3::X).length() < 1e-14);
//!
//! let mut solution = [DVec3::ZERO; 3];
//! let report = conjugate_gradients(
//!     |vector, product| rows.multiply(vector, product),
//!     |residual, correction| correction.copy_from_slice(residual),
//!     &rhs,
//!     &mut solution,
//!     ConjugateGradientSettings {
//!         tolerance: 1e-12,
//!         max_iterations: 10,
//!     },
//! );
//! assert_eq!(report.outcome, ConjugateGradientOutcome::Converged);
//! assert!((solution[0] - direct[0]).length() < 1e-12);
//! # Ok::<(), kluft_algebra::LinearFailure>(())
//! ```

mod block_matrix;
mod block_pattern;
mod block_rows;
mod cholesky;
mod conjugate_gradients;
pub mod dense_kernels;
mod division;
mod failure;
mod gmres;
mod interface;
mod lists;
pub mod multigrid;
mod ownership;
mod schur;
pub mod small;
pub mod thread_ranks;
mod vectors;

pub use block_matrix::BlockMatrix;
pub use block_pattern::BlockPattern;
pub use block_rows::BlockRows;
pub use cholesky::{Analysis, Cholesky, NodeOrder, ScalarCholesky, ScalarMatrix};
pub use conjugate_gradients::{
    ConjugateGradientOutcome, ConjugateGradientReport, ConjugateGradientSettings,
    conjugate_gradients,
};
pub use division::{AllGather, Communicator, Division};
pub use failure::{LinearFailure, MultigridFailure};
pub use gmres::gmres;
pub use interface::{FixedPart, InterfaceBlocks, InterfacePattern};
pub use lists::{Lists, sum_up};
pub use ownership::RowOwnership;
pub use schur::SchurComplement;
pub use vectors::{add_at, dot, largest, norm, trace};
