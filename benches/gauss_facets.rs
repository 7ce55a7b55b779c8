//! The mean aperture of every facet of a scene in its last load step, with the fractures integrated
//! at Gauss points instead of at their nodes: what programs that use Gauss points there must get
//! too. One line a facet, its centre (m) and its aperture (m); for `benches/peers`.
//!
//!     cargo bench --bench gauss_facets -- SCENE.toml

use std::env;
use std::error::Error;
use std::io::{self, Write};
use std::path::Path;

use glam::DVec3;
use kluft_mesh::Defect;
use kluft_scene::{MeshSource, Scene};
use kluft_solver::{Discretisation, Newton, NewtonSettings, Problem, Solution, System, solution};
use lie_core::FacetQuadrature;

fn main() -> Result<(), Box<dyn Error>> {
    let file = env::args().nth(1).ok_or("which scene?")?;
    let problem = problem(Path::new(&file)).map_err(|defects| format!("{defects:?}"))?;
    let discretisation = Discretisation::of(&problem).map_err(|defects| format!("{defects:?}"))?;
    let system = System::assemble(&problem, discretisation);
    let solution = solve(&problem, &system)?;
    let mut out = io::stdout().lock();
    for (centre, aperture) in facets(&system, &solution) {
        let DVec3 { x, y, z } = centre;
        writeln!(out, "{x:e} {y:e} {z:e} {aperture:e}")?;
    }
    Ok(())
}

/// The problem of a scene with a mesh file, with the other rule for its facets.
fn problem(scene_file: &Path) -> Result<Problem, Vec<Defect>> {
    let scene = Scene::read(scene_file)?;
    let MeshSource::File(mesh_file) = &scene.mesh else {
        let remedy = "name a mesh file";
        return Err(vec![Defect::new("[mesh]", "no `file`", remedy)]);
    };
    let draft = kluft_io::load_msh(mesh_file, &env::temp_dir(), &Default::default())?;
    let mut problem = scene.problem(draft)?.problem;
    problem.facet_quadrature = FacetQuadrature::Gauss;
    Ok(problem)
}

/// The state after the last load step.
fn solve(problem: &Problem, system: &System<'_>) -> Result<Solution, Box<dyn Error>> {
    let mut newton =
        Newton::new(system, NewtonSettings::default()).map_err(|failure| format!("{failure:?}"))?;
    let mut state = system.initial_state();
    for step in &problem.schedule.steps {
        let record = newton.solve_step(system, &mut state, &step.load, kluft_solver::unobserved);
        if !record.converged() {
            return Err("no convergence".into());
        }
    }
    Ok(solution(system, &state))
}

/// Centre (m) and mean aperture (m) of every facet.
fn facets(system: &System<'_>, solution: &Solution) -> Vec<(DVec3, f64)> {
    let mesh = &system.problem().mesh;
    let facets = &mesh.facets.elements;
    let mut sums = vec![(0.0, 0.0); facets.len()];
    let points = system.discretisation().interface().points();
    for (point, result) in points.iter().zip(&solution.facet_points) {
        let (area, volume) = &mut sums[point.facet as usize];
        *area += point.area;
        *volume += point.area * result.aperture;
    }
    let centre = |facet: usize| {
        let nodes = &facets.nodes[facets.range(facet)];
        let sum: DVec3 = nodes.iter().map(|&node| mesh.nodes[node as usize]).sum();
        sum / nodes.len() as f64
    };
    let means = sums.iter().map(|(area, volume)| volume / area);
    means
        .enumerate()
        .map(|(facet, mean)| (centre(facet), mean))
        .collect()
}
