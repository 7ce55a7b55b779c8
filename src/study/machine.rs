//! What a study ran on.

use kluft_run::memory;

use crate::gmsh::GmshArgs;

/// The machine and the programs, as far as they tell.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Machine {
    /// Model of the processor.
    pub(super) processor: String,
    /// Number of cores that this process may use.
    pub(super) cores: usize,
    /// Memory (bytes).
    pub(super) memory_bytes: Option<usize>,
    /// Version of gmsh.
    pub(super) gmsh: String,
}

impl Machine {
    /// This machine.
    pub(super) fn this(gmsh: GmshArgs) -> Self {
        let unknown = || "unknown".to_owned();
        Self {
            processor: processor().unwrap_or_else(unknown),
            cores: cores(),
            memory_bytes: memory::total_bytes(),
            gmsh: kluft_io::gmsh::version(&gmsh.into()).unwrap_or_else(unknown),
        }
    }
}

/// Number of cores that this process may use.
pub(super) fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// Where Linux tells.
fn processor() -> Option<String> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("model name"))?;
    line.split_once(':').map(|(_, name)| name.trim().to_owned())
}
