//! Poisson's ratio near one half, linear and quadratic cells.

use kluft_chart::{Axis, Chart, Series};
use kluft_solver::{LinearMethod, NewtonSettings, StepRecord};
use lie_core::Rock;

use super::counts::{count, entry, height, hold_promise};
use crate::oracles::spherical_joint::{Exact, errors, sphere};
use crate::report::{Effort, Finding, Study, Table};
use crate::scenes::{self, EXACT, ROCK};

/// The study.
pub const STUDY: Study = Study {
    name: "locking",
    title: "Rock that hardly changes its volume",
    subject: "Poisson's ratio from 0.25 to 0.4999, linear and quadratic tetrahedra",
    run,
};

/// One solve.
struct Case {
    order: u32,
    ratio: f64,
    /// Relative errors: traction, opening, displacement of the shell.
    errors: [f64; 3],
    direct: StepRecord,
    iterative: StepRecord,
}

fn case(order: u32, h: f64, ratio: f64) -> Case {
    let rock = Rock {
        poisson_ratio: ratio,
        ..ROCK
    };
    let problem = sphere(EXACT, rock.clone(), h, order);
    let (direct, solution, _) = scenes::try_solve(&problem, NewtonSettings::default());
    let settings = NewtonSettings {
        linear: Some(LinearMethod::Iterative),
        ..NewtonSettings::default()
    };
    let (iterative, ..) = scenes::try_solve(&problem, settings);
    let ([traction, opening, _, shell], _) = errors(&problem, &solution, &Exact::of(EXACT, rock));
    Case {
        order,
        ratio,
        errors: [traction, opening, shell],
        direct,
        iterative,
    }
}

fn linear_iterations(record: &StepRecord) -> Option<usize> {
    record.converged().then(|| record.linear_iterations())
}

/// How a series of an order is called.
fn name(order: u32) -> &'static str {
    if order == 1 {
        "linear tetrahedra"
    } else {
        "quadratic tetrahedra"
    }
}

fn curve(cases: &[Case], order: u32, of: impl Fn(&Case) -> f64) -> Series {
    let own = cases.iter().filter(|case| case.order == order);
    let points = own.map(|case| (1.0 - 2.0 * case.ratio, of(case)));
    Series::line(name(order), points.collect())
}

fn charts(cases: &[Case]) -> Vec<(&'static str, Chart)> {
    let x = || Axis::logarithmic("1 − 2 ν (0.5 is ν = 0.25, 0.0002 is ν = 0.4999)");
    vec![
        (
            "locking",
            Chart {
                series: [1, 2]
                    .map(|order| curve(cases, order, |case| case.errors[2]))
                    .into(),
                ..Chart::new(
                    "A floating core: error of the shell's displacement",
                    x(),
                    Axis::logarithmic("error (relative, root mean square)"),
                )
            },
        ),
        (
            "locking-iterations",
            Chart {
                series: [1, 2]
                    .map(|order| {
                        curve(cases, order, |case| {
                            height(linear_iterations(&case.iterative))
                        })
                    })
                    .into(),
                failure: "no convergence".into(),
                ..Chart::new(
                    "A floating core: iterations of the multigrid solver in one load step",
                    x(),
                    Axis::logarithmic("linear iterations"),
                )
            },
        ),
    ]
}

fn table(cases: &[Case], misses: &mut Vec<String>) -> Table {
    let mut table = Table::new(&[
        "order",
        "Poisson's ratio",
        "error of the traction",
        "error of the opening",
        "error of the shell's displacement",
        "Newton",
        "Newton, iterative solver",
        "linear iterations, iterative solver",
    ]);
    for case in cases {
        let place = format!("{}, ratio {}", name(case.order), case.ratio);
        hold_promise(misses, &place, &case.direct);
        hold_promise(
            misses,
            &format!("{place}, iterative solver"),
            &case.iterative,
        );
        table.push([
            case.order.to_string(),
            case.ratio.to_string(),
            format!("{:.3e}", case.errors[0]),
            format!("{:.3e}", case.errors[1]),
            format!("{:.3e}", case.errors[2]),
            entry(count(&case.direct)),
            entry(count(&case.iterative)),
            entry(linear_iterations(&case.iterative)),
        ]);
    }
    table
}

fn run(effort: Effort) -> Finding {
    let (sizes, ratios): ([f64; 2], &[f64]) = match effort {
        Effort::Quick => ([0.5, 0.7], &[0.25, 0.4999]),
        Effort::Full => (
            [0.3, 0.5],
            &[
                0.25, 0.3, 0.4, 0.45, 0.48, 0.49, 0.495, 0.498, 0.499, 0.4995, 0.4999,
            ],
        ),
    };
    let mut cases = Vec::new();
    for (order, h) in [1, 2].into_iter().zip(sizes) {
        cases.extend(ratios.iter().map(|&ratio| case(order, h, ratio)));
    }
    let mut misses = Vec::new();
    let table = table(&cases, &mut misses);
    let end = |order: u32, last: bool| {
        let mut own = cases.iter().filter(|case| case.order == order);
        let found = if last { own.next_back() } else { own.next() };
        found.expect("cases")
    };
    let percent = |order, last| format!("{:.2} %", 100.0 * end(order, last).errors[2]);
    let iterations = |order, last| entry(linear_iterations(&end(order, last).iterative));
    // Each where the ratio is smallest and where it is largest.
    let [linear, quadratic] = [1, 2].map(|order| [false, true].map(|last| percent(order, last)));
    let [[soft, hard], [soft_2, hard_2]] =
        [1, 2].map(|order| [false, true].map(|last| iterations(order, last)));
    let errors = format!(
        "with linear cells the displacement of the shell is off by {} at 0.25 and by {} at 0.4999, \
         with quadratic cells on a coarser mesh by {} and {}",
        linear[0], linear[1], quadratic[0], quadratic[1]
    );
    Finding::new([
        format!(
            "linear tetrahedra: the shell's displacement is {} off at ν = 0.25 and {} at 0.4999",
            linear[0], linear[1]
        ),
        format!(
            "`order = 2`: {} and {}; {hard_2} linear iterations instead of {soft_2}",
            quadratic[0], quadratic[1]
        ),
    ])
    .text(format!(
        "Linear tetrahedra that must keep their volume can hardly move: they lock. A core that \
         floats in a spherical joint inside a shell under pressure has a closed form for every \
         Poisson's ratio; {errors}. `order = 2` in `[mesh]` is the remedy. The multigrid suffers \
         too: the whole step takes {soft} linear iterations at 0.25 and {hard} at 0.4999 with \
         linear cells, {soft_2} and {hard_2} with quadratic ones."
    ))
    .charts(charts(&cases))
    .numbers(table)
    .missing(misses)
}
