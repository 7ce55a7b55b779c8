//! Contact: a penalty against exact contact.

use kluft_chart::{Axis, Chart, Rate, Series};
use kluft_solver::{NewtonSettings, Problem, Solution, StepRecord};
use lie_core::{Closure, ClosureKind, FractureLaw, Tension};

use super::blocks::{fracture, tilting};
use super::counts::{count, entry, height, hold_promise, most};
use crate::methods::plain_newton;
use crate::report::{Effort, Finding, Study, Table, largest};
use crate::scenes::{self, ROCK};

/// The study.
pub const STUDY: Study = Study {
    name: "contact",
    title: "Contact",
    subject: "a penalty of K h/E from 1e-3 to 1e8 beside exact contact",
    run,
};

/// Pressure on the half of the top (Pa).
const PRESSURE: f64 = 10e6;
/// Cells along the joint.
const CELLS: f64 = 8.0;

/// A block that tilts on another, the joint a penalty without tension.
fn penalty(contrast: f64) -> Problem {
    let stiffness = contrast * ROCK.young_modulus * CELLS;
    let closure = Closure {
        tension: Tension::CutOff,
        ..Closure::new(1e-4, stiffness, ClosureKind::Linear)
    };
    tilting(fracture(FractureLaw::elastic(closure, 0.0)), PRESSURE)
}

fn exact() -> Problem {
    tilting(
        fracture(FractureLaw::elastic(Closure::contact(0.0), 0.0)),
        PRESSURE,
    )
}

/// Deepest penetration over the largest displacement.
fn penetration(solution: &Solution) -> f64 {
    let deepest = largest(solution.facet_points.iter().map(|point| -point.opening));
    deepest / largest(solution.displacements.iter().map(|u| u.length()))
}

/// Difference of the tractions from those of exact contact, root mean square over the largest.
fn traction_error(solution: &Solution, exact: &Solution) -> f64 {
    let pairs = || solution.facet_points.iter().zip(&exact.facet_points);
    let squares = pairs().map(|(a, b)| (a.normal_traction - b.normal_traction).powi(2));
    let mean = squares.sum::<f64>() / exact.facet_points.len() as f64;
    mean.sqrt() / largest(pairs().map(|(_, b)| b.normal_traction.abs()))
}

/// Numbers of one penalty.
struct Case {
    contrast: f64,
    penetration: f64,
    traction: f64,
    ours: StepRecord,
    plain: StepRecord,
}

fn solved(problem: &Problem) -> (StepRecord, Solution) {
    let (record, solution, _) = scenes::try_solve(problem, NewtonSettings::default());
    (record, solution)
}

fn case(contrast: f64, exact: &Solution) -> Case {
    let problem = penalty(contrast);
    let (ours, solution) = solved(&problem);
    Case {
        contrast,
        penetration: penetration(&solution),
        traction: traction_error(&solution, exact),
        ours,
        plain: plain_newton::solve(&problem, NewtonSettings::default()).0,
    }
}

fn table(cases: &[Case], exact: &StepRecord, touching: f64) -> Table {
    let mut table = Table::new(&[
        "joint",
        "penetration / displacement",
        "traction error (rms / largest)",
        "Newton, Kluft",
        "Newton, plain",
    ]);
    for case in cases {
        table.push([
            format!("penalty {:e}", case.contrast),
            format!("{:.2e}", case.penetration),
            format!("{:.2e}", case.traction),
            entry(count(&case.ours)),
            entry(count(&case.plain)),
        ]);
    }
    table.push([
        "contact".to_owned(),
        format!("{touching:.2e}"),
        "0".to_owned(),
        entry(count(exact)),
        String::new(),
    ]);
    table
}

fn charts(cases: &[Case], exact: &StepRecord, touching: f64) -> Vec<(&'static str, Chart)> {
    let curve = |name: &str, of: &dyn Fn(&Case) -> f64| {
        let points = cases.iter().map(|case| (case.contrast, of(case)));
        Series::line(name, points.collect())
    };
    let x = || Axis::logarithmic("stiffness of the penalty, K h/E");
    vec![
        (
            "contact",
            Chart {
                series: vec![
                    curve("penetration, penalty", &|case| case.penetration),
                    curve("traction error, penalty", &|case| case.traction),
                    curve("penetration, contact", &|_| touching),
                ],
                rates: vec![Rate {
                    series: 1,
                    rate: -1.0,
                }],
                ..Chart::new(
                    "A block that tilts on another: penalty and exact contact",
                    x(),
                    Axis::logarithmic("over the largest displacement or traction").from(1e-17),
                )
            },
        ),
        (
            "contact-iterations",
            Chart {
                series: vec![
                    curve("penalty, plain Newton", &|case| height(count(&case.plain))),
                    curve("penalty, Kluft", &|case| height(count(&case.ours))),
                    curve("contact, Kluft", &|_| height(count(exact))),
                ],
                failure: "no convergence in 50 iterations".into(),
                ..Chart::new(
                    "A block that tilts on another: iterations",
                    x(),
                    Axis::linear("Newton iterations"),
                )
            },
        ),
    ]
}

/// Share of the facet points that are open.
fn open_share(solution: &Solution) -> f64 {
    let points = solution.facet_points.iter();
    let open = points.filter(|point| point.opening > 0.0).count();
    open as f64 / solution.facet_points.len() as f64
}

/// The cases of some penalties, and exact contact beside them.
struct Compared {
    cases: Vec<Case>,
    record: StepRecord,
    reference: Solution,
}

impl Compared {
    fn of(exponents: impl IntoIterator<Item = i32>) -> Self {
        let (record, reference) = solved(&exact());
        let contrasts = exponents.into_iter().map(|power| 10.0_f64.powi(power));
        let cases = contrasts.map(|contrast| case(contrast, &reference));
        Self {
            cases: cases.collect(),
            record,
            reference,
        }
    }

    fn misses(&self) -> Vec<String> {
        let mut misses = Vec::new();
        hold_promise(&mut misses, "contact", &self.record);
        for case in &self.cases {
            let name = format!("penalty {:e}", case.contrast);
            hold_promise(&mut misses, &name, &case.ours);
        }
        let touching = penetration(&self.reference);
        if touching.is_nan() || touching > 1e-12 {
            misses.push(format!(
                "contact: penetration {touching:.1e} of the displacement"
            ));
        }
        misses
    }

    /// How penalties fail, and how exact contact does not.
    fn text(&self) -> String {
        let (soft, stiff) = (&self.cases[0], self.cases.last().expect("cases"));
        let penetrations = [soft, stiff].map(|case| format!("{:.1e}", case.penetration));
        let tractions = [soft, stiff].map(|case| format!("{:.1e}", case.traction));
        let penalty = format!(
            "A penalty lets walls overlap by what its stiffness leaves: a block pressed on one \
             half of its top tilts on the block below, the joint opens on {:.0} % of its points, \
             and the rest penetrates by {} of the largest displacement at K h/E = {:e} and {} at \
             {:e}, falling with the stiffness; the tractions are off by {}.",
            100.0 * open_share(&self.reference),
            penetrations[0],
            soft.contrast,
            penetrations[1],
            stiff.contrast,
            tractions.join(" and "),
        );
        let plain = self.cases.iter().filter_map(|case| count(&case.plain));
        let failed = self.cases.iter().filter(|case| !case.plain.converged());
        let newton = format!(
            "In other programs a stiff penalty spoils the linear system (see above: split nodes); \
             in jump unknowns it does not, and Newton takes at most {} iterations (plain Newton up \
             to {}, {} of {} cases fail).",
            self.most(),
            plain.max().unwrap_or(0),
            failed.count(),
            self.cases.len(),
        );
        format!(
            "{penalty} {newton} Exact contact needs no stiffness to be chosen: penetration {:.0e}, \
             {} iterations.",
            penetration(&self.reference),
            entry(count(&self.record)),
        )
    }

    /// Most Newton iterations of a penalty.
    fn most(&self) -> String {
        entry(most(self.cases.iter().map(|case| count(&case.ours))))
    }
}

fn run(effort: Effort) -> Finding {
    let compared = Compared::of(match effort {
        Effort::Quick => vec![-3, 2, 8],
        Effort::Full => (-3..=8).collect(),
    });
    let Compared { cases, record, .. } = &compared;
    let touching = penetration(&compared.reference);
    let (soft, stiff) = (&cases[0], cases.last().expect("cases"));
    Finding::new([
        format!(
            "a penalty: penetration {:.0e} of the displacement at K h/E = {:e}, {:.0e} at {:e}",
            soft.penetration, soft.contrast, stiff.penetration, stiff.contrast
        ),
        format!(
            "`closure = \"contact\"`: {touching:.0e} in {} iterations; any penalty in at most {}",
            entry(count(record)),
            compared.most(),
        ),
    ])
    .text(compared.text())
    .charts(charts(cases, record, touching))
    .numbers(table(cases, record, touching))
    .missing(compared.misses())
}
