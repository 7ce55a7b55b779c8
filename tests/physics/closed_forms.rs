//! Laws by simulation: the table of the logarithmic one, and the single joint of OpenGeoSys.

use glam::{DMat3, DVec3};
use kluft_mesh::structured::Patch;
use kluft_solver::{FacetState, Fracture, Solution, Support};
use lie_core::{Closure, ClosureKind, FractureLaw, Rock};

use kluft_verification::oracles::{LOG_LAW_TABLE, closed_aperture};
use kluft_verification::scenes::closing::column;
use kluft_verification::scenes::{self, EXACT};

#[test]
fn log_law_table_by_simulation_of_a_column() {
    for (q, x, slope) in LOG_LAW_TABLE {
        let solution = scenes::solve(&column(EXACT, q));
        // Secant over a small change of load, to compare the slope as well.
        let step = 1e-5;
        let further = scenes::solve(&column(EXACT, q * (1.0 + step)));
        for (point, after) in solution.facet_points.iter().zip(&further.facet_points) {
            let found = point.aperture / 1e-4;
            assert!(
                (found / closed_aperture(q) - 1.0).abs() < 1e-8,
                "q = {q}: {found}"
            );
            assert!(
                (found / x - 1.0).abs() < 2e-5,
                "q = {q}: {found} against {x}"
            );
            let secant = q * step / ((point.aperture - after.aperture) / 1e-4);
            assert!(
                (secant / slope - 1.0).abs() < 1e-3,
                "q = {q}: {secant} against {slope}"
            );
        }
    }
}

/// The rock and joint of `single_joint_3D` (OpenGeoSys, Tests/Data/LIE/Mechanics, dip 50 degrees),
/// -7 kPa on top.
fn single_joint(dip: f64, [normal, shear]: [f64; 2], kind: ClosureKind) -> Solution {
    let draft = scenes::geometry("inclined-joint", &[("dip", dip), ("h", 0.3)]);
    let fracture = Fracture {
        law: FractureLaw::elastic(Closure::new(1e-5, normal, kind), shear),
        fluid_pressure: 0.0,
    };
    let mut problem = scenes::problem(scenes::build(draft), fracture);
    problem.rocks[0] = Rock {
        young_modulus: 170e6,
        poisson_ratio: 0.22,
        density: 0.0,
        anisotropy: None,
    };
    for face in ["front", "back", "bottom"] {
        scenes::support(&mut problem, face, Support::Symmetry);
    }
    scenes::fix(&mut problem, DVec3::ZERO, [Some(0.0), None, None]);
    scenes::load(&mut problem, "top", DVec3::new(0.0, 0.0, -7e3));
    scenes::solve(&problem)
}

fn close(value: f64, expected: f64, tolerance: f64) {
    assert!(
        (value / expected - 1.0).abs() < tolerance,
        "{value:e} against {expected:e}"
    );
}

#[test]
fn single_joint_3d_linear() {
    let (sin, cos) = 50_f64.to_radians().sin_cos();
    let kind = ClosureKind::Logarithmic { cutoff: Some(1e-5) };
    let solution = single_joint(50.0, [1e12, 1e9], kind);
    for point in &solution.facet_points {
        close(point.slip.length(), 7e3 * sin * cos / 1e9, 1e-9);
        close(point.slip.length(), 3.4468e-6, 1e-5);
        close(point.opening, -7e3 * cos * cos / 1e12, 1e-6);
        close(point.opening, -2.892e-9, 1e-3);
    }
}

/// Apertures at dips of 20, 50 and 60 degrees as `geometries/README.md` has them. A constant
/// stiffness pushes the walls through each other.
#[test]
fn single_joint_negative_aperture() {
    let kind = ClosureKind::Logarithmic { cutoff: Some(1e-7) };
    for (dip, aperture) in [
        (20.0, 9.009_393e-7),
        (50.0, 1.987_915e-6),
        (60.0, 2.956_818e-6),
    ] {
        let (sin, cos) = f64::to_radians(dip).sin_cos();
        let solution = single_joint(dip, [1e8, 1e12], kind);
        for point in &solution.facet_points {
            let exact = 1e-5 * closed_aperture(7e3 * cos * cos / 1e3);
            close(point.aperture, exact, 1e-9);
            close(point.aperture, aperture, 1e-6);
            close(point.slip.length(), 7e3 * sin * cos / 1e12, 1e-9);
            close(point.normal_traction, -7e3 * cos * cos, 1e-9);
        }
    }
    let linear = single_joint(50.0, [1e8, 1e12], ClosureKind::Linear);
    for point in &linear.facet_points {
        close(point.aperture, -1.892e-5, 1e-3);
    }
}

/// Two joints under a uniaxial stress in their planes, with `across` (Pa) on the faces that they
/// are parallel to. The exact traction of the joints is `across`, whatever the law.
fn beside_the_stress(closure: Closure, across: f64) -> Vec<FacetState> {
    let contains = |[x, _, _]: [f64; 3]| x == 0.25 || x == 0.75;
    let patch = Patch::new("joints", &contains);
    let draft = scenes::box_draft([4, 3, 3], [1.0, 1.0, 1.0], &[patch]);
    let fracture = Fracture {
        law: FractureLaw::elastic(closure, 20e9),
        fluid_pressure: 0.0,
    };
    let mut problem = scenes::problem(scenes::build(draft), fracture);
    let stress = DMat3::from_diagonal(DVec3::new(across, 0.0, -1e7));
    scenes::load_with_stress(&mut problem, stress);
    scenes::fix_rigid_motions(&mut problem, [DVec3::ZERO, DVec3::X, DVec3::Y]);
    let points = scenes::solve(&problem).facet_points;
    points.iter().map(|point| point.state).collect()
}

/// Which way rounding moves the walls of a joint without load says nothing of the joint; a tension
/// of a millionth of the stress beside it does, however stiff the joint is.
#[test]
fn rounding_parts_no_walls() {
    for stiffness in [20e9, 1e18] {
        let law = Closure::new(1e-3, stiffness, EXACT);
        for (across, expected) in [
            (0.0, FacetState::Stuck),
            (-10.0, FacetState::Stuck),
            (10.0, FacetState::Open),
        ] {
            let states = beside_the_stress(law, across);
            let others = states.iter().filter(|state| **state != expected).count();
            assert_eq!(others, 0, "{stiffness:e} Pa/m, {across} Pa: {states:?}");
        }
    }
}
