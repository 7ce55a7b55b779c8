//! Orthogonal joint sets as an equivalent continuum, exact for crossings; and a T-junction under
//! uniform stress.

use glam::{DMat3, DVec3};
use kluft_mesh::structured::Patch;
use kluft_solver::Support;
use lie_core::ClosureKind;

use kluft_verification::oracles::{closed_aperture, jointed_moduli};
use kluft_verification::scenes::joint_sets::{SPACING, jointed_cube, strain_of_the_diagonal};
use kluft_verification::scenes::{self, EXACT, ROCK, joint};

fn close(value: f64, expected: f64) {
    assert!(
        (value / expected - 1.0).abs() < 1e-9,
        "{value:e} against {expected:e}"
    );
}

#[test]
fn one_two_and_three_sets_have_the_moduli_of_the_continuum() {
    let pressure = 1e6;
    for sets in 1..=3 {
        let cut = |axis: usize| axis < sets;
        for axis in 0..3 {
            let mut stress = [[0.0; 3]; 3];
            stress[axis][axis] = pressure;
            let stress = DMat3::from_cols_array_2d(&stress);
            let cube = jointed_cube(sets, stress, joint(ClosureKind::Linear));
            let strain = strain_of_the_diagonal(&cube);
            let (jointed, _, nu) = jointed_moduli(25e9, 0.25, 50e9, 20e9, SPACING, 2.0);
            let young = if cut(axis) { jointed } else { 25e9 };
            close(strain[axis], pressure / young);
            if cut(axis) {
                close(jointed, 12.5e9);
                close(-strain[(axis + 1) % 3], nu * pressure / jointed);
                close(nu, 0.125);
            }
        }
        for (a, b) in [(0, 1), (1, 2), (0, 2)] {
            let mut stress = [[0.0; 3]; 3];
            stress[a][b] = pressure;
            stress[b][a] = pressure;
            let stress = DMat3::from_cols_array_2d(&stress);
            let cube = jointed_cube(sets, stress, joint(ClosureKind::Linear));
            let strain = strain_of_the_diagonal(&cube);
            let count = f64::from(u8::from(cut(a)) + u8::from(cut(b)));
            let (_, shear, _) = jointed_moduli(25e9, 0.25, 50e9, 20e9, SPACING, count);
            close(strain[a] + strain[b], pressure / shear);
        }
    }
    let (_, shear, _) = jointed_moduli(25e9, 0.25, 50e9, 20e9, SPACING, 2.0);
    close(shear, 10.0e9 / 3.0);
    let (_, shear, _) = jointed_moduli(25e9, 0.25, 50e9, 20e9, SPACING, 1.0);
    close(shear, 5.0e9);
}

#[test]
fn three_closing_sets_carry_a_uniform_stress() {
    let stress = DMat3::from_diagonal(DVec3::new(-2.5e6, -5e6, -10e6));
    let problem = jointed_cube(3, stress, joint(EXACT));
    assert_eq!(problem.mesh.sectors.count.iter().max(), Some(&8));
    let solution = scenes::solve(&problem);
    let areas = problem.mesh.facet_areas();
    for (facet, area) in areas.iter().enumerate() {
        let normal = area.normalize();
        let q = -normal.dot(stress * normal) / (50e9 * 1e-4);
        for index in problem.mesh.facets.elements.range(facet) {
            close(
                solution.facet_points[index].aperture,
                1e-4 * closed_aperture(q),
            );
        }
    }
    for found in &solution.stresses {
        for (component, expected) in found.iter().zip([-2.5e6, -5e6, -10e6, 0.0, 0.0, 0.0]) {
            assert!((component - expected).abs() < 1e-9 * 10e6);
        }
    }
}

/// The foot of the abutting joint closes, so its two sides shift against each other along the
/// through-going joint; with `K_s = 0` there that costs nothing and the stress is uniform.
#[test]
fn t_junction_with_a_frictionless_through_joint() {
    let through = |x: [f64; 3]| x[2] == 0.5;
    let abutting = |x: [f64; 3]| x[0] == 0.5 && x[2] <= 0.5;
    let patches = [
        Patch {
            name: "through",
            contains: &through,
        },
        Patch {
            name: "abutting",
            contains: &abutting,
        },
    ];
    let draft = scenes::box_draft([4; 3], [1.0; 3], &patches);
    let mut problem = scenes::problem(scenes::build(draft), joint(EXACT));
    assert_eq!(problem.mesh.sectors.count.iter().max(), Some(&3));
    problem.fractures[0].law.shear_stiffness = 0.0;
    for face in ["left", "front", "bottom"] {
        scenes::support(&mut problem, face, Support::Symmetry);
    }
    scenes::load(&mut problem, "right", DVec3::new(-5e6, 0.0, 0.0));
    scenes::load(&mut problem, "top", DVec3::new(0.0, 0.0, -10e6));
    let solution = scenes::solve(&problem);
    for found in &solution.stresses {
        for (component, expected) in found.iter().zip([-5e6, 0.0, -10e6, 0.0, 0.0, 0.0]) {
            assert!((component - expected).abs() < 1e-9 * 10e6, "{found:?}");
        }
    }
    let elements = &problem.mesh.facets.elements;
    for facet in 0..elements.len() {
        let q = [2.0, 1.0][problem.mesh.facets.fracture[facet] as usize];
        for index in elements.range(facet) {
            close(
                solution.facet_points[index].aperture,
                1e-4 * closed_aperture(q),
            );
        }
    }
    let right = scenes::node_at(&problem.mesh, DVec3::new(1.0, 0.0, 0.0));
    let first: u32 = problem.mesh.sectors.count[..right as usize].iter().sum();
    let shortening = -5e6 / ROCK.young_modulus + 0.25 * 10e6 / ROCK.young_modulus
        - 1e-4 * (1.0 - closed_aperture(1.0));
    close(solution.displacements[first as usize].x, shortening);
}
