//! Cutoff and load: Newton's method at the landing point against ours.

use std::collections::BTreeSet;

use kluft_chart::{Axis, Chart, Series};
use kluft_solver::{NewtonSettings, Problem, StepRecord};
use lie_core::ClosureKind;

use super::counts::{count, entry, height, hold_promise, most};
use crate::methods::plain_newton;
use crate::report::{Effort, Finding, Study, Table};
use crate::scenes;
use crate::scenes::closing::{column, inclined_joint, three_planes};

/// The study.
pub const STUDY: Study = Study {
    name: "cutoff",
    title: "Cutoff and load",
    subject: "cutoff from 1e-2 to 1e-12 b0, and none; load from 0.5 to 200 K_n0 b0 in one step",
    run,
};

/// Loads over `K_n0 b0`.
fn loads(effort: Effort) -> &'static [f64] {
    match effort {
        Effort::Quick => &[0.5, 10.0, 200.0],
        Effort::Full => &[0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0],
    }
}

/// Cutoffs over `b0`; 0 is none.
fn cutoffs(effort: Effort) -> Vec<f64> {
    let exponents: Vec<i32> = match effort {
        Effort::Quick => vec![-2, -12],
        Effort::Full => (-12..=-2).rev().collect(),
    };
    let cutoffs = exponents
        .into_iter()
        .map(|exponent| 10.0_f64.powi(exponent));
    cutoffs.chain([0.0]).collect()
}

/// A problem for a law and a load.
type Scene<'a> = &'a dyn Fn(ClosureKind, f64) -> Problem;

struct Case {
    scene: &'static str,
    cutoff: f64,
    load: f64,
    ours: StepRecord,
    plain: StepRecord,
}

fn cases(effort: Effort) -> Vec<Case> {
    let draft = scenes::geometry("inclined-joint", &[("h", 0.4)]);
    let inclined = |kind, load| inclined_joint(&draft, kind, load);
    let scenes: [(&str, Scene<'_>); 3] = [
        ("column", &column),
        ("inclined joint", &inclined),
        ("three planes", &three_planes),
    ];
    let settings = NewtonSettings::default();
    let mut cases = Vec::new();
    for (scene, problem) in scenes {
        for cutoff in cutoffs(effort) {
            for &load in loads(effort) {
                let kind = ClosureKind::Logarithmic {
                    cutoff: (cutoff > 0.0).then_some(cutoff * 1e-4),
                };
                let problem = problem(kind, load);
                cases.push(Case {
                    scene,
                    cutoff,
                    load,
                    ours: scenes::try_solve(&problem, settings).0,
                    plain: plain_newton::solve(&problem, settings).0,
                });
            }
        }
    }
    cases
}

/// Most iterations of the cases that `of` maps to the same number.
fn curve<'a>(
    cases: impl Iterator<Item = &'a Case> + Clone,
    of: fn(&Case) -> f64,
    record: fn(&Case) -> &StepRecord,
) -> Vec<(f64, f64)> {
    let places: BTreeSet<u64> = cases.clone().map(|case| of(case).to_bits()).collect();
    let worst = |at: f64| {
        let here = cases.clone().filter(|case| of(case) == at);
        most(here.map(|case| count(record(case))))
    };
    let places = places.into_iter().map(f64::from_bits);
    places.map(|at| (at, height(worst(at)))).collect()
}

fn chart(title: &str, x: Axis, series: Vec<Series>) -> Chart {
    Chart {
        series,
        failure: "no convergence in 50 iterations, or no number".into(),
        ..Chart::new(title, x, Axis::linear("Newton iterations, the worst scene"))
    }
}

fn over_cutoffs(cases: &[Case]) -> Chart {
    let curve = |record| curve(cases.iter(), |case| case.cutoff, record);
    let series = vec![
        Series::line("plain Newton", curve(|case| &case.plain)),
        Series::line("Kluft", curve(|case| &case.ours)),
    ];
    let axis = Axis::logarithmic("cutoff aperture / b0 (leftmost: none)").from(1e-14);
    chart("One load step, the worst of all loads", axis, series)
}

fn over_loads(cases: &[Case]) -> Chart {
    let plain = |cutoff: f64, name: &str| {
        let own = cases.iter().filter(move |case| case.cutoff == cutoff);
        Series::line(name, curve(own, |case| case.load, |case| &case.plain))
    };
    let series = vec![
        plain(1e-2, "plain, cutoff 1e-2 b0"),
        plain(1e-12, "plain, cutoff 1e-12 b0"),
        plain(0.0, "plain, no cutoff"),
        Series::line(
            "Kluft, all cutoffs",
            curve(cases.iter(), |case| case.load, |case| &case.ours),
        ),
    ];
    let axis = Axis::logarithmic("closing load / (K_n0 b0)");
    chart("One load step over the load", axis, series)
}

fn written(cutoff: f64) -> String {
    if cutoff > 0.0 {
        format!("{cutoff:e}")
    } else {
        "none".to_owned()
    }
}

fn table(cases: &[Case]) -> Table {
    let mut table = Table::new(&[
        "scene",
        "cutoff / b0",
        "load / (K_n0 b0)",
        "Kluft",
        "plain Newton",
    ]);
    for case in cases {
        table.push([
            case.scene.to_owned(),
            written(case.cutoff),
            case.load.to_string(),
            entry(count(&case.ours)),
            entry(count(&case.plain)),
        ]);
    }
    table
}

fn run(effort: Effort) -> Finding {
    let cases = cases(effort);
    let mut misses = Vec::new();
    for case in &cases {
        let name = format!(
            "{}, cutoff {}, load {}",
            case.scene,
            written(case.cutoff),
            case.load
        );
        hold_promise(&mut misses, &name, &case.ours);
        let last = case.ours.iterations.last();
        let aperture = last.map_or(f64::NAN, |last| last.smallest_aperture);
        if case.cutoff == 0.0 && (aperture.is_nan() || aperture <= 0.0) {
            misses.push(format!("{name}: aperture {aperture:e} m"));
        }
    }
    let failed = cases.iter().filter(|case| !case.plain.converged()).count();
    let plain = cases.iter().filter_map(|case| count(&case.plain)).max();
    let ours = entry(most(cases.iter().map(|case| count(&case.ours))));
    let all = cases.len();
    Finding::new([
        format!(
            "plain Newton: no solution in {failed} of {all} cases, up to {} iterations in the others",
            plain.unwrap_or(0)
        ),
        format!("at most {ours} iterations, whatever the cutoff"),
    ])
    .text(format!(
        "Plain Newton linearises the law where the last step landed. A closing load of more than \
         `K_n0 b0` lands at a negative aperture, where the exact law has no value, and with a \
         cutoff the tangent is that of the cutoff, so that the way back is long: {failed} of {all} \
         cases fail, and the others take up to {} iterations. Kluft linearises where the law \
         balances the rock beside the facet point, which is never beyond closure: at most {ours} \
         iterations for three scenes (a column, an inclined joint, three crossing planes), with \
         every cutoff and with none.",
        plain.unwrap_or(0)
    ))
    .charts(vec![
        ("cutoff", over_cutoffs(&cases)),
        ("load", over_loads(&cases)),
    ])
    .numbers(table(&cases))
    .missing(misses)
}
