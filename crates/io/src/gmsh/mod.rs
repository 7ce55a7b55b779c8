//! Drives the program `gmsh`: geometry to mesh, and old mesh files to new ones.
//!
//! The environment variable `KLUFT_GMSH` names another program to run instead of `gmsh`.

mod attempts;
mod cache;
mod capture;
mod commands;
mod ending;
mod file_format;
mod files;
mod ingredients;
mod log;
mod made;
mod meshing;
mod options;
mod parameters;
mod review;
mod run;
mod script;
mod size_field;
mod version;
mod workspace;

use std::ffi::OsString;
use std::path::Path;

use kluft_mesh::Defect;

use crate::msh::bytes_of;
pub use cache::MeshCache;
use ending::{cannot_start, judge};
pub use ingredients::geometry_fingerprint;
use log::IN_A_MESH;
pub use meshing::mesh_geometry;
use meshing::{MADE, QUIETLY};
pub use options::{
    Dimension, GmshOptions, Launcher, Meshed, Meshing, NOT_MESHED, NOT_STARTED, WITHOUT_VOLUMES,
};
pub use parameters::constants;
use review::reviewed;
use run::{Gmsh, Scope, path_argument};
pub use size_field::write_size_field;
pub use version::version;
use workspace::Workspace;

/// Lets gmsh rewrite a mesh file as MSH 4.1 (binary), and hands on the bytes; physical groups and
/// node tags stay. `scratch_dir` is where it may write meanwhile.
pub(crate) fn convert_mesh(
    input: &Path,
    scratch_dir: &Path,
    options: &GmshOptions,
) -> Result<Vec<u8>, Vec<Defect>> {
    let one = |defect| vec![defect];
    let mut reads = reviewed(input, options)?.reads(input);
    reads.push(input.to_owned());
    let name = input.file_name().unwrap_or_default();
    let workspace = Workspace::beside(&scratch_dir.join(name)).map_err(one)?;
    let mut arguments = vec![path_argument(input)];
    // Without -save_all, elements outside all physical groups would be lost.
    arguments.extend(["-save", "-save_all", "-format", "msh41", "-bin"].map(OsString::from));
    arguments.extend(QUIETLY.map(OsString::from));
    arguments.extend(["-o".into(), path_argument(&workspace.path(MADE))]);
    let scope = Scope {
        folder: Some(workspace.folder().to_owned()),
        reads,
    };
    let gmsh = Gmsh::from_environment(options);
    let ended = gmsh.run(&arguments, &scope);
    let ended = ended.map_err(|error| vec![cannot_start(&gmsh, &error)])?;
    judge(&gmsh, (input, IN_A_MESH), &ended)?;
    bytes_of(&workspace.path(MADE)).map_err(one)
}

#[cfg(test)]
mod tests;
