//! Newton's counts over loads and cutoffs, beside plain Newton's.

use glam::DVec3;
use lie_core::ClosureKind;
use lie_mesh::structured::Patch;
use lie_solver::{Linearisation, NewtonSettings, Problem, StepRecord, Support};

use crate::scenes::{self, joint};

const LOADS: [f64; 9] = [0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0];
const CUTOFFS: [Option<f64>; 7] = [
    None,
    Some(1e-2),
    Some(1e-4),
    Some(1e-6),
    Some(1e-8),
    Some(1e-10),
    Some(1e-12),
];

fn column(kind: ClosureKind, q: f64) -> Problem {
    let middle = |x: [f64; 3]| x[2] == 1.0;
    let draft = scenes::box_draft(
        [2, 2, 4],
        [1.0, 1.0, 2.0],
        &[Patch { name: "joint", contains: &middle }],
    );
    let mut problem = scenes::problem(scenes::build(draft), joint(kind));
    for face in ["left", "front", "bottom"] {
        scenes::support(&mut problem, face, Support::Symmetry);
    }
    scenes::load(&mut problem, "top", DVec3::new(0.0, 0.0, -q * 50e9 * 1e-4));
    problem
}

fn three_planes(kind: ClosureKind, q: f64) -> Problem {
    let planes: [&dyn Fn([f64; 3]) -> bool; 3] =
        [&|x| x[0] == 0.5, &|x| x[1] == 0.5, &|x| x[2] == 0.5];
    let patches: Vec<Patch<'_>> = ["x", "y", "z"]
        .iter()
        .zip(planes)
        .map(|(name, contains)| Patch { name, contains })
        .collect();
    let draft = scenes::box_draft([4; 3], [1.0; 3], &patches);
    let mut problem = scenes::problem(scenes::build(draft), joint(kind));
    for face in ["left", "front", "bottom"] {
        scenes::support(&mut problem, face, Support::Symmetry);
    }
    let s = -q * 50e9 * 1e-4;
    scenes::load(&mut problem, "top", DVec3::new(0.0, 0.0, s));
    scenes::load(&mut problem, "right", DVec3::new(0.5 * s, 0.0, 0.0));
    scenes::load(&mut problem, "back", DVec3::new(0.0, 0.25 * s, 0.0));
    problem
}

fn count(problem: &Problem, linearisation: Linearisation) -> (String, StepRecord) {
    let settings = NewtonSettings { linearisation, ..NewtonSettings::default() };
    let (record, _, _) = scenes::try_solve(problem, settings);
    let text = if record.converged() {
        record.iterations.len().to_string()
    } else {
        "-".to_owned()
    };
    (text, record)
}

fn table(name: &str, scene: impl Fn(ClosureKind, f64) -> Problem) {
    println!("{name}: iterations (plain Newton) over q = |sigma| / (K_n0 b0)");
    for cutoff in CUTOFFS {
        let kind = ClosureKind::Logarithmic { cutoff: cutoff.map(|c| c * 1e-4) };
        print!("cutoff {cutoff:?}:");
        for q in LOADS {
            let problem = scene(kind, q);
            let (ours, record) = count(&problem, Linearisation::Balanced);
            let (plain, _) = count(&problem, Linearisation::Landed);
            print!("  {ours} ({plain})");
            let _ = record;
        }
        println!();
    }
}

#[test]
fn column_converges() {
    table("column", column);
}

#[test]
fn three_planes_converge() {
    table("three planes", three_planes);
}

#[test]
fn dbg() {
    for stiffness in [50e9, 1e9, 1e7] {
        print!("K {stiffness:e} load:");
        for q in LOADS {
            let mut problem = column(scenes::EXACT, q);
            problem.fractures[0].law.closure.normal_stiffness = stiffness;
            problem.conditions.pop();
            scenes::load(&mut problem, "top", DVec3::new(0.0, 0.0, -q * stiffness * 1e-4));
            print!(" {}", count(&problem, Linearisation::Balanced).0);
        }
        print!("  displacement:");
        for q in LOADS {
            let mut problem = column(scenes::EXACT, q);
            problem.fractures[0].law.closure.normal_stiffness = stiffness;
            problem.conditions.pop();
            let x = problem.fractures[0].law.closure.balanced(0.0, -q * stiffness * 1e-4).aperture;
            let u = (x - 1e-4) - q * stiffness * 1e-4 * 2.0 / 25e9;
            scenes::support(&mut problem, "top", Support::Displacement([None, None, Some(u)]));
            print!(" {}", count(&problem, Linearisation::Balanced).0);
        }
        println!();
    }
}
