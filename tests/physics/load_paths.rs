//! Load cases with histories of their own: superposition, unloading, and steps that are divided.
//!
//! Laws here are linear unless a test says otherwise, so the oracle of a step is the sum of the
//! closed forms of its cases, each times its factor. Tolerances are those of Newton's test of the
//! forces.

use glam::{DMat3, DVec3};
use kluft_mesh::structured::Patch;
use kluft_solver::{
    Discretisation, LinearMethod, Load, Newton, NewtonSettings, Problem, Schedule, Solution, Step,
    Support, System, solution, unobserved,
};
use lie_core::ClosureKind;

use kluft_verification::scenes::closing::column;
use kluft_verification::scenes::{self, EXACT, joint};

/// Loads that grow, hold, turn and vanish, each case for itself: time and factors.
const PATH: [[f64; 3]; 9] = [
    [0.5, 0.5, 0.0],
    [1.0, 1.0, 0.0],
    [2.0, 1.0, 0.5],
    [3.0, 1.0, 1.0],
    [4.0, 0.25, 2.0],
    [5.0, -0.5, 1.0],
    [6.0, 0.0, 1.0],
    [7.0, 0.0, 1.0],
    [8.0, 0.0, 0.0],
];

fn schedule(path: &[[f64; 3]]) -> Schedule {
    let step = |&[time, a, b]: &[f64; 3]| Step {
        load: Load {
            time,
            factors: vec![a, b],
        },
        phase: None,
    };
    Schedule {
        steps: path.iter().map(step).collect(),
        is_timed: true,
        goes_on_from: None,
        sudden: Vec::new(),
        ..Schedule::proportional(Vec::new())
    }
}

/// Solves all steps; `check` sees each with its factors.
fn follow(problem: &Problem, linear: LinearMethod, check: impl Fn(&Load, &System<'_>, &Solution)) {
    let discretisation = Discretisation::of(problem).unwrap_or_else(|d| panic!("{d:?}"));
    let system = System::assemble(problem, discretisation);
    let settings = NewtonSettings {
        linear: Some(linear),
        ..NewtonSettings::default()
    };
    let mut newton = Newton::new(&system, settings).expect("prepared");
    let mut state = system.initial_state();
    for step in &problem.schedule.steps {
        let record = newton.solve_step(&system, &mut state, &step.load, unobserved);
        assert!(record.converged(), "{linear}, {:?}: {record:?}", step.load);
        check(&step.load, &system, &solution(&system, &state));
    }
}

fn level_joint() -> Problem {
    let middle = |x: [f64; 3]| x[2] == 1.0;
    let patch = Patch {
        name: "joint",
        contains: &middle,
    };
    let draft = scenes::box_draft([2, 2, 4], [1.0, 1.0, 2.0], &[patch]);
    scenes::problem(scenes::build(draft), joint(ClosureKind::Linear))
}

/// Pressure is one case and shear the other: opening `-f_1 p / K_n`, slip `f_2 tau / K_s`.
#[test]
fn pressure_and_shear_superpose() {
    let (pressure, shear) = (3e6, 1e6);
    let mut problem = level_joint();
    let stresses = [
        DMat3::from_diagonal(DVec3::new(0.0, 0.0, -pressure)),
        DMat3::from_cols(shear * DVec3::Z, DVec3::ZERO, shear * DVec3::X),
    ];
    problem.schedule = schedule(&PATH);
    for (case, stress) in stresses.into_iter().enumerate() {
        scenes::load_with_stress(&mut problem, stress);
        let count = problem.conditions.len();
        problem.schedule.cases.conditions.resize(count, case);
    }
    scenes::fix_rigid_motions(&mut problem, [DVec3::ZERO, DVec3::X, DVec3::Y]);
    for method in LinearMethod::ALL {
        follow(&problem, method, |load, _, solution| {
            let (opening, slip) = (
                -load.factors[0] * pressure / 50e9,
                load.factors[1] * shear / 20e9,
            );
            for point in &solution.facet_points {
                assert!((point.opening - opening).abs() < 1e-9 * pressure / 50e9);
                assert!((point.jump.x.abs() - slip.abs()).abs() < 1e-9 * shear / 20e9);
                assert!((point.aperture - 1e-4 - opening).abs() < 1e-9 * 1e-4);
                let traction =
                    DVec3::new(load.factors[1] * shear, 0.0, -load.factors[0] * pressure);
                assert!((point.traction.abs() - traction.abs()).length() < 1e-9 * pressure);
            }
        });
    }
}

/// The top is moved by one case and the joint is filled under pressure by the other. With `sigma`
/// the stress of the column, `u = sigma L / E + w` and `sigma = K_n w - p`.
#[test]
fn displacement_and_fluid_pressure_superpose() {
    let (shortening, pressure) = (-1e-4, 2e6);
    let mut problem = level_joint();
    for face in ["left", "front", "bottom"] {
        scenes::support(&mut problem, face, Support::Symmetry);
    }
    let push = Support::Displacement([None, None, Some(shortening)]);
    scenes::support(&mut problem, "top", push);
    problem.fractures[0].fluid_pressure = pressure;
    problem.schedule = schedule(&PATH);
    problem.schedule.cases.fractures = vec![1];
    let stiffness = 1.0 / (2.0 / 25e9 + 1.0 / 50e9);
    for method in LinearMethod::ALL {
        follow(&problem, method, |load, _, solution| {
            let (moved, pressure) = (load.factors[0] * shortening, load.factors[1] * pressure);
            let stress = stiffness * (moved - pressure / 50e9);
            let opening = (stress + pressure) / 50e9;
            for point in &solution.facet_points {
                assert!((point.opening - opening).abs() < 1e-9 * 1e-4);
                assert!((point.normal_traction - 50e9 * opening).abs() < 1e-9 * 5e6);
            }
        });
    }
}

/// The blocks beside an upright joint stand on faces that are moved by different cases, so that the
/// walls of the joint are prescribed there. The shear traction follows its jump by increments, and
/// must be `K_s` times the slip after every turn of the path.
#[test]
fn walls_moved_by_different_cases_keep_their_shear() {
    let middle = |x: [f64; 3]| x[0] == 0.5;
    let low = |x: [f64; 3]| x[2] == 0.0 && x[0] <= 0.5;
    let high = |x: [f64; 3]| x[2] == 0.0 && x[0] >= 0.5;
    let patch = |name, contains| Patch { name, contains };
    let patches = [
        patch("joint", &middle),
        patch("low", &low),
        patch("high", &high),
    ];
    let draft = scenes::box_draft([4, 2, 2], [1.0, 0.5, 0.5], &patches);
    let mut roles = scenes::roles(&draft);
    for (group, role) in draft.groups.iter().zip(&mut roles) {
        if ["low", "high"].contains(&group.name.as_str()) {
            *role = kluft_mesh::SurfaceRole::Boundary;
        }
    }
    let mesh = kluft_mesh::Mesh::build(draft, &roles).expect("a good mesh");
    let mut problem = scenes::problem(mesh, joint(ClosureKind::Linear));
    let moved = |x: f64, z: f64| Support::Displacement([Some(x), Some(0.0), Some(z)]);
    scenes::support(&mut problem, "low", moved(1e-5, 2e-5));
    scenes::support(&mut problem, "high", moved(0.0, -1e-5));
    problem.schedule = schedule(&PATH);
    problem.schedule.cases.conditions = vec![0, 1];
    for method in LinearMethod::ALL {
        follow(&problem, method, |load, system, solution| {
            let points = system.discretisation().interface().points();
            for (point, result) in points.iter().zip(&solution.facet_points) {
                let shear = result.traction - result.normal_traction * point.normal;
                assert!((shear - 20e9 * result.slip).length() < 1e-9 * 20e9 * 1e-5);
                let normal = result.normal_traction - 50e9 * result.opening;
                assert!(normal.abs() < 1e-9 * 50e9 * 1e-5);
                if point.position.z == 0.0 {
                    let [a, b] = [load.factors[0], load.factors[1]];
                    let jump = 1e-5 * DVec3::new(-a, 0.0, -b - 2.0 * a);
                    let jump = point.normal.x.signum() * jump;
                    assert!((result.jump - jump).length() < 1e-20, "{}", result.jump);
                }
            }
        });
    }
}

/// Conditions of different cases on one node: each direction has its own factor.
#[test]
fn one_node_is_held_by_several_cases() {
    let mut problem = level_joint();
    let along = |x: f64| Support::Displacement([Some(x), None, None]);
    let up = |z: f64| Support::Displacement([None, Some(0.0), Some(z)]);
    for face in ["bottom", "top"] {
        scenes::support(&mut problem, face, along(1e-5));
        scenes::support(&mut problem, face, up(2e-5));
    }
    problem.schedule = schedule(&PATH);
    problem.schedule.cases.conditions = vec![0, 1, 0, 1];
    follow(&problem, LinearMethod::Direct, |load, _, solution| {
        let moved = DVec3::new(1e-5 * load.factors[0], 0.0, 2e-5 * load.factors[1]);
        for u in &solution.displacements {
            assert!((*u - moved).length() < 1e-9 * 2e-5);
        }
    });
}

#[test]
fn different_histories_of_one_displacement_contradict_each_other() {
    let mut problem = level_joint();
    let down = Support::Displacement([None, None, Some(-1e-5)]);
    scenes::support(&mut problem, "top", down);
    scenes::support(&mut problem, "left", down);
    problem.schedule = schedule(&PATH);
    problem.schedule.cases.conditions = vec![0, 1];
    let defects = Discretisation::of(&problem).expect_err("a contradiction");
    let said = defects[0].to_string();
    assert!(
        said.contains("`top` and `left`") && said.contains("history"),
        "{said}"
    );
}

/// A joint that closes far is let go in steps that do not return along the path.
#[test]
fn unloading_to_nothing_leaves_nothing() {
    let factors = vec![0.3, 0.7, 1.0, 0.8, 0.45, 0.2, 0.05, 0.0, 0.0];
    for kind in [ClosureKind::Linear, EXACT] {
        let mut problem = column(kind, 5.0);
        problem.schedule = Schedule::proportional(factors.clone());
        for method in LinearMethod::ALL {
            follow(&problem, method, |load, _, solution| {
                if load.factors[0] != 0.0 {
                    return;
                }
                // Against 5 K_n0 b0 on a column of 2 m, which moves about 3e-3 m.
                for u in &solution.displacements {
                    assert!(u.length() < 1e-9 * 3e-3, "{kind:?}, {method}: {u}");
                }
                for point in &solution.facet_points {
                    assert!((point.aperture / 1e-4 - 1.0).abs() < 1e-9);
                    assert!(point.traction.length() < 1e-9 * 25e6);
                }
            });
        }
    }
}

/// A step that is divided ends where the whole one does.
#[test]
fn substeps_end_where_the_step_does() {
    let mut problem = column(EXACT, 10.0);
    problem.fractures[0].fluid_pressure = 4e6;
    problem.schedule = schedule(&[[1.0, 0.5, 0.0], [2.0, 1.0, 1.0]]);
    problem.schedule.cases.fractures = vec![1];
    let whole = std::cell::RefCell::new(Vec::new());
    let keep = |_: &Load, _: &System<'_>, solution: &Solution| {
        *whole.borrow_mut() = solution.facet_points.clone();
    };
    follow(&problem, LinearMethod::Direct, keep);
    let steps = problem.schedule.steps.clone();
    let parts = [0.25, 0.5, 1.0].map(|share| Step {
        load: Load::between(&steps[0].load, &steps[1].load, share),
        phase: None,
    });
    problem.schedule.steps.splice(1.., parts);
    let undivided = whole.take();
    follow(&problem, LinearMethod::Direct, keep);
    for (a, b) in undivided.iter().zip(whole.borrow().iter()) {
        assert!((a.aperture / b.aperture - 1.0).abs() < 1e-9);
        assert!((a.traction - b.traction).length() < 1e-9 * 50e6);
    }
}
