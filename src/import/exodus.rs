//! Exodus meshes, read by the VTK of a Python.

use std::env;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use kluft_defect::open_ordinary;
use kluft_io::import::{Imported, read_grid};
use kluft_mesh::Defect;

const SCRIPT: &str = include_str!("exodus.py");
/// Exit code of the script without VTK.
const NO_VTK: i32 = 3;

const REMEDY: &str = "install it with `sh scripts/setup` in Kluft's repository, or with `pip \
                      install vtk`, and let the environment variable KLUFT_PYTHON name that Python; \
                      or write the mesh as .vtu or .inp";

/// Reads element blocks and side sets.
///
/// # Errors
/// If there is no Python with VTK, or the file is no Exodus mesh that can be used.
pub fn read_exodus(file: &Path) -> Result<Imported, Vec<Defect>> {
    let place = file.display().to_string();
    let refuse = |problem: String, remedy: &str| vec![Defect::new(&place, problem, remedy)];
    let cannot = |why: &str| {
        let problem = format!("cannot be read: {why}");
        refuse(problem, "give the path of an Exodus mesh")
    };
    open_ordinary(file).map_err(|error| cannot(&error.to_string()))?;
    let folder = tempfile::tempdir()
        .map_err(|error| refuse(format!("no temporary folder: {error}"), "set TMPDIR"))?;
    let grid = folder.path().join("mesh.vtu");
    let python = python();
    let run = Command::new(&python)
        .args(["-I", "-c", SCRIPT])
        .args([file, &grid])
        .output();
    let name = python.display();
    let Output {
        status,
        stdout,
        stderr,
    } = run.map_err(|error| {
        let problem = format!("Exodus is read by Python, and `{name}` does not start: {error}");
        refuse(problem, REMEDY)
    })?;
    if status.code() == Some(NO_VTK) {
        let problem = format!("Exodus is read by VTK, which `{name}` does not have");
        return Err(refuse(problem, REMEDY));
    }
    if !status.success() {
        let said = String::from_utf8_lossy(&stderr);
        let said = said.trim().lines().last().unwrap_or_default();
        return Err(cannot(said));
    }
    let mut imported = read_grid(&grid)?;
    imported.draft.source = place;
    let groups = String::from_utf8_lossy(&stdout);
    imported
        .notes
        .splice(..1, groups.lines().map(str::to_owned));
    Ok(imported)
}

/// The Python that the environment names, that of `scripts/setup` beside the program, or any.
fn python() -> PathBuf {
    let named = env::var_os("KLUFT_PYTHON").filter(|name| !name.is_empty());
    let beside = || {
        let program = env::current_exe().ok()?;
        let target = program.parent()?.parent()?;
        let own = target.join("venv/bin/python");
        own.exists().then_some(own)
    };
    named
        .map(PathBuf::from)
        .or_else(beside)
        .unwrap_or_else(|| PathBuf::from("python3"))
}
