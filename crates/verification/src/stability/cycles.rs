//! Cycles of loading and unloading: zero hysteresis for laws with a potential.

use kluft_chart::{Axis, Chart, Series};
use kluft_solver::{NewtonSettings, Problem, Solution, StepRecord};
use lie_core::Closure;

use super::counts::{count, entry, hold_promise, most};
use super::steps::linearised;
use crate::report::{Effort, Finding, Study, Table, largest};
use crate::scenes::{self, EXACT, joint};

/// The study.
pub const STUDY: Study = Study {
    name: "cycles",
    title: "Loading and unloading",
    subject: "20 cycles of load, unload and reload",
    run,
};

/// Load factors of a cycle.
const CYCLE: [f64; 4] = [0.0, 0.5, 1.0, 0.5];
/// The state of the first cycle that each of a cycle must be.
const SAME: [usize; 4] = [0, 1, 2, 1];
/// Hysteresis that the map allows laws without friction.
const NONE: f64 = 1e-10;

/// One scene with one law.
struct Case {
    name: String,
    records: Vec<StepRecord>,
    /// For each cycle the largest difference from the same load in the first one, loading or
    /// unloading, of jumps and tractions, over the largest.
    hysteresis: Vec<f64>,
}

/// Largest jump and traction of a solution.
fn sizes(solution: &Solution) -> (f64, f64) {
    let points = || solution.facet_points.iter();
    (
        largest(points().map(|point| point.jump.length())),
        largest(points().map(|point| point.traction.length())),
    )
}

/// Hysteresis of each cycle: its `i`-th state against state `first[i]` of the first cycle, of jumps
/// and tractions, over the largest of the first cycle.
pub fn hysteresis(solutions: &[Solution], first: &[usize]) -> Vec<f64> {
    let sizes = || solutions[..first.len()].iter().map(sizes);
    let jump = largest(sizes().map(|size| size.0));
    let traction = largest(sizes().map(|size| size.1));
    let apart = |a: &Solution, b: &Solution| {
        let pairs = a.facet_points.iter().zip(&b.facet_points);
        largest(pairs.map(|(a, b)| {
            let jumps = a.jump.distance(b.jump) / jump;
            jumps.max(a.traction.distance(b.traction) / traction)
        }))
    };
    let of_cycle = |cycle: &[Solution]| {
        let pairs = cycle.iter().zip(first);
        largest(pairs.map(|(found, &first)| apart(found, &solutions[first])))
    };
    solutions.chunks(first.len()).map(of_cycle).collect()
}

fn case(name: String, problem: &Problem, cycles: usize) -> Case {
    let loads = (0..cycles).flat_map(|_| CYCLE);
    let path = scenes::solve_path(problem, NewtonSettings::default(), loads);
    let (records, solutions): (Vec<_>, Vec<_>) = path.into_iter().unzip();
    Case {
        name,
        records,
        hysteresis: hysteresis(&solutions, &SAME),
    }
}

/// What the incremental law leaves of the largest traction after each cycle from `b0` to a tenth
/// and back in eight equal steps.
fn incremental_rest(closure: &Closure, cycles: usize) -> Vec<f64> {
    let b0 = closure.aperture;
    let closed = closure.at_aperture(0.1 * b0).traction;
    let apertures: Vec<f64> = [0.775, 0.55, 0.325, 0.1, 0.325, 0.55, 0.775, 1.0]
        .map(|x| x * b0)
        .into();
    let (mut before, mut traction) = (b0, 0.0);
    let mut rests = Vec::new();
    for _ in 0..cycles {
        for &b in &apertures {
            traction += closure.at_aperture(b).tangent * (b - before);
            before = b;
        }
        rests.push((traction / closed).abs());
    }
    rests
}

fn charts(cases: &[Case], rests: &[f64]) -> Vec<(&'static str, Chart)> {
    let points = |values: &[f64]| -> Vec<(f64, f64)> {
        let values = values.iter().enumerate();
        values
            .map(|(cycle, value)| (cycle as f64 + 1.0, *value))
            .collect()
    };
    let of_law = |law: &str| {
        let own = || cases.iter().filter(|case| case.name.ends_with(law));
        let worst = |cycle: usize| largest(own().map(|case| case.hysteresis[cycle]));
        points(&(0..rests.len()).map(worst).collect::<Vec<f64>>())
    };
    vec![(
        "cycles",
        Chart {
            series: vec![
                Series::line("incremental law", points(rests)),
                Series::line("logarithmic, worst scene", of_law("logarithmic")),
                Series::line("linear, worst scene", of_law("linear")),
            ],
            ..Chart::new(
                "Hysteresis over cycles of loading and unloading",
                Axis::linear("cycle"),
                Axis::logarithmic("difference from the first loading (relative)").from(1e-17),
            )
        },
    )]
}

fn table(cases: &[Case], misses: &mut Vec<String>) -> Table {
    let mut table = Table::new(&[
        "scene",
        "cycle",
        "hysteresis",
        "most Newton iterations of a step",
    ]);
    for case in cases {
        for record in &case.records {
            hold_promise(misses, &case.name, record);
        }
        let worst = largest(case.hysteresis.iter().copied());
        if worst.is_nan() || worst > NONE {
            misses.push(format!("{}: hysteresis {worst:.1e}", case.name));
        }
        for (cycle, value) in case.hysteresis.iter().enumerate() {
            let records = &case.records[CYCLE.len() * cycle..][..CYCLE.len()];
            let count = most(records.iter().map(count));
            table.push([
                case.name.clone(),
                (cycle + 1).to_string(),
                format!("{value:.2e}"),
                entry(count),
            ]);
        }
    }
    table
}

/// Its scenes.
pub fn problems(effort: Effort) -> Vec<(&'static str, Problem)> {
    let scenes: &[(&str, f64)] = match effort {
        Effort::Quick => &[("x-junction", 0.3)],
        Effort::Full => &[
            ("x-junction", 0.25),
            ("t-junction", 0.25),
            ("three-planes", 0.25),
            ("closing-blocks", 0.4),
        ],
    };
    let of = |&(scene, h)| (scene, scenes::scene_file(scene, &[("h", h)]));
    scenes.iter().map(of).collect()
}

fn run(effort: Effort) -> Finding {
    let cycles = if effort == Effort::Quick { 3 } else { 20 };
    let mut cases = Vec::new();
    for (scene, problem) in problems(effort) {
        cases.push(case(format!("{scene}, logarithmic"), &problem, cycles));
        cases.push(case(
            format!("{scene}, linear"),
            &linearised(&problem),
            cycles,
        ));
    }
    let rests = incremental_rest(&joint(EXACT).law.closure, cycles);
    let mut misses = Vec::new();
    let table = table(&cases, &mut misses);
    let worst = largest(
        cases
            .iter()
            .flat_map(|case| case.hysteresis.iter().copied()),
    );
    let records = cases.iter().flat_map(|case| &case.records);
    let newton = entry(most(records.map(count)));
    let (first, last) = (rests[0], rests[rests.len() - 1]);
    Finding::new([
        format!(
            "the incremental law: {first:.2} of the largest traction left after one cycle, \
             {last:.1} after {cycles}"
        ),
        format!("hysteresis {worst:.0e}; at most {newton} iterations a step"),
    ])
    .text(format!(
        "Laws without friction have a potential: what is loaded and unloaded must come back. The \
         incremental law does not, because its steps up and down take other tangents: after one \
         cycle to a tenth of the aperture in four steps each way it keeps {first:.2} times the \
         largest traction, and {last:.1} times after {cycles}. In Kluft the junctions (X, T, three \
         planes) and the closing blocks return over {cycles} cycles to the same jumps and \
         tractions, to {worst:.0e} of the largest, in at most {newton} Newton iterations a step."
    ))
    .charts(charts(&cases, &rests))
    .numbers(table)
    .missing(misses)
}
