//! Linear algebra on matrices of 3x3 blocks.
mod block_matrix;
mod block_rows;
mod cholesky;
mod conjugate_gradients;
pub mod dense_kernels;
mod failure;
mod gmres;
mod interface;
mod lists;
pub mod multigrid;
mod ownership;
mod schur;
pub mod small;
mod vectors;

pub use block_matrix::{BlockMatrix, BlockPattern};
pub use block_rows::BlockRows;
pub use cholesky::{Analysis, Cholesky, NodeOrder};
pub use conjugate_gradients::{
    ConjugateGradientOutcome, ConjugateGradientReport, ConjugateGradientSettings,
    conjugate_gradients,
};
pub use failure::{LinearFailure, MultigridFailure};
pub use gmres::gmres;
pub use interface::{FixedPart, InterfaceBlocks, InterfacePattern};
pub use lists::{Lists, sum_up};
pub use ownership::RowOwnership;
pub use schur::SchurComplement;
pub use vectors::{dot, norm, trace};
