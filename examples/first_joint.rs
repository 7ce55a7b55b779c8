//! A first joint, in memory: a scene as text, a mesh without gmsh, results as values.
//!
//!     cargo run --release --example first_joint
#![allow(clippy::print_stdout, reason = "the table is what it is run for")]

use std::path::Path;

use kluft_mesh::structured::{Patch, tetrahedra};
use kluft_run::{MeshInput, Request, run};
use kluft_scene::Scene;

/// A block of 1 m, cut by a joint at half its height and pressed from above in four load steps.
const SCENE: &str = r#"
title = "a first joint"
[mesh]
file = "in memory.msh"
[rock.default]
young_modulus = "50 GPa"
poisson_ratio = 0.25
[fracture.joint]
aperture = "0.1 mm"
normal_stiffness = "100 GPa/m"
shear_stiffness = "10 GPa/m"
closure = "logarithmic"
[boundary.top]
pressure = "20 MPa"
[boundary.bottom]
displacement = { x = 0.0, y = 0.0, z = 0.0 }
[load]
steps = [0.25, 0.5, 0.75, 1.0]
"#;

fn main() {
    let scene = Scene::parse(SCENE, "the scene above", Path::new("."));
    let scene = scene.unwrap_or_else(|defects| panic!("{defects:?}"));
    let surfaces = [
        Patch::new("joint", &|x| x[2] == 0.5),
        Patch::new("top", &|x| x[2] == 1.0),
        Patch::new("bottom", &|x| x[2] == 0.0),
    ];
    let mesh = MeshInput::Draft(Box::new(tetrahedra([8; 3], [1.0; 3], &surfaces)));
    let pool = rayon::ThreadPoolBuilder::new().build().expect("threads");

    let outcome = run(Request::in_memory(&scene, mesh, &pool), &mut ());
    let outcome = outcome.unwrap_or_else(|defects| panic!("{defects:?}"));

    println!("load  mean aperture (um)  mean normal traction (MPa)");
    for step in &outcome.steps {
        let (load, (_, joint)) = (step.summary.load.unwrap_or(1.0), &step.fractures[0]);
        let aperture = 1e6 * joint.aperture.mean;
        let traction = 1e-6 * joint.normal_traction.mean;
        println!("{load:4.2}  {aperture:18.2}  {traction:26.2}");
    }
}
