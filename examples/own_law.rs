//! A closure law of one's own, beside its closed form: the semi-logarithmic law of rough joints.
//!
//!     cargo run --release --example own_law
#![allow(clippy::print_stdout, reason = "the table is what it is run for")]

use kluft_mesh::structured::{Patch, tetrahedra};
use kluft_scene::Scene;
use kluft_solver::{Discretisation, Load, Newton, NewtonSettings, System, solution, unobserved};
use lie_core::{ClosureKind, OwnLaw, OwnResponse};

/// `sigma_n = K_n0 b0 ln x`, `x = b / b0`: equal factors of stress close a joint by equal amounts.
const SEMI_LOGARITHMIC: OwnLaw = OwnLaw {
    name: "semi-logarithmic",
    at: |x, y| OwnResponse {
        traction: if x < 0.5 { x.ln() } else { y.ln_1p() },
        tangent: 1.0 / x,
        potential: x * x.ln() - y,
    },
};

const SCENE: &str = r#"
[mesh]
file = "in memory.msh"
[rock.default]
young_modulus = "50 GPa"
poisson_ratio = 0.0
[fracture.joint]
aperture = "0.1 mm"
normal_stiffness = "100 GPa/m"
shear_stiffness = "10 GPa/m"
[boundary.top]
pressure = "10 MPa"
[boundary.bottom]
displacement = { x = 0.0, y = 0.0, z = 0.0 }
"#;

fn main() {
    let scene = Scene::parse(SCENE, "the scene above", ".".as_ref()).expect("a sound scene");
    let surfaces = [
        Patch::new("joint", &|x| x[2] == 0.5),
        Patch::new("top", &|x| x[2] == 1.0),
        Patch::new("bottom", &|x| x[2] == 0.0),
    ];
    let draft = tetrahedra([4; 3], [1.0; 3], &surfaces);
    let mut problem = scene.problem(draft).expect("a mesh that fits").problem;
    problem.fractures[0].law.closure.kind = ClosureKind::Own(SEMI_LOGARITHMIC);

    let discretisation = Discretisation::of(&problem).expect("a body that is held");
    let system = System::assemble(&problem, discretisation);
    let mut newton = Newton::new(&system, NewtonSettings::default()).expect("a solver");
    let mut state = system.initial_state();
    println!("pressure (MPa)  aperture (um)  closed form (um)");
    for factor in [0.1, 1.0, 5.0, 20.0] {
        let load = Load::proportional(factor);
        newton.solve_step(&system, &mut state, &load, unobserved);
        let aperture = 1e6 * solution(&system, &state).facet_points[0].aperture;
        let exact = 100.0 * f64::exp(-factor);
        println!("{:14.1}  {aperture:13.7}  {exact:16.7}", 10.0 * factor);
    }
}
