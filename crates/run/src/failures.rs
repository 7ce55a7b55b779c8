//! Why a run failed, and where, in words.

use kluft_io::NOT_WRITTEN;
use kluft_mesh::Defect;
use kluft_scene::SolverEntry;
use kluft_solver::{LinearFailure, Plan, Problem, Step, StepOutcome, StepRecord, System};

use crate::decisions::{gigabytes, of_step};
use crate::ranks::Ranks;

/// A solver that does not fit in memory, and what would.
pub fn too_large(plan: &Plan, asked: &SolverEntry, limit: usize) -> Defect {
    let chosen = plan.prediction();
    let smaller = plan.predictions.iter().find(|p| p.memory_bytes <= limit);
    let place = match (asked.linear, asked.memory_limit) {
        (None, None) => "memory of this machine",
        _ => "[solver]",
    };
    let remedy = smaller.map_or(
        "mesh coarser (a larger h, or order = 1), or run it on a machine with more memory".into(),
        |smaller| {
            format!(
                "write linear = \"{}\" under [solver] ({}), or leave the choice to the program",
                smaller.method,
                gigabytes(smaller.memory_bytes)
            )
        },
    );
    Defect::new(
        place,
        format!(
            "the {} solver needs {} with the estimate of errors, and may take {}",
            chosen.method,
            gigabytes(chosen.memory_bytes),
            gigabytes(limit)
        ),
        remedy,
    )
}

/// A rank that has no room for its part.
pub fn rank_too_large(ranks: Ranks<'_>, needed: usize, limit: usize) -> Defect {
    let problem = format!(
        "rank {} of {} needs {} for its part of the solver and the estimate of errors, and may \
         take {}",
        ranks.rank(),
        ranks.count(),
        gigabytes(needed),
        gigabytes(limit)
    );
    let remedy = "mesh coarser (a larger h), start fewer ranks of more threads (--threads) on each \
                  machine, or spread them over more machines";
    Defect::new("memory of this machine", problem, remedy)
}

/// Says of files that could not be written what is kept nevertheless.
pub fn with_what_is_kept(mut defects: Vec<Defect>, steps: usize) -> Vec<Defect> {
    for defect in defects
        .iter_mut()
        .filter(|defect| defect.code == Some(NOT_WRITTEN))
    {
        let kept = match steps {
            0 => "; no load step was finished",
            1 => "; the first load step is finished, and its results are kept",
            _ => &format!("; {steps} load steps are finished, and their results are kept"),
        };
        defect.problem.push_str(kept);
        if steps > 0 {
            defect.remedy.push_str(", then go on with --resume");
        }
    }
    defects
}

/// Share of a load step that counts as nothing of it.
const NOTHING_BEARABLE: f64 = 0.002;

/// Why a load step did not converge, and where.
pub fn not_converged(
    system: &System<'_>,
    (number, step): (usize, &Step),
    record: &StepRecord,
) -> String {
    let problem = system.problem();
    let step = of_step(&problem.schedule, step);
    let why = of_outcome(system, record);
    let completed = (record.completed > 0.0).then(|| {
        let percent = 100.0 * record.completed;
        format!("; {percent:.1} % of the load increment was completed")
    });
    let bearable = record.bearable.filter(|share| *share > NOTHING_BEARABLE);
    let bearable = bearable.map(|share| {
        let percent = 100.0 * share;
        format!("; the fractures can bear at most {percent:.1} % of the load increment")
    });
    let motions = record.rigid_motions.iter().map(|block| {
        let told = &block.told;
        let (place, problem, remedy) = (&told.place, &told.problem, &told.remedy);
        format!("; {place}: {problem}: {remedy}")
    });
    let rest: String = completed
        .into_iter()
        .chain(bearable)
        .chain(motions)
        .collect();
    format!("step {number} ({step}): {why}{rest}")
}

/// Why the iterations of a load step did not converge.
pub fn of_outcome(system: &System<'_>, record: &StepRecord) -> String {
    let problem = system.problem();
    let count = record.iterations.len();
    let at = |point: Option<usize>| {
        point.map_or(String::new(), |point| {
            format!(" at {}", facet_place(problem, system, point))
        })
    };
    match &record.outcome {
        StepOutcome::Converged => "nothing went wrong".to_owned(),
        StepOutcome::OutOfIterations => format!(
            "the tests do not hold after {count} iterations; the closure error is largest{}",
            at(record.worst_facet_point)
        ),
        StepOutcome::RigidBodyMotion => {
            "the loads push rock that nothing holds any more".to_owned()
        }
        StepOutcome::NotFinite(point) => format!(
            "in iteration {} a number is no longer finite{}; check the units of stiffness, aperture and load: the logarithmic law answers up to about 1e5 K_n0 b0",
            count + 1,
            at(*point)
        ),
        StepOutcome::Linear(failure) => linear_failure(problem, system, failure),
        StepOutcome::Stopped => format!("it was stopped after {count} iterations"),
    }
}

/// A facet point in words.
pub fn facet_place(problem: &Problem, system: &System<'_>, point: usize) -> String {
    let facet_point = system.discretisation().interface().points()[point];
    let facet = facet_point.facet as usize;
    let node = problem.mesh.facets.elements.nodes_of(facet)[0] as usize;
    let x = problem.mesh.nodes[node];
    let fracture = &problem.mesh.fractures[facet_point.fracture as usize];
    format!(
        "fracture `{fracture}`, facet at node {} ({:.4}, {:.4}, {:.4})",
        problem.mesh.node_tags[node], x.x, x.y, x.z
    )
}

/// Why a flow could not be solved.
pub fn flow_failure(failure: &LinearFailure) -> String {
    match failure {
        LinearFailure::OutOfMemory(bytes) => format!(
            "the solver of the flow asked for {} of memory more, and did not get them; mesh \
             fractures coarser (a larger h), or raise the limit (ulimit -v, container)",
            gigabytes(*bytes)
        ),
        LinearFailure::NotFinite => {
            "a number of the flow is not finite; check the units of apertures, viscosity, pressures \
             and rates"
                .into()
        }
        LinearFailure::Indefinite(_) => {
            "the matrix of the flow is not positive definite: transmissivities lie too far apart"
                .into()
        }
        LinearFailure::Stalled(_) | LinearFailure::Analysis(_) => {
            format!("the flow could not be solved: {failure:?}")
        }
    }
}

/// Why a linear system could not be solved.
pub fn linear_failure(problem: &Problem, system: &System<'_>, failure: &LinearFailure) -> String {
    match failure {
        LinearFailure::OutOfMemory(bytes) => format!(
            "the linear solver asked for {} of memory more, and did not get them; mesh coarser (a \
             larger h), run on fewer threads, or raise the limit (ulimit -v, container)",
            gigabytes(*bytes)
        ),
        LinearFailure::Indefinite(row) => {
            let node = system.discretisation().points().node[*row] as usize;
            let x = problem.mesh.nodes[node];
            format!(
                "the stiffness is not positive definite at node {} ({:.4}, {:.4}, {:.4}): the rock there can move freely; hold it, or give the fractures around it stiffness",
                problem.mesh.node_tags[node], x.x, x.y, x.z
            )
        }
        LinearFailure::NotFinite => {
            "a number in the linear system is not finite; check the units of stiffness and load"
                .into()
        }
        LinearFailure::Stalled(iterations) => format!(
            "the linear solver gave up after {iterations} iterations; choose another with [solver]"
        ),
        LinearFailure::Analysis(what) => format!("the linear solver failed: {what}"),
    }
}
