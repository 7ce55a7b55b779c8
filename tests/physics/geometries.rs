//! Scenes of `geometries/` against their oracles: uniform stress through joints that meet at 120
//! degrees and through hexahedra, a rigid pull along a curved fault.

use glam::{DMat3, DVec3};
use kluft_solver::{Problem, Solution, Support};
use lie_core::ClosureKind;

use kluft_verification::oracles::closed_aperture;
use kluft_verification::scenes::{self, EXACT, joint};

/// Uniform stress: exact wherever the jumps that it asks for are rigid motions of the blocks.
/// 1e-9 is the tolerance of Newton's method.
fn check_uniform(problem: &Problem, stress: DMat3) -> Solution {
    let solution = scenes::solve(problem);
    let scale = 1e7;
    for found in &solution.stresses {
        let s = stress;
        let wanted = [
            s.x_axis.x, s.y_axis.y, s.z_axis.z, s.x_axis.y, s.y_axis.z, s.x_axis.z,
        ];
        for (found, wanted) in found.iter().zip(wanted) {
            assert!(
                (found - wanted).abs() < 1e-9 * scale,
                "{found:e}, {wanted:e}"
            );
        }
    }
    let facets = &problem.mesh.facets;
    for (facet, area) in problem.mesh.facet_areas().iter().enumerate() {
        let normal = area.normalize();
        let law = &problem.fractures[facets.fracture[facet] as usize].law;
        let across = normal.dot(stress * normal);
        let opening = match law.closure.kind {
            ClosureKind::Linear => across / law.closure.normal_stiffness,
            ClosureKind::Logarithmic { .. } => 1e-4 * (closed_aperture(-across / 5e6) - 1.0),
            other => panic!("no closed form for {other:?}"),
        };
        let slip = (stress * normal - across * normal) / law.shear_stiffness;
        for index in facets.elements.range(facet) {
            let found = solution.facet_points[index].jump;
            let wanted = opening * normal + slip;
            assert!(
                (found - wanted).length() < 1e-9 * 1e-4,
                "{found} against {wanted}"
            );
        }
    }
    solution
}

/// Where the rigid motions of the body are held; the blocks may move against each other.
const CORNERS: [DVec3; 3] = [DVec3::ZERO, DVec3::X, DVec3::Y];

fn y_junction(fracture: kluft_solver::Fracture, stress: DMat3) -> Problem {
    let draft = scenes::geometry("y-junction", &[("h", 0.3)]);
    let mut problem = scenes::problem(scenes::build(draft), fracture);
    assert_eq!(problem.mesh.sectors.count.iter().max(), Some(&3));
    assert_eq!(problem.mesh.block_count, 3);
    scenes::load_with_stress(&mut problem, stress);
    scenes::fix_rigid_motions(&mut problem, CORNERS);
    problem
}

/// Equal closures along normals at 120 degrees add up to zero, and so do the slips of a shear along
/// the line.
#[test]
fn y_junction_under_equal_stresses_and_shear_along_the_line() {
    let stress = DMat3::from_cols(
        DVec3::new(-5e6, 0.0, 1e6),
        DVec3::new(0.0, -5e6, -0.4e6),
        DVec3::new(1e6, -0.4e6, -8e6),
    );
    check_uniform(&y_junction(joint(EXACT), stress), stress);
    let problem = y_junction(joint(EXACT), stress);
    for point in scenes::solve(&problem).facet_points {
        assert!((point.aperture / 4.240_127_935e-5 - 1.0).abs() < 1e-9);
    }
}

/// With `K_n = K_s` the jump is `sigma n / K`, and closes around the line for every stress.
#[test]
fn y_junction_of_equal_stiffnesses_under_any_stress() {
    let stress = DMat3::from_cols(
        DVec3::new(-4e6, 1e6, -0.5e6),
        DVec3::new(1e6, -6e6, 0.7e6),
        DVec3::new(-0.5e6, 0.7e6, -9e6),
    );
    let mut fracture = joint(ClosureKind::Linear);
    fracture.law.shear_stiffness = fracture.law.closure.normal_stiffness;
    check_uniform(&y_junction(fracture, stress), stress);
}

#[test]
fn uniform_stress_through_crossing_joints_in_hexahedra() {
    let stress = DMat3::from_cols(
        DVec3::new(-5e6, 1e6, 0.3e6),
        DVec3::new(1e6, -10e6, 0.0),
        DVec3::new(0.3e6, 0.0, -2.5e6),
    );
    for order in [1, 2] {
        let draft = scenes::geometry_of_order("hexahedra", &[("n", 2.0), ("angle", 60.0)], order);
        let mut problem = scenes::problem(scenes::build(draft), joint(EXACT));
        assert_eq!(problem.mesh.sectors.count.iter().max(), Some(&8));
        scenes::load_with_stress(&mut problem, stress);
        scenes::fix_rigid_motions(&mut problem, CORNERS);
        check_uniform(&problem, stress);
    }
}

/// A rigid translation of the hanging wall along a fault without stiffness strains nothing.
#[test]
fn rigid_pull_along_a_curved_fault_is_free_of_stress() {
    let pull = DVec3::new(1e-2, 0.0, 4e-3);
    for (order, bulge) in [(1, 0.0), (1, 0.15), (2, 0.15)] {
        let draft =
            scenes::geometry_of_order("curved-fault", &[("h", 0.2), ("bulge", bulge)], order);
        let mut roles = scenes::roles(&draft);
        for (group, role) in draft.groups.iter().zip(&mut roles) {
            if group.name == "hanging" {
                *role = kluft_mesh::SurfaceRole::Boundary;
            }
        }
        let mesh = kluft_mesh::Mesh::build(draft, &roles).expect("a good mesh");
        let mut fracture = joint(ClosureKind::Linear);
        fracture.law.closure.normal_stiffness = 0.0;
        fracture.law.shear_stiffness = 0.0;
        let mut problem = scenes::problem(mesh, fracture);
        let held = pull.to_array().map(Some);
        scenes::support(
            &mut problem,
            "bottom",
            Support::Displacement([Some(0.0); 3]),
        );
        scenes::support(&mut problem, "hanging", Support::Displacement(held));
        let solution = scenes::solve(&problem);
        let stresses = solution.stresses.iter().flatten().map(|s| s.abs());
        let largest = stresses.fold(0.0, f64::max);
        // What rounding of displacements of 1e-2 m gives on the shortest edges is 1e-14 E.
        assert!(
            largest < 1e-12 * scenes::ROCK.young_modulus,
            "{largest:e} Pa"
        );
        for point in &solution.facet_points {
            // The normal of the fault points from the footwall up to the hanging wall.
            assert!((point.jump - pull).length() < 1e-12 * pull.length());
        }
    }
}
