//! Why a run failed, and where, in words.

use kluft_io::NOT_WRITTEN;
use kluft_mesh::Defect;
use kluft_scene::SolverEntry;
use kluft_solver::{LinearFailure, Plan, Problem, Step, StepOutcome, StepRecord, System};
use lie_core::{ClosureKind, FractureLaw, Rock};

use crate::decisions::of_step;
use crate::memory;
use crate::ranks::Ranks;

/// A solver that does not fit in memory, and what would.
pub fn too_large(plan: &Plan, asked: &SolverEntry, limit: usize) -> Defect {
    let chosen = plan.prediction();
    let smaller = plan.predictions.iter().find(|p| p.memory_bytes <= limit);
    let place = match (asked.linear, asked.memory_limit) {
        (None, None) => "memory of this machine",
        _ => "[solver]",
    };
    let more = match asked.memory_limit {
        Some(_) => "raise `memory_limit` under [solver]",
        None => "run it on a machine with more memory",
    };
    let remedy = smaller.map_or(
        format!("mesh coarser (a larger h, or order = 1), or {more}"),
        |smaller| {
            format!(
                "write linear = \"{}\" under [solver] ({}), or leave the choice to the program",
                smaller.method,
                memory::in_words(smaller.memory_bytes)
            )
        },
    );
    Defect::new(
        place,
        format!(
            "the {} solver needs {} with the estimate of errors, and may take {}",
            chosen.method,
            memory::in_words(chosen.memory_bytes),
            memory::in_words(limit)
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
        memory::in_words(needed),
        memory::in_words(limit)
    );
    let remedy = "mesh coarser (a larger h), start fewer ranks of more threads (--threads) on each \
                  machine, or spread them over more machines";
    Defect::new("memory of this machine", problem, remedy)
}

/// Says of files that could not be written what is kept nevertheless: so many load steps, after so
/// many of which a checkpoint goes on.
pub fn with_what_is_kept(
    mut defects: Vec<Defect>,
    [steps, checkpointed]: [usize; 2],
) -> Vec<Defect> {
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
        defect.remedy.push_str(&match checkpointed {
            0 => String::new(),
            _ if checkpointed == steps => ", then go on with --resume".to_owned(),
            _ => format!(", then go on after load step {checkpointed} with --resume"),
        });
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
            "the tests do not hold after {count} iterations; the closure error is largest{}{}",
            at(record.worst_facet_point),
            of_contrast(problem)
        ),
        StepOutcome::RigidBodyMotion => {
            "the loads push rock that nothing holds any more".to_owned()
        }
        StepOutcome::NotFinite(point) => format!(
            "in iteration {} a number is no longer finite{}; check the units of stiffness, aperture \
             and load{}",
            count + 1,
            at(*point),
            of_logarithm(problem)
        ),
        StepOutcome::Linear(failure) => linear_failure(problem, system, failure),
        StepOutcome::Stopped => format!("it was stopped after {count} iterations"),
    }
}

/// Stiffnesses that lie further apart than this leave rounding larger than what the tests ask for.
const FAR_APART: f64 = 1e8;

/// What may help where stiffnesses are so unlike that the rounding of the largest hides the others.
fn of_contrast(problem: &Problem) -> String {
    let names = problem.mesh.fractures.iter();
    let fractures = names.zip(problem.fractures.iter().map(|fracture| &fracture.law));
    let (what, or) = if let Some(what) = contrast_of_rocks(&problem.rocks) {
        (what, ", or try linear = \"iterative\" under [solver]")
    } else if let Some(what) = contrast_in_fractures(fractures) {
        (what, "")
    } else {
        return String::new();
    };
    format!(
        "; {what}, and what rounding leaves of that may be more than the tests allow: bring them \
         closer{or}"
    )
}

fn contrast_of_rocks(rocks: &[Rock]) -> Option<String> {
    let moduli = || rocks.iter().map(|rock| rock.young_modulus);
    let least = moduli().fold(f64::INFINITY, f64::min);
    let contrast = moduli().fold(0.0, f64::max) / least;
    // `K / G = 2 (1 + nu) / (3 (1 - 2 nu))`.
    let firmness = |rock: &Rock| 1.0 / (1.0 - 2.0 * rock.poisson_ratio);
    let firmest = rocks.iter().map(firmness).fold(0.0, f64::max);
    if contrast > FAR_APART {
        Some(format!(
            "a rock is {contrast:.0e} times as stiff as another"
        ))
    } else if firmest > FAR_APART {
        let what = "rock is far stiffer against a change of volume than of shape (a Poisson's \
                    ratio is all but 0.5)";
        Some(what.to_owned())
    } else {
        None
    }
}

fn contrast_in_fractures<'a>(
    mut fractures: impl Iterator<Item = (&'a String, &'a FractureLaw)>,
) -> Option<String> {
    fractures.find_map(|(name, law)| {
        let (normal, shear) = (law.closure.normal_stiffness, law.shear_stiffness);
        let contrast = shear / normal;
        let is_far = normal > 0.0 && contrast.is_finite() && contrast >= FAR_APART;
        is_far.then(|| {
            format!("the shear stiffness of `{name}` is {contrast:.0e} times its normal stiffness")
        })
    })
}

/// Which loads the logarithmic law answers, if a fracture follows it.
fn of_logarithm(problem: &Problem) -> &'static str {
    let mut laws = problem.fractures.iter().map(|fracture| &fracture.law);
    let is_one = |law: &FractureLaw| matches!(law.closure.kind, ClosureKind::Logarithmic { .. });
    if laws.any(is_one) {
        ": the logarithmic law answers up to about 1e5 K_n0 b0"
    } else {
        ""
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
            memory::in_words(*bytes)
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
            memory::in_words(*bytes)
        ),
        LinearFailure::Indefinite(row) => {
            let node = system.discretisation().points().node[*row] as usize;
            let x = problem.mesh.nodes[node];
            format!(
                "the stiffness is not positive definite at node {} ({:.4}, {:.4}, {:.4}): the rock \
                 there can move freely; hold it, or give the fractures around it stiffness{}",
                problem.mesh.node_tags[node],
                x.x,
                x.y,
                x.z,
                of_contrast(problem)
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

#[cfg(test)]
mod tests {
    use lie_core::Closure;

    use super::*;

    #[test]
    fn a_run_goes_on_only_where_a_checkpoint_does() {
        for (kept, says) in [
            ([0, 0], "free some space"),
            ([1, 0], "free some space"),
            ([4, 4], "free some space, then go on with --resume"),
            (
                [4, 3],
                "free some space, then go on after load step 3 with --resume",
            ),
        ] {
            let full = Defect::new("a", "no room", "free some space").with_code(NOT_WRITTEN);
            let told = with_what_is_kept(vec![full], kept);
            assert_eq!(told[0].remedy, says);
        }
    }

    #[test]
    fn stiffnesses_that_are_too_unlike_are_named() {
        let rock = |young_modulus, poisson_ratio| Rock {
            young_modulus,
            poisson_ratio,
            density: 0.0,
            anisotropy: None,
        };
        for (rocks, says) in [
            (vec![rock(50e9, 0.4999999), rock(50e3, 0.2)], ""),
            (vec![rock(50e9, 0.2), rock(50.0, 0.2)], "1e9 times as stiff"),
            (vec![rock(50e9, 0.499_999_999_9)], "all but 0.5"),
        ] {
            let told = contrast_of_rocks(&rocks);
            assert_eq!(told.is_none(), says.is_empty(), "{told:?}");
            assert!(told.unwrap_or_default().contains(says));
        }
        for (normal, shear, is_told) in [
            (1.0, 1e10, true),
            (1e4, 1e10, false),
            (0.0, 1e10, false),
            (f64::INFINITY, f64::INFINITY, false),
        ] {
            let closure = Closure::new(1e-4, normal, ClosureKind::Linear);
            let (name, law) = ("f".to_owned(), FractureLaw::elastic(closure, shear));
            let told = contrast_in_fractures(std::iter::once((&name, &law)));
            assert_eq!(told.is_some(), is_told, "{told:?}");
        }
    }
}
