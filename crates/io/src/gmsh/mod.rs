//! Drives the program `gmsh`: geometry to mesh, and old mesh files to new ones.
//!
//! The environment variable `KLUFT_GMSH` names another program to run instead of `gmsh`.

mod log;
mod parameters;
mod run;
mod size_field;

use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

use kluft_mesh::Defect;

use crate::msh::holds_cells;
use run::{Gmsh, path_argument};
pub use size_field::write_size_field;

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
}

/// The version of gmsh, if it can be started.
pub fn version() -> Option<String> {
    Gmsh::from_environment().version()
}

/// Runs gmsh and answers with its warnings.
///
/// # Errors
/// A geometry that is missing, parameters that gmsh would silently ignore, gmsh not installed, and
/// everything that gmsh reports as an error: it writes a mesh even then.
pub fn mesh_geometry(meshing: &Meshing) -> Result<Vec<String>, Vec<Defect>> {
    mesh_with(&Gmsh::from_environment(), meshing)
}

fn mesh_with(gmsh: &Gmsh, meshing: &Meshing) -> Result<Vec<String>, Vec<Defect>> {
    check(meshing)?;
    let temporary = temporary_name(meshing.output);
    let script = meshing.sizes.map(|_| temporary.with_extension("geo"));
    if let (Some(script), Some(sizes)) = (&script, meshing.sizes) {
        size_field::write_script(script, meshing.geometry, sizes).map_err(|defect| vec![defect])?;
    }
    let input = script.as_deref().unwrap_or(meshing.geometry);
    let made = gmsh
        .run(meshing.geometry, &arguments(meshing, input, &temporary))
        .and_then(|warnings| publish(meshing, &temporary).map(|()| warnings));
    if made.is_err() {
        // gmsh may not have written it, and its own errors are the ones to report.
        let _ = fs::remove_file(&temporary);
    }
    if let Some(script) = script {
        let _ = fs::remove_file(script);
    }
    made
}

fn check(meshing: &Meshing) -> Result<(), Vec<Defect>> {
    let place = meshing.geometry.display().to_string();
    let bytes = fs::read(meshing.geometry).map_err(|error| {
        let problem = format!("the geometry cannot be read: {error}");
        vec![Defect::new(
            &place,
            problem,
            "check the path and the permissions",
        )]
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

fn arguments(meshing: &Meshing, input: &Path, temporary: &Path) -> Vec<OsString> {
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
    arguments.extend(["-o".into(), path_argument(temporary)]);
    arguments
}

/// gmsh answers with success and a file also when it has found nothing to mesh.
fn publish(meshing: &Meshing, temporary: &Path) -> Result<(), Vec<Defect>> {
    let place = meshing.geometry.display().to_string();
    let one = |problem: String, remedy: &str| vec![Defect::new(&place, problem, remedy)];
    if !temporary.exists() {
        let remedy = "remove `Exit` and `Abort` from the geometry";
        return Err(one("gmsh wrote no mesh".to_owned(), remedy));
    }
    if !holds_cells(temporary).unwrap_or(false) {
        let remedy = "define a volume, and a `Physical Volume` if there are other physical groups";
        return Err(one(
            "the mesh that gmsh made holds no volume elements".to_owned(),
            remedy,
        ));
    }
    fs::rename(temporary, meshing.output).map_err(|error| {
        let problem = format!("cannot be written: {error}");
        let output = meshing.output.display().to_string();
        vec![Defect::new(
            output,
            problem,
            "check that the folder may be written to",
        )]
    })
}

/// The same folder, because a rename is atomic only within one file system.
fn temporary_name(output: &Path) -> PathBuf {
    let stem = output.file_stem().unwrap_or_default().to_string_lossy();
    output.with_file_name(format!(".{stem}.{}.tmp.msh", std::process::id()))
}

/// Rewrites a mesh file as MSH 4.1 (binary); physical groups and node tags stay.
pub(crate) fn convert_mesh(input: &Path, output: &Path) -> Result<(), Vec<Defect>> {
    let mut arguments = vec![path_argument(input)];
    // Without -save_all, elements outside all physical groups would be lost.
    arguments.extend(["-save", "-save_all", "-format", "msh41", "-bin", "-o"].map(OsString::from));
    arguments.push(path_argument(output));
    Gmsh::from_environment().run(input, &arguments).map(drop)
}

#[cfg(test)]
mod tests;
