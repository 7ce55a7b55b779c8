//! A stiff joint ahead of a crack.
//!
//! A unit cube is pulled apart; one half of its middle plane is a free crack, the other half a
//! joint of stiffness `K = L E/h`. The joint is in tension everywhere, so a negative traction is an
//! artefact of quadrature (Schellekens & de Borst 1993).

use glam::DVec3;
use kluft_mesh::Shape;
use kluft_mesh::structured::{Patch, cells_of};
use kluft_solver::{Discretisation, Problem, Support};
use lie_core::{ClosureKind, FacetQuadrature};

use crate::scenes::{self, ROCK, joint};

/// Cubes along an edge.
pub const CUBES: usize = 8;

/// The cube with its crack and its joint.
pub fn problem(shape: Shape, quadrature: FacetQuadrature, stiffness: f64) -> Problem {
    let on: Vec<_> = (0..6)
        .map(|face| move |x: [f64; 3]| x[face / 2] == f64::from(face as u32 % 2))
        .collect();
    let mut patches: Vec<Patch<'_>> = scenes::FACES
        .iter()
        .zip(&on)
        .map(|(name, contains)| Patch { name, contains })
        .collect();
    let crack = |x: [f64; 3]| x[2] == 0.5 && x[0] <= 0.5;
    let ahead = |x: [f64; 3]| x[2] == 0.5 && x[0] >= 0.5;
    patches.push(Patch {
        name: "crack",
        contains: &crack,
    });
    patches.push(Patch {
        name: "joint",
        contains: &ahead,
    });
    let draft = cells_of(shape, [CUBES, 2, CUBES], [1.0; 3], &patches);
    let mut problem = scenes::problem(scenes::build(draft), joint(ClosureKind::Linear));
    problem.facet_quadrature = quadrature;
    let stiff = stiffness * ROCK.young_modulus * CUBES as f64;
    for (fracture, k) in problem.fractures.iter_mut().zip([0.0, stiff]) {
        fracture.law.closure.normal_stiffness = k;
        fracture.law.shear_stiffness = k;
    }
    let pull = |z: f64| Support::Displacement([None, None, Some(z)]);
    scenes::support(&mut problem, "bottom", pull(0.0));
    scenes::support(&mut problem, "top", pull(1e-4));
    scenes::support(&mut problem, "left", Support::Symmetry);
    scenes::support(&mut problem, "front", Support::Symmetry);
    problem
}

/// Places of the facet points of the joint ahead of the crack, and the normal tractions there (Pa).
pub fn tractions(shape: Shape, quadrature: FacetQuadrature, stiffness: f64) -> Vec<(DVec3, f64)> {
    let problem = problem(shape, quadrature, stiffness);
    let solution = scenes::solve(&problem);
    let interface = Discretisation::of(&problem)
        .expect("supported")
        .into_interface();
    let nodes = &problem.mesh.facets.elements.nodes;
    // The position of a nodal point is the middle of its share; where it acts is the node.
    let place = |index: usize| match (quadrature, nodes.get(index)) {
        (FacetQuadrature::Nodal | FacetQuadrature::Control, Some(&node)) => {
            problem.mesh.nodes[node as usize]
        }
        _ => interface.points()[index].position,
    };
    let ahead = (0..interface.points().len()).filter(|&i| interface.points()[i].fracture == 1);
    ahead
        .map(|index| (place(index), solution.facet_points[index].normal_traction))
        .collect()
}
