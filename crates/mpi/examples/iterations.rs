//! Iterations of the linear solver on ranks against those of the serial one, by the stiffness of
//! the fractures: `mpiexec -n 2 iterations SCENE.toml MESH.msh`.
//!
//! All facet points get the normal stiffness `K_n` and the shear stiffness `K_s`, given by
//! `K_n h/E` and `K_s h/E`, where `E/h` is the stiffness of the rock as each of them feels it.
//! `slide` has `K_s h/E = 0.05`, walls that are pressed together and may slide; `glue` has
//! `K_s = 0.3 K_n`.

#![allow(clippy::print_stdout, reason = "the table is what it is run for")]

use std::path::PathBuf;

use glam::{DMat3, DVec3};
use kluft_io::{GmshOptions, load_msh};
use kluft_mpi::communicator::communicator;
use kluft_mpi::distributed::Distributed;
use kluft_mpi::petsc::World;
use kluft_scene::Scene;
use kluft_solver::{Discretisation, Iterative, Load, System, TangentSolver};

const TOLERANCE: f64 = 1e-8;

fn main() {
    let world = World::start().expect("PETSc starts");
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [scene, mesh] = &arguments[..] else {
        panic!("a scene and its mesh are wanted");
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1);
    let pool = pool.use_current_thread().build().expect("a thread");
    pool.install(|| {
        let scene = Scene::read(scene).expect("a scene");
        let folder = std::env::temp_dir();
        let draft = load_msh(mesh, &folder, &GmshOptions::default()).expect("a mesh");
        let binding = scene.problem(draft).expect("a problem");
        let discretisation = Discretisation::of(&binding.problem).expect("held");
        let mut divided = System::divided(
            &binding.problem,
            discretisation.clone(),
            &communicator(&world),
        );
        let system = System::assemble(&binding.problem, discretisation);
        let load = &binding.problem.schedule.steps[0].load;
        let mut distributed = Distributed::new(&world, &mut divided).expect("prepared");
        let mut serial = Iterative::new(&system).expect("prepared");
        if world.rank() == 0 {
            let unknowns = system.discretisation().unknown_count();
            println!("{unknowns} unknowns, {} ranks", world.ranks());
            println!("kind   K_n h/E   serial  ranks  difference");
        }
        for kind in ["slide", "glue"] {
            for exponent in -2..=6 {
                let row = Row { kind, exponent };
                let found = row.solve(load, (&system, &mut serial), (&divided, &mut distributed));
                if world.rank() == 0 {
                    println!("{kind:<6} {:>7.0e}   {found}", 10_f64.powi(exponent));
                }
            }
        }
    });
}

struct Row {
    kind: &'static str,
    exponent: i32,
}

impl Row {
    fn tangents(&self, system: &System<'_>) -> Vec<DMat3> {
        let points = system.discretisation().interface().points().iter();
        let tangents = points.map(|point| {
            let rock = point.rock_stiffness().normal;
            let normal = 10_f64.powi(self.exponent) * rock;
            let shear = match self.kind {
                "slide" => 0.05 * rock,
                _ => 0.3 * normal,
            };
            let n = point.normal;
            let nn = DMat3::from_cols(n.x * n, n.y * n, n.z * n);
            shear * DMat3::IDENTITY + (normal - shear) * nn
        });
        tangents.collect()
    }

    fn solve(
        &self,
        load: &Load,
        (system, serial): (&System<'_>, &mut Iterative),
        (divided, distributed): (&System<'_>, &mut Distributed),
    ) -> String {
        let interface = system.discretisation().interface();
        let stiffness = interface.stiffness(&self.tangents(system));
        let rhs: Vec<DVec3> = system.load_forces(load);
        let solved = |system: &System<'_>, solver: &mut dyn TangentSolver| {
            let fixed = system.fixed_part();
            solver.update(fixed, stiffness.clone())?;
            solver.solve(fixed, &rhs, TOLERANCE)
        };
        let (a, b) = match (solved(system, serial), solved(divided, distributed)) {
            (Ok(a), Ok(b)) => (a, b),
            (a, b) => return format!("{:?} {:?}", a.err(), b.err()),
        };
        let pairs = a.unknowns.iter().zip(&b.unknowns);
        let difference = pairs.map(|(a, b)| (*a - *b).length()).fold(0.0, f64::max);
        let largest = a.unknowns.iter().map(|a| a.length()).fold(0.0, f64::max);
        format!(
            "{:>6} {:>6}  {:.1e}",
            a.iterations,
            b.iterations,
            difference / largest
        )
    }
}
