//! The tangent of the whole system: derivative of the residual, symmetric, positive definite.

use glam::DVec3;
use kluft_mesh::structured::Patch;
use kluft_solver::{
    Analysis, Cholesky, Discretisation, Load, NodeOrder, Problem, Support, System, norm,
};
use lie_core::{Closure, ClosureKind, FractureLaw, Tension};

use kluft_verification::methods::plain_newton::{response, response_at, responses};
use kluft_verification::scenes::{self, EXACT, joint};

fn three_planes(kind: ClosureKind) -> Problem {
    let planes: [&dyn Fn([f64; 3]) -> bool; 3] =
        [&|x| x[0] == 0.5, &|x| x[1] == 0.5 && x[0] >= 0.25, &|x| {
            x[2] == 0.5
        }];
    let patches: Vec<Patch<'_>> = ["x", "y", "z"]
        .iter()
        .zip(planes)
        .map(|(name, contains)| Patch { name, contains })
        .collect();
    let draft = scenes::box_draft([4; 3], [1.0; 3], &patches);
    let mut problem = scenes::problem(scenes::build(draft), joint(kind));
    scenes::support(
        &mut problem,
        "bottom",
        Support::Displacement([Some(0.0), None, Some(2e-6)]),
    );
    scenes::support(&mut problem, "front", Support::Symmetry);
    problem
}

/// Reproducible numbers in (-1, 1).
fn noise(count: usize, mut seed: u64) -> Vec<DVec3> {
    let mut next = || {
        seed ^= seed << 13;
        seed ^= seed >> 7;
        seed ^= seed << 17;
        (seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    };
    (0..count)
        .map(|_| DVec3::new(next(), next(), next()))
        .collect()
}

fn residual(system: &System<'_>, unknowns: &[DVec3]) -> Vec<DVec3> {
    let responses = responses(system, unknowns, &Load::proportional(1.0));
    let tractions: Vec<DVec3> = responses.iter().map(|response| response.traction).collect();
    system.residual(
        &system.rock_forces(unknowns),
        &tractions,
        &Load::proportional(1.0),
    )
}

#[test]
fn tangent_is_the_derivative_of_the_residual() {
    for kind in [EXACT, ClosureKind::Logarithmic { cutoff: Some(9e-5) }] {
        let problem = three_planes(kind);
        let discretisation = Discretisation::of(&problem).expect("supported");
        let system = System::assemble(&problem, discretisation);
        let count = system.discretisation().points().len();
        let unknowns: Vec<DVec3> = noise(count, 5).iter().map(|v| 1e-5 * *v).collect();
        let direction = noise(count, 11);
        let step = 1e-10;
        let moved = |sign: f64| -> Vec<DVec3> {
            std::iter::zip(&unknowns, &direction)
                .map(|(u, d)| *u + sign * step * *d)
                .collect()
        };
        let (ahead, behind) = (
            residual(&system, &moved(1.0)),
            residual(&system, &moved(-1.0)),
        );
        let tangents: Vec<_> = responses(&system, &unknowns, &Load::proportional(1.0))
            .iter()
            .map(|response| response.tangent)
            .collect();
        let tangent = system.tangent(&tangents);
        let product = tangent.times(&system.discretisation().pattern().blocks, &direction);
        // In the rows of held nodes the matrix carries the scale of the rock for the directions
        // that are held, and the residual nothing.
        let held = |unknown: usize| {
            let node = system.discretisation().points().node[unknown] as usize;
            let mut own = system.discretisation().points().of_node(node);
            own.any(|point| {
                system
                    .discretisation()
                    .supports()
                    .constraint(point)
                    .is_some()
            })
        };
        let free: Vec<usize> = (0..count).filter(|&unknown| !held(unknown)).collect();
        let expected: Vec<DVec3> = free.iter().map(|&i| product[i]).collect();
        let difference: Vec<DVec3> = free
            .iter()
            .map(|&i| (behind[i] - ahead[i]) / (2.0 * step) - product[i])
            .collect();
        let error = norm(&difference) / norm(&expected);
        assert!(error < 1e-6, "{kind:?}: {error:e}");
    }
}

#[test]
fn tangent_is_symmetric_and_positive_definite_in_closed_states() {
    let problem = three_planes(EXACT);
    let discretisation = Discretisation::of(&problem).expect("supported");
    let system = System::assemble(&problem, discretisation);
    let pattern = system.discretisation().pattern();
    let interface = system.discretisation().interface();
    for closure in [0.9, 0.5, 1e-1, 1e-3, 1e-6, 1e-9] {
        let tangents: Vec<_> = interface
            .points()
            .iter()
            .map(|point| {
                let law = system.law(point);
                let separation = law.closure.opened(1e-4 * (closure - 1.0));
                response_at(law, separation, DVec3::ZERO, point.normal).tangent
            })
            .collect();
        let tangent = system.tangent(&tangents);
        let points = system.discretisation().points();
        let rows = tangent.rows(&pattern.blocks);
        for row in 0..points.len() {
            for (column, block) in rows.row(row) {
                let mut twins = rows.row(column as usize);
                let twin = twins.find(|(at, _)| *at as usize == row);
                let (_, twin) = twin.expect("symmetric");
                let difference = block - twin.transpose();
                let size = block.to_cols_array().map(f64::abs);
                let size = size.into_iter().fold(0.0, f64::max);
                let worst = difference
                    .to_cols_array()
                    .map(f64::abs)
                    .into_iter()
                    .fold(0.0, f64::max);
                assert!(worst <= 1e-12 * size);
            }
        }
        let order = NodeOrder::of(&pattern.node_graph(points), &points.offset).expect("ordering");
        let order = order.all(&points.offset);
        let blocks = &pattern.blocks;
        let analysis = Analysis::of(&blocks.row_offset, &blocks.columns, order).expect("analysis");
        let mut solver = Cholesky::new(analysis, rows);
        assert_eq!(solver.factorise(), Ok(()), "closed to {closure}");
    }
}

#[test]
fn tractions_are_the_derivatives_of_the_energy_and_tangents_theirs() {
    let kind = ClosureKind::Logarithmic { cutoff: Some(1e-6) };
    let mut closure = Closure::new(1e-4, 1e11, kind);
    let normal = DVec3::new(1.0, -2.0, 0.5).normalize();
    for tension in [Tension::Elastic, Tension::CutOff] {
        closure.tension = tension;
        let law = FractureLaw::elastic(closure, 3e10);
        for opening in [-9.95e-5, -5e-5, 2e-5, 7e-5, 2e-4] {
            let jump = opening * normal + DVec3::new(1e-5, 2e-5, -1e-5);
            let here = response(&law, jump, normal);
            for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
                let beside = |sign: f64| response(&law, jump + sign * 1e-11 * axis, normal);
                let (above, below) = (beside(1.0), beside(-1.0));
                let change = above.traction - below.traction;
                let difference = change / 2e-11 - here.tangent * axis;
                assert!(difference.length() < 1e-5 * 1e11);
                let force = (above.potential - below.potential) / 2e-11;
                assert!((force - here.traction.dot(axis)).abs() < 1e-4 * 1e7);
            }
        }
    }
}
