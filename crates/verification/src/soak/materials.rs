//! Random materials on six junctions: one answer, whatever the linear solver and the load steps.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use kluft_scene::counted;
use kluft_solver::{LinearMethod, NewtonSettings};
use rayon::ThreadPoolBuilder;

use super::asked::{Asked, tell_if_long};
use super::material;
use super::meshes::{Fineness, JUNCTIONS, Meshes};
use super::random_stream::RandomStream;
use super::solve::{End, Fields, longest, solve};
use super::tally::{Miss, Verdict, finding};
use super::workers::{cores, each_by};
use crate::report::{Finding, Study};

/// The suite.
pub const STUDY: Study = Study {
    name: "materials",
    title: "Random materials",
    subject: "rock, closure laws, friction, bonds, loads on six junctions; three linear solvers; \
              1, 2 and 10 load steps",
    run: |effort| run(&Asked::of(effort)),
};

/// Iterations of Newton's method that a run may take.
const MOST_ITERATIONS: usize = 100_000;
/// Jumps below this share of the largest displacement are rounding.
const ROUNDING: f64 = 1e-9;
/// Differences between numbers of load steps below so many path accuracies have a class of their
/// own.
const SLIGHT: f64 = 10.0;

const TEXT: &str = "Each case draws Young's modulus (1e9 to 1e11 Pa, at times 1e5 to 1e13), \
    Poisson's ratio (-0.5 to 0.4999), for each fracture a closure law with its aperture (1e-6 to \
    3e-3 m) and stiffnesses (1e8 to 1e14 Pa/m, at times 1e4 to 1e18), tension cutoff or bond, \
    friction, cohesion, dilation and fluid pressure, then supports, loads of either sign, gravity \
    and initial stress. The junctions are a wedge of 5 degrees, a crossing, a T, a cube in a cube, \
    a small block at a corner, and three planes; every fourth round has cells of order 2. Each \
    case runs with the direct, condensed and iterative solver in 1, 2 and 10 equal load steps; \
    every 25th is meshed so finely that the iterative solver is the program's own choice, and \
    compares that choice with the direct solver in 1 and 2 steps. A run may take 100 000 \
    iterations of Newton's method.

Runs *agree* if the largest difference of a jump anywhere on the fractures between any two is at \
    most the path accuracy (1e-3, the default of `path_accuracy`, which each increment keeps) of \
    the largest jump in either, or rounding (1e-9 of the largest displacement). They *agree within \
    their estimates* if it is more, but no more than the errors of their increments, as both runs \
    estimate them (`path_error` of all load steps), add up to. They *fail alike* if no run \
    converges and all name the same kind of reason, at least those with the same load steps. A \
    run *declares* that its state is not unique by a warning. Anything else is not explained, and \
    listed below; *slightly* is below ten path accuracies.";

/// How a case is run.
#[derive(Debug, Clone, Copy)]
struct Way {
    /// The linear solver; none for the program's choice.
    linear: Option<LinearMethod>,
    /// Number of equal load steps.
    steps: usize,
}

struct Case {
    number: usize,
    name: String,
    junction: usize,
    fineness: Fineness,
    text: String,
}

impl Case {
    fn of(number: usize, seed: u64) -> Self {
        let junction = number % JUNCTIONS.len();
        let fineness = match number {
            _ if number % 25 == 24 => Fineness::Fine,
            _ if number / JUNCTIONS.len() % 4 == 3 => Fineness::Quadratic,
            _ => Fineness::Coarse,
        };
        let own = &JUNCTIONS[junction];
        let drawn = material::random(own.fractures, &mut RandomStream::new(seed, number));
        Self {
            number,
            name: format!("{number} (seed {seed}, {}, {fineness:?})", own.name),
            junction,
            fineness,
            text: own.section(fineness) + &drawn,
        }
    }

    fn ways(&self) -> Vec<Way> {
        let (solvers, counts): (Vec<_>, &[usize]) = if self.fineness == Fineness::Fine {
            (vec![None, Some(LinearMethod::Direct)], &[1, 2])
        } else {
            (LinearMethod::ALL.map(Some).into(), &[1, 2, 10])
        };
        let all = |&steps: &usize| {
            let with = move |&linear: &Option<LinearMethod>| Way { linear, steps };
            solvers.iter().map(with).collect::<Vec<_>>()
        };
        counts.iter().flat_map(all).collect()
    }

    fn scene(&self, Way { linear, steps }: Way) -> String {
        let factor = |step: usize| format!("{}", step as f64 / steps as f64);
        let factors: Vec<String> = (1..=steps).map(factor).collect();
        let solver = linear.map(|linear| format!("[solver]\nlinear = \"{linear}\"\n"));
        let solver = solver.unwrap_or_default();
        format!(
            "{}{solver}[load]\nsteps = [{}]\n",
            self.text,
            factors.join(", ")
        )
    }
}

/// Runs the suite.
pub fn run(asked: &Asked) -> Finding {
    let meshes = Meshes::none();
    let verdicts = asked.verdicts(STUDY.name, [3, 1000], |number| {
        let case = Case::of(number, asked.seed);
        if asked.is_one_case() {
            keep(asked, &case, "asked for alone");
        }
        let verdict = judged(&case, &ends(&case, &meshes, asked));
        if let Some(miss) = &verdict.miss {
            keep(asked, &case, miss);
        }
        verdict
    });
    finding(TEXT, &verdicts)
}

/// Keeps the input of a case, with words on it.
fn keep(asked: &Asked, case: &Case, words: &str) {
    let words: String = words.lines().map(|line| format!("# {line}\n")).collect();
    let junction = &JUNCTIONS[case.junction];
    let scene = format!("materials-{}-{}.toml", asked.seed, case.number);
    let geometry = format!("{}.geo", junction.name);
    asked.keep(&scene, (words + &case.text).as_bytes());
    asked.keep(&geometry, junction.geometry().as_bytes());
}

/// How the runs of a case end, each on one thread, and side by side if it is asked for alone; none
/// is begun after one that is out of iterations.
fn ends(case: &Case, meshes: &Meshes, asked: &Asked) -> Vec<(Way, End)> {
    let kept = asked.kept_ends(STUDY.name, case.number);
    let is_over = AtomicBool::new(false);
    let threads = if asked.is_one_case() { cores() } else { 1 };
    each_by(threads, &case.ways(), |&way| {
        if is_over.load(Ordering::Relaxed) {
            return None;
        }
        let scene = case.scene(way);
        let end = kept.end_of(&scene, || end(case, way, &scene, meshes));
        let end = end.unwrap_or_else(|error| panic!("case {}: {error}", case.name));
        is_over.fetch_or(matches!(end, End::OutOfIterations), Ordering::Relaxed);
        Some((way, end))
    })
}

/// How a run ends; told if it is long.
fn end(case: &Case, way: Way, scene: &str, meshes: &Meshes) -> End {
    let begin = Instant::now();
    let pool = ThreadPoolBuilder::new().num_threads(1).build();
    let pool = pool.expect("a thread");
    let draft = meshes.of(case.junction, case.fineness);
    let end = solve(scene, draft, &pool, MOST_ITERATIONS);
    let told = || format!("case {}: {}: {}", case.name, words(&way), reason(&end));
    tell_if_long(begin.elapsed(), told);
    end
}

fn words(&Way { linear, steps }: &Way) -> String {
    let method = linear.map_or("the program's choice".to_owned(), |linear| {
        linear.to_string()
    });
    format!("{method} in {}", counted(steps, "step"))
}

fn judged(case: &Case, ends: &[(Way, End)]) -> Verdict {
    let missed = |outcome: &str, what: &str| {
        Verdict::missed(outcome, format!("case {}: {outcome}: {what}", case.name))
    };
    let first = |is: fn(&End) -> Option<&str>| {
        let mut found = ends.iter().filter_map(|(way, end)| Some((way, is(end)?)));
        found
            .next()
            .map(|(way, text)| format!("{}: {text}", words(way)))
    };
    if let Some(what) = first(panic_of) {
        return missed("panic", &what);
    }
    if let Some(what) = first(|end| matches!(end, End::OutOfIterations).then_some("stopped")) {
        return missed("out of iterations", &what);
    }
    let solved = || {
        ends.iter().filter_map(|(way, end)| match end {
            End::Solved(fields) => Some((way, fields)),
            _ => None,
        })
    };
    let is_declared = solved().any(|(_, fields)| fields.is_declared);
    match solved().count() {
        0 => all_failed(ends, &missed),
        count if count == ends.len() => {
            let solved = solved().collect::<Vec<_>>();
            match worst(&solved, |_, _| 0.0) {
                None => Verdict::held("agree"),
                Some(_) if is_declared => Verdict::held("declared not unique"),
                Some(_) => match worst(&solved, estimated) {
                    None => Verdict::held("agree within their estimates"),
                    Some(Miss { outcome, what }) => missed(outcome, &what),
                },
            }
        }
        _ if is_declared => Verdict::held("declared not unique"),
        _ => missed("solved by some only", &listed(ends)),
    }
}

fn panic_of(end: &End) -> Option<&str> {
    match end {
        End::Panicked(words) => Some(words),
        _ => None,
    }
}

fn reason(end: &End) -> &str {
    match end {
        End::Failed(why) => why,
        End::Refused(_) => "refused",
        End::Solved(_) => "solved",
        End::OutOfIterations => "out of iterations",
        End::Panicked(_) => "panic",
    }
}

fn all_failed(ends: &[(Way, End)], missed: &dyn Fn(&str, &str) -> Verdict) -> Verdict {
    let first = reason(&ends[0].1);
    if ends.iter().all(|(_, end)| reason(end) == first) {
        return match &ends[0].1 {
            End::Refused(defect) => missed("refused", defect),
            _ => Verdict::held(format!("fail alike: {first}")),
        };
    }
    let of_steps = |steps| ends.iter().filter(move |(way, _)| way.steps == steps);
    let is_alike = |steps| {
        let mut reasons = of_steps(steps).map(|(_, end)| reason(end));
        let first = reasons.next();
        reasons.all(|reason| Some(reason) == first)
    };
    if [1, 2, 10].into_iter().all(is_alike) {
        return Verdict::held("fail, why depends on the load steps");
    }
    missed("fail for different reasons", &listed(ends))
}

fn listed(ends: &[(Way, End)]) -> String {
    let ends = ends
        .iter()
        .map(|(way, end)| format!("{}: {}", words(way), reason(end)));
    ends.collect::<Vec<_>>().join("; ")
}

/// What the errors of the increments of two runs, as they estimate them, may add up to, as a share
/// of the largest jump; 0 for runs of the same load steps that do not warn of it, which take the
/// same path.
fn estimated(a: &(&Way, &Fields), b: &(&Way, &Fields)) -> f64 {
    let warns = a.1.warns_of_sums || b.1.warns_of_sums;
    if a.0.steps == b.0.steps && !warns {
        return 0.0;
    }
    (a.1.path_error + b.1.path_error) / longest(&a.1.jumps).max(longest(&b.1.jumps))
}

/// The largest difference between two runs, if it is more than the path accuracy and more than what
/// is `allowed`.
fn worst(
    solved: &[(&Way, &Fields)],
    allowed: fn(&(&Way, &Fields), &(&Way, &Fields)) -> f64,
) -> Option<Miss> {
    let accuracy = NewtonSettings::default().path;
    let pairs = solved.iter().enumerate();
    let pairs = pairs.flat_map(|(i, a)| solved[..i].iter().map(move |b| (a, b)));
    let differ = pairs.filter_map(|(a, b)| {
        let by = difference(a.1, b.1);
        let is_more = by > accuracy.max(allowed(a, b));
        is_more.then_some((by, a.0, b.0))
    });
    // Solvers that differ in the same load steps say more than load steps that differ.
    let rank = |&(_, a, b): &(f64, &Way, &Way)| a.steps == b.steps;
    let order = |a: &(f64, &Way, &Way), b: &(f64, &Way, &Way)| {
        rank(a).cmp(&rank(b)).then(a.0.total_cmp(&b.0))
    };
    let (by, a, b) = differ.max_by(order)?;
    let outcome = if a.steps == b.steps {
        "linear solvers differ"
    } else if by <= SLIGHT * accuracy {
        "load steps differ slightly"
    } else {
        "load steps differ"
    };
    let largest = longest(&solved[0].1.jumps);
    let what = format!(
        "by {by:.1e} of the largest jump ({largest:.1e} m): {} and {}",
        words(b),
        words(a)
    );
    Some(Miss { outcome, what })
}

/// The largest difference of a jump as a share of the largest jump; 0 if it is rounding.
fn difference(a: &Fields, b: &Fields) -> f64 {
    let differences: Vec<f64> = a.jumps.iter().zip(&b.jumps).map(|(a, b)| a - b).collect();
    if differences.iter().any(|x| !x.is_finite()) {
        return f64::INFINITY;
    }
    let by = longest(&differences);
    if by <= ROUNDING * a.displacement.max(b.displacement) {
        return 0.0;
    }
    by / longest(&a.jumps).max(longest(&b.jumps))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fields(jump: f64) -> Fields {
        Fields {
            jumps: vec![1e-4, 0.0, 0.0, 0.0, 0.0, jump],
            displacement: 1e-3,
            path_error: 1.5e-7,
            is_declared: false,
            warns_of_sums: false,
        }
    }

    #[test]
    fn a_difference_beyond_the_path_accuracy_is_seen_and_named() {
        let way = |linear, steps| Way {
            linear: Some(linear),
            steps,
        };
        let direct = way(LinearMethod::Direct, 2);
        let iterative = way(LinearMethod::Iterative, 2);
        let once = way(LinearMethod::Direct, 1);
        let [a, near, far] = [5e-5, 5.005e-5, 5.02e-5].map(fields);
        let none: fn(&(&Way, &Fields), &(&Way, &Fields)) -> f64 = |_, _| 0.0;
        assert!(worst(&[(&direct, &a), (&iterative, &near)], none).is_none());
        for allowed in [none, estimated] {
            let found = worst(&[(&direct, &a), (&iterative, &far), (&once, &far)], allowed);
            assert_eq!(
                found.expect("a difference").outcome,
                "linear solvers differ"
            );
        }
        let found = worst(&[(&direct, &a), (&once, &far)], none).expect("a difference");
        assert_eq!(found.outcome, "load steps differ slightly");
        assert!(found.what.contains("2.0e-3"), "{}", found.what);
        assert!(worst(&[(&direct, &a), (&once, &far)], estimated).is_none());
    }

    #[test]
    fn every_drawn_scene_is_read() {
        for number in 0..300 {
            let case = Case::of(number, 1);
            let scene = case.scene(Way {
                linear: None,
                steps: 1,
            });
            let read = kluft_scene::Scene::parse(&scene, "s", std::path::Path::new("."));
            assert!(read.is_ok(), "{:?}\n{scene}", read.err());
        }
    }
}
