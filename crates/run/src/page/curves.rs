//! Curves over the load steps.

use kluft_chart::{Axis, Chart, Series};
use kluft_report::prefixed;

use crate::summary::StepSummary;

/// Fractures on a chart; more cannot be told apart.
const MOST_SERIES: usize = 8;
/// Points of a curve; more cannot be seen.
const MOST_POINTS: usize = 60;
/// Columns that are charted where they are, with their titles.
const COLUMNS: [(&str, &str, Measured); 5] = [
    ("aperture_mean", "Mean aperture", APERTURE),
    (
        "normal_traction_mean",
        "Mean normal traction",
        ("traction", "Pa"),
    ),
    ("slip_mean", "Mean slip", ("slip", "m")),
    ("pressure_mean", "Mean fluid pressure", ("pressure", "Pa")),
    (
        "hydraulic_aperture_mean",
        "Mean hydraulic aperture",
        APERTURE,
    ),
];

/// What an axis measures, and its unit.
pub(super) type Measured = (&'static str, &'static str);

pub(super) const APERTURE: Measured = ("aperture", "m");
pub(super) const TIME: Measured = ("time", "");

/// A value after each load step: names, and times with values.
pub(super) type Curves = Vec<(String, Vec<(f64, f64)>)>;

/// The curves of the fractures in a `history.csv`: over time, and the closure curve. None of a run
/// of one step.
pub fn of_history(text: &str) -> Vec<Chart> {
    let over_time = COLUMNS.iter().filter_map(|(column, title, axis)| {
        let curves = curves(text, column);
        let varies = curves.iter().any(|(_, points)| spread(points) > 0.0);
        varies.then(|| chart(&format!("{title} of fractures"), [TIME, *axis], curves))
    });
    let mut charts: Vec<Chart> = over_time.collect();
    charts.extend(closure(text));
    charts
}

/// What flows in at each source over time.
pub fn of_sources(steps: &[StepSummary]) -> Option<Chart> {
    let mut curves: Curves = Vec::new();
    for step in steps {
        for source in step.flow.iter().flat_map(|flow| &flow.sources) {
            push(&mut curves, &source.name, (step.time, source.rate));
        }
    }
    let varies = curves.iter().any(|(_, points)| points.len() > 1);
    varies.then(|| chart("Inflow", [TIME, ("rate", "m³/s")], curves))
}

/// Compression over aperture.
fn closure(text: &str) -> Option<Chart> {
    let apertures = curves(text, "aperture_mean");
    let tractions = curves(text, "normal_traction_mean");
    let pairs = apertures.into_iter().zip(tractions);
    let curves = pairs.map(|((name, apertures), (_, tractions))| {
        let points = apertures.iter().zip(&tractions);
        (name, points.map(|(b, t)| (b.1, -t.1)).collect())
    });
    let curves: Curves = curves.collect();
    let varies = curves
        .iter()
        .any(|(_, points)| points.len() > 2 && spread(points) > 0.0);
    varies.then(|| chart("Closure", [APERTURE, ("compression", "Pa")], curves))
}

/// The curves that move most over one pair of axes.
pub(super) fn chart(title: &str, axes: [Measured; 2], curves: Curves) -> Chart {
    let count = curves.len();
    let mut best = curves;
    // A curve that moves says more than one that does not; ties keep the order of the file.
    best.sort_by(|a, b| spread(&b.1).total_cmp(&spread(&a.1)));
    best.truncate(MOST_SERIES);
    let title = match count - best.len() {
        0 => title.to_owned(),
        left => format!("{title} ({left} more move less)"),
    };
    let points = || best.iter().flat_map(|(_, points)| points);
    let (across, x) = scaled(axes[0], points().map(|point| point.0));
    let (up, y) = scaled(axes[1], points().map(|point| point.1));
    let series = best.iter().map(|(name, points)| {
        let points = thinned(points).map(|(a, b)| (a / across, b / up));
        Series::line(shortened(name), points.collect())
    });
    Chart {
        series: series.collect(),
        ..Chart::new(title, Axis::linear(x), Axis::linear(y))
    }
}

/// A multiple of a unit that suits values, and the title of their axis.
fn scaled((what, unit): Measured, values: impl Iterator<Item = f64>) -> (f64, String) {
    let (factor, unit) = prefixed(values.map(f64::abs).fold(0.0, f64::max), unit);
    match unit.is_empty() {
        true => (factor, what.to_owned()),
        false => (factor, format!("{what} ({unit})")),
    }
}

/// The curves of the fractures in a column of a history.
fn curves(text: &str, column: &str) -> Curves {
    let mut table = csv::Reader::from_reader(text.as_bytes());
    let head: Vec<String> = match table.headers() {
        Ok(head) => head.iter().map(str::to_owned).collect(),
        Err(_) => return Vec::new(),
    };
    let place = |name: &str| head.iter().position(|known| known == name);
    let places = [place("kind"), place("name"), place("time"), place(column)];
    let [Some(kind), Some(name), Some(time), Some(value)] = places else {
        return Vec::new();
    };
    let mut curves = Vec::new();
    for row in table.records().filter_map(Result::ok) {
        let number = |place: usize| row.get(place).and_then(|text| text.parse().ok());
        if let ("fracture", Some(time), Some(value)) = (&row[kind], number(time), number(value)) {
            push(&mut curves, &row[name], (time, value));
        }
    }
    curves
}

fn push(curves: &mut Curves, name: &str, point: (f64, f64)) {
    match curves.iter_mut().find(|(known, _)| known == name) {
        Some((_, points)) => points.push(point),
        None => curves.push((name.to_owned(), vec![point])),
    }
}

/// How far the values of a curve lie apart.
pub(super) fn spread(points: &[(f64, f64)]) -> f64 {
    let values = points.iter().map(|point| point.1);
    let [low, high] = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
        [low.min(value), high.max(value)]
    });
    (high - low).max(0.0)
}

/// Every so many points, and the last.
fn thinned(points: &[(f64, f64)]) -> impl Iterator<Item = (f64, f64)> {
    let every = points.len().div_ceil(MOST_POINTS).max(1);
    let last = points.len().saturating_sub(1);
    let kept = points.iter().copied().enumerate();
    kept.filter(move |(i, _)| i % every == 0 || *i == last)
        .map(|(_, point)| point)
}

/// A name that fits below a chart.
fn shortened(name: &str) -> String {
    const LENGTH: usize = 40;
    match name.chars().count() > LENGTH {
        true => name.chars().take(LENGTH - 1).chain(['…']).collect(),
        false => name.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HISTORY: &str = "step,time,kind,name,aperture_mean,normal_traction_mean\n\
        1,0.5,step,,,\n1,0.5,fracture,a,3e-4,-1e6\n1,0.5,fracture,b,2e-4,-1e6\n\
        2,1,fracture,a,2e-4,-2e6\n2,1,fracture,b,2e-4,-1e6\n\
        3,1.5,fracture,a,1e-4,-4e6\n3,1.5,fracture,b,2e-4,-1e6\n";

    #[test]
    fn fractures_have_curves_over_time_and_a_closure_curve() {
        let charts = of_history(HISTORY);
        let titles: Vec<&str> = charts.iter().map(|chart| chart.title.as_str()).collect();
        let wanted = [
            "Mean aperture of fractures",
            "Mean normal traction of fractures",
            "Closure",
        ];
        assert_eq!(titles, wanted);
        let close = |chart: usize, wanted: [(f64, f64); 3]| {
            let pairs = charts[chart].series[0].points.iter().zip(wanted);
            let off = pairs.map(|(a, b)| (a.0 - b.0).abs() + (a.1 - b.1).abs());
            off.fold(0.0, f64::max) < 1e-9
        };
        assert!(close(0, [(0.5, 300.0), (1.0, 200.0), (1.5, 100.0)]));
        assert_eq!(charts[0].y.title, "aperture (µm)");
        assert!(close(2, [(300.0, 1.0), (200.0, 2.0), (100.0, 4.0)]));
        assert_eq!(charts[2].y.title, "compression (MPa)");
    }

    #[test]
    fn one_step_and_no_history_have_no_curves() {
        let first: String = HISTORY
            .lines()
            .take(4)
            .map(|line| line.to_owned() + "\n")
            .collect();
        assert!(of_history(&first).is_empty());
        assert!(of_history("").is_empty());
    }

    #[test]
    fn curves_are_few_and_short() {
        let mut text = HISTORY.lines().next().expect("a head").to_owned() + "\n";
        for step in 0..500 {
            for fracture in 0..20 {
                let aperture = f64::from(step * fracture);
                text += &format!("{step},{step},fracture,f{fracture},{aperture},-1\n");
            }
        }
        let charts = of_history(&text);
        let series = &charts[0].series;
        assert_eq!(series.len(), MOST_SERIES);
        assert!(charts[0].title.contains("12 more"), "{}", charts[0].title);
        assert_eq!(series[0].name, "f19");
        assert!(series[0].points.len() <= MOST_POINTS + 1);
        assert_eq!(series[0].points.last(), Some(&(499.0, 499.0 * 19.0)));
    }
}
