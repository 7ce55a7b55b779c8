//! From a scene to a checked problem, piece by piece; a run and an inspection share them.

use std::path::{Path, PathBuf};
use std::time::Instant;

use kluft_io::{Dimension, GmshOptions, Meshed, Meshing, load_msh, mesh_geometry};
use kluft_mesh::{Defect, Draft};
use kluft_scene::{MeshSource, Scene};

use crate::memory;
use crate::observer::{Observer, Stage};
use crate::output::Output;

/// The mesh that gmsh makes.
pub const MESH: &str = "mesh.msh";

/// A mesh file.
pub struct MeshFile {
    /// The file.
    pub path: PathBuf,
    /// How gmsh made it, if the scene names a geometry.
    pub meshed: Option<Meshed>,
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
    let values = scene.map(Scene::value_files).unwrap_or_default();
    [file].into_iter().chain(mesh).chain(values).collect()
}

/// Least memory that topology, unknowns and stiffness take for each cell (bytes): linear tetrahedra
/// take that, others more.
const LEAST_OF_CELL: usize = 400;

/// Reads a mesh, unless it is certain that there is no memory for it as the scene refines it; what
/// gmsh has to convert goes through the folder `scratch`.
///
/// # Errors
/// As [`load_msh`], and a mesh that is too large for this process.
pub fn read_mesh(
    path: &Path,
    refine: u32,
    scratch: &Path,
    gmsh: &GmshOptions,
) -> Result<Draft, Vec<Defect>> {
    let available = memory::available_bytes().unwrap_or(usize::MAX);
    // A file that is not there is refused by who reads it.
    let length = std::fs::metadata(path).map_or(0, |file| file.len() as usize);
    check_memory(&path.display().to_string(), "to be read", length, available)?;
    let draft = load_msh(path, scratch, gmsh)?;
    check_cells(&draft, refine)?;
    Ok(draft)
}

/// Refuses a mesh for whose cells, divided so many times, there is certainly no memory.
///
/// # Errors
/// If there is none.
pub fn check_cells(draft: &Draft, refine: u32) -> Result<(), Vec<Defect>> {
    let available = memory::available_bytes().unwrap_or(usize::MAX);
    let cells = draft.refined_cells(refine);
    let needed = (LEAST_OF_CELL as u64).saturating_mul(cells);
    let what = match refine {
        0 => format!("for its {cells} cells"),
        times => format!("for its {cells} cells with `refine = {times}`"),
    };
    let needed = usize::try_from(needed).unwrap_or(usize::MAX);
    check_memory(&draft.source, &what, needed, available)
}

fn check_memory(
    place: &str,
    what: &str,
    needed: usize,
    available: usize,
) -> Result<(), Vec<Defect>> {
    if needed <= available {
        return Ok(());
    }
    let problem = format!(
        "the mesh needs at least {} of memory {what}, and this process may take {}",
        memory::in_words(needed),
        memory::in_words(available)
    );
    let remedy = "mesh coarser (a larger h), refine less often, or raise the limit of memory \
                  (ulimit -v, container)";
    Err(vec![Defect::new(place, problem, remedy)])
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
    let mut file = unfinished_mesh_file(scene, output, sizes, gmsh, observer)?;
    if file.meshed.is_some() {
        output.publish(MESH).map_err(|defect| vec![defect])?;
        file.path = output.path(MESH);
    }
    Ok(file)
}

/// The same where the place of the mesh is to keep what it holds: what gmsh makes has the name of
/// an unfinished file.
///
/// # Errors
/// Whatever gmsh objects to.
pub fn unfinished_mesh_file(
    scene: &Scene,
    output: &Output,
    sizes: Option<&Path>,
    gmsh: &GmshOptions,
    observer: &mut dyn Observer,
) -> Result<MeshFile, Vec<Defect>> {
    match &scene.mesh {
        MeshSource::File(file) => Ok(MeshFile {
            path: file.clone(),
            meshed: None,
        }),
        MeshSource::Geometry {
            geometry,
            parameters,
            order,
            surfaces_alone,
            ..
        } => {
            let unfinished = output.unfinished(MESH);
            let meshing = Meshing {
                geometry,
                parameters,
                order: *order,
                dimension: match surfaces_alone {
                    true => Dimension::Surfaces,
                    false => Dimension::Volumes,
                },
                sizes,
                output: &unfinished,
                gmsh,
            };
            observer.stage_begins(Stage::Mesh);
            let start = Instant::now();
            let meshed = mesh_geometry(&meshing);
            observer.stage_ends(Stage::Mesh, start.elapsed());
            let meshed = meshed?;
            for warning in &meshed.warnings {
                observer.detail("gmsh", warning);
            }
            Ok(MeshFile {
                path: unfinished,
                meshed: Some(meshed),
            })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mesh_without_room_is_refused_by_name() {
        let place = "a/b.msh";
        check_memory(place, "to be read", 5, 5).expect("it fits");
        let defects = check_memory(place, "for its 9 cells", 3 << 30, 1 << 30).expect_err("large");
        let said = defects[0].to_string();
        for part in ["a/b.msh: ", "for its 9 cells", "may take 1", "coarser"] {
            assert!(said.contains(part), "{part}: {said}");
        }
    }

    #[test]
    fn what_refinement_makes_of_a_mesh_counts() {
        let draft = kluft_mesh::structured::tetrahedra([2, 1, 1], [1.0; 3], &[]);
        check_cells(&draft, 2).expect("768 cells");
        let defects = check_cells(&draft, 15).expect_err("8^15 times 12 cells");
        let said = defects[0].to_string();
        for part in ["422212465065984 cells", "`refine = 15`", "refine less"] {
            assert!(said.contains(part), "{part}: {said}");
        }
    }
}
