//! What the program decided, and what went wrong, in words.

use lie_solver::{LinearFailure, Outcome, Problem, StepRecord, System};

use crate::summary::FractureSummary;

/// A surface that the scene does not name.
pub fn unused_surface(name: &str) -> String {
    format!("surface `{name}` is not named in the scene: free outside, welded inside")
}

/// How much model a problem needs.
pub fn of_problem(problem: &Problem) -> Vec<String> {
    let mut lines = Vec::new();
    let names = |holds: &dyn Fn(&lie_core::FractureLaw) -> bool| -> String {
        let pairs = problem.mesh.fractures.iter().zip(&problem.fractures);
        let chosen = pairs.filter(|(_, fracture)| holds(&fracture.law));
        chosen
            .map(|(name, _)| name.as_str())
            .collect::<Vec<_>>()
            .join(", ")
    };
    if problem.fractures.is_empty() {
        lines.push("no fracture: plain elasticity, one linear solve a step".into());
    } else {
        let nonlinear = names(&|law| !law.closure.is_linear());
        if nonlinear.is_empty() {
            lines.push("no fracture is nonlinear: one linear solve a step".into());
        } else {
            lines.push(format!(
                "closure of {nonlinear} is nonlinear: Newton's method"
            ));
        }
    }
    if problem.steps.len() > 1 {
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

/// What the user should know of a result.
pub fn warnings(fractures: &[(String, FractureSummary)]) -> Vec<String> {
    let overlapping = fractures
        .iter()
        .filter(|(_, summary)| summary.overlap_area > 0.0);
    overlapping
        .map(|(name, summary)| {
            format!(
                "the walls of `{name}` overlap on {:.4} m2 (smallest aperture {:.3e} m): closure = \"logarithmic\" without cutoff_aperture never does",
                summary.overlap_area, summary.aperture.min
            )
        })
        .collect()
}

/// Why a load step did not converge, and where.
pub fn not_converged(
    problem: &Problem,
    system: &System<'_>,
    step: usize,
    record: &StepRecord,
) -> String {
    let count = record.iterations.len();
    let place = |point: Option<usize>| {
        point.map_or("nowhere in particular".into(), |point| {
            facet_place(problem, system, point)
        })
    };
    let why = match &record.outcome {
        Outcome::Converged => "nothing went wrong".to_owned(),
        Outcome::OutOfIterations => format!(
            "the tests do not hold after {count} iterations; the closure error is largest at {}",
            place(record.worst_facet_point)
        ),
        Outcome::NotFinite(point) => format!(
            "after {count} iterations a number is not finite, {}; check the units of stiffness, aperture and load: the logarithmic law answers up to about 1e5 K_n0 b0",
            place(*point)
        ),
        Outcome::Linear(failure) => linear_failure(problem, system, failure),
    };
    format!("step {step} (load {}): {why}", record.load)
}

fn facet_place(problem: &Problem, system: &System<'_>, point: usize) -> String {
    let facet_point = &system.discretisation.interface.points[point];
    let node = problem.mesh.facets.elements.nodes[point] as usize;
    let x = problem.mesh.nodes[node];
    let fracture = &problem.mesh.fractures[facet_point.fracture as usize];
    format!(
        "fracture `{fracture}`, node {} ({:.4}, {:.4}, {:.4})",
        problem.mesh.node_tags[node], x.x, x.y, x.z
    )
}

/// Why a linear system could not be solved.
pub fn linear_failure(problem: &Problem, system: &System<'_>, failure: &LinearFailure) -> String {
    match failure {
        LinearFailure::OutOfMemory => {
            "the factor does not fit in memory; mesh coarser (a larger h)".into()
        }
        LinearFailure::Indefinite(row) => {
            let node = system.discretisation.points.node[*row] as usize;
            let x = problem.mesh.nodes[node];
            format!(
                "the stiffness is not positive definite at node {} ({:.4}, {:.4}, {:.4}): the rock there can move freely; hold it, or give the fractures around it stiffness",
                problem.mesh.node_tags[node], x.x, x.y, x.z
            )
        }
        LinearFailure::Analysis(what) => format!("the linear solver failed: {what}"),
    }
}
