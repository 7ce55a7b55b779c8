//! The total law against its incremental form, over the number of steps.

use kluft_chart::{Axis, Chart, Rate, Series};
use kluft_solver::{NewtonSettings, Problem, StepRecord, Support};
use lie_core::Closure;

use super::counts::hold_promise;
use crate::report::{Effort, Finding, Study, Table, largest};
use crate::scenes::closing::column;
use crate::scenes::{self, EXACT, ROCK};

/// The study.
pub const STUDY: Study = Study {
    name: "increments",
    title: "Incremental and total law",
    subject: "1 to 1e8 steps to a tenth of the aperture",
    run,
};

/// Aperture over `b0` in the end.
const CLOSED: f64 = 0.1;

/// The failing method: `sigma += K(b) dw` with the tangent at the end of each step, the walls
/// brought to `b = 0.1 b0` in equal steps. Its traction over the law's.
pub fn incremental_ratio(closure: &Closure, steps: usize) -> f64 {
    let b0 = closure.aperture;
    let change = (CLOSED - 1.0) * b0 / steps as f64;
    let of_step = |step: usize| {
        let b = b0 + change * step as f64;
        closure.at_aperture(b).tangent * change
    };
    let traction: f64 = (1..=steps).map(of_step).sum();
    traction / closure.at_aperture(CLOSED * b0).traction
}

/// A column whose joint a displacement of the top closes to a tenth.
fn pushed_column() -> Problem {
    let mut problem = column(EXACT, 0.0);
    let closure = problem.fractures[0].law.closure;
    let traction = closure.at_aperture(CLOSED * closure.aperture).traction;
    let opening = (CLOSED - 1.0) * closure.aperture;
    // The column is 2 m high.
    let top = opening + 2.0 * traction / ROCK.young_modulus;
    let push = Support::Displacement([None, None, Some(top)]);
    scenes::support(&mut problem, "top", push);
    problem
}

/// The program's traction over the law's, the worst facet point, after equal steps; and the
/// records.
fn total_ratio(problem: &Problem, steps: usize) -> (f64, Vec<StepRecord>) {
    let loads = (1..=steps).map(|step| step as f64 / steps as f64);
    let path = scenes::solve_path(problem, NewtonSettings::default(), loads);
    let closure = problem.fractures[0].law.closure;
    let law = closure.at_aperture(CLOSED * closure.aperture).traction;
    let last = path.last().expect("a step");
    let ratios = last
        .1
        .facet_points
        .iter()
        .map(|point| point.normal_traction / law);
    let worst = ratios.max_by(|a, b| (a - 1.0).abs().total_cmp(&(b - 1.0).abs()));
    let worst = worst.expect("facet points");
    (worst, path.into_iter().map(|(record, _)| record).collect())
}

/// Error of the traction over the steps.
fn errors(rows: &[(usize, f64)]) -> Vec<(f64, f64)> {
    let errors = rows
        .iter()
        .map(|(steps, ratio)| (*steps as f64, (ratio - 1.0).abs()));
    errors.collect()
}

fn table(theirs: &[(usize, f64)], ours: &[(usize, f64)]) -> Table {
    let mut table = Table::new(&["law", "steps", "traction / law"]);
    for (law, rows) in [("incremental", theirs), ("total, Kluft", ours)] {
        for (steps, ratio) in rows {
            table.push([law.to_owned(), steps.to_string(), format!("{ratio:.12}")]);
        }
    }
    table
}

fn charts(theirs: &[(usize, f64)], ours: &[(usize, f64)]) -> Vec<(&'static str, Chart)> {
    vec![(
        "increments",
        Chart {
            series: vec![
                Series::line("incremental law", errors(theirs)),
                Series::line("total law, Kluft", errors(ours)),
            ],
            rates: vec![Rate {
                series: 0,
                rate: -1.0,
            }],
            ..Chart::new(
                "A joint closed to a tenth: error of the traction over the steps",
                Axis::logarithmic("load steps"),
                Axis::logarithmic("error of the traction (relative)").from(1e-16),
            )
        },
    )]
}

fn run(effort: Effort) -> Finding {
    let (decades, own): (u32, &[usize]) = match effort {
        Effort::Quick => (4, &[1, 10]),
        Effort::Full => (8, &[1, 2, 5, 10, 20, 50, 100, 1000]),
    };
    let problem = pushed_column();
    let closure = problem.fractures[0].law.closure;
    let counts = (0..decades).flat_map(|decade| [1, 2, 5].map(|n| n * 10_usize.pow(decade)));
    let counts = counts.chain([10_usize.pow(decades)]);
    let theirs: Vec<(usize, f64)> = counts
        .map(|n| (n, incremental_ratio(&closure, n)))
        .collect();
    let mut misses = Vec::new();
    let mut ours = Vec::new();
    for &steps in own {
        let (ratio, records) = total_ratio(&problem, steps);
        for record in &records {
            hold_promise(&mut misses, &format!("{steps} steps"), record);
        }
        ours.push((steps, ratio));
    }
    let worst = largest(errors(&ours).iter().map(|point| point.1));
    if worst > 1e-9 {
        misses.push(format!("the total law is off by {worst:.1e}"));
    }
    let at = |steps: usize| {
        let row = theirs.iter().find(|row| row.0 == steps);
        row.map_or(f64::NAN, |row| row.1)
    };
    let listed = [1, 2, 5, 10, 20, 50, 100].map(|steps| format!("{:.2}", at(steps)));
    let (last, before) = listed.split_last().expect("ratios");
    let listed = format!("{} and {last}", before.join(", "));
    Finding::new([
        format!(
            "the incremental law: {:.2} times the traction in 1 step, {:.2} in 10, {:.2} in 100",
            at(1),
            at(10),
            at(100)
        ),
        format!("the law's traction to {worst:.0e} in any number of steps"),
    ])
    .text(format!(
        "Programs with friction often integrate the normal law step by step, `sigma += K(b) dw` \
         with the tangent at the end of the step. The tangent of the logarithmic law grows so fast \
         that this is wrong by a factor: closing to a tenth of the aperture gives {listed} times \
         the law's traction in 1, 2, 5, 10, 20, 50 and 100 steps, and the error falls only with \
         the number of steps. Kluft evaluates the total law, also where shear has a history: a \
         column whose top is pushed until its joint closes to a tenth carries the law's traction \
         to {worst:.0e} after any number of steps.",
    ))
    .charts(charts(&theirs, &ours))
    .numbers(table(&theirs, &ours))
    .missing(misses)
}
