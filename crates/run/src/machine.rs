//! What a run works on.

use serde::Serialize;

use crate::memory;

/// The machine, as far as it tells.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Machine {
    /// Model of the processor; `unknown` where it does not tell.
    pub processor: String,
    /// System and instruction set.
    pub system: String,
    /// Number of cores that this process may use.
    pub cores: usize,
    /// Memory (bytes).
    pub memory_bytes: Option<usize>,
}

impl Machine {
    /// This machine.
    pub fn this() -> Self {
        Self {
            processor: processor().unwrap_or_else(|| "unknown".to_owned()),
            system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            memory_bytes: memory::total_bytes(),
        }
    }
}

/// Where Linux tells.
fn processor() -> Option<String> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("model name"))?;
    line.split_once(':').map(|(_, name)| name.trim().to_owned())
}
