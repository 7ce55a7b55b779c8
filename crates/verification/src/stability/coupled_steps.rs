//! Steps of flow that follows its walls, and what the stability map says of them.

use kluft_chart::{Axis, Chart, Series};

use crate::report::{Table, digits, largest};
use crate::scenes::soft_slabs::Path;

/// Most iterations of a part of a step, and most parts of a step that must be divided.
const ITERATIONS: usize = 14;
const PARTS: usize = 4;
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
    /// Newton iterations of each part.
    pub(super) parts: Vec<usize>,
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
            parts: parts.collect(),
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

    /// What it does not hold.
    pub(super) fn miss(&self) -> Option<String> {
        let (most, parts) = (self.most(), self.parts.len());
        let why = match () {
            () if !self.converged => format!("refused after {parts} parts"),
            () if most > ITERATIONS && parts > PARTS => {
                format!("{most} iterations in one of {parts} parts")
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
        let parts = own.map(|case| case.parts.len()).max().unwrap_or(0);
        format!("{most} iterations a part and {parts} parts at most")
    };
    let mass = largest(cases.iter().map(|case| case.mass));
    let narrowest = cases
        .iter()
        .map(|case| case.narrowest)
        .fold(f64::INFINITY, f64::min);
    format!(
        "A cube of 10 m (25 GPa) with a logarithmic joint through it, which carries 10 MPa beside \
         water of 10 MPa. Its pressure rises by half at one end, in one step of 1e-9 to 1e9 diffusion \
         times: {}. Pressures of 0.6 to 1.2 times the normal stress open joints that are closed to \
         as little as a millionth of their aperture, in one diffusion time: {}. Loads of 0.1 to 100 \
         K_n b0 close a joint on fluid that leaves through one end: {}; no aperture falls below {} \
         of what it was. A strip that is pumped up and let off in turn comes back to the same \
         apertures to {apart:.0e}. Four half planes that cross at small angles in elastic rock: {}. \
         A closed joint hands a load that comes in 1e-9 diffusion times to fluid that does not give \
         way, its pressure right to {off:.0e} and even to {rough:.0e}. A network without any \
         pressure is refused in steady flow, by name. One, two and three threads give the same bits. \
         But for rounding, nodes never miss more than {mass:.0e} of what moves. Boreholes under refinement, \
         obtuse and flat facets are in the study of steady flow; contact and friction with flow are \
         in the book, resumed runs in the tests.",
        of("time steps"),
        of("opening"),
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
            case.parts.iter().sum::<usize>().to_string(),
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
