//! A sweep of a joint's stiffness: the rock is assembled and prepared once, only the law changes.
//!
//!     cargo run --release --example sweep_stiffness
#![allow(clippy::print_stdout, reason = "the table is what it is run for")]

use std::path::Path;

use kluft_mesh::structured::{Patch, tetrahedra};
use kluft_scene::Scene;
use kluft_solver::{Discretisation, Load, Newton, NewtonSettings, System, solution, unobserved};

const SCENE: &str = r#"
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
"#;

fn main() {
    let scene = Scene::parse(SCENE, "the scene above", Path::new(".")).expect("a sound scene");
    let surfaces = [
        Patch::new("joint", &|x| x[2] == 0.5),
        Patch::new("top", &|x| x[2] == 1.0),
        Patch::new("bottom", &|x| x[2] == 0.0),
    ];
    let draft = tetrahedra([8; 3], [1.0; 3], &surfaces);
    let problem = scene.problem(draft).expect("a mesh that fits").problem;

    let discretisation = Discretisation::of(&problem).expect("a body that is held");
    let mut system = System::assemble(&problem, discretisation);
    let mut newton = Newton::new(&system, NewtonSettings::default()).expect("a solver");
    let mut state = system.initial_state();
    println!("K_n (GPa/m)  Newton iterations  smallest aperture (um)");
    for stiffness in [50.0, 100.0, 200.0, 400.0, 800.0] {
        let mut law = problem.fractures[0].law;
        law.closure.normal_stiffness = 1e9 * stiffness;
        system.set_laws(vec![law]);
        let record = newton.solve_step(&system, &mut state, &Load::proportional(1.0), unobserved);
        let apertures = solution(&system, &state).facet_points;
        let smallest = apertures
            .iter()
            .map(|point| point.aperture)
            .fold(1.0, f64::min);
        let count = record.iterations.len();
        println!("{stiffness:11.0}  {count:17}  {:22.3}", 1e6 * smallest);
    }
}
