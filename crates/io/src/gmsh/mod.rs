//! Drives the program `gmsh`: geometry to mesh, and old mesh files to new ones.
//!
//! The environment variable `KLUFT_GMSH` names another program to run instead of `gmsh`.

mod capture;
mod commands;
mod ending;
mod files;
mod log;
mod options;
mod parameters;
mod review;
mod run;
mod script;
mod size_field;
mod workspace;

use std::ffi::OsString;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::time::Duration;

use kluft_mesh::Defect;

use crate::msh::{bytes_of, holds_cells};
use ending::{cannot_start, judge};
pub use options::{GmshOptions, Launcher, NOT_MESHED, NOT_STARTED};
use review::review;
use run::{Gmsh, Scope, path_argument};
pub use size_field::write_size_field;
use workspace::Workspace;

/// Name of what gmsh writes in its workspace.
const MADE: &str = "made.msh";
/// Without a window, with errors and warnings only.
const QUIETLY: [&str; 3] = ["-nopopup", "-v", "2"];
/// How long gmsh may take to say its version.
const VERSION_LIMIT: Duration = Duration::from_secs(20);

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
    /// A view of cell sizes to go by (see [`write_size_field`]), instead of those of the geometry.
    pub sizes: Option<&'a Path>,
    /// The `.msh` file to write; it is written whole or not at all.
    pub output: &'a Path,
    /// How gmsh is started, and what the geometry may do.
    pub gmsh: &'a GmshOptions,
}

/// The version of gmsh, if it can be started.
pub fn version(options: &GmshOptions) -> Option<String> {
    let options = GmshOptions {
        time_limit: Some(VERSION_LIMIT),
        ..options.clone()
    };
    let gmsh = Gmsh::from_environment(&options);
    let ended = gmsh.run(&["--version".into()], &Scope::default()).ok()?;
    // gmsh prints its version on the error stream.
    let said = ended.output + &ended.errors;
    let said = said.trim();
    (ended.status.success() && !said.is_empty()).then(|| said.to_owned())
}

/// Runs gmsh and answers with its warnings.
///
/// # Errors
/// A geometry that is missing or would do more than describe a body, parameters that gmsh would
/// silently ignore, gmsh not installed, everything that gmsh reports as an error (it writes a mesh
/// even then), and, with the code [`NOT_MESHED`], time or space that ran out.
pub fn mesh_geometry(meshing: &Meshing) -> Result<Vec<String>, Vec<Defect>> {
    mesh_with(&Gmsh::from_environment(meshing.gmsh), meshing)
}

fn mesh_with(gmsh: &Gmsh, meshing: &Meshing) -> Result<Vec<String>, Vec<Defect>> {
    check(meshing)?;
    let mut reads = reviewed(meshing.geometry, meshing.gmsh)?;
    let one = |defect| vec![defect];
    let workspace = Workspace::beside(meshing.output).map_err(one)?;
    let mut input = meshing.geometry.to_owned();
    if let Some(sizes) = meshing.sizes {
        input = workspace.path("sized.geo");
        size_field::write_script(&input, meshing.geometry, sizes).map_err(one)?;
        reads.push(sizes.to_owned());
    }
    let scope = Scope {
        folder: Some(workspace.folder().to_owned()),
        reads,
    };
    let ended = gmsh.run(&arguments(meshing, &input, &workspace.path(MADE)), &scope);
    let ended = ended.map_err(|error| vec![cannot_start(gmsh, &error)])?;
    let warnings = judge(gmsh, meshing.geometry, &ended)?;
    inspect_made(meshing, &workspace.path(MADE)).map_err(one)?;
    workspace.publish(MADE, meshing.output).map_err(one)?;
    Ok(warnings)
}

/// What gmsh must be able to read to open a file; what nobody may do behind the user's back is
/// refused, unless the user trusts the file.
fn reviewed(file: &Path, options: &GmshOptions) -> Result<Vec<PathBuf>, Vec<Defect>> {
    let folder = file.parent().filter(|folder| *folder != Path::new(""));
    let folder = folder.unwrap_or(Path::new(".")).to_owned();
    if options.trust {
        return Ok(vec![folder]);
    }
    let review = review(file, options.confines());
    if !review.defects.is_empty() {
        return Err(review.defects);
    }
    let whole = folder.canonicalize().unwrap_or_else(|_| folder.clone());
    let outside = review
        .opened
        .into_iter()
        .filter(|file| !file.starts_with(&whole));
    Ok(std::iter::once(folder).chain(outside).collect())
}

fn check(meshing: &Meshing) -> Result<(), Vec<Defect>> {
    let place = meshing.geometry.display().to_string();
    let bytes = bytes_of(meshing.geometry).map_err(|defect| {
        let problem = format!("the geometry {}", defect.problem);
        vec![Defect { problem, ..defect }]
    })?;
    let script = String::from_utf8_lossy(&bytes);
    let mut defects = parameters::check(&place, &script, meshing.parameters);
    if !(1..=2).contains(&meshing.order) {
        let problem = format!("elements of order {} cannot be used", meshing.order);
        defects.push(Defect::new(place, problem, "ask for order 1 or 2"));
    }
    if defects.is_empty() {
        Ok(())
    } else {
        Err(defects)
    }
}

fn arguments(meshing: &Meshing, input: &Path, made: &Path) -> Vec<OsString> {
    let mut arguments: Vec<OsString> = vec![
        path_argument(input),
        "-3".into(),
        "-format".into(),
        "msh41".into(),
        "-bin".into(),
        "-order".into(),
        meshing.order.to_string().into(),
    ];
    for (name, value) in meshing.parameters {
        arguments.extend([
            "-setnumber".into(),
            name.into(),
            format!("{value:e}").into(),
        ]);
    }
    arguments.extend(QUIETLY.map(OsString::from));
    arguments.extend(["-o".into(), path_argument(made)]);
    arguments
}

/// gmsh answers with success and a file also when it has found nothing to mesh, or when the disk is
/// full.
fn inspect_made(meshing: &Meshing, made: &Path) -> Result<(), Defect> {
    let place = meshing.geometry.display().to_string();
    if !made.exists() {
        let remedy = "remove `Exit` and `Abort` from the geometry";
        return Err(Defect::new(place, "gmsh wrote no mesh", remedy));
    }
    let end = end_of(made).map_err(|error| {
        let problem = format!("the mesh that gmsh made cannot be read: {error}");
        Defect::new(&place, problem, "check the permissions")
    })?;
    if is_cut_off(&end) {
        let problem = "the mesh file that gmsh wrote is cut off, as it is when a disk is full";
        let output = meshing.output.display();
        let remedy = format!("free some space where {output} goes, or write to another disk");
        return Err(Defect::new(place, problem, remedy).with_code(NOT_MESHED));
    }
    if !holds_cells(made).unwrap_or(false) {
        let problem = "the mesh that gmsh made holds no volume elements";
        let remedy = "define a volume, and a `Physical Volume` if there are other physical groups";
        return Err(Defect::new(place, problem, remedy));
    }
    Ok(())
}

/// The last bytes of a file.
fn end_of(path: &Path) -> io::Result<Vec<u8>> {
    const LENGTH: u64 = 64;
    let mut file = File::open(path)?;
    let length = file.metadata()?.len();
    file.seek(SeekFrom::Start(length.saturating_sub(LENGTH)))?;
    let mut end = Vec::new();
    file.read_to_end(&mut end).map(|_| end)
}

/// Whether the last section of a file is not closed.
fn is_cut_off(bytes: &[u8]) -> bool {
    let last_line = bytes.trim_ascii_end().rsplit(|&byte| byte == b'\n').next();
    !last_line.is_some_and(|line| line.starts_with(b"$End"))
}

/// Lets gmsh rewrite a mesh file as MSH 4.1 (binary), and hands on the bytes; physical groups and
/// node tags stay. `scratch_dir` is where it may write meanwhile.
pub(crate) fn convert_mesh(
    input: &Path,
    scratch_dir: &Path,
    options: &GmshOptions,
) -> Result<Vec<u8>, Vec<Defect>> {
    let one = |defect| vec![defect];
    let mut reads = reviewed(input, options)?;
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
    judge(&gmsh, input, &ended)?;
    bytes_of(&workspace.path(MADE)).map_err(one)
}

#[cfg(test)]
mod tests;
