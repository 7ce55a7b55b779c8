//! From a scene to a checked problem, piece by piece; a run and an inspection share them.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use kluft_io::{Meshing, mesh_geometry};
use kluft_mesh::Defect;
use kluft_scene::{MeshSource, Scene};

use crate::observer::{Observer, Stage};
use crate::output::Output;

/// The mesh that gmsh makes.
pub const MESH: &str = "mesh.msh";

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

/// The files that the results of a scene are made from, as far as they are known: what a geometry
/// includes is known to gmsh alone.
pub fn inputs<'a>(file: &'a Path, scene: Option<&'a Scene>) -> Vec<&'a Path> {
    let mesh = scene.map(|scene| match &scene.mesh {
        MeshSource::Geometry { geometry, .. } => geometry.as_path(),
        MeshSource::File(mesh) => mesh.as_path(),
    });
    [file].into_iter().chain(mesh).collect()
}

/// The mesh file of a scene; gmsh makes it if the scene names a geometry.
///
/// # Errors
/// Whatever gmsh objects to.
pub fn mesh_file(
    scene: &Scene,
    output: &Output,
    sizes: Option<&Path>,
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
            let unfinished = output.unfinished(MESH);
            let meshing = Meshing {
                geometry,
                parameters,
                order: *order,
                sizes,
                output: &unfinished,
            };
            observer.stage_begins(Stage::Mesh);
            let start = Instant::now();
            let warnings = mesh_geometry(&meshing);
            let took = start.elapsed();
            observer.stage_ends(Stage::Mesh, took);
            for warning in warnings? {
                observer.detail("gmsh", &warning);
            }
            output.publish(MESH).map_err(|defect| vec![defect])?;
            Ok(MeshFile {
                path: output.path(MESH),
                meshing: Some(took),
            })
        }
    }
}
