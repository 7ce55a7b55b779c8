//! An inspection: what a scene or a mesh is like, told before anything is solved.

mod cost;
mod findings;
mod gather;
mod grid;
mod groups;
mod text;
mod walls;

use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use kluft_io::{GmshOptions, load_msh, write_atomically, write_vtu};
use kluft_mesh::{Defect, Draft, Faces, Mesh, Survey};
use kluft_solver::{Discretisation, Problem, Workload};

use crate::failure::Failure;
use kluft_run::Output;
use kluft_run::{folder_for, mesh_file};
use kluft_scene::{Scene, bind, in_terms_of_scene, roles};

use findings::Inspection;

/// How to inspect.
#[derive(Debug, Clone)]
pub struct InspectOptions {
    /// Folder for `inspect.vtu`; `out` beside the input if not given.
    pub out: Option<PathBuf>,
    /// Whether the report is JSON instead of text.
    pub json: bool,
    /// How gmsh is started, and what a geometry may do.
    pub gmsh: GmshOptions,
}

/// Inspects a scene (`.toml`) or a mesh alone (`.msh`) without solving: prints the report to the
/// standard output stream and writes `inspect.vtu`.
///
/// # Errors
/// [`Failure::BadInput`] with every defect found; what could be inspected in spite of them is
/// printed before.
pub fn inspect(input: &Path, options: &InspectOptions) -> Result<(), Failure> {
    let start = Instant::now();
    let is_mesh = input
        .extension()
        .is_some_and(|extension| extension == "msh");
    let scene = if is_mesh {
        None
    } else {
        Some(Scene::read(input)?)
    };
    let folder = folder_for(input, options.out.as_deref());
    let output = Output::prepare(&folder).map_err(|defect| vec![defect])?;
    let draft = read(input, scene.as_ref(), &output, &options.gmsh)?;
    let mut inspection = Inspection::of(input, scene.as_ref(), &draft);
    let mut defects = look(draft, scene.as_ref(), &output, &mut inspection);
    inspection.seconds = start.elapsed().as_secs_f64();
    inspection.defects = defects.iter().map(Into::into).collect();
    defects.extend(print(&inspection, options.json, &output));
    match defects.is_empty() {
        true => Ok(()),
        false => Err(Failure::BadInput(defects)),
    }
}

fn read(
    input: &Path,
    scene: Option<&Scene>,
    output: &Output,
    gmsh: &GmshOptions,
) -> Result<Draft, Vec<Defect>> {
    let scratch = output.path("");
    let Some(scene) = scene else {
        return load_msh(input, &scratch, gmsh);
    };
    let file = mesh_file(scene, output, None, gmsh, &mut ())?;
    load_msh(&file.path, &scratch, gmsh)
}

/// Fills the inspection as far as the input allows; returns what is wrong with it.
fn look(
    draft: Draft,
    scene: Option<&Scene>,
    output: &Output,
    inspection: &mut Inspection,
) -> Vec<Defect> {
    let faces = Faces::of(&draft);
    let inner = faces.inner_surfaces(&draft);
    inspection.groups = groups::list(&draft, &inner, None, scene);
    let surface_roles = match scene {
        None => Ok(groups::guess(&draft, &inner)),
        Some(scene) => roles(scene, &draft, &inner).map(|found| found.of_group),
    };
    let surface_roles = match surface_roles {
        Ok(found) => found,
        Err(defects) => return defects,
    };
    inspection.groups = groups::list(&draft, &inner, Some(&surface_roles), scene);
    let mesh = match Mesh::build_on(draft, faces, &surface_roles) {
        Ok(mesh) => mesh,
        Err(defects) if scene.is_some() => return in_terms_of_scene(defects),
        Err(defects) => return defects,
    };
    let survey = Survey::of(&mesh);
    gather::topology(&mesh, &survey, inspection);
    let mut defects = Vec::new();
    let grid = grid::of(&mesh, &survey);
    defects.extend(write_vtu(&output.path("inspect.vtu"), grid).err());
    let Some(scene) = scene else {
        cost::predict(&mesh, None, Workload::one_step(&mesh, &[]), inspection);
        return defects;
    };
    match bind(scene, mesh) {
        Ok(binding) => {
            inspection.warnings.extend(binding.warnings);
            defects.extend(weigh(&binding.problem, &survey, inspection));
        }
        Err(found) => defects.extend(found),
    }
    defects
}

/// Adds what supports, loads and laws make of the mesh.
fn weigh(problem: &Problem, survey: &Survey, inspection: &mut Inspection) -> Vec<Defect> {
    gather::held_and_loaded(problem, inspection);
    walls::judge(problem, survey, inspection);
    let (discretisation, defects) = match Discretisation::of(problem) {
        Ok(discretisation) => (Some(discretisation), Vec::new()),
        Err(defects) => (None, in_terms_of_scene(defects)),
    };
    let workload = Workload::of(problem);
    cost::predict(&problem.mesh, discretisation.as_ref(), workload, inspection);
    defects
}

/// Prints the report and keeps it as `inspect.json`.
fn print(inspection: &Inspection, json: bool, output: &Output) -> Option<Defect> {
    let encoded = serde_json::to_string_pretty(inspection).unwrap_or_default() + "\n";
    let text = if json {
        encoded.clone()
    } else {
        text::of(inspection)
    };
    // A closed pipe (`| head`) ends the report, not the inspection.
    let _ = std::io::stdout().lock().write_all(text.as_bytes());
    let path = output.path("inspect.json");
    write_atomically(&path, |out| out.write_all(encoded.as_bytes())).err()
}
