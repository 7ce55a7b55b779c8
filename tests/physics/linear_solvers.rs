//! The linear solvers against each other: the same state whichever solves.

use glam::DVec3;
use kluft_mesh::structured::Patch;
use kluft_solver::{
    Discretisation, FacetResult, LinearMethod, Load, Newton, NewtonSettings, Problem, RestartState,
    Solution, State, Support, System, solution, unobserved,
};
use lie_core::Friction;

use kluft_verification::scenes::networks;
use kluft_verification::scenes::{self, EXACT, joint};

fn settings(method: LinearMethod) -> NewtonSettings {
    NewtonSettings {
        linear: Some(method),
        ..NewtonSettings::default()
    }
}

/// Solves load steps of equal size; returns the solution and the Newton iterations of all steps.
fn solve(problem: &Problem, method: LinearMethod, steps: usize) -> (Solution, usize) {
    let discretisation = Discretisation::of(problem).expect("supported");
    let system = System::assemble(problem, discretisation);
    let mut newton = Newton::new(&system, settings(method)).expect("prepared");
    let mut state = system.initial_state();
    let mut iterations = 0;
    for step in 1..=steps {
        let load = step as f64 / steps as f64;
        let record = newton.solve_step(&system, &mut state, &Load::proportional(load), unobserved);
        assert!(record.converged(), "{method}: {record:?}");
        iterations += record.iterations.len();
    }
    (solution(&system, &state), iterations)
}

/// Largest difference of displacements, apertures and tractions, each against its largest value.
fn difference(a: &Solution, b: &Solution) -> f64 {
    let pairs = || a.facet_points.iter().zip(&b.facet_points);
    let moved = a.displacements.iter().zip(&b.displacements);
    let ratio = |pairs: &mut dyn Iterator<Item = (f64, f64)>| {
        let (error, scale) = pairs.fold((0.0_f64, 0.0_f64), |(error, scale), (e, s)| {
            (error.max(e), scale.max(s))
        });
        error / scale
    };
    let displacement = ratio(&mut moved.map(|(a, b)| ((*a - *b).length(), a.length())));
    let aperture = ratio(&mut pairs().map(|(a, b)| ((a.aperture - b.aperture).abs(), a.aperture)));
    let traction =
        ratio(&mut pairs().map(|(a, b)| ((a.traction - b.traction).length(), a.traction.length())));
    displacement.max(aperture).max(traction)
}

/// A level joint and an upright one that ends on it, pressed until the level one closes to a tenth.
fn t_block(cubes: usize) -> Problem {
    let level = |x: [f64; 3]| x[2] == 0.5;
    let upright = |x: [f64; 3]| x[0] == 0.5 && x[2] <= 0.5;
    let patches = [
        Patch {
            name: "level",
            contains: &level,
        },
        Patch {
            name: "upright",
            contains: &upright,
        },
    ];
    let draft = scenes::box_draft([cubes; 3], [1.0; 3], &patches);
    let mut problem = scenes::problem(scenes::build(draft), joint(EXACT));
    for face in ["left", "front", "bottom"] {
        scenes::support(&mut problem, face, Support::Symmetry);
    }
    scenes::load(&mut problem, "top", DVec3::new(0.0, 0.0, -28.4e6));
    problem
}

/// The same block sheared as well, so that no two points of its joints close alike.
fn sheared_block(cubes: usize) -> Problem {
    let mut problem = t_block(cubes);
    scenes::load(&mut problem, "top", DVec3::new(8e6, 3e6, -28.4e6));
    problem
}

#[test]
fn all_solvers_reach_the_same_state() {
    let network = networks::meshed(&networks::polygons(3), 0.25).expect("a network");
    for (name, problem) in [
        ("t", t_block(6)),
        ("network", networks::random_problem(network, 3)),
    ] {
        let (direct, _) = solve(&problem, LinearMethod::Direct, 1);
        let (condensed, _) = solve(&problem, LinearMethod::Condensed, 1);
        let (iterative, _) = solve(&problem, LinearMethod::Iterative, 1);
        let (exact, inexact) = (
            difference(&direct, &condensed),
            difference(&direct, &iterative),
        );
        assert!(exact < 1e-9, "{name}: {exact:e}");
        assert!(inexact < 1e-6, "{name}: {inexact:e}");
    }
}

#[test]
fn many_steps_end_where_one_does_and_cost_little() {
    let problem = t_block(6);
    for method in LinearMethod::ALL {
        let (one, _) = solve(&problem, method, 1);
        let (many, iterations) = solve(&problem, method, 40);
        let error = difference(&one, &many);
        assert!(error < 1e-6, "{method}: {error:e}");
        assert!(iterations <= 120, "{method}: {iterations} iterations");
    }
}

/// What former steps moved spans what the next one needs: most small steps need no linear solve.
#[test]
fn a_hundred_steps_or_fifty_stiffnesses_take_few_linear_iterations() {
    let problem = t_block(10);
    let discretisation = Discretisation::of(&problem).expect("supported");
    let mut system = System::assemble(&problem, discretisation);
    let prepared = |system: &System<'_>| {
        let newton = Newton::new(system, settings(LinearMethod::Iterative));
        (newton.expect("prepared"), system.initial_state())
    };
    let step = |system: &System<'_>, newton: &mut Newton, state: &mut State, factor: f64| {
        let record = newton.solve_step(system, state, &Load::proportional(factor), unobserved);
        assert!(record.converged(), "{factor}: {record:?}");
        record.linear_iterations()
    };
    let (mut newton, mut state) = prepared(&system);
    let one = step(&system, &mut newton, &mut state, 1.0);
    let expected = solution(&system, &state);
    let (mut newton, mut state) = prepared(&system);
    let factors = (1..=100).map(|step| f64::from(step) / 100.0);
    let hundred: usize = factors
        .map(|factor| step(&system, &mut newton, &mut state, factor))
        .sum();
    let error = difference(&expected, &solution(&system, &state));
    println!("one step: {one} iterations, a hundred: {hundred}, apart by {error:.1e}");
    assert!(hundred <= 3 * one, "{hundred} against {one}");
    assert!(error < 1e-9, "{error:e}");

    let (mut newton, mut state) = prepared(&system);
    let mut fifty = 0;
    let mut stiffened = problem.clone();
    for number in 0..50 {
        let share = 4.0_f64.powf(f64::from(number) / 49.0 - 0.5);
        for (other, given) in stiffened.fractures.iter_mut().zip(&problem.fractures) {
            let stiffness = share * given.law.closure.normal_stiffness;
            other.law.closure.normal_stiffness = stiffness;
        }
        system.set_laws(stiffened.fractures.iter().map(|f| f.law).collect());
        fifty += step(&system, &mut newton, &mut state, 1.0);
    }
    let (alone, _) = solve(&stiffened, LinearMethod::Iterative, 1);
    let error = difference(&alone, &solution(&system, &state));
    println!("fifty stiffnesses: {fifty} iterations, the last apart by {error:.1e}");
    assert!(fifty <= 4 * one, "{fifty} against {one}");
    assert!(error < 1e-9, "{error:e}");
}

/// Steps that need no linear solve are as good as those of a solver that is exact, whatever the
/// joints.
#[test]
fn guesses_in_the_space_of_former_steps_are_exact() {
    for factor in [1e-3, 1.0, 1e3] {
        let mut problem = sheared_block(6);
        for fracture in &mut problem.fractures {
            // The same traction closes them to the same share.
            fracture.law.closure.aperture /= factor;
            fracture.law.closure.normal_stiffness *= factor;
            fracture.law.shear_stiffness *= factor;
        }
        let (direct, _) = solve(&problem, LinearMethod::Direct, 1);
        let (one, _) = solve(&problem, LinearMethod::Iterative, 1);
        let (many, _) = solve(&problem, LinearMethod::Iterative, 60);
        let (one, many) = (difference(&direct, &one), difference(&direct, &many));
        println!("{factor}: {one:.1e} in one step, {many:.1e} in many");
        assert!(many < 1e-8, "{factor}: {many:e}");
    }
}

#[test]
fn one_set_up_serves_other_laws() {
    let problem = t_block(4);
    for method in LinearMethod::ALL {
        let discretisation = Discretisation::of(&problem).expect("supported");
        let mut system = System::assemble(&problem, discretisation);
        let mut newton = Newton::new(&system, settings(method)).expect("prepared");
        let mut former = system.initial_state();
        for factor in [1e-2, 1.0, 1e3] {
            let mut stiffer = problem.clone();
            for fracture in &mut stiffer.fractures {
                fracture.law.closure.normal_stiffness *= factor;
                fracture.law.shear_stiffness *= factor;
                fracture.law.closure.aperture *= 2.0;
            }
            system.set_laws(stiffer.fractures.iter().map(|f| f.law).collect());
            let mut state = system.initial_state();
            let record =
                newton.solve_step(&system, &mut state, &Load::proportional(1.0), unobserved);
            assert!(record.converged(), "{method}, {factor}: {record:?}");
            let (alone, _) = solve(&stiffer, method, 1);
            let error = difference(&alone, &solution(&system, &state));
            assert!(error < 1e-6, "{method}, {factor}: {error:e}");
            let record =
                newton.solve_step(&system, &mut former, &Load::proportional(1.0), unobserved);
            assert!(record.converged(), "{method}, {factor}: {record:?}");
            let error = difference(&alone, &solution(&system, &former));
            assert!(error < 1e-6, "{method}, {factor}, continued: {error:e}");
        }
    }
}

/// Stiff fractures cost conjugate gradients nothing; soft ones let blocks move, which costs some.
#[test]
fn iterations_are_bounded_for_stiff_and_soft_fractures() {
    let mut counts = Vec::new();
    for factor in [1e-4, 1e-2, 1.0, 1e2, 1e4, 1e6] {
        let mut problem = t_block(8);
        for fracture in &mut problem.fractures {
            fracture.law.closure.kind = lie_core::ClosureKind::Linear;
            fracture.law.closure.normal_stiffness *= factor;
            fracture.law.shear_stiffness *= factor;
        }
        let discretisation = Discretisation::of(&problem).expect("supported");
        let system = System::assemble(&problem, discretisation);
        let iterative = settings(LinearMethod::Iterative);
        let mut newton = Newton::new(&system, iterative).expect("prepared");
        let record = newton.solve_step(
            &system,
            &mut system.initial_state(),
            &Load::proportional(1.0),
            unobserved,
        );
        assert!(record.converged(), "{factor}: {record:?}");
        counts.push(record.linear_iterations());
    }
    println!("iterations: {counts:?}");
    assert!(counts.iter().all(|&count| count <= 120), "{counts:?}");
}

#[test]
fn iterations_do_not_depend_on_the_number_of_threads() {
    let problem = t_block(8);
    for method in LinearMethod::ALL {
        let with = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let pool = pool.expect("threads");
            pool.install(|| solve(&problem, method, 6).0.displacements)
        };
        let one = with(1);
        for threads in [2, 3] {
            assert_eq!(one, with(threads), "{method}, {threads} threads");
        }
    }
}

/// Load factors that rise, fall and jump, and where runs with them are interrupted.
const FACTORS: [f64; 8] = [0.1, 0.2, 0.3, 0.4, 0.5, 0.35, 0.2, 0.9];
const STARTS: [usize; 4] = [0, 1, 4, 7];

/// Runs that go on in a new solver from the bytes of a restart state, against the one that does not
/// stop; returns the iterations of the linear solver, and whether a restart state is shorter than
/// one before.
fn interrupt(
    problem: &Problem,
    method: LinearMethod,
    factors: &[f64],
    starts: [usize; 4],
) -> (usize, bool) {
    let discretisation = Discretisation::of(problem).expect("supported");
    let system = System::assemble(problem, discretisation);
    let prepared = || Newton::new(&system, settings(method)).expect("prepared");
    let step = |newton: &mut Newton, state: &mut _, factor: f64| {
        let record = newton.solve_step(&system, state, &Load::proportional(factor), unobserved);
        assert!(record.converged(), "{method}, {factor}: {record:?}");
        record.linear_iterations()
    };
    let (mut newton, mut state) = (prepared(), system.initial_state());
    let mut restarts = Vec::new();
    let mut iterations = 0;
    for &factor in factors {
        let bytes = postcard::to_stdvec(&newton.restart_state(&state));
        restarts.push(bytes.expect("bytes"));
        iterations += step(&mut newton, &mut state, factor);
    }
    let end = postcard::to_stdvec(&newton.restart_state(&state)).expect("bytes");
    for start in starts {
        let mut newton = prepared();
        let restart: RestartState<'_> =
            postcard::from_bytes(&restarts[start]).expect("a restart state");
        assert!(restart.fits(&system));
        let mut state = newton.restore(&system, restart).expect("prepared");
        for factor in &factors[start..] {
            step(&mut newton, &mut state, *factor);
        }
        let same = postcard::to_stdvec(&newton.restart_state(&state)).expect("bytes") == end;
        assert!(same, "{method} from step {start}");
    }
    let shrinks = restarts
        .windows(2)
        .any(|pair| pair[1].len() < pair[0].len());
    (iterations, shrinks)
}

/// Whatever the solver has learnt before counts: factors of former tangents, paths that turn.
/// Blocks smaller than these never reuse a factor.
#[test]
fn restarts_continue_to_the_last_bit() {
    let direct = interrupt(&t_block(4), LinearMethod::Direct, &FACTORS, STARTS);
    assert_eq!(direct.0, 0);
    for method in [LinearMethod::Condensed, LinearMethod::Iterative] {
        let (iterations, _) = interrupt(&t_block(14), method, &FACTORS, STARTS);
        assert!(iterations > 0, "{method}");
    }
}

/// So many steps that the space of their moves is condensed.
#[test]
fn restarts_of_many_steps_continue_to_the_last_bit() {
    let factors: Vec<f64> = (1..=40).map(|step| 0.025 * f64::from(step)).collect();
    let starts = [3, 14, 22, 37];
    let (_, is_condensed) = interrupt(&sheared_block(6), LinearMethod::Iterative, &factors, starts);
    assert!(is_condensed);
}

/// Joints that slide and open by it remember that.
#[test]
fn restarts_continue_sliding_to_the_last_bit() {
    let mut problem = t_block(4);
    scenes::load(&mut problem, "right", DVec3::new(-5e6, 0.0, 0.0));
    for fracture in &mut problem.fractures {
        fracture.law.friction = Some(Friction {
            coefficient: 1.0_f64.to_radians().tan(),
            cohesion: 0.0,
            dilation: 0.5_f64.to_radians().tan(),
        });
    }
    let slid = |point: &FacetResult| {
        let shear = (point.traction.length_squared() - point.normal_traction.powi(2)).sqrt();
        point.slip.length() > 1.1 * shear / 20e9
    };
    assert!(scenes::solve(&problem).facet_points.iter().any(slid));
    for method in LinearMethod::ALL {
        interrupt(&problem, method, &FACTORS, STARTS);
    }
}

#[test]
fn a_restart_state_of_another_system_does_not_fit() {
    let (small, large) = (t_block(4), t_block(6));
    let system = |problem| System::assemble(problem, Discretisation::of(problem).expect("held"));
    let (small, large) = (system(&small), system(&large));
    let newton = Newton::new(&small, settings(LinearMethod::Direct)).expect("prepared");
    let state = small.initial_state();
    let restart = newton.restart_state(&state);
    assert!(restart.fits(&small) && !restart.fits(&large));
}
