//! Unilateral contact: closed cracks, blocks that part and meet again, blocks that nothing holds.

use glam::DVec3;
use lie_core::{Closure, ClosureKind, FractureLaw, Tension};
use lie_mesh::structured::Patch;
use lie_solver::{
    Discretisation, Fracture, Load, Newton, NewtonSettings, Problem, Solution, StepRecord, Support,
    System, solution,
};

use crate::scenes;

const FREE: Option<f64> = None;
const HELD: Option<f64> = Some(0.0);

fn fracture(closure: Closure) -> Fracture {
    Fracture {
        law: FractureLaw::elastic(closure, 0.0),
        fluid_pressure: 0.0,
    }
}

/// Walks through load factors; the records and solutions of all steps.
fn walk(problem: &Problem, loads: &[f64]) -> Vec<(StepRecord, Solution)> {
    let discretisation = Discretisation::of(problem).unwrap_or_else(|d| panic!("{d:?}"));
    let system = System::assemble(problem, discretisation);
    let mut newton = Newton::new(&system, NewtonSettings::default()).expect("analysis");
    let mut state = system.initial_state();
    let steps = loads.iter().map(|&load| {
        let record = newton.step(&system, &mut state, &Load::proportional(load), |_, _| {});
        (record, solution(&system, &state))
    });
    steps.collect()
}

/// A cube with a square crack inside, pressed from above.
fn cracked_cube(closure: Closure, pressure: f64) -> Problem {
    let inside =
        |x: [f64; 3]| x[2] == 0.5 && (0.25..=0.75).contains(&x[0]) && (0.25..=0.75).contains(&x[1]);
    let patches = [Patch {
        name: "crack",
        contains: &inside,
    }];
    let mesh = scenes::build(scenes::box_draft([8, 8, 8], [1.0; 3], &patches));
    let mut problem = scenes::problem(mesh, fracture(closure));
    scenes::support(
        &mut problem,
        "bottom",
        Support::Displacement([FREE, FREE, HELD]),
    );
    scenes::support(&mut problem, "left", Support::Symmetry);
    scenes::support(&mut problem, "front", Support::Symmetry);
    scenes::load(&mut problem, "top", DVec3::new(0.0, 0.0, -pressure));
    problem
}

#[test]
fn a_crack_under_compression_closes_to_nothing() {
    for aperture in [0.0, 1e-6, 2e-5] {
        let problem = cracked_cube(Closure::contact(aperture), 50e6);
        let (record, solution) = walk(&problem, &[1.0]).remove(0);
        println!("{aperture:e}: {:?} {:?}", record.outcome, record.parts);
        for it in &record.iterations {
            println!("  {it:?}");
        }
        assert!(record.converged());
        let closed = solution
            .facet_points
            .iter()
            .filter(|p| p.aperture == 0.0)
            .count();
        let deepest = solution
            .facet_points
            .iter()
            .map(|p| -aperture - p.opening)
            .fold(f64::MIN, f64::max);
        println!(
            "  closed {closed} of {}, deepest {deepest:e}",
            solution.facet_points.len()
        );
    }
}

/// Three blocks on top of each other; the bottom one stands, the top one hangs.
fn stack(closure: Closure) -> Problem {
    let between = |x: [f64; 3]| x[2] == 1.0 || x[2] == 2.0;
    let patches = [Patch {
        name: "joints",
        contains: &between,
    }];
    let mesh = scenes::build(scenes::box_draft([2, 2, 6], [1.0, 1.0, 3.0], &patches));
    let mut problem = scenes::problem(mesh, fracture(closure));
    scenes::support(
        &mut problem,
        "bottom",
        Support::Displacement([FREE, FREE, HELD]),
    );
    for side in ["left", "front"] {
        scenes::support(&mut problem, side, Support::Symmetry);
    }
    problem
}

#[test]
fn stack_with_floating_block() {
    let mut cut = Closure::new(1e-4, 50e9, ClosureKind::Logarithmic { cutoff: None });
    cut.tension = Tension::CutOff;
    for closure in [Closure::contact(0.0), Closure::contact(1e-4), cut] {
        let mut problem = stack(closure);
        scenes::support(
            &mut problem,
            "top",
            Support::Displacement([FREE, FREE, Some(1e-3)]),
        );
        for (name, gravity) in [("no weight", 0.0), ("weight", -9.81), ("lift", 9.81)] {
            problem.gravity = DVec3::new(0.0, 0.0, gravity);
            problem.rocks[0].density = 2700.0;
            for (record, solution) in walk(&problem, &[0.5, 1.0, -1.0, 0.0]) {
                println!(
                    "{name} {}: {:?} {:?} {:?}",
                    record.load.time,
                    record.outcome,
                    record.parts,
                    record.iterations.len()
                );
                let apertures: Vec<f64> =
                    solution.facet_points.iter().map(|p| p.aperture).collect();
                println!(
                    "   {:e} .. {:e}",
                    apertures.iter().copied().fold(f64::MAX, f64::min),
                    apertures.iter().copied().fold(f64::MIN, f64::max)
                );
            }
        }
    }
}
