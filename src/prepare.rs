//! From a scene to a checked problem, piece by piece; a run and an inspection share them.

use std::path::{Path, PathBuf};
use std::time::Duration;

use kluft_io::{Meshing, mesh_geometry};
use kluft_mesh::{Defect, Draft, SurfaceRole};

use crate::decisions;
use crate::output::Output;
use crate::report::Report;
use crate::scene::{MeshSource, Scene, surface_roles};

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
    report: &mut Report,
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
            };
            let (warnings, took) = report.stage("meshing (gmsh)", |_| mesh_geometry(&meshing));
            for warning in warnings? {
                report.detail("gmsh", &warning);
            }
            Ok(MeshFile {
                path,
                meshing: Some(took),
            })
        }
    }
}

/// What a scene makes of the groups of a mesh.
pub struct Roles {
    /// One entry for each group; only those of surfaces count.
    pub of_group: Vec<SurfaceRole>,
    /// What becomes of surfaces that the scene does not name.
    pub decisions: Vec<String>,
}

/// Gives roles to the groups of a mesh; `inner` tells which of them are surfaces inside the rock.
///
/// # Errors
/// Names of the scene that are no group of the mesh, or one of the wrong dimension.
pub fn roles(scene: &Scene, draft: &Draft, inner: &[bool]) -> Result<Roles, Vec<Defect>> {
    let of_group = surface_roles(scene, draft, |group| inner[group])?;
    let unused = |inside: bool| -> Vec<&str> {
        let groups = draft.groups.iter().zip(&of_group).zip(inner);
        let chosen = groups.filter(|((group, role), inner)| {
            group.dimension == 2 && **role == SurfaceRole::Unused && **inner == inside
        });
        chosen.map(|((group, _), _)| group.name.as_str()).collect()
    };
    let decisions = decisions::unused_surfaces(&unused(true), &unused(false));
    Ok(Roles {
        of_group,
        decisions,
    })
}
