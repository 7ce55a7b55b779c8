//! Steps of flow that follows its walls, and what the stability map says of them.

use kluft_chart::{Axis, Chart, Series};

use crate::report::{Table, digits, largest};
use crate::scenes::soft_slabs::Path;

/// Most iterations of a step, or of each part of one that must be divided, and most parts of it.
const ITERATIONS: usize = 10;
const PARTS: usize = 4;
/// Most iterations of a step in a path of small ones, on average.
const ON_A_PATH: f64 = 3.0;
/// Group of such paths.
pub(super) const PATH: &str = "path";
/// Most linear iterations of an iteration.
const LINEAR: usize = 25;
/// What nodes may miss of what moves.
const MASS: f64 = 1e-10;

/// A step that was taken.
pub(super) struct Case {
    pub(super) group: &'static str,
    pub(super) what: String,
    /// Of the sweep, for the chart.
    pub(super) value: f64,
    pub(super) converged: bool,
    /// Load steps.
    steps: usize,
    /// Newton iterations of each part of them.
    pub(super) parts: Vec<usize>,
    /// Newton iterations of attempts that were given up.
    pub(super) given_up: usize,
    pub(super) linear: usize,
    /// Most linear iterations of one iteration.
    pub(super) most_linear: usize,
    pub(super) mass: f64,
    /// Smallest aperture at the end over the first.
    pub(super) narrowest: f64,
}

impl Case {
    pub(super) fn of(
        group: &'static str,
        what: String,
        value: f64,
        (path, first): (&Path, f64),
    ) -> Self {
        let records = path.frames.iter().map(|frame| &frame.record);
        let records: Vec<_> = records.chain(&path.failed).collect();
        let parts = records.iter().flat_map(|record| record.substeps.clone());
        let parts: Vec<usize> = parts.collect();
        let all: usize = records.iter().map(|record| record.iterations.len()).sum();
        let linear = records
            .iter()
            .map(|record| record.linear_iterations())
            .sum();
        let ends = path.frames.last().map(|frame| &frame.apertures);
        let ends = ends.into_iter().flatten().copied();
        Self {
            group,
            what,
            value,
            converged: path.failed.is_none(),
            steps: records.len(),
            given_up: all - parts.iter().sum::<usize>(),
            parts,
            linear,
            most_linear: records
                .iter()
                .flat_map(|record| &record.iterations)
                .map(|iteration| iteration.linear_iterations)
                .max()
                .unwrap_or(0),
            mass: path.mass_error(),
            narrowest: ends.filter(|b| b.is_finite()).fold(f64::INFINITY, f64::min) / first,
        }
    }

    pub(super) fn most(&self) -> usize {
        self.parts.iter().copied().max().unwrap_or(0)
    }

    /// Newton iterations of a part, on average.
    pub(super) fn mean(&self) -> f64 {
        self.parts.iter().sum::<usize>() as f64 / self.parts.len() as f64
    }

    /// What it does not hold.
    pub(super) fn miss(&self) -> Option<String> {
        let (most, parts) = (self.most(), self.parts.len());
        let why = match () {
            () if !self.converged => format!("refused after {parts} parts"),
            () if self.group == PATH && self.mean() > ON_A_PATH => {
                format!("{} iterations a step", digits(self.mean()))
            }
            () if most > ITERATIONS || parts > PARTS * self.steps => {
                let given_up = self.given_up;
                format!("{most} iterations in one of {parts} parts, {given_up} given up")
            }
            () if self.most_linear > LINEAR => {
                format!("{} linear iterations in one", self.most_linear)
            }
            () if self.mass.is_nan() || self.mass > MASS => format!("mass {:.1e}", self.mass),
            () if self.narrowest <= 0.0 => "an aperture that is not positive".to_owned(),
            () => return None,
        };
        Some(format!("{}, {}: {why}", self.group, self.what))
    }
}

pub(super) fn text(cases: &[Case], [apart, off, rough]: [f64; 3]) -> String {
    let of = |group: &str| {
        let own = cases
            .iter()
            .filter(|case| case.group == group && case.converged);
        let most = own.clone().map(Case::most).max().unwrap_or(0);
        let parts = own.map(|case| case.parts.len().div_ceil(case.steps));
        let parts = parts.max().unwrap_or(0);
        format!("at most {most} iterations, in at most {parts} parts")
    };
    let mass = largest(cases.iter().map(|case| case.mass));
    let narrowest = cases
        .iter()
        .map(|case| case.narrowest)
        .fold(f64::INFINITY, f64::min);
    format!(
        "A cube of 10 m (25 GPa) with a logarithmic joint through it, which carries 10 MPa beside \
         water of 10 MPa. Its pressure rises by half at one end, in one step of 1e-9 to 1e9 \
         diffusion times: {}; beside rock of 10 MPa to 10 TPa: {}. Pressures of 0.6 to 1.2 times \
         the normal stress open joints that are closed to as little as a millionth of their \
         aperture, in 1e-6 to 1e4 diffusion times: {}. A pressure of 1 MPa lets them close: {}. \
         Loads of 0.1 to 100 K_n b0 close a joint on fluid that leaves through one end: {}; no \
         aperture falls below {} of what it was. A strip that is pumped up and let off in turn \
         comes back to the same apertures to {apart:.0e}. Four half planes that cross at small \
         angles in elastic rock: {}. A closed joint hands a load that comes in 1e-9 diffusion \
         times to fluid that does not give way, its pressure right to {off:.0e} and even to \
         {rough:.0e}. A network without any pressure is refused in steady flow, by name. One, two \
         and three threads give the same bits. But for rounding, nodes never miss more than \
         {mass:.0e} of what moves. Boreholes under refinement, obtuse and flat facets are in the \
         study of steady flow; contact and friction with flow are in the book, resumed runs in \
         the tests.",
        of("time steps"),
        of("contrast"),
        of("opening"),
        of("drawdown"),
        of("closing"),
        digits(narrowest),
        of("crossing")
    )
}

pub(super) fn table(cases: &[Case]) -> Table {
    let mut table = Table::new(&[
        "group",
        "case",
        "converged",
        "parts",
        "Newton iterations",
        "of these given up",
        "most of a part",
        "linear iterations",
        "most of an iteration",
        "mass",
        "narrowest over first",
    ]);
    for case in cases {
        table.push([
            case.group.to_owned(),
            case.what.clone(),
            if case.converged { "yes" } else { "failed" }.to_owned(),
            case.parts.len().to_string(),
            (case.parts.iter().sum::<usize>() + case.given_up).to_string(),
            case.given_up.to_string(),
            case.most().to_string(),
            case.linear.to_string(),
            case.most_linear.to_string(),
            format!("{:.1e}", case.mass),
            digits(case.narrowest),
        ]);
    }
    table
}

pub(super) fn chart(cases: &[Case]) -> Chart {
    let own = |part: &'static str| {
        let own = cases.iter();
        let own = own.filter(|case| case.group == "time steps" && case.what.starts_with(part));
        let own = own.filter(|case| case.what.contains("incompressible"));
        let height = |case: &Case| match case.converged {
            true => case.parts.iter().sum::<usize>() as f64,
            false => f64::NAN,
        };
        Series::line(part, own.map(|case| (case.value, height(case))).collect())
    };
    let parts = ["K_n 1e9", "K_n 1e10", "K_n 1e11", "K_n 1e13"];
    let series = parts.map(own).into_iter();
    Chart {
        series: series.filter(|series| !series.points.is_empty()).collect(),
        failure: "refused".to_owned(),
        ..Chart::new(
            "A joint whose pressure rises: Newton iterations of one step",
            Axis::logarithmic("time step (diffusion times)"),
            Axis::linear("Newton iterations"),
        )
    }
}
