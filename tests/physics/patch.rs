//! Patch test: a uniform stress passes through a planar joint of any orientation on a real gmsh
//! mesh.
//!
//! Tractions of a uniform stress act on all faces; the exact solution is an affine displacement
//! plus a rigid jump with the traction `sigma . n`. It must hold whatever the orientation of the
//! facets and the numbering in the file.

use glam::{DMat3, DVec3};
use kluft_solver::Problem;
use lie_core::ClosureKind;

use kluft_verification::scenes::uniform_stress::{errors, uniform, with_wavy_facets};
use kluft_verification::scenes::{self, EXACT, joint};

fn check(problem: &Problem) {
    let errors = errors(problem);
    assert!(errors.iter().all(|error| *error < 1e-9), "{errors:?}");
}

#[test]
fn uniform_stress_through_an_inclined_joint() {
    for dip in [20.0, 50.0] {
        let draft = scenes::geometry("inclined-joint", &[("dip", dip), ("h", 0.3)]);
        let hyperbolic = ClosureKind::Hyperbolic { max_closure: 9e-5 };
        for kind in [ClosureKind::Linear, EXACT, hyperbolic] {
            check(&uniform(draft.clone(), joint(kind)));
            check(&uniform(with_wavy_facets(draft.clone()), joint(kind)));
            check(&uniform(scenes::shuffled(&draft, 7), joint(kind)));
        }
    }
}

#[test]
fn orientation_and_numbering_do_not_change_the_normals() {
    let draft = scenes::geometry("inclined-joint", &[("h", 0.4)]);
    let reference = scenes::build(draft.clone()).facet_areas();
    for other in [with_wavy_facets(draft.clone()), scenes::shuffled(&draft, 3)] {
        let normals = scenes::build(other).facet_areas();
        for normal in &normals {
            assert!(normal.normalize().dot(reference[0].normalize()) > 1.0 - 1e-12);
        }
    }
}

#[test]
fn rotated_bodies_rotate_their_solution() {
    let rotation = DMat3::from_axis_angle(DVec3::new(1.0, 2.0, -0.5).normalize(), 0.7);
    let draft = scenes::geometry("inclined-joint", &[("h", 0.4)]);
    let solve = |turned: bool| {
        let mut draft = draft.clone();
        let mut load = DVec3::new(0.0, 0.0, -7e6);
        if turned {
            load = rotation * load;
            for node in &mut draft.nodes {
                *node = (rotation * DVec3::from(*node)).to_array();
            }
        }
        let mut problem = scenes::problem(scenes::build(draft), joint(EXACT));
        for face in ["left", "front", "bottom"] {
            scenes::support(&mut problem, face, kluft_solver::Support::Symmetry);
        }
        scenes::load(&mut problem, "top", load);
        scenes::solve(&problem)
    };
    let (straight, turned) = (solve(false), solve(true));
    let largest = straight
        .displacements
        .iter()
        .map(|u| u.length())
        .fold(0.0, f64::max);
    for (u, v) in straight.displacements.iter().zip(&turned.displacements) {
        assert!((rotation * *u - *v).length() < 1e-9 * largest);
    }
}
