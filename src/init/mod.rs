//! `kluft init`: from a mesh or a geometry to a scene that runs, in which every decision says why.

mod conditions;
mod file;
mod lines;
mod supports;
mod text;

use std::path::{Path, PathBuf};

use kluft_defect::ordinary_bytes;
use kluft_io::gmsh::{WITHOUT_VOLUMES, constants};
use kluft_io::{Dimension, GmshOptions, Meshing, mesh_geometry};
use kluft_mesh::{Defect, Draft, Faces, Mesh, Survey};
use kluft_run::{Output, read_mesh};

use crate::failure::Failure;
use crate::input::{is_geometry, is_mesh, scene_at};
use crate::printing::{one_line, shell_path};
use crate::stdout::print;
use file::{check_place, write};
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
/// [`Failure::BadInput`] with every defect of geometry and mesh, or a scene that is there already
/// or cannot be where it is wanted; [`Failure::Machine`] if it cannot be written.
pub fn init(input: &Path, options: &InitOptions) -> Result<(), Failure> {
    let is_geometry = match (is_mesh(input), is_geometry(input)) {
        (true, _) => false,
        (false, true) => true,
        (false, false) => return Err(neither(input).into()),
    };
    let beside = || input.with_file_name(SCENE);
    let file = options.out.clone().unwrap_or_else(beside);
    check_place(&file)?;
    let mesh = mesh(input, is_geometry, &options.gmsh)?;
    let survey = Survey::of(&mesh);
    let source = Source {
        path: relative(input, &file),
        is_geometry,
        constants: constants_of(input, is_geometry),
    };
    let made = scene(&source, &mesh, &survey);
    write(&file, &made.text)?;
    print(&next_step(&file, made.is_held))
}

/// The mesh, with surfaces that have rock on both sides as fractures; that of a plane is one cell
/// thick.
fn mesh(input: &Path, is_geometry: bool, gmsh: &GmshOptions) -> Result<Mesh, Vec<Defect>> {
    let output = Output::nowhere()?;
    let draft = match is_geometry {
        true => meshed(input, &output, gmsh)?,
        false => read_mesh(input, 0, &output.unfinished(""), gmsh)?,
    };
    let draft = match draft.is_plane() {
        true => draft.extruded(),
        false => draft,
    };
    let faces = Faces::of(&draft);
    let roles = faces.guessed_roles(&draft);
    Mesh::build_on(draft, faces, &roles)
}

/// The mesh of a geometry: of its volumes or, where it has none, of its surfaces if they lie in a
/// plane.
fn meshed(geometry: &Path, output: &Output, gmsh: &GmshOptions) -> Result<Draft, Vec<Defect>> {
    let made = output.unfinished("made.msh");
    let up_to = |dimension| -> Result<Draft, Vec<Defect>> {
        mesh_geometry(&Meshing {
            geometry,
            parameters: &[],
            order: 1,
            dimension,
            sizes: None,
            output: &made,
            gmsh,
        })?;
        read_mesh(&made, 0, &output.unfinished(""), gmsh)
    };
    let refused = match up_to(Dimension::Volumes) {
        Err(defects) if are_without_volumes(&defects) => defects,
        done => return done,
    };
    match up_to(Dimension::Surfaces) {
        Ok(draft) if draft.is_plane() => Ok(draft),
        _ => Err(refused),
    }
}

fn are_without_volumes(defects: &[Defect]) -> bool {
    let mut defects = defects.iter();
    defects.any(|defect| defect.code == Some(WITHOUT_VOLUMES))
}

/// What a scene may set of a geometry.
fn constants_of(input: &Path, is_geometry: bool) -> Vec<(String, f64)> {
    if !is_geometry {
        return Vec::new();
    }
    let script = ordinary_bytes(input).unwrap_or_default();
    constants(&String::from_utf8_lossy(&script))
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

/// What is to be done with a scene that has been written.
fn next_step(file: &Path, is_held: bool) -> String {
    let (shown, word) = (file.display().to_string(), shell_path(file));
    let (shown, word) = (one_line(&shown), one_line(&word));
    let look = "look at the values marked `assumed`, then";
    match is_held {
        true => format!("{shown}: {look}\n  kluft run {word}\n"),
        false => format!(
            "{shown}: too little was found that holds the body, and a run would refuse it.\n\
             Give surfaces in it `symmetry = true`, or add [[fixed_point]] sections; {look}\n  \
             kluft run {word}\n"
        ),
    }
}

fn neither(input: &Path) -> Defect {
    let place = input.display().to_string();
    if input.is_dir() && scene_at(input).is_ok() {
        let remedy = format!("run it: kluft run {}", shell_path(input));
        return Defect::new(place, "there is a scene in this folder", remedy);
    }
    let problem = match input.exists() {
        true => "this is neither a mesh nor a geometry of gmsh",
        false => "there is no such file",
    };
    let remedy = "give a mesh (.msh) or a geometry (.geo)";
    Defect::new(place, problem, remedy)
}
