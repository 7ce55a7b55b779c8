//! From a scene to a checked problem, piece by piece; a run and an inspection share them.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use kluft_io::{GmshOptions, Meshing, mesh_geometry};
use kluft_mesh::Defect;
use kluft_scene::{MeshSource, Scene};

use crate::observer::{Observer, Stage};
use crate::output::Output;

/// A mesh file, and how long gmsh took to make it, if it did.
pub struct MeshFile {
    /// The file.
    pub path: PathBuf,
    /// Time in gmsh.
    pub meshing: Option<Duration>,
}

/// The folder `out` beside a file, unless another one is asked for.
pub fn folder_for(file: &Path, asked: Option<&Path>) -> PathBuf {
    let beside = || file.parent().unwrap_or(Path::new(".")).join("out");
    asked.map_or_else(beside, Path::to_owned)
}

/// The mesh file of a scene; gmsh makes it if the scene names a geometry.
///
/// # Errors
/// Whatever gmsh objects to.
pub fn mesh_file(
    scene: &Scene,
    output: &Output,
    sizes: Option<&Path>,
    gmsh: &GmshOptions,
    observer: &mut dyn Observer,
) -> Result<MeshFile, Vec<Defect>> {
    match &scene.mesh {
        MeshSource::File(file) => Ok(MeshFile {
            path: file.clone(),
            meshing: None,
        }),
        MeshSource::Geometry {
            geometry,
            parameters,
            order,
            ..
        } => {
            let path = output.path("mesh.msh");
            let meshing = Meshing {
                geometry,
                parameters,
                order: *order,
                sizes,
                output: &path,
                gmsh,
            };
            observer.stage_begins(Stage::Mesh);
            let start = Instant::now();
            let warnings = mesh_geometry(&meshing);
            let took = start.elapsed();
            observer.stage_ends(Stage::Mesh, took);
            for warning in warnings? {
                observer.detail("gmsh", &warning);
            }
            Ok(MeshFile {
                path,
                meshing: Some(took),
            })
        }
    }
}
