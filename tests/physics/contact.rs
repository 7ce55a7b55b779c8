//! Unilateral contact: closed cracks, blocks that part and meet again, blocks that nothing holds.

use glam::DVec3;
use kluft_mesh::structured::Patch;
use kluft_solver::{
    Discretisation, Fracture, NewtonSettings, Problem, Solution, StepOutcome, StepRecord, Support,
};
use lie_core::{Closure, FractureLaw, Tension};

use kluft_verification::scenes::pressed;
use kluft_verification::scenes::{self, EXACT};

const FREE: Option<f64> = None;
const HELD: Option<f64> = Some(0.0);

fn fracture(closure: Closure) -> Fracture {
    Fracture {
        law: FractureLaw::elastic(closure, 0.0),
        fluid_pressure: 0.0,
    }
}

/// The records and solutions of steps through load factors.
fn walk(problem: &Problem, loads: &[f64]) -> Vec<(StepRecord, Solution)> {
    scenes::solve_path(problem, NewtonSettings::default(), loads.iter().copied())
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

/// Largest penetration of the walls (m), negative if they are apart.
fn deepest(solution: &Solution, aperture: f64) -> f64 {
    let points = solution.facet_points.iter();
    points
        .map(|point| -aperture - point.opening)
        .fold(f64::MIN, f64::max)
}

/// A closed crack carries the stress as if it were not there. One with a gap closes where its walls
/// come that far; its rim has no jump, so its aperture stays there.
#[test]
fn a_crack_under_compression_closes_to_nothing() {
    for aperture in [0.0, 1e-6, 2e-5] {
        let problem = cracked_cube(Closure::contact(aperture), 50e6);
        let (record, solution) = walk(&problem, &[1.0]).remove(0);
        assert!(record.converged() && record.iterations.len() <= 4);
        let (low, high) = (0.25 + 1e-9, 0.75 - 1e-9);
        let points = std::iter::zip(&solution.facet_points, places(&problem));
        for (point, x) in points {
            let inside = (low..high).contains(&x.x) && (low..high).contains(&x.y);
            assert!(point.normal_traction <= 0.0);
            if inside || aperture == 0.0 {
                assert_eq!(point.aperture, 0.0, "at {x}");
            }
            if inside && aperture == 0.0 {
                assert!((point.normal_traction / -50e6 - 1.0).abs() < 1e-9);
            }
        }
        assert!(deepest(&solution, aperture) < 1e-12);
    }
}

fn places(problem: &Problem) -> impl Iterator<Item = DVec3> + '_ {
    let nodes = problem.mesh.facets.elements.nodes.iter();
    nodes.map(|&node| problem.mesh.nodes[node as usize])
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

fn hung(closure: Closure, gravity: f64) -> Problem {
    let mut problem = stack(closure);
    let lift = Support::Displacement([FREE, FREE, Some(1e-3)]);
    scenes::support(&mut problem, "top", lift);
    problem.gravity = DVec3::new(0.0, 0.0, gravity);
    problem.rocks[0].density = 2700.0;
    problem
}

fn cut_off() -> Closure {
    Closure {
        tension: Tension::CutOff,
        ..Closure::new(1e-4, 50e9, EXACT)
    }
}

/// Once the joints are open nothing holds the block in the middle; gravity puts it on one of its
/// neighbours, and without gravity it stays where it is. It must settle either way.
#[test]
fn a_block_that_floats_settles_if_the_loads_allow_it() {
    for closure in [Closure::contact(0.0), Closure::contact(1e-4), cut_off()] {
        for gravity in [0.0, -9.81, 9.81] {
            let problem = hung(closure, gravity);
            for (record, solution) in walk(&problem, &[0.5, 1.0, -1.0, 0.0, 1.0]) {
                assert!(record.converged(), "{closure:?} {gravity}: {record:?}");
                assert!(
                    record.substeps.iter().all(|&count| count <= 12),
                    "{record:?}"
                );
                assert!(deepest(&solution, closure.aperture) < 1e-12 * 3.0);
                let load = record.load.factors[0];
                let apertures = solution.facet_points.iter().map(|point| point.aperture);
                let (least, most) = apertures.fold((f64::MAX, 0.0_f64), |(least, most), b| {
                    (least.min(b), most.max(b))
                });
                if load > 0.0 && gravity != 0.0 {
                    // One joint carries the weight, the other has what the lift opened.
                    let rest = closure.balanced(0.0, -2700.0 * 9.81 * load).aperture;
                    assert!((least - rest).abs() < 1e-2 * 1e-4, "{least:e} {rest:e}");
                    let opened = 1e-3 * load + 2.0 * closure.aperture - least;
                    assert!((most / opened - 1.0).abs() < 2e-2, "{most:e} {opened:e}");
                } else if load > 0.0 {
                    assert!(least > closure.aperture);
                }
            }
        }
    }
}

/// The block rests on the lower joint by its weight alone, the upper one open by anything from less
/// than what the weight closes to many apertures. With shear stiffness the upper joint lets go of
/// the little slip that it has and pushes, by less than 1e-4 of the weight.
#[test]
fn a_block_rests_on_its_weight_under_any_lift() {
    for (exponent, (stiffness, allowed)) in
        (-9..=-1).flat_map(|exponent| [(0.0, 1e-8), (20e9, 1e-4)].map(|case| (exponent, case)))
    {
        let mut problem = hung(cut_off(), -9.81);
        problem.fractures[0].law.shear_stiffness = stiffness;
        let lift = Support::Displacement([FREE, FREE, Some(10_f64.powi(exponent))]);
        let top = scenes::boundary(&problem, "top");
        problem
            .conditions
            .retain(|condition| condition.boundary != top);
        scenes::support(&mut problem, "top", lift);
        let discretisation = Discretisation::of(&problem).expect("supported");
        let interface = discretisation.interface();
        for (record, solution) in walk(&problem, &[0.5, 1.0, 0.1]) {
            let count = record.iterations.len();
            assert!(record.converged() && count <= 12, "1e{exponent}: {count}");
            let points = interface.points().iter().zip(&solution.facet_points);
            let lower = points.filter(|(point, _)| point.position.z < 1.5);
            let carried: f64 = lower
                .map(|(point, found)| point.area * found.normal_traction)
                .sum();
            let error = (carried / (-2700.0 * 9.81 * record.load.factors[0]) - 1.0).abs();
            assert!(error < allowed, "1e{exponent}, {stiffness}: {error}");
        }
    }
}

/// The top block is pulled up and nothing holds it: there is no solution, and the message says why.
#[test]
fn a_block_that_is_pulled_off_is_named() {
    for closure in [Closure::contact(0.0), cut_off()] {
        let mut problem = stack(closure);
        scenes::load(&mut problem, "top", DVec3::new(0.0, 0.0, 1e6));
        let (record, _) = walk(&problem, &[1.0]).remove(0);
        assert_eq!(record.outcome, StepOutcome::RigidBodyMotion);
        let block = &record.rigid_motions[0].told;
        assert!(block.problem.contains("translation along z"), "{block}");
        assert!(block.remedy.contains("`joints`"), "{block}");
    }
}

/// A sheared joint whose tension is cut off is opened and closed twenty times. It comes back on the
/// same curve, is free of load when open, and its shear never jumps.
#[test]
fn opening_and_closing_leaves_nothing_behind() {
    let between = |x: [f64; 3]| x[2] == 1.0;
    let patches = [Patch {
        name: "joint",
        contains: &between,
    }];
    let mesh = scenes::build(scenes::box_draft([2, 2, 4], [1.0, 1.0, 2.0], &patches));
    let mut joint = fracture(cut_off());
    joint.law.shear_stiffness = 20e9;
    let mut problem = scenes::problem(mesh, joint);
    scenes::support(&mut problem, "bottom", Support::Displacement([HELD; 3]));
    let moved = Support::Displacement([Some(5e-5), HELD, Some(2e-4)]);
    scenes::support(&mut problem, "top", moved);
    let path: Vec<f64> = (0..160)
        .map(|step| (f64::from(step) * std::f64::consts::TAU / 8.0).sin())
        .collect();
    let steps = walk(&problem, &path);
    for (number, (record, solution)) in steps.iter().enumerate() {
        assert!(record.converged(), "{:?}", record.outcome);
        assert!(
            record.substeps.iter().all(|&count| count <= 12),
            "{:?}",
            record.substeps
        );
        let load = path[number];
        for (point, first) in
            std::iter::zip(&solution.facet_points, &steps[number % 8].1.facet_points)
        {
            let apart = (point.jump - first.jump).length();
            assert!(
                apart < 1e-10 * 1e-4,
                "step {number}: {apart:e} m, {record:?}"
            );
            let apart = (point.traction - first.traction).length();
            assert!(apart < 1e-10 * 5e6, "step {number}: {apart:e} Pa");
            if load > 0.8 {
                assert_eq!(point.traction, DVec3::ZERO);
            }
        }
    }
}

/// Walls in contact slip to and fro on an inclined joint. Statics knows the traction of every facet
/// (uniaxial stress), and steps must not add to its error: 1e-12 is round-off.
#[test]
fn contact_that_slips_keeps_its_traction_over_many_steps() {
    let problem = pressed::inclined().with(Closure::contact(0.0));
    let path: Vec<f64> = (0..20).map(|step| [1.0, 0.5][step % 2]).collect();
    for (load, (record, solution)) in path.iter().zip(walk(&problem, &path)) {
        assert!(record.converged(), "{:?}", record.outcome);
        let exact = load * pressed::inclined_traction();
        for point in &solution.facet_points {
            let error = (point.normal_traction / exact - 1.0).abs();
            assert!(error < 1e-12, "load {load}: {error:e}");
        }
    }
}

/// A bar with a bond of 1 MPa and 100 J/m^2 is pulled apart, let back and pulled on: the series of
/// a bar of stiffness E/H and the bond in closed form.
#[test]
fn a_bond_breaks_in_a_bar() {
    let between = |x: [f64; 3]| x[2] == 1.0;
    let patches = [Patch {
        name: "bond",
        contains: &between,
    }];
    let mesh = scenes::build(scenes::box_draft([1, 1, 2], [0.5, 0.5, 2.0], &patches));
    let closure = Closure {
        tension: Tension::Cohesive {
            strength: 1e6,
            energy: 100.0,
        },
        ..Closure::new(1e-4, 50e9, EXACT)
    };
    let mut problem = scenes::problem(mesh, fracture(closure));
    problem.rocks[0].poisson_ratio = 0.0;
    scenes::support(
        &mut problem,
        "bottom",
        Support::Displacement([FREE, FREE, HELD]),
    );
    for side in ["left", "front"] {
        scenes::support(&mut problem, side, Support::Symmetry);
    }
    scenes::support(
        &mut problem,
        "top",
        Support::Displacement([FREE, FREE, Some(1e-4)]),
    );
    let bar = 25e9 / 2.0;
    let (peak, broken) = (1e6 / 50e9, 2.0 * 100.0 / 1e6);
    let softening = 1e6 / (broken - peak);
    // Opening under a top displacement `u`, once beyond the peak, and the bond left by it.
    let soft = |u: f64| (bar * u - softening * broken) / (bar - softening);
    let secant = |w: f64| softening * (broken - w) / w;
    let worst = soft(1.5e-4);
    let expected = [
        (0.5, 0.5e-4 * bar / (bar + 50e9)),
        (1.5, worst),
        (0.75, 0.75e-4 * bar / (bar + secant(worst))),
        (1.5, worst),
        (1.8, soft(1.8e-4)),
        (2.5, 2.5e-4),
        (0.5, 0.5e-4),
    ];
    let path: Vec<f64> = expected.iter().map(|(load, _)| *load).collect();
    for ((record, solution), (load, wanted)) in std::iter::zip(walk(&problem, &path), expected) {
        assert!(record.converged(), "{load}: {record:?}");
        for point in &solution.facet_points {
            let error = (point.opening / wanted - 1.0).abs();
            assert!(error < 1e-6, "{load}: {} against {wanted}", point.opening);
        }
    }
}
