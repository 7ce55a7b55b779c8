//! What to run, on which mesh and threads, and where results go.

use std::path::Path;

use kluft_io::GmshOptions;
use kluft_mesh::Draft;
use kluft_scene::Scene;
use rayon::ThreadPool;

use crate::ranks::Ranks;

/// Where the mesh of a run comes from.
#[derive(Debug, Clone)]
pub enum MeshInput {
    /// From the geometry or the file that the scene names.
    OfScene,
    /// From memory.
    Draft(Box<Draft>),
}

/// The file that a scene was read from; checkpoints know a run by it.
#[derive(Debug, Clone, Copy)]
pub struct Origin<'a> {
    /// Its path.
    pub file: &'a Path,
    /// Its text.
    pub text: &'a str,
}

/// Who asks for a run, for whoever reads its results.
#[derive(Debug, Clone, Copy, Default)]
pub struct Caller<'a> {
    /// The command line, if one asks.
    pub command: Option<&'a str>,
    /// Commit that the program was built from, if it is known.
    pub commit: Option<&'a str>,
}

/// What to run.
#[derive(Debug, Clone)]
pub struct Request<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// Its mesh.
    pub mesh: MeshInput,
    /// The threads that it may use; results do not depend on their number.
    pub pool: &'a ThreadPool,
    /// Folder for grids, `summary.json` and checkpoints; without one nothing is written.
    pub folder: Option<&'a Path>,
    /// The file of the scene; without one there are no checkpoints.
    pub origin: Option<Origin<'a>>,
    /// Whether to go on after the last load step that an interrupted run into the folder finished.
    pub resume: bool,
    /// Whether the outcome holds the grids of all load steps.
    pub keep_results: bool,
    /// Whether the folder gets `report.html`.
    pub report: bool,
    /// Who asks.
    pub caller: Caller<'a>,
    /// How gmsh is started, and what a geometry may do.
    pub gmsh: GmshOptions,
    /// The other processes of the run, if there are any. A mesh from memory has none.
    pub ranks: Option<Ranks<'a>>,
}

impl<'a> Request<'a> {
    /// A run that writes nothing and returns all results.
    pub fn in_memory(scene: &'a Scene, mesh: MeshInput, pool: &'a ThreadPool) -> Self {
        Self {
            scene,
            mesh,
            pool,
            folder: None,
            origin: None,
            resume: false,
            keep_results: true,
            report: true,
            caller: Caller::default(),
            gmsh: GmshOptions::default(),
            ranks: None,
        }
    }
}
