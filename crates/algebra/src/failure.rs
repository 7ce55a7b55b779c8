//! What may go wrong.

/// Why a linear system could not be solved.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum LinearFailure {
    /// So many bytes were asked for, for a factor or the kernels that make it, and not given.
    OutOfMemory(usize),
    /// The matrix is not positive definite; the block row where it showed.
    Indefinite(usize),
    /// The ordering or the symbolic analysis failed.
    Analysis(String),
    /// A number is not finite.
    NotFinite,
    /// The iteration did not converge in this many steps.
    Stalled(usize),
}

/// Why a multigrid hierarchy could not be built.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MultigridFailure {
    /// The diagonal block of this row is not positive definite, or not finite.
    NotPositive(usize),
    /// The matrix or the modes of some level have entries that are not finite.
    NotFinite,
}

impl MultigridFailure {
    /// The failure of a matrix made of these rows, in terms of the one they are taken from.
    pub(crate) fn of_rows(self, rows: &[u32]) -> Self {
        match self {
            Self::NotPositive(row) => Self::NotPositive(rows[row] as usize),
            Self::NotFinite => Self::NotFinite,
        }
    }
}

impl From<MultigridFailure> for LinearFailure {
    fn from(failure: MultigridFailure) -> Self {
        match failure {
            MultigridFailure::NotPositive(row) => Self::Indefinite(row),
            MultigridFailure::NotFinite => Self::NotFinite,
        }
    }
}
