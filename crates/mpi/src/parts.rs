//! What a solver is made of.

use std::sync::Arc;

/// The matrices `M` of a solver.
pub struct SolverParts<M> {
    /// The stiffness of the rock, which the solver shares.
    pub rock: Arc<M>,
    /// What the fractures add to it.
    pub fractures: M,
    /// The inverses of the diagonal blocks of clusters of the sum.
    pub inverse: M,
    /// The prolongators from the levels below, the largest first.
    pub prolongators: Vec<M>,
    /// Their matrices, whose diagonal is the identity.
    pub matrices: Vec<M>,
    /// The inverse of the last of them; without it that level is smoothed.
    pub coarsest: Option<M>,
    /// Upper bounds of the spectra of all levels, the finest first.
    pub largest_eigenvalues: Vec<f64>,
    /// Whether the whole is small enough for each rank to factorise.
    pub is_small: bool,
}
