//! The number of load steps.

use kluft_chart::{Axis, Chart, Series};
use kluft_solver::{NewtonSettings, Problem, Solution, StepRecord};
use lie_core::ClosureKind;

use super::counts::{count, entry, height, hold_promise, most};
use crate::report::{Effort, Finding, Study, Table, largest};
use crate::scenes::closing::{column, three_planes};
use crate::scenes::{self, EXACT};

/// The study.
pub const STUDY: Study = Study {
    name: "steps",
    title: "Number of load steps",
    subject: "1 to 100 equal steps to the same load",
    run,
};

/// Agreement that the map promises.
const AGREEMENT: f64 = 1e-9;

/// Largest difference of jumps and tractions, each over the largest.
pub fn difference(a: &Solution, b: &Solution) -> f64 {
    let pairs = || a.facet_points.iter().zip(&b.facet_points);
    let jump = largest(pairs().map(|(a, _)| a.jump.length()));
    let traction = largest(pairs().map(|(a, _)| a.traction.length()));
    let apart = pairs().map(|(a, b)| {
        let jumps = a.jump.distance(b.jump) / jump;
        jumps.max(a.traction.distance(b.traction) / traction)
    });
    largest(apart)
}

/// The same problem with linear joints.
pub fn linearised(problem: &Problem) -> Problem {
    let mut problem = problem.clone();
    for fracture in &mut problem.fractures {
        fracture.law.closure.kind = ClosureKind::Linear;
    }
    problem
}

/// Numbers of one scene and number of steps.
struct Case {
    scene: &'static str,
    steps: usize,
    records: Vec<StepRecord>,
    /// From one step.
    apart: f64,
}

impl Case {
    fn most(&self) -> Option<usize> {
        most(self.records.iter().map(count))
    }

    fn all(&self) -> usize {
        self.records
            .iter()
            .map(|record| record.iterations.len())
            .sum()
    }
}

/// Its scenes.
pub fn problems(effort: Effort) -> Vec<(&'static str, Problem)> {
    let mut problems = vec![
        ("column", column(EXACT, 20.0)),
        ("three planes", three_planes(EXACT, 20.0)),
        (
            "three planes, linear",
            three_planes(ClosureKind::Linear, 20.0),
        ),
    ];
    if effort == Effort::Full {
        problems.push((
            "closing blocks",
            scenes::scene_file("closing-blocks", &[("h", 0.4)]),
        ));
    }
    problems
}

fn cases(effort: Effort) -> Vec<Case> {
    let steps: &[usize] = match effort {
        Effort::Quick => &[1, 10],
        Effort::Full => &[1, 2, 5, 10, 20, 50, 100],
    };
    let mut cases: Vec<Case> = Vec::new();
    for (scene, problem) in problems(effort) {
        let mut one: Option<Solution> = None;
        for &steps in steps {
            let loads = (1..=steps).map(|step| step as f64 / steps as f64);
            let path = scenes::solve_path(&problem, NewtonSettings::default(), loads);
            let (records, solutions): (Vec<_>, Vec<_>) = path.into_iter().unzip();
            let last = solutions.into_iter().next_back().expect("a step");
            let apart = one.as_ref().map_or(0.0, |one| difference(one, &last));
            one.get_or_insert(last);
            cases.push(Case {
                scene,
                steps,
                records,
                apart,
            });
        }
    }
    cases
}

fn curves(cases: &[Case], of: impl Fn(&Case) -> f64) -> Vec<Series> {
    let mut names: Vec<&str> = cases.iter().map(|case| case.scene).collect();
    names.dedup();
    let curve = |name: &str| {
        let own = cases.iter().filter(|case| case.scene == name);
        Series::line(
            name,
            own.map(|case| (case.steps as f64, of(case))).collect(),
        )
    };
    names.into_iter().map(curve).collect()
}

fn charts(cases: &[Case]) -> Vec<(&'static str, Chart)> {
    vec![
        (
            "steps",
            Chart {
                series: curves(cases, |case| height(Some(case.all()))),
                ..Chart::new(
                    "Newton iterations of the whole run over the number of steps",
                    Axis::logarithmic("load steps"),
                    Axis::logarithmic("Newton iterations in all"),
                )
            },
        ),
        (
            "steps-agreement",
            Chart {
                series: curves(cases, |case| case.apart),
                ..Chart::new(
                    "Agreement with one step",
                    Axis::logarithmic("load steps"),
                    Axis::logarithmic("difference of jumps and tractions (relative)").from(1e-17),
                )
            },
        ),
    ]
}

fn run(effort: Effort) -> Finding {
    let cases = cases(effort);
    let mut misses = Vec::new();
    let mut table = Table::new(&[
        "scene",
        "steps",
        "Newton iterations in all",
        "most of a step",
        "difference from one step",
    ]);
    for case in &cases {
        let name = format!("{}, {} steps", case.scene, case.steps);
        for record in &case.records {
            hold_promise(
                &mut misses,
                &format!("{name}, load {}", record.load.factors[0]),
                record,
            );
        }
        if case.apart.is_nan() || case.apart > AGREEMENT {
            misses.push(format!("{name}: {:.1e} from one step", case.apart));
        }
        table.push([
            case.scene.to_owned(),
            case.steps.to_string(),
            case.all().to_string(),
            entry(case.most()),
            format!("{:.2e}", case.apart),
        ]);
    }
    let worst = largest(cases.iter().map(|case| case.apart));
    let most_of_all = entry(most(cases.iter().map(Case::most)));
    let finest = cases
        .iter()
        .max_by_key(|case| case.steps)
        .expect("cases")
        .steps;
    let per_step = cases.iter().filter(|case| case.steps == finest);
    let per_step = largest(per_step.map(|case| case.all() as f64 / finest as f64));
    Finding::new([
        "an incremental law, see above: its answer depends on the number of steps".to_owned(),
        format!(
            "the same answer to {worst:.0e}; at most {most_of_all} iterations a step, \
             {per_step:.1} on average in {finest}"
        ),
    ])
    .text(format!(
        "With a total law the number of steps is a matter of taste. A load of 20 K_n0 b0 on a \
         column and on three crossing planes, and the jointed block, in 1 to {finest} equal steps: \
         the answers differ by {worst:.0e}, a step takes at most {most_of_all} Newton iterations, \
         and in {finest} steps {per_step:.1} on average or less, because every step starts from \
         the path of the last ones, continued."
    ))
    .charts(charts(&cases))
    .numbers(table)
    .missing(misses)
}
