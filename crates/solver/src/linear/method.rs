//! The linear solvers that there are.

use std::fmt;
use std::str::FromStr;

/// The linear solvers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LinearMethod {
    /// Cholesky factorisation of the whole tangent, whenever it changes.
    Direct,
    /// Cholesky factorisation of the rock, once; what changes is solved for the jumps alone.
    Condensed,
    /// Conjugate gradients, preconditioned by a multigrid of rock and fractures; the part of the
    /// rock is set up once.
    Iterative,
}

impl LinearMethod {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Direct, Self::Condensed, Self::Iterative];

    /// Its name in scenes and reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Direct => "direct",
            Self::Condensed => "condensed",
            Self::Iterative => "iterative",
        }
    }
}

impl fmt::Display for LinearMethod {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}

impl FromStr for LinearMethod {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|method| method.name() == name);
        found.ok_or_else(|| format!("there is no solver `{name}`"))
    }
}
