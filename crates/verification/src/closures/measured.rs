//! What is measured of every treatment alike, in tables and charts.

use kluft_chart::{Axis, Chart, Series};
use kluft_solver::LinearMethod;

use super::memory::{Peak, Place, Run, measured};
use crate::methods::treatments::{self, Point, Solved, Treatment, solve};
use crate::report::Table;
use crate::scenes::pressed::Pressed;

/// A scene with what its treatments are compared with.
pub struct Terms<'a> {
    pub place: Place,
    pub scene: &'a Pressed,
    /// Exact contact on the same mesh, and the memory that it takes.
    contact: (Solved, Option<Peak>),
    /// Traction (Pa) that is true.
    exact: &'a dyn Fn(&Point) -> f64,
}

/// What is measured of one treatment with one parameter.
pub struct Case {
    pub treatment: Treatment,
    /// Where it stands on charts.
    pub parameter: f64,
    /// Its stiffness (Pa/m).
    pub stiffness: f64,
    /// Largest traction that exact contact carries on the same mesh (Pa).
    pub load: f64,
    /// Nothing if it failed.
    pub solved: Option<Solved>,
    pub closure: f64,
    pub traction: f64,
    pub from_contact: f64,
    pub apart: f64,
    pub aperture: f64,
    /// Nothing if it failed, or the system does not tell.
    pub peak: Option<Peak>,
}

impl<'a> Terms<'a> {
    pub fn new(place: Place, scene: &'a Pressed, exact: &'a dyn Fn(&Point) -> f64) -> Self {
        let run = Run {
            place,
            treatment: Treatment::Contact,
            stiffness: 0.0,
            linear: LinearMethod::Direct,
        };
        let contact = timed(scene, &run).expect("contact converges");
        Self {
            place,
            scene,
            contact: (contact, measured(&run)),
            exact,
        }
    }

    /// Solves with a stiffness in E/h; contact, which has no parameter, was solved before.
    pub fn case(&self, treatment: Treatment, contrast: f64, parameter: f64) -> Case {
        let run = Run {
            place: self.place,
            treatment,
            stiffness: contrast * self.scene.scale,
            linear: LinearMethod::Direct,
        };
        let (solved, peak) = match treatment {
            Treatment::Contact => (Some(self.contact.0.clone()), self.contact.1),
            _ => {
                let solved = timed(self.scene, &run);
                let peak = solved.as_ref().and_then(|_| measured(&run));
                (solved, peak)
            }
        };
        let contact = &self.contact.0.points;
        let measure = |of: &dyn Fn(&[Point]) -> f64| {
            let solved = solved.as_ref();
            solved.map_or(f64::NAN, |solved| of(&solved.points))
        };
        let load = contact.iter().map(|point| point.traction.abs());
        Case {
            treatment,
            parameter,
            stiffness: run.stiffness,
            load: load.fold(0.0, f64::max),
            closure: measure(&treatments::closure),
            traction: measure(&|points| treatments::traction_error(points, self.exact)),
            from_contact: measure(&|points| from_contact(points, contact)),
            apart: measure(&|points| treatments::apart(points, contact)),
            aperture: measure(&treatments::aperture_left),
            peak,
            solved,
        }
    }
}

/// Repetitions of which the fastest counts.
const REPETITIONS: usize = 3;

/// Solves, with the least time of some repetitions; nothing if that fails.
fn timed(scene: &Pressed, run: &Run) -> Option<Solved> {
    let once = || solve(scene, run.treatment, run.stiffness, run.linear);
    let mut solved = once()?;
    for _ in 1..REPETITIONS {
        solved.seconds = solved.seconds.min(once()?.seconds);
    }
    Some(solved)
}

/// Difference of the tractions from those of contact, L2 over L2.
fn from_contact(points: &[Point], contact: &[Point]) -> f64 {
    let (mut squares, mut whole) = (0.0, 0.0);
    for (point, other) in points.iter().zip(contact) {
        squares += point.area * (point.traction - other.traction).powi(2);
        whole += point.area * other.traction.powi(2);
    }
    (squares / whole).sqrt()
}

/// Cases of one line of a chart.
pub struct Curve {
    pub name: String,
    pub cases: Vec<Case>,
}

impl Curve {
    fn line(&self, of: impl Fn(&Case) -> f64) -> Series {
        let points = self.cases.iter().map(|case| (case.parameter, of(case)));
        Series::line(self.name.clone(), points.collect())
    }

    pub fn converged(&self) -> impl Iterator<Item = (&Case, &Solved)> {
        let cases = self.cases.iter();
        cases.filter_map(|case| Some((case, case.solved.as_ref()?)))
    }

    pub fn failures(&self) -> usize {
        self.cases.len() - self.converged().count()
    }
}

/// Smallest and largest of a measure where a curve converged.
pub fn range(curve: &Curve, of: impl Fn(&Case, &Solved) -> f64) -> (f64, f64) {
    let values = curve.converged().map(|(case, solved)| of(case, solved));
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
        (low.min(value), high.max(value))
    })
}

/// Largest of a measure where any of some curves converged.
pub fn worst(curves: &[Curve], of: impl Fn(&Case, &Solved) -> f64) -> f64 {
    let each = curves.iter().map(|curve| range(curve, &of).1);
    each.fold(0.0, f64::max)
}

const MEASURES: [&str; 12] = [
    "deepest closure / b0",
    "traction error",
    "traction against contact",
    "mean opening against contact / b0",
    "mean aperture of what is pressed / b0",
    "Newton",
    "outer",
    "factorisations",
    "seconds",
    "peak memory measured (MB)",
    "of it during the solve (MB)",
    "solve, memory predicted (MB)",
];

/// A table of cases; `lead` has what comes first, a head and entries for each case.
pub fn table<const N: usize>(
    curves: &[Curve],
    head: [&'static str; N],
    lead: impl Fn(&Curve, &Case) -> [String; N],
) -> Table {
    let mut table = Table::new(&[head.as_slice(), &MEASURES].concat());
    for curve in curves {
        for case in &curve.cases {
            table
                .rows
                .push([lead(curve, case).to_vec(), row(case)].concat());
        }
    }
    table
}

fn row(case: &Case) -> Vec<String> {
    let count = |of: &dyn Fn(&Solved) -> String| {
        let solved = case.solved.as_ref();
        solved.map_or("failed".to_owned(), of)
    };
    vec![
        format!("{:.3e}", case.closure),
        format!("{:.2e}", case.traction),
        format!("{:.2e}", case.from_contact),
        format!("{:.3e}", case.apart),
        format!("{:.3e}", case.aperture),
        count(&|s| s.newton.to_string()),
        count(&|s| s.outer.to_string()),
        count(&|s| s.factorisations.to_string()),
        count(&|s| format!("{:.3}", s.seconds)),
        megabytes(case.peak, |peak| peak.process),
        megabytes(case.peak, |peak| peak.solve),
        count(&|s| format!("{:.0}", s.memory as f64 / 1e6)),
    ]
}

/// A measured size for a table.
pub fn megabytes(peak: Option<Peak>, of: impl Fn(Peak) -> usize) -> String {
    peak.map_or("not measured".to_owned(), |peak| {
        format!("{:.1}", of(peak) as f64 / 1e6)
    })
}

/// A chart of one measure of all curves.
pub fn chart(curves: &[Curve], title: &str, x: &str, y: Axis, of: impl Fn(&Case) -> f64) -> Chart {
    Chart {
        series: curves.iter().map(|curve| curve.line(&of)).collect(),
        failure: "not converged".into(),
        ..Chart::new(title, Axis::logarithmic(x), y)
    }
}

pub fn newton(case: &Case) -> f64 {
    let solved = case.solved.as_ref();
    solved.map_or(f64::NAN, |solved| solved.newton as f64)
}

pub fn seconds(case: &Case) -> f64 {
    let solved = case.solved.as_ref();
    solved.map_or(f64::NAN, |solved| solved.seconds)
}

/// Memory during the solve (MB).
pub fn solve_memory(case: &Case) -> f64 {
    case.peak.map_or(f64::NAN, |peak| peak.solve as f64 / 1e6)
}
