//! How gmsh is started.

use std::ffi::OsString;
use std::path::PathBuf;
use std::time::Duration;

/// How gmsh is started, and what a geometry may do. By default gmsh is a child of this process
/// without a time limit, and a geometry that does more than describe a body is refused.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct GmshOptions {
    /// The program that becomes gmsh.
    pub launcher: Option<Launcher>,
    /// Whether a geometry may run programs, and read and write any file.
    pub trust: bool,
    /// After this time gmsh is ended.
    pub time_limit: Option<Duration>,
}

/// A program that prepares its own process and becomes gmsh.
///
/// It is called as `PROGRAM ARGUMENT --parent PID [--confine [--folder DIR] [--read PATH]...] --
/// GMSH ARGUMENTS...`. It ends when the process `PID` has ended. With `--confine` nothing is
/// executed but gmsh, nothing written but in DIR, and nothing of the user's read but DIR and what
/// lies beneath each PATH. If it cannot become gmsh, it says why in the last line of its error
/// stream and ends with the exit code [`NOT_STARTED`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Launcher {
    /// The program.
    pub program: PathBuf,
    /// Its first argument.
    pub argument: OsString,
    /// Whether it can confine gmsh on this machine.
    pub confines: bool,
}

/// Exit code of a [`Launcher`] that could not become gmsh.
pub const NOT_STARTED: u8 = 125;

/// Code of a defect that lies with the machine, not with the input: time or space ran out.
pub const NOT_MESHED: &str = "not meshed";

impl GmshOptions {
    /// Whether gmsh can do no harm whatever the geometry says.
    pub(super) fn confines(&self) -> bool {
        !self.trust
            && self
                .launcher
                .as_ref()
                .is_some_and(|launcher| launcher.confines)
    }
}
