//! How a run ended.

/// How a run ended.
#[derive(Debug, Clone, PartialEq)]
pub enum Ending {
    /// All load steps converged.
    Solved,
    /// A load step did not converge: which, where and why.
    NotConverged(String),
    /// The observer stopped it.
    Stopped,
    /// A former run had finished all load steps: nothing was left to do.
    NothingLeft,
}

impl Ending {
    /// In words, as `summary.json` has it.
    pub fn in_words(&self) -> &'static str {
        match self {
            Self::Solved | Self::NothingLeft => "solved",
            Self::NotConverged(_) => "not converged",
            Self::Stopped => "stopped",
        }
    }
}
