//! What the program decided, in words.

use kluft_scene::SolverEntry;
use kluft_solver::{
    Flow, LinearMethod, Plan, Prediction, Problem, Schedule, Spring, SpringStiffness, Step, Support,
};

use crate::memory;

/// That a direct solver went on in a load step.
pub fn of_fallback(number: usize) -> String {
    format!(
        "linear solver: direct from step {number} on, where the iterative one gave up or came close \
         to it"
    )
}

/// How much model a problem needs; `path` is how exactly its path is to be followed.
pub fn of_problem(problem: &Problem, flow: Option<&Flow>, path: f64) -> Vec<String> {
    let mut lines: Vec<String> = rock_outside(problem).into_iter().collect();
    let names = |holds: &dyn Fn(&lie_core::FractureLaw) -> bool| -> String {
        let pairs = problem.mesh.fractures.iter().zip(&problem.fractures);
        let chosen = pairs.filter(|(_, fracture)| holds(&fracture.law));
        chosen
            .map(|(name, _)| name.as_str())
            .collect::<Vec<_>>()
            .join(", ")
    };
    for &(left, kept, count) in &problem.mesh.shared_facets {
        let name = |index: u32| &problem.mesh.fractures[index as usize];
        lines.push(format!(
            "{count} facets of {} also belong to {}, whose law they follow",
            name(left),
            name(kept)
        ));
    }
    if problem.fractures.is_empty() {
        lines.push("no fracture: plain elasticity, one linear solve a step".into());
    } else {
        let nonlinear = names(&|law| !law.is_linear());
        if flow.is_some_and(|flow| flow.follows_walls(problem.schedule.is_timed)) {
            lines.push("transmissivities follow apertures: Newton's method on all unknowns".into());
        } else if nonlinear.is_empty() {
            lines.push("no fracture is nonlinear: one linear solve a step".into());
        } else {
            lines.push(format!(
                "closure of {nonlinear} is nonlinear: Newton's method"
            ));
        }
    }
    if flow.is_none() && nothing_acts(problem) {
        lines.push("nothing acts: no load, no pressure, no prescribed displacement".into());
    }
    if let Some(rock) = locking(problem) {
        lines.push(format!(
            "linear cells lock at a Poisson's ratio of {}: the rock will seem too stiff; order = 2 under [mesh] does not",
            rock.poisson_ratio
        ));
    }
    let path_dependent = names(&lie_core::FractureLaw::is_path_dependent);
    if !path_dependent.is_empty() {
        lines.push(format!(
            "{path_dependent} can slip or break: the path of the loads matters, steps are divided until jumps agree to {path} of the largest"
        ));
    } else if problem.schedule.steps.len() > 1 {
        let why = "no law has friction: the end state does not depend on the load steps";
        lines.push(why.into());
    }
    if problem.initial_stress.is_some() {
        let loose = names(&|law| law.closure.normal_stiffness == 0.0 || law.shear_stiffness == 0.0);
        if !loose.is_empty() {
            lines.push(format!(
                "{loose} without normal or shear stiffness cannot carry that part of the initial stress and relaxes it"
            ));
        }
    }
    lines
}

/// What stands for rock outside that is not isotropic.
fn rock_outside(problem: &Problem) -> Option<String> {
    let is_outside = |spring: &Spring| matches!(spring.stiffness, SpringStiffness::Outside { .. });
    let mut rocks = problem.rocks.iter();
    let differs = rocks.any(|rock| rock.anisotropy.is_some());
    (differs && problem.springs.iter().any(is_outside)).then(|| {
        "far_field: outside, the nearest isotropic rock stands for one that depends on the direction"
            .into()
    })
}

/// A rock whose volume hardly changes, meshed with cells that cannot follow.
fn locking(problem: &Problem) -> Option<&lie_core::Rock> {
    const NEARLY_INCOMPRESSIBLE: f64 = 0.45;
    let shapes = &problem.mesh.cells.shapes;
    let linear = shapes.first().is_some_and(|shape| !shape.is_quadratic());
    let mut rocks = problem.rocks.iter();
    let is_isotropic = |rock: &&lie_core::Rock| rock.anisotropy.is_none();
    rocks.find(|rock| linear && is_isotropic(rock) && rock.poisson_ratio > NEARLY_INCOMPRESSIBLE)
}

/// What a linear solver costs.
fn cost(prediction: &Prediction) -> String {
    format!(
        "{} {} and {}",
        prediction.method,
        duration(prediction.seconds),
        memory::in_words(prediction.memory_bytes)
    )
}

/// That another linear solver takes the place of the present one, from a load step on.
pub fn of_other_plan(plan: &Plan, present: LinearMethod, number: usize) -> String {
    let (chosen, mut others) = (plan.prediction(), plan.predictions.iter());
    let present = others.find(|p| p.method == present).map(cost);
    format!(
        "linear solver: {} from step {number} on, by what load steps take; predicted for those left {} \
         (against {})",
        plan.method,
        cost(chosen),
        present.unwrap_or_default()
    )
}

/// Which linear solver, and what the others would have cost.
pub fn of_plan(plan: &Plan, asked: &SolverEntry) -> String {
    let chosen = plan.prediction();
    let is_cheapest = plan.predictions.iter().all(|p| p.seconds >= chosen.seconds);
    let why = match asked.linear {
        Some(_) => "as the scene asks",
        None if is_cheapest => "the cheapest",
        None if plan.method == LinearMethod::Iterative => "that which fits in memory",
        None => "exact and quick enough",
    };
    let others = plan.predictions.iter().filter(|p| p.method != plan.method);
    let others: Vec<String> = others.map(cost).collect();
    let line = format!("linear solver: {why}, predicted {}", cost(chosen));
    if others.is_empty() {
        return line;
    }
    format!("{line} (against {})", others.join(", "))
}

fn duration(seconds: f64) -> String {
    match seconds {
        ..0.1 => "less than 0.1 s".into(),
        ..100.0 => format!("{seconds:.1} s"),
        _ => format!("{:.0} min", seconds / 60.0),
    }
}

fn nothing_acts(problem: &Problem) -> bool {
    let moves =
        |components: &[Option<f64>; 3]| components.iter().flatten().any(|value| *value != 0.0);
    let loaded = problem.conditions.iter().any(|condition| {
        let pushed = matches!(condition.support, Some(Support::Displacement(d)) if moves(&d));
        condition.load.is_some() || pushed
    });
    let pressed = problem
        .fractures
        .iter()
        .any(|fracture| fracture.fluid_pressure != 0.0);
    let varying = &problem.varying;
    let varies = !varying.loads.is_empty()
        || !varying.pressures.is_empty()
        || !varying.displacements.is_empty();
    let fixed = problem
        .fixed_points
        .iter()
        .any(|fixed| moves(&fixed.displacement));
    let body = problem.gravity != glam::DVec3::ZERO || problem.initial_stress.is_some();
    !(loaded || pressed || varies || fixed || body)
}

/// A load step in words: its phase, its time and its factors, as far as the user gave them.
pub fn of_step(schedule: &Schedule, step: &Step) -> String {
    let phase = step.phase.iter().map(|phase| format!("phase {phase}"));
    let time = schedule
        .is_timed
        .then(|| format!("time {}", brief(step.load.time)));
    let factors: Vec<String> = step.load.factors.iter().map(|f| brief(*f)).collect();
    let factors = match &factors[..] {
        [factor] => format!("load {factor}"),
        factors => format!("loads {}", factors.join(" ")),
    };
    let parts: Vec<String> = phase.chain(time).chain([factors]).collect();
    parts.join(", ")
}

/// A number with six digits, without the zeros at its end.
fn brief(number: f64) -> String {
    let rounded: f64 = format!("{number:.5e}").parse().unwrap_or(number);
    rounded.to_string()
}
