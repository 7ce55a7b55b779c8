//! Conditions: supports on cut faces, loads, gravity, initial stress, load steps.

use glam::{DMat3, DVec3};
use kluft_mesh::structured::Patch;
use kluft_solver::{
    Condition, Discretisation, Field, InitialStress, Load, Newton, NewtonSettings, Problem,
    Profile, Support, SurfaceLoad, System, solution, unobserved,
};
use lie_core::ClosureKind;

use kluft_verification::oracles::closed_aperture;
use kluft_verification::scenes::closing::column;
use kluft_verification::scenes::{self, EXACT, joint};

fn vertical_joint() -> Problem {
    let middle = |x: [f64; 3]| x[0] == 0.5;
    let patch = Patch {
        name: "joint",
        contains: &middle,
    };
    let draft = scenes::box_draft([4, 2, 2], [1.0, 0.5, 0.5], &[patch]);
    scenes::problem(scenes::build(draft), joint(EXACT))
}

/// Displacements of all points of the nodes that satisfy `on`.
fn at_nodes(problem: &Problem, displacements: &[DVec3], on: impl Fn(DVec3) -> bool) -> Vec<DVec3> {
    let points = kluft_solver::SectorNodes::of(&problem.mesh);
    (0..points.len())
        .filter(|&point| on(problem.mesh.nodes[points.node[point] as usize]))
        .map(|point| displacements[point])
        .collect()
}

#[test]
fn supports_hold_both_sides_of_a_cut_face() {
    let mut problem = vertical_joint();
    scenes::support(
        &mut problem,
        "bottom",
        Support::Displacement([Some(1e-4); 3]),
    );
    scenes::load(&mut problem, "right", DVec3::new(-5e6, 1e6, 2e6));
    let solution = scenes::solve(&problem);
    let held = at_nodes(&problem, &solution.displacements, |x| x.z == 0.0);
    assert_eq!(
        held.len(),
        5 * 3 + 3,
        "the cut face has two copies of three nodes"
    );
    for u in held {
        assert_eq!(u, DVec3::splat(1e-4));
    }
    let elsewhere = at_nodes(&problem, &solution.displacements, |x| x.z == 0.5);
    assert!(
        elsewhere
            .iter()
            .any(|u| (*u - DVec3::splat(1e-4)).length() > 1e-6)
    );
}

#[test]
fn loads_act_on_both_sides_of_a_cut_face() {
    let mut problem = vertical_joint();
    for face in ["left", "front", "bottom"] {
        scenes::support(&mut problem, face, Support::Symmetry);
    }
    scenes::load(&mut problem, "right", DVec3::new(-5e6, 0.0, 0.0));
    scenes::load(&mut problem, "top", DVec3::new(0.0, 0.0, -3e6));
    let solution = scenes::solve(&problem);
    for stress in &solution.stresses {
        for (component, expected) in stress.iter().zip([-5e6, 0.0, -3e6, 0.0, 0.0, 0.0]) {
            assert!((component - expected).abs() < 1e-9 * 5e6);
        }
    }
}

/// Two opposite blocks of a crossing share the middle edge; one is lifted, one lowered.
#[test]
fn blocks_that_meet_at_an_edge_are_held_differently() {
    let planes: [&dyn Fn([f64; 3]) -> bool; 2] = [&|x| x[0] == 0.5, &|x| x[1] == 0.5];
    let low = |x: [f64; 3]| x[2] == 0.0 && x[0] <= 0.5 && x[1] <= 0.5;
    let high = |x: [f64; 3]| x[2] == 0.0 && x[0] >= 0.5 && x[1] >= 0.5;
    let mut draft = scenes::box_draft(
        [4, 4, 2],
        [1.0, 1.0, 0.5],
        &[
            Patch {
                name: "x",
                contains: planes[0],
            },
            Patch {
                name: "y",
                contains: planes[1],
            },
            Patch {
                name: "low",
                contains: &low,
            },
            Patch {
                name: "high",
                contains: &high,
            },
        ],
    );
    let mut roles = scenes::roles(&draft);
    for (group, role) in draft.groups.iter_mut().zip(&mut roles) {
        if ["low", "high"].contains(&group.name.as_str()) {
            *role = kluft_mesh::SurfaceRole::Boundary;
        }
    }
    let mesh = kluft_mesh::Mesh::build(draft, &roles).expect("a good mesh");
    let mut problem = scenes::problem(mesh, joint(ClosureKind::Linear));
    let lift = |z: f64| Support::Displacement([Some(0.0), Some(0.0), Some(z)]);
    scenes::support(&mut problem, "low", lift(1e-5));
    scenes::support(&mut problem, "high", lift(-1e-5));
    let solution = scenes::solve(&problem);
    let middle = DVec3::new(0.5, 0.5, 0.0);
    let mut lifts: Vec<f64> = at_nodes(&problem, &solution.displacements, |x| x == middle)
        .iter()
        .map(|u| u.z)
        .collect();
    lifts.sort_by(f64::total_cmp);
    assert_eq!(lifts.len(), 4);
    assert_eq!((lifts[0], lifts[3]), (-1e-5, 1e-5));
    assert!(lifts[1].abs() < 0.9e-5 && lifts[2].abs() < 0.9e-5);
}

#[test]
fn fluid_pressure_opens() {
    let mut problem = column(ClosureKind::Linear, 0.0);
    problem.fractures[0].fluid_pressure = 3e6;
    let solution = scenes::solve(&problem);
    for point in &solution.facet_points {
        assert!((point.opening / (3e6 / 50e9) - 1.0).abs() < 1e-9);
        assert!((point.normal_traction / 3e6 - 1.0).abs() < 1e-9);
    }
}

#[test]
fn pressure_is_traction_along_the_inward_normal() {
    let mut pressed = vertical_joint();
    for face in ["left", "front", "bottom"] {
        scenes::support(&mut pressed, face, Support::Symmetry);
    }
    let mut pulled = pressed.clone();
    scenes::load(&mut pulled, "right", DVec3::new(-4e6, 0.0, 0.0));
    pressed.conditions.push(Condition {
        boundary: scenes::boundary(&pressed, "right"),
        load: Some(SurfaceLoad::Pressure(4e6)),
        support: None,
    });
    let (a, b) = (scenes::solve(&pressed), scenes::solve(&pulled));
    for (u, v) in a.displacements.iter().zip(&b.displacements) {
        assert!((*u - *v).length() < 1e-14);
    }
}

/// The joint carries exactly the weight above it.
#[test]
fn gravity_rests_on_the_joint() {
    let mut problem = column(EXACT, 0.0);
    problem.rocks[0].density = 2700.0;
    problem.gravity = DVec3::new(0.0, 0.0, -9.81);
    let solution = scenes::solve(&problem);
    let interface = Discretisation::of(&problem)
        .expect("supported")
        .into_interface();
    let force: f64 = std::iter::zip(interface.points(), &solution.facet_points)
        .map(|(point, result)| point.area * result.normal_traction)
        .sum();
    assert!((force / (-2700.0 * 9.81) - 1.0).abs() < 1e-9, "{force}");
}

fn uniform_profile(stress: DMat3) -> InitialStress {
    let value = |value: f64| Profile {
        value,
        ..Profile::default()
    };
    let components = [
        value(stress.x_axis.x),
        value(stress.y_axis.y),
        value(stress.z_axis.z),
        value(stress.x_axis.y),
        value(stress.y_axis.z),
        value(stress.x_axis.z),
    ];
    InitialStress {
        components: components.map(Field::from),
    }
}

#[test]
fn loads_that_balance_the_initial_stress_move_nothing() {
    let stress = DMat3::from_cols(
        DVec3::new(-4e6, 1e6, -0.5e6),
        DVec3::new(1e6, -6e6, 0.7e6),
        DVec3::new(-0.5e6, 0.7e6, -9e6),
    );
    let draft = scenes::geometry("inclined-joint", &[("h", 0.4)]);
    let mut problem = scenes::problem(scenes::build(draft), joint(EXACT));
    scenes::load_with_stress(&mut problem, stress);
    scenes::fix_rigid_motions(&mut problem, [DVec3::ZERO, DVec3::X, DVec3::Y]);
    problem.initial_stress = Some(uniform_profile(stress));
    let solution = scenes::solve(&problem);
    let largest = solution
        .displacements
        .iter()
        .map(|u| u.length())
        .fold(0.0, f64::max);
    assert!(largest < 1e-15, "{largest:e}");
    let normal = problem.mesh.facet_areas()[0].normalize();
    let q = -normal.dot(stress * normal) / (50e9 * 1e-4);
    for point in &solution.facet_points {
        assert!((point.aperture / (1e-4 * closed_aperture(q)) - 1.0).abs() < 1e-9);
        assert!((point.traction - stress * normal).length() < 1e-9 * 9e6);
    }
}

/// Weight and a stress that grows with depth, on joints lying, inclined and crossing.
#[test]
fn lithostatic_stress_and_gravity_move_nothing() {
    let flat = |x: [f64; 3]| x[2] == 1.0;
    let steep = |x: [f64; 3]| x[0] == 0.5;
    let patches = [
        Patch {
            name: "flat",
            contains: &flat,
        },
        Patch {
            name: "steep",
            contains: &steep,
        },
    ];
    let draft = scenes::box_draft([4, 2, 4], [1.0, 0.5, 2.0], &patches);
    let mut problem = scenes::problem(scenes::build(draft), joint(EXACT));
    let weight = 2700.0 * 9.81;
    problem.rocks[0].density = 2700.0;
    problem.gravity = DVec3::new(0.0, 0.0, -9.81);
    let profile = |factor: f64| Profile {
        at: 2.0,
        value: 0.0,
        per_metre: factor * weight,
    };
    let mut initial = InitialStress::default();
    let normal = [profile(0.5), profile(0.7), profile(1.0)].map(Field::from);
    initial.components[..3].clone_from_slice(&normal);
    problem.initial_stress = Some(initial);
    for face in ["left", "right", "front", "back", "bottom"] {
        scenes::support(&mut problem, face, Support::Symmetry);
    }
    let solution = scenes::solve(&problem);
    let largest = solution
        .displacements
        .iter()
        .map(|u| u.length())
        .fold(0.0, f64::max);
    assert!(largest < 1e-16, "{largest:e}");
}

#[test]
fn initial_stress_closes_and_unloading_opens() {
    let mut problem = column(EXACT, 0.0);
    let stress = DMat3::from_diagonal(DVec3::new(0.0, 0.0, -10e6));
    problem.initial_stress = Some(uniform_profile(stress));
    let solution = scenes::solve(&problem);
    for point in &solution.facet_points {
        assert!((point.aperture / 1e-4 - 1.0).abs() < 1e-9);
        assert!((point.opening / (1e-4 * (1.0 - closed_aperture(2.0))) - 1.0).abs() < 1e-9);
    }
}

#[test]
fn load_steps_end_where_one_step_does() {
    let mut problem = column(EXACT, 20.0);
    scenes::support(
        &mut problem,
        "back",
        Support::Displacement([None, Some(1e-5), None]),
    );
    let discretisation = Discretisation::of(&problem).expect("supported");
    let system = System::assemble(&problem, discretisation);
    let mut newton = Newton::new(&system, NewtonSettings::default()).expect("analysis");
    let mut ends = Vec::new();
    for steps in [vec![1.0], vec![0.1, 0.5, 2.0, 1.0]] {
        let mut state = system.initial_state();
        for load in steps {
            assert!(
                newton
                    .solve_step(&system, &mut state, &Load::proportional(load), unobserved)
                    .converged()
            );
        }
        ends.push(solution(&system, &state));
    }
    for (a, b) in std::iter::zip(&ends[0].facet_points, &ends[1].facet_points) {
        assert!((a.aperture / b.aperture - 1.0).abs() < 1e-9);
        assert!((a.traction - b.traction).length() < 1e-9 * 1e8);
    }
}
