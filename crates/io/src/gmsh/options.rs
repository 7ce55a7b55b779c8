//! What gmsh is asked for, and how it is started.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use super::cache::MeshCache;

/// How far gmsh goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Dimension {
    /// Surfaces alone.
    Surfaces,
    /// Volumes, with their surfaces.
    #[default]
    Volumes,
}

/// A mesh to be made.
#[derive(Debug, Clone, Copy)]
pub struct Meshing<'a> {
    /// The `.geo` file.
    pub geometry: &'a Path,
    /// Values for `DefineConstant` names of the geometry, or for options such as
    /// `Mesh.Algorithm3D`.
    pub parameters: &'a [(String, f64)],
    /// Order of the elements: 1 or 2.
    pub order: u32,
    /// What is meshed.
    pub dimension: Dimension,
    /// A view of cell sizes to go by (see [`super::write_size_field`]), instead of those of the
    /// geometry.
    pub sizes: Option<&'a Path>,
    /// The `.msh` file to write; it is written whole or not at all.
    pub output: &'a Path,
    /// How gmsh is started, and what the geometry may do.
    pub gmsh: &'a GmshOptions,
}

/// A mesh that was made, or had been made before.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Meshed {
    /// What gmsh warned of.
    pub warnings: Vec<String>,
    /// Its version, if it said one.
    pub version: Option<String>,
    /// How long gmsh took, at the time (s).
    pub seconds: f64,
    /// Whether it was made before.
    pub is_kept: bool,
}

/// How gmsh is started, and what a geometry may do. By default gmsh is a child of this process
/// without a time limit, and a geometry that does more than describe a body is refused.
#[derive(Debug, Clone, Default)]
pub struct GmshOptions {
    /// The program that becomes gmsh.
    pub launcher: Option<Launcher>,
    /// Where gmsh, and what starts it, is sought before the search path.
    pub tools: Option<PathBuf>,
    /// Whether a geometry may run programs, and read and write any file.
    pub trust: bool,
    /// After this time gmsh is ended.
    pub time_limit: Option<Duration>,
    /// gmsh is ended once this is true.
    pub stop: Option<Arc<AtomicBool>>,
    /// Where meshes are kept for the next time.
    pub cache: Option<MeshCache>,
}

/// A program that prepares its own process and becomes gmsh.
///
/// It is called as `PROGRAM ARGUMENTS... --parent PID [--confine [--folder DIR] [--read PATH]...]
/// -- GMSH ARGUMENTS...`. It ends when the process `PID` has ended. With `--confine` nothing is
/// executed but gmsh, nothing written but in DIR, and nothing of the user's read but DIR and what
/// lies beneath each PATH. If it cannot become gmsh, it says why in the last line of its error
/// stream and ends with the exit code [`NOT_STARTED`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Launcher {
    /// The program.
    pub program: PathBuf,
    /// Its first arguments.
    pub arguments: Vec<OsString>,
    /// Whether it can confine gmsh on this machine.
    pub confines: bool,
}

/// Exit code of a [`Launcher`] that could not become gmsh.
pub const NOT_STARTED: u8 = 125;

/// Code of a defect that lies with the machine, not with the input: time or space ran out.
pub const NOT_MESHED: &str = "not meshed";

/// Code of a defect: volumes were asked for, and the geometry has none.
pub const WITHOUT_VOLUMES: &str = "without volumes";

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
