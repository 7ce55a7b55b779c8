//! A run as a library: from memory, on given threads, with an observer, without a file.

use std::ops::ControlFlow;

use kluft_io::Values;
use kluft_mesh::Draft;
use kluft_mesh::structured::{Patch, tetrahedra};
use kluft_run::{Ending, MeshInput, Observer, Outcome, Request, Stage, StepResult, run};
use kluft_scene::Scene;
use kluft_solver::Iteration;
use rayon::ThreadPool;

/// A cube of rock cut in two by a joint that closes under 7 MPa, in two load steps.
const SCENE: &str = r#"
title = "a joint"
[mesh]
file = "in memory.msh"
[rock.default]
young_modulus = 50e9
poisson_ratio = 0.0
[fracture.joint]
aperture = 1e-4
normal_stiffness = 1e11
shear_stiffness = 1e10
closure = "logarithmic"
[boundary.top]
traction = [0, 0, -7e6]
[boundary.bottom]
displacement = { x = 0.0, y = 0.0, z = 0.0 }
[load]
steps = [0.5, 1.0]
"#;

fn scene() -> Scene {
    let folder = std::path::Path::new(".");
    Scene::parse(SCENE, "a scene in memory", folder).expect("a sound scene")
}

fn draft() -> Draft {
    let patches = [
        Patch {
            name: "joint",
            contains: &|x| x[2] == 0.5,
        },
        Patch {
            name: "bottom",
            contains: &|x| x[2] == 0.0,
        },
        Patch {
            name: "top",
            contains: &|x| x[2] == 1.0,
        },
    ];
    tetrahedra([4; 3], [1.0; 3], &patches)
}

fn threads(count: usize) -> ThreadPool {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build();
    pool.expect("threads")
}

fn solved_on(count: usize, observer: &mut dyn Observer) -> Outcome {
    let (scene, pool) = (scene(), threads(count));
    let mesh = MeshInput::Draft(Box::new(draft()));
    run(Request::in_memory(&scene, mesh, &pool), observer).expect("no defects")
}

fn apertures(step: &StepResult) -> &[f64] {
    let mut fields = step.fracture_grid.point_fields.iter();
    let field = fields.find(|field| field.name == "aperture");
    match &field.expect("apertures").values {
        Values::Real(values) => values,
        Values::Integer(_) => panic!("apertures are numbers"),
    }
}

/// Root of `(1 + ln^2 x) (1 - x) = q`, by bisection: the aperture of the logarithmic law (Nagel
/// 2017) under the compression `q K_n0 b0`.
fn closed_form(q: f64) -> f64 {
    let (mut low, mut high) = (1e-9_f64, 1.0);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        let resists = (1.0 + middle.ln().powi(2)) * (1.0 - middle) > q;
        if resists {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// Oracle: with a Poisson's ratio of 0 every facet carries the traction, so the law alone gives the
/// aperture; the tolerance is that of Newton's method.
#[test]
fn results_of_all_steps_come_back_as_values() {
    let outcome = solved_on(2, &mut ());
    assert_eq!(outcome.ending, Ending::Solved);
    assert_eq!(outcome.steps.len(), 2);
    for (step, q) in outcome.steps.iter().zip([0.35, 0.7]) {
        let expected = 1e-4 * closed_form(q);
        for aperture in apertures(step) {
            assert!(
                (aperture / expected - 1.0).abs() < 1e-7,
                "{aperture} {expected}"
            );
        }
    }
}

#[test]
fn runs_side_by_side_on_different_threads_give_the_same_bits() {
    let outcomes = std::thread::scope(|scope| {
        let runs = [1, 2, 3].map(|count| scope.spawn(move || solved_on(count, &mut ())));
        runs.map(|run| run.join().expect("no panic"))
    });
    let bits = |outcome: &Outcome| -> Vec<u64> {
        let steps = outcome.steps.iter().flat_map(apertures);
        steps.map(|aperture| aperture.to_bits()).collect()
    };
    for (outcome, count) in outcomes.iter().zip([1, 2, 3]) {
        assert_eq!(outcome.summary.threads, count);
        assert_eq!(bits(outcome), bits(&outcomes[0]));
    }
}

/// Keeps what it hears, and stops in the second load step.
#[derive(Default)]
struct Listener {
    stages: Vec<Stage>,
    steps: usize,
}

impl Observer for Listener {
    fn stage_begins(&mut self, stage: Stage) {
        self.stages.push(stage);
    }

    fn iteration(&mut self, _number: usize, _iteration: &Iteration) -> ControlFlow<()> {
        if self.steps == 1 {
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    }

    fn step_ends(&mut self, _result: &StepResult) {
        self.steps += 1;
    }
}

#[test]
fn an_observer_hears_the_stages_and_may_stop_the_run() {
    let mut listener = Listener::default();
    let outcome = solved_on(1, &mut listener);
    assert_eq!(outcome.ending, Ending::Stopped);
    assert_eq!(outcome.steps.len(), 1, "the converged step is kept");
    let last = outcome.summary.steps.last().expect("a step");
    assert_eq!(
        last.measures.as_ref().map(|found| found.newton_iterations),
        Some(1),
        "it stops after the iteration at hand"
    );
    let solve = |stage: &&Stage| **stage == Stage::Solve;
    assert_eq!(listener.stages.iter().filter(solve).count(), 2);
    assert_eq!(listener.stages[..2], [Stage::Read, Stage::Enrich]);
}

/// Says after every iteration that it is enough.
struct Impatient;

impl Observer for Impatient {
    fn iteration(&mut self, _number: usize, _iteration: &Iteration) -> ControlFlow<()> {
        ControlFlow::Break(())
    }
}

#[test]
fn a_step_that_converges_where_it_is_stopped_is_the_last() {
    let linear = SCENE.replace("logarithmic", "linear");
    let scene = Scene::parse(&linear, "a scene in memory", ".".as_ref()).expect("a sound scene");
    let (mesh, pool) = (MeshInput::Draft(Box::new(draft())), threads(1));
    let outcome = run(Request::in_memory(&scene, mesh, &pool), &mut Impatient);
    let outcome = outcome.expect("no defects");
    assert_eq!(outcome.ending, Ending::Stopped);
    assert_eq!(outcome.steps.len(), 1);
}

#[test]
fn defects_come_back_as_values() {
    let (scene, pool) = (scene(), threads(1));
    let patches: [Patch<'_>; 0] = [];
    let draft = tetrahedra([1; 3], [1.0; 3], &patches);
    let mesh = MeshInput::Draft(Box::new(draft));
    let defects = run(Request::in_memory(&scene, mesh, &pool), &mut ()).expect_err("no groups");
    let text: Vec<String> = defects.iter().map(ToString::to_string).collect();
    assert!(text.iter().any(|line| line.contains("joint")), "{text:?}");
}
