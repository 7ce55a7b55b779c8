//! A uniform stress through a planar joint.
//!
//! Tractions of the stress act on all faces; the exact solution is an affine displacement plus a
//! rigid jump with the traction `sigma . n`.

use glam::{DMat3, DVec3};
use kluft_mesh::Draft;
use kluft_solver::{Fracture, Problem};
use lie_core::ClosureKind;

use crate::oracles::closed_aperture;
use crate::scenes;

/// Compression with shear on every plane (Pa).
const STRESS: DMat3 = DMat3::from_cols(
    DVec3::new(-4.0e6, 1.0e6, -0.5e6),
    DVec3::new(1.0e6, -6.0e6, 0.7e6),
    DVec3::new(-0.5e6, 0.7e6, -9.0e6),
);

/// A joint in a block under the uniform stress.
pub fn uniform(draft: Draft, fracture: Fracture) -> Problem {
    let mut problem = scenes::problem(scenes::build(draft), fracture);
    scenes::load_with_stress(&mut problem, STRESS);
    scenes::fix_rigid_motions(&mut problem, [DVec3::ZERO, DVec3::X, DVec3::Y]);
    problem
}

/// Largest errors of the stress in the rock, and of traction, aperture and jump of the joint, as
/// shares of the closed form.
pub fn errors(problem: &Problem) -> [f64; 4] {
    let solution = scenes::solve(problem);
    let scale = 9.0e6;
    let mut errors = [0.0; 4];
    let mut note = |which: usize, error: f64| {
        // What is not a number stays.
        if error.is_nan() || error > errors[which] {
            errors[which] = error;
        }
    };
    for stress in &solution.stresses {
        let expected = [-4.0e6, -6.0e6, -9.0e6, 1.0e6, 0.7e6, -0.5e6];
        for (value, expected) in stress.iter().zip(expected) {
            note(0, (value - expected).abs() / scale);
        }
    }
    let law = &problem.fractures[0].law;
    let areas = problem.mesh.facet_areas();
    for (facet, area) in areas.iter().enumerate() {
        let normal = area.normalize();
        let traction = STRESS * normal;
        let across = traction.dot(normal);
        let q = -across / (law.closure.normal_stiffness * law.closure.aperture);
        let aperture = match law.closure.kind {
            ClosureKind::Linear => law.closure.aperture * (1.0 - q),
            ClosureKind::Logarithmic { .. } => law.closure.aperture * closed_aperture(q),
            // Half closed at K_n0 v_m, all but closed at any load.
            ClosureKind::Hyperbolic { max_closure } => {
                law.closure.aperture - max_closure * q / (q + max_closure / law.closure.aperture)
            }
            ClosureKind::Contact => 0.0,
            ClosureKind::Own(_) => unreachable!("no scene here has such a law"),
        };
        let slip = (traction - across * normal) / law.shear_stiffness;
        let jump = (aperture - law.closure.aperture) * normal + slip;
        for index in problem.mesh.facets.elements.range(facet) {
            let point = &solution.facet_points[index];
            note(1, (point.traction - traction).length() / scale);
            note(2, (point.aperture / aperture - 1.0).abs());
            note(3, (point.jump - jump).length() / jump.length());
        }
    }
    errors
}

/// Turns every other facet of the file around.
pub fn with_wavy_facets(mut draft: Draft) -> Draft {
    let facets = &mut draft.facets.elements;
    for facet in (0..facets.len()).step_by(2) {
        let range = facets.range(facet);
        facets.nodes[range].reverse();
    }
    draft
}
