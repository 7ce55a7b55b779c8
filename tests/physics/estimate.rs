//! The estimated error against true errors.

use std::f64::consts::PI;

use glam::{DMat3, DVec3};
use kluft_mesh::Shape;
use kluft_mesh::structured::{Patch, cells_of};
use kluft_solver::{
    Deformation, Discretisation, Estimator, Newton, NewtonSettings, Problem, System, dual_solution,
    norm, solution, unobserved,
};
use lie_core::{ClosureKind, Orthotropy, Rock, kernel, recovery_rule};

use kluft_verification::scenes::{self, ROCK, joint};

/// A cube of cells; `bump` moves nodes inside, so that cells have no special form.
fn cube(shape: Shape, cubes: usize, bump: f64) -> Problem {
    let mut draft = cells_of(shape, [cubes; 3], [1.0; 3], &[] as &[Patch<'_>]);
    for x in &mut draft.nodes {
        let bump = bump * (PI * x[0]).sin() * (PI * x[1]).sin() * (PI * x[2]).sin();
        *x = (DVec3::from(*x) + bump * DVec3::new(1.0, -0.7, 0.5)).to_array();
    }
    let mut problem = scenes::problem(scenes::build(draft), joint(scenes::EXACT));
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y];
    scenes::fix_rigid_motions(&mut problem, corners);
    problem
}

/// Estimated error and true error, in the energy norm, of a field interpolated at the nodes;
/// `gradient` is that of the field.
fn errors(
    problem: &Problem,
    field: impl Fn(DVec3) -> DVec3,
    gradient: impl Fn(DVec3) -> DMat3,
) -> (f64, f64) {
    let discretisation = Discretisation::of(problem).expect("supported");
    let system = System::assemble(problem, discretisation);
    let points = system.discretisation().points();
    let places = points.node.iter();
    let mesh = &problem.mesh;
    let moved: Vec<DVec3> = places
        .map(|&node| field(mesh.nodes[node as usize]))
        .collect();
    let estimated = Estimator::of(&system).stress_error(&system, &moved);
    let mut square = 0.0;
    for cell in 0..mesh.cells.len() {
        let nodes: Vec<DVec3> = mesh
            .cells
            .nodes_of(cell)
            .iter()
            .map(|&n| mesh.nodes[n as usize])
            .collect();
        let moved: Vec<DVec3> = nodes.iter().map(|&x| field(x)).collect();
        for fine in &recovery_rule(mesh.cells.shapes[cell]).fine {
            let (found, volume) = kernel::gradient_at(&fine.point, &nodes, &moved);
            let exact = gradient(kernel::position(&fine.point, &nodes));
            square += volume * energy(&problem.rocks[0], exact - found);
        }
    }
    (estimated.of_cell.iter().sum::<f64>().sqrt(), square.sqrt())
}

/// `sigma(H) : H`.
fn energy(rock: &Rock, gradient: DMat3) -> f64 {
    let stress = rock.stress(gradient);
    (0..3).map(|i| stress.col(i).dot(gradient.col(i))).sum()
}

#[test]
fn stresses_within_the_polynomials_have_no_error() {
    // Linear stresses, which quadratic cells hold themselves.
    let field = |x: DVec3| DVec3::new(x.x * x.y, x.y * x.z - x.x * x.x, x.z * x.z);
    let gradient = |x: DVec3| {
        DMat3::from_cols(
            DVec3::new(x.y, -2.0 * x.x, 0.0),
            DVec3::new(x.x, x.z, 0.0),
            DVec3::new(0.0, x.y, 2.0 * x.z),
        )
    };
    let (_, size) = errors(&cube(Shape::Tet4, 2, 0.0), |_| DVec3::ZERO, gradient);
    let (estimated, exact) = errors(&cube(Shape::Tet10, 3, 0.0), field, gradient);
    assert!(
        estimated < 1e-9 * size && exact < 1e-9 * size,
        "{estimated} {exact} {size}"
    );
}

#[test]
fn smooth_errors_are_met_in_all_families() {
    let wave = |x: DVec3| (1.5 * x.x + x.y - 0.7 * x.z, DVec3::new(1.5, 1.0, -0.7));
    let along = DVec3::new(1.0, 2.0, -1.0);
    let field = |x: DVec3| wave(x).0.sin() * along;
    let gradient = |x: DVec3| {
        let (phase, slope) = wave(x);
        DMat3::from_cols(along * slope.x, along * slope.y, along * slope.z) * phase.cos()
    };
    let layered =
        Orthotropy::transverse([60e9, 15e9], [0.3, 0.2], 6e9, DMat3::from_rotation_x(0.5));
    for rock in [ROCK, Rock::orthotropic(&layered, 0.0)] {
        for shape in Shape::CELLS {
            let cubes = if shape.is_quadratic() { 4 } else { 6 };
            let mut cube = cube(shape, cubes, 0.05);
            cube.rocks[0] = rock.clone();
            let (estimated, exact) = errors(&cube, field, gradient);
            let effectivity = estimated / exact;
            println!("{shape:?}: {effectivity:.3}");
            assert!(
                (0.7..1.4).contains(&effectivity),
                "{shape:?}: {effectivity}"
            );
        }
    }
}

/// A pressurised disc (Sneddon 1946), far too stiff on a coarse mesh: `|e|^2 = p (V - V_h)`.
#[test]
fn the_error_at_a_crack_front_is_met() {
    let problem = scenes::scene_file("penny", &[("h", 0.16)]);
    let discretisation = Discretisation::of(&problem).expect("supported");
    let system = System::assemble(&problem, discretisation);
    let mut newton = Newton::new(&system, NewtonSettings::default()).expect("prepared");
    let mut state = system.initial_state();
    let load = &problem.schedule.steps[0].load;
    let record = newton.solve_step(&system, &mut state, load, unobserved);
    assert!(record.converged());
    let found = solution(&system, &state);
    let points = system.discretisation().interface().points();
    let volume: f64 = points
        .iter()
        .zip(&found.facet_points)
        .map(|(p, r)| p.area * r.opening)
        .sum();
    let area: f64 = points.iter().map(|point| point.area).sum();
    let (pressure, missing) = (2e6, 4.0e-4 - volume);

    let normals: Vec<DVec3> = points.iter().map(|point| point.normal).collect();
    let dual = dual_solution(&system, &mut newton, &normals).expect("solved");
    let estimator = Estimator::of(&system);
    let states = [
        Deformation::of(&system, &found.displacements),
        Deformation::of_dual(&dual),
    ];
    let [stress, of_dual] = estimator.stress_errors(&system, states);
    let effectivity = (stress.of_cell.iter().sum::<f64>() / (pressure * missing)).sqrt();
    assert!((0.5..2.0).contains(&effectivity), "{effectivity}");

    let mean = estimator.mean_error(&system, &of_dual, &stress);
    let share = mean.of_fracture[0] * area / missing;
    println!("energy {effectivity:.3}, mean opening {share:.3}");
    assert!((0.34..2.0).contains(&share), "{share}");
    let parts: f64 = mean.of_cell.iter().sum();
    assert!((parts / mean.of_fracture[0] - 1.0).abs() < 1e-12);
}

/// Uniform stress in a block that a joint cuts: nothing to recover, nothing wrong.
#[test]
fn a_uniform_stress_has_no_error() {
    let problem = scenes::scene_file("inclined-joint", &[("h", 0.4), ("dip", 50.0)]);
    let (record, found, _) = scenes::try_solve(&problem, NewtonSettings::default());
    assert!(record.converged());
    let system = System::assemble(&problem, Discretisation::of(&problem).expect("supported"));
    let error = Estimator::of(&system).stress_error(&system, &found.displacements);
    assert!(error.relative() < 1e-9, "{}", error.relative());
    assert!(error.energy > 0.0 && norm(&found.displacements) > 0.0);
    assert!(matches!(
        problem.fractures[0].law.closure.kind,
        ClosureKind::Logarithmic { .. }
    ));
}
