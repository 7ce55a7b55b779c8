//! `kluft init`: from a mesh or a geometry to a scene that runs, in which every decision says why.

mod supports;
mod text;

use std::fs::OpenOptions;
use std::io::Write;
use std::path::{Path, PathBuf};

use kluft_io::{Dimension, GmshOptions, Meshing, NOT_WRITTEN, mesh_geometry};
use kluft_mesh::{Defect, Faces, Mesh, Survey};
use kluft_run::{Output, read_mesh};

use crate::failure::Failure;
use crate::input::{is_geometry, is_mesh, scene_at};
use crate::stdout::print;
use text::{Source, scene};

/// What the scene is called unless the user says otherwise.
const SCENE: &str = "scene.toml";

/// How to make a scene.
#[derive(Debug, Clone)]
pub struct InitOptions {
    /// The scene; `scene.toml` beside the input if not given.
    pub out: Option<PathBuf>,
    /// How gmsh is started, and what a geometry may do.
    pub gmsh: GmshOptions,
}

/// Writes the scene that the groups of a mesh suggest, and says where.
///
/// # Errors
/// [`Failure::BadInput`] with every defect of geometry and mesh, or a scene that is there already.
pub fn init(input: &Path, options: &InitOptions) -> Result<(), Failure> {
    let is_geometry = match (is_mesh(input), is_geometry(input)) {
        (true, _) => false,
        (false, true) => true,
        (false, false) => return Err(neither(input).into()),
    };
    let beside = || input.with_file_name(SCENE);
    let file = options.out.clone().unwrap_or_else(beside);
    if std::fs::symlink_metadata(&file).is_ok() {
        return Err(there_already(&file).into());
    }
    let mesh = mesh(input, is_geometry, &options.gmsh)?;
    let survey = Survey::of(&mesh);
    let source = Source {
        path: relative(input, &file),
        is_geometry,
    };
    let text = scene(&source, &mesh, &survey);
    write(&file, &text)?;
    let shown = file.display();
    print(&format!(
        "{shown}: look at the values marked `assumed`, then\n  kluft run {shown}\n"
    ))
}

/// The mesh, with surfaces that have rock on both sides as fractures.
fn mesh(input: &Path, is_geometry: bool, gmsh: &GmshOptions) -> Result<Mesh, Vec<Defect>> {
    let output = Output::nowhere()?;
    let made = output.unfinished("made.msh");
    if is_geometry {
        mesh_geometry(&Meshing {
            geometry: input,
            parameters: &[],
            order: 1,
            dimension: Dimension::Volumes,
            sizes: None,
            output: &made,
            gmsh,
        })?;
    }
    let file = if is_geometry { &made } else { input };
    let draft = read_mesh(file, 0, &output.unfinished(""), gmsh)?;
    let faces = Faces::of(&draft);
    let roles = faces.guessed_roles(&draft);
    Mesh::build_on(draft, faces, &roles)
}

/// The path of the input as the scene names it.
fn relative(input: &Path, scene: &Path) -> PathBuf {
    match input.parent() == scene.parent() {
        true => input
            .file_name()
            .map_or_else(|| input.into(), PathBuf::from),
        false => std::path::absolute(input).unwrap_or_else(|_| input.to_owned()),
    }
}

/// Writes a file that is not there, not even since it was looked for.
fn write(file: &Path, text: &str) -> Result<(), Defect> {
    let opened = OpenOptions::new().write(true).create_new(true).open(file);
    let written = opened.and_then(|mut file| file.write_all(text.as_bytes()));
    written.map_err(|error| match error.kind() {
        std::io::ErrorKind::AlreadyExists => there_already(file),
        _ => {
            let problem = format!("cannot be written: {error}");
            let remedy = "name another file with --out";
            Defect::new(file.display().to_string(), problem, remedy).with_code(NOT_WRITTEN)
        }
    })
}

fn there_already(file: &Path) -> Defect {
    Defect::new(
        file.display().to_string(),
        "there is a file of this name already",
        "name another one with --out, or remove it",
    )
}

fn neither(input: &Path) -> Defect {
    let place = input.display().to_string();
    if input.is_dir() && scene_at(input).is_ok() {
        let remedy = format!("run it: kluft run {place}");
        return Defect::new(place, "there is a scene in this folder", remedy);
    }
    let problem = match input.exists() {
        true => "this is neither a mesh nor a geometry of gmsh",
        false => "there is no such file",
    };
    let remedy = "give a mesh (.msh) or a geometry (.geo)";
    Defect::new(place, problem, remedy)
}
