//! What reaches a tolerance at the least cost, as a scene fragment; or what came nearest.

use std::fmt::Write;

use super::assess::{Assessment, MeasuredSeries};
use super::charts::subject;
use super::dimension::SweepKind;
use super::edits::difference;
use super::point::PointRecord;
use super::reference::slope;
use super::under_way::Study;
use super::words::{duration, percent, short};

/// The cheapest setting, by measured time, whose error is surely not above a tolerance.
pub(super) fn cheapest(study: &Study, found: &Assessment, tolerance: f64) -> Option<usize> {
    let reaches = |&i: &usize| {
        found.verdicts[i]
            .at_most()
            .is_some_and(|most| most <= tolerance)
    };
    let all = (0..study.records.len()).filter(reaches);
    all.min_by(|&a, &b| study.seconds(a).total_cmp(&study.seconds(b)))
}

/// Keys to write into the scene for a setting, and everything else as comments.
pub(super) fn fragment(study: &Study, found: &Assessment, best: usize, tolerance: f64) -> String {
    let plan = &study.plan;
    let (keys, removed) = difference(&plan.scene, &plan.scene_of(&plan.settings[best]));
    let mut text = format!(
        "# {} of {} at the least cost measured: {}\n",
        percent(tolerance),
        subject(found),
        line(study, found, best)
    );
    let _ = match keys.is_empty() && removed.is_empty() {
        true => writeln!(text, "# This is the scene as it stands."),
        false => writeln!(
            text,
            "# Write these keys into the scene, in the place of its own:\n\n{keys}"
        ),
    };
    for key in removed {
        let _ = writeln!(text, "# and remove {key}");
    }
    let _ = writeln!(
        text,
        "# As a whole scene: {}",
        study.scene_file(best).display()
    );
    text + &others(study, found, best)
}

/// One setting: name, error, time.
fn line(study: &Study, found: &Assessment, index: usize) -> String {
    let verdict = found.verdicts[index];
    let error = match (verdict.error, verdict.uncertainty) {
        (None, _) => "no error known".to_owned(),
        (Some(error), 0.0) => format!("error {}", percent(error)),
        (Some(error), unsure) => format!("error {} ± {}", percent(error), percent(unsure)),
    };
    let seconds = duration(study.seconds(index));
    format!("{}, {error}, {seconds}", study.name(index))
}

fn others(study: &Study, found: &Assessment, but: usize) -> String {
    let mut text = String::new();
    for (i, record) in study.records.iter().enumerate().filter(|(i, _)| *i != but) {
        let _ = match record {
            Some(record) if record.numbers().is_some() => {
                writeln!(text, "#   {}", line(study, found, i))
            }
            Some(_) => writeln!(text, "#   {}, failed", study.name(i)),
            None => writeln!(text, "#   {}, not run", study.name(i)),
        };
    }
    match text.is_empty() {
        true => text,
        false => format!("# The others:\n{text}"),
    }
}

/// Why no setting reaches a tolerance, which came nearest, and what to try.
pub(super) fn closest_setting(study: &Study, found: &Assessment, tolerance: f64) -> String {
    let error = |i: &usize| found.verdicts[*i].at_most();
    let best = (0..study.records.len()).filter_map(|i| Some((i, error(&i)?)));
    let best = best.min_by(|a, b| a.1.total_cmp(&b.1));
    let Some((best, most)) = best else {
        return format!(
            "{} of {}: {}",
            percent(tolerance),
            subject(found),
            no_errors(study, found)
        );
    };
    let mut text = format!(
        "no setting is within {} of {}; the best: {}",
        percent(tolerance),
        subject(found),
        line(study, found, best)
    );
    let verdict = found.verdicts[best];
    if verdict.error.is_some_and(|error| error <= tolerance) && most > tolerance {
        text += "\nits error may be small enough, but the reference is not certain enough to tell: add a finer mesh";
    }
    match next(study, found, tolerance) {
        Some(next) => text + "\nnext: " + &next,
        None => {
            text + "\nnext: add finer meshes to [study] meshes, smaller [study] tolerances or more [study] refinements"
        }
    }
}

/// What is charted in the place of what is asked for and no run has.
pub(super) fn instead(found: &Assessment) -> Option<String> {
    let problem = &found.missing.as_ref()?.problem;
    Some(format!("{problem}; charted instead: {}", subject(found)))
}

/// Why there are no errors.
pub(super) fn no_errors(study: &Study, found: &Assessment) -> String {
    if has_no_result(&study.records) {
        return "no setting was solved, see study.html for the reasons".into();
    }
    if found.target.is_none() {
        return "the runs have no measure".into();
    }
    if let Some(reference) = found.references.first() {
        return reference.in_words();
    }
    let meshes = study
        .plan
        .dimensions
        .iter()
        .find(|d| d.kind == SweepKind::Mesh);
    let count = meshes.map_or(0, |dimension| dimension.choices.len());
    format!(
        "the scene has no closed form for it, and without one errors need three meshes solved with the same \
         order, law, facet rule and solver (the study has {count}); add meshes to [study] meshes, \
         or tolerances or refinements, or an [oracle.NAME]"
    )
}

/// What meshes that are one and the same mean.
pub(super) fn identical_meshes(labels: &str) -> String {
    format!(
        "{labels} are one and the same mesh: sweep a parameter that sizes the cells of the geometry, \
         or tolerances that lie further apart"
    )
}

/// The cell size at which a series should reach the tolerance, by the rate observed over cell
/// sizes; of the series that needs the least time then, if time grows with the number of cells.
fn next(study: &Study, found: &Assessment, tolerance: f64) -> Option<String> {
    let plan = &study.plan;
    let mesh = plan
        .dimensions
        .iter()
        .position(|d| d.kind == SweepKind::Mesh)?;
    let choice = |i: usize| &plan.dimensions[mesh].choices[plan.settings[i].choices[mesh]];
    let guess = |series: &MeasuredSeries| -> Option<(f64, String)> {
        let known = series.settings.iter().copied();
        let known = known.filter_map(|i| Some((i, found.verdicts[i].error?)));
        let known: Vec<(usize, f64)> = known.collect();
        let sizes = known
            .iter()
            .filter_map(|&(i, error)| Some((choice(i).number?, error)));
        let rate = slope(&sizes.collect::<Vec<_>>()).filter(|rate| *rate > 0.1)?;
        let &(last, error) = known.last()?;
        let wanted = (tolerance - found.verdicts[last].uncertainty).max(0.5 * tolerance);
        let finer = (error / wanted).powf(rate.recip());
        let seconds = study.seconds(last) * finer.powi(3);
        let text = format!(
            "{}: cells smaller by a factor of {} than {} should do, in roughly {}",
            series.name,
            short(finer),
            choice(last).label,
            duration(seconds)
        );
        (finer > 1.0 && seconds.is_finite()).then_some((seconds, text))
    };
    let guesses = found.series.iter().filter_map(guess);
    guesses
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, text)| text)
}

/// Whether anything came out of a study.
pub(super) fn has_no_result(records: &[Option<PointRecord>]) -> bool {
    !records
        .iter()
        .flatten()
        .any(|record| record.numbers().is_some())
}
