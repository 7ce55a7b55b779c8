//! The charts of a study.

use super::assess::{Assessment, MeasuredSeries};
use super::dimension::{SweepDimension, SweepKind};
use super::point::Numbers;
use super::reference::slope;
use super::settings::StudyPlan;
use super::under_way::Study;
use super::words::{or_the_scene, percent, unit};
use kluft_chart::{Axis, Band, Chart, Series as Line};

/// The files of errors against time and against unknowns.
const ERRORS: [&str; 2] = ["error-time.svg", "error-unknowns.svg"];
/// Most series on a chart; more cannot be told apart.
const MOST_SERIES: usize = 10;
/// Errors below the rounding of doubles are drawn there.
const SMALLEST: f64 = 1e-16;

/// A chart and the name of its file.
pub(super) struct NamedChart {
    pub(super) file: String,
    /// The chart.
    pub(super) chart: Chart,
    /// What is not on it.
    pub(super) left_out: Option<String>,
}

/// All charts for which there is something to show.
pub(super) fn charts(study: &Study, found: &Assessment) -> Vec<NamedChart> {
    let has_error = found.verdicts.iter().any(|verdict| verdict.error.is_some());
    let mut charts = Vec::new();
    if has_error {
        let seconds = |numbers: &Numbers| numbers.seconds;
        let unknowns = |numbers: &Numbers| numbers.unknowns as f64;
        charts.push(errors(study, found, (ERRORS[0], "wall time (s)"), &seconds));
        charts.push(errors(study, found, (ERRORS[1], "unknowns"), &unknowns));
    }
    let dimensions = study.plan.dimensions.iter().enumerate();
    let swept = dimensions.filter(|(_, dimension)| is_charted(dimension));
    charts.extend(swept.filter_map(|(dimension, _)| over_value(study, found, dimension)));
    charts
}

/// The files of all charts that a study may have.
pub(super) fn file_names(plan: &StudyPlan) -> Vec<String> {
    let swept = plan
        .dimensions
        .iter()
        .filter(|dimension| is_charted(dimension));
    let over = swept.map(|dimension| over(&dimension.name));
    ERRORS.into_iter().map(String::from).chain(over).collect()
}

fn is_charted(dimension: &SweepDimension) -> bool {
    dimension.kind == SweepKind::Value && dimension.choices.len() > 1
}

/// What is charted, in words.
pub(super) fn subject(found: &Assessment) -> String {
    let Some(target) = &found.target else {
        return "nothing".into();
    };
    let name = target
        .name
        .replace('_', " ")
        .replace(" l2", " (root mean square)");
    match &target.fracture {
        Some(fracture) => format!("{name} of {fracture}"),
        None => name,
    }
}

fn errors(
    study: &Study,
    found: &Assessment,
    (file, title): (&str, &str),
    x: &dyn Fn(&Numbers) -> f64,
) -> NamedChart {
    let line = |series: &MeasuredSeries| {
        let points = found.points(series, &study.records, x);
        // Times that fall from mesh to mesh are noise, and errors that do not shrink have no rate.
        let grows = points.is_sorted_by(|a, b| a.0 < b.0);
        let slope = slope(&points).filter(|slope| grows && *slope < -0.005);
        let note = slope.map(|slope| format!("{slope:.2}").replace('-', "−"));
        Line {
            note,
            ..Line::line(series.name.clone(), points)
        }
    };
    let mut lines: Vec<Line> = found.series.iter().map(line).collect();
    lines.retain(|line| !line.points.is_empty());
    let left_out = keep_best(&mut lines);
    let subject = subject(found);
    let unsure = || found.uncertainties().filter(|share| *share > 0.0);
    let band = unsure().reduce(f64::max).map(|below| Band {
        below,
        name: format!("reference unsure: {}", percent(below)),
    });
    // Where nothing is known, an error of nothing is as good as any.
    let floor = unsure()
        .reduce(f64::min)
        .map_or(SMALLEST, |least| least / 3.0);
    let chart = Chart {
        series: lines,
        front: true,
        band,
        ..Chart::new(
            format!(
                "Error of {subject} against {}",
                title.split(" (").next().unwrap_or(title)
            ),
            Axis::logarithmic(title),
            Axis::logarithmic("relative error").from(floor),
        )
    };
    NamedChart {
        file: file.into(),
        chart,
        left_out,
    }
}

/// Keeps the series that come nearest to the best, in their order; says how many it left out.
fn keep_best(lines: &mut Vec<Line>) -> Option<String> {
    let count = lines.len();
    if count <= MOST_SERIES {
        return None;
    }
    let best = |line: &Line| {
        line.points
            .iter()
            .map(|point| point.1)
            .fold(f64::INFINITY, f64::min)
    };
    let mut errors: Vec<f64> = lines.iter().map(best).collect();
    errors.sort_by(f64::total_cmp);
    let worst = errors[MOST_SERIES - 1];
    let mut left = MOST_SERIES;
    lines.retain(|line| {
        let keeps = best(line) <= worst && left > 0;
        left -= usize::from(keeps);
        keeps
    });
    Some(format!(
        "{} of {count} series with larger errors are not shown; the table has all.",
        count - lines.len()
    ))
}

/// The measure over a value that is swept, or its error if the measure is no number.
fn over_value(study: &Study, found: &Assessment, dimension: usize) -> Option<NamedChart> {
    let swept = &study.plan.dimensions[dimension];
    let is_number = found.verdicts.iter().any(|verdict| verdict.value.is_some());
    let of = |i: usize| match is_number {
        true => found.verdicts[i].value,
        false => found.verdicts[i].error,
    };
    let mut series = lines_over(study, dimension, of);
    // Finer meshes and higher orders are mostly listed last.
    let too_many = series.len().saturating_sub(MOST_SERIES);
    let left_out =
        (too_many > 0).then(|| format!("{too_many} of {} series are not shown.", series.len()));
    series.drain(..too_many);
    let target = found.target.as_ref().filter(|_| !series.is_empty())?;
    let subject = capital(&subject(found));
    let title = match is_number {
        true => format!("{subject}{}", unit(&target.name)),
        false => "relative error".into(),
    };
    let points = || series.iter().flat_map(|line| &line.points);
    let across = format!("{}{}", swept.name, unit(&swept.name));
    let chart = Chart::new(
        format!("{subject} against {}", swept.name),
        axis(across, points().map(|point| point.0)),
        axis(title, points().map(|point| point.1)),
    );
    Some(NamedChart {
        file: over(&swept.name),
        chart: Chart { series, ..chart },
        left_out,
    })
}

/// The file of a chart over what is swept.
fn over(name: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    format!("over-{}.svg", name.chars().map(plain).collect::<String>())
}

/// Something of each setting over its value in a dimension, one line for each combination of the
/// others.
fn lines_over(study: &Study, dimension: usize, of: impl Fn(usize) -> Option<f64>) -> Vec<Line> {
    let plan = &study.plan;
    let mut lines: Vec<(Vec<usize>, Line)> = Vec::new();
    for (i, setting) in plan.settings.iter().enumerate() {
        let number = plan.dimensions[dimension].choices[setting.choices[dimension]].number;
        let (Some(x), Some(y)) = (number, of(i)) else {
            continue;
        };
        let mut key = setting.choices.clone();
        key.remove(dimension);
        match lines.iter_mut().find(|(other, _)| *other == key) {
            Some((_, line)) => line.points.push((x, y)),
            None => {
                let others = plan.dimensions.iter().enumerate();
                let others = others.filter(|(i, d)| *i != dimension && d.choices.len() > 1);
                let labels: Vec<&str> = others.map(|(i, _)| plan.label(setting, i)).collect();
                lines.push((
                    key,
                    Line::line(or_the_scene(labels.join(", ")), vec![(x, y)]),
                ));
            }
        }
    }
    lines.sort_by(|a, b| a.0.cmp(&b.0));
    for (_, line) in &mut lines {
        line.points.sort_by(|a, b| a.0.total_cmp(&b.0));
    }
    lines.into_iter().map(|(_, line)| line).collect()
}

/// Logarithmic where values differ by more than a factor of 20 and are positive.
fn axis(title: String, values: impl Iterator<Item = f64> + Clone) -> Axis {
    let low = values.clone().fold(f64::INFINITY, f64::min);
    let high = values.fold(f64::NEG_INFINITY, f64::max);
    match low > 0.0 && high > 20.0 * low {
        true => Axis::logarithmic(title),
        false => Axis::linear(title),
    }
}

fn capital(text: &str) -> String {
    let mut chars = text.chars();
    let first = chars.next().map(|c| c.to_uppercase().to_string());
    first.unwrap_or_default() + chars.as_str()
}
