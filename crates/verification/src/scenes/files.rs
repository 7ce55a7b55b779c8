//! Meshes of gmsh, and the scenes of `geometries/`.

use std::path::Path;

use kluft_io::{Dimension, GmshOptions, Meshing, load_msh, mesh_geometry};
use kluft_mesh::{Defect, Draft};
use kluft_run::{Caller, MeshInput, Origin, Outcome, Request};
use kluft_scene::Scene;
use kluft_solver::Problem;

use crate::root;

/// The mesh that gmsh makes of `geometries/NAME/NAME.geo`.
pub fn geometry(name: &str, parameters: &[(&str, f64)]) -> Draft {
    geometry_of_order(name, parameters, 1)
}

/// The same of order 1 or 2.
pub fn geometry_of_order(name: &str, parameters: &[(&str, f64)], order: u32) -> Draft {
    let geometry = root().join(format!("geometries/{name}/{name}.geo"));
    meshed_file(&geometry, parameters, order, Dimension::Volumes)
}

/// The mesh of the plane that gmsh makes of it, one cell thick.
pub fn geometry_in_plane(name: &str, parameters: &[(&str, f64)], order: u32) -> Draft {
    let geometry = root().join(format!("geometries/{name}/{name}.geo"));
    meshed_file(&geometry, parameters, order, Dimension::Surfaces).extruded()
}

/// The mesh that gmsh makes of a geometry, of order 1 or 2.
pub fn meshed_file(
    geometry: &Path,
    parameters: &[(&str, f64)],
    order: u32,
    dimension: Dimension,
) -> Draft {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("mesh.msh");
    let parameters: Vec<(String, f64)> = parameters
        .iter()
        .map(|&(name, value)| (name.to_owned(), value))
        .collect();
    mesh_geometry(&Meshing {
        geometry,
        parameters: &parameters,
        order,
        dimension,
        sizes: None,
        output: &file,
        gmsh: &GmshOptions::default(),
    })
    .unwrap_or_else(|defects| panic!("{defects:?}"));
    load_msh(&file, folder.path(), &GmshOptions::default())
        .unwrap_or_else(|defects| panic!("{defects:?}"))
}

/// The problem of `geometries/NAME/scene.toml` on a mesh with these parameters.
pub fn scene_file(name: &str, parameters: &[(&str, f64)]) -> Problem {
    let file = root().join(format!("geometries/{name}/scene.toml"));
    bound(&file, geometry(name, parameters))
}

/// The problem of a scene file on a mesh.
pub fn bound(file: &Path, draft: Draft) -> Problem {
    let scene = Scene::read(file).unwrap_or_else(|defects| panic!("{defects:?}"));
    let bound = scene.problem(draft);
    bound
        .unwrap_or_else(|defects| panic!("{defects:?}"))
        .problem
}

/// Runs a scene file, with its results in the folder `out`.
///
/// # Errors
/// Every defect of the scene.
pub fn run_scene_file(file: &Path, out: &Path) -> Result<Outcome, Vec<Defect>> {
    let text = Scene::text(file)?;
    let scene = Scene::parse_file(file, &text)?;
    let pool = rayon::ThreadPoolBuilder::new().build().expect("threads");
    let request = Request {
        scene: &scene,
        mesh: MeshInput::OfScene,
        pool: &pool,
        folder: Some(out),
        origin: Some(Origin { file, text: &text }),
        resume: false,
        keep_results: false,
        report: true,
        caller: Caller::default(),
        gmsh: GmshOptions::default(),
        ranks: None,
    };
    kluft_run::run(request, &mut ())
}
