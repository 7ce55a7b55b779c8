//! Cubes cut by orthogonal sets of joints.

use glam::{DMat3, DVec3};
use kluft_mesh::structured::Patch;
use kluft_solver::{Fracture, Problem};

use crate::scenes;

/// Of the joints of a set (m): the edge of the cube.
pub const SPACING: f64 = 0.5;
const PLANES: [(&str, usize); 3] = [("x", 0), ("y", 1), ("z", 2)];

/// A cube of rock with `sets` joint sets, one joint a set through its middle.
pub fn jointed_cube(sets: usize, stress: DMat3, fracture: Fracture) -> Problem {
    let on: Vec<_> = PLANES
        .iter()
        .map(|&(_, axis)| move |x: [f64; 3]| x[axis] == SPACING / 2.0)
        .collect();
    let patches: Vec<Patch<'_>> = PLANES[..sets]
        .iter()
        .zip(&on)
        .map(|(&(name, _), contains)| Patch { name, contains })
        .collect();
    let draft = scenes::box_draft([4; 3], [SPACING; 3], &patches);
    let mut problem = scenes::problem(scenes::build(draft), fracture);
    scenes::load_with_stress(&mut problem, stress);
    let arm = SPACING / 4.0;
    scenes::fix_rigid_motions(&mut problem, [DVec3::ZERO, arm * DVec3::X, arm * DVec3::Y]);
    problem
}

/// Displacement of the corner opposite to the fixed one, over the spacing.
pub fn strain_of_the_diagonal(problem: &Problem) -> DVec3 {
    let solution = scenes::solve(problem);
    let corner = scenes::node_at(&problem.mesh, DVec3::splat(SPACING));
    let point: u32 = problem.mesh.sectors.count[..corner as usize].iter().sum();
    solution.displacements[point as usize] / SPACING
}
