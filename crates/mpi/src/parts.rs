//! What a solver is made of.

use std::fmt;

/// A function of the numbers of this rank and of its ghosts, and of room for those of the image.
pub type LocalFunction<'a> = dyn FnMut(&[f64], &[f64], &mut [f64]) + Send + 'a;

/// What this rank makes of vectors that ranks share.
pub struct LocalMap<'a> {
    /// Numbers of this rank that are given.
    pub own: usize,
    /// Numbers of its ghosts that are given, which other ranks have.
    pub ghosts: usize,
    /// Numbers of the image.
    pub image: usize,
    /// What is made of them.
    pub function: Box<LocalFunction<'a>>,
}

impl fmt::Debug for LocalMap<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{} and {} numbers", self.own, self.ghosts)
    }
}

/// A matrix whose products are made by functions.
#[derive(Debug)]
pub struct MappedMatrix {
    /// Numbers of this rank in the image of a vector.
    pub rows: usize,
    /// Numbers of this rank in a vector.
    pub columns: usize,
    /// Numbers of a node of the vector.
    pub block: usize,
    /// Global numbers of the nodes of others that the rows of this rank have to do with.
    pub ghosts: Vec<i64>,
    /// Products, from the entries of this rank and of the ghosts; each solve may give its own.
    pub product: Option<LocalMap<'static>>,
    /// Products with the transposed matrix: what the rows of this rank give to the entries of this
    /// rank, and then to those of the ghosts.
    pub transposed: Option<LocalMap<'static>>,
}

impl MappedMatrix {
    /// Numbers of the ghosts.
    pub fn ghost_numbers(&self) -> usize {
        self.block * self.ghosts.len()
    }
}

/// The matrices of a solver, some of them matrices `M` of PETSc.
pub struct SolverParts<M> {
    /// The matrix that is solved with.
    pub system: MappedMatrix,
    /// The way to scaled unknowns, in which the matrices of the levels have the identity as their
    /// diagonal, and back.
    pub scaling: [LocalMap<'static>; 2],
    /// Those of the levels, the finest first.
    pub matrices: Vec<MappedMatrix>,
    /// The prolongators from the levels below, the largest first.
    pub prolongators: Vec<MappedMatrix>,
    /// The inverse of the last matrix; without it that level is smoothed.
    pub coarsest: Option<M>,
    /// The finest matrix, if it has no level below and is small enough for each rank to factorise.
    pub whole: Option<M>,
    /// Upper bounds of the spectra of all levels, the finest first.
    pub largest_eigenvalues: Vec<f64>,
}
