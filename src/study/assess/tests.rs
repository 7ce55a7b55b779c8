//! Verdicts, references and orders.

use std::path::Path;

use super::*;
use crate::study::point::PointOutcome;

const SCENE: &str = r#"
[mesh]
geometry = "a.geo"
parameters = { h = 0.4 }
[rock.default]
young_modulus = 50e9
poisson_ratio = 0.25
[fracture.default]
aperture = 1e-4
normal_stiffness = 1e11
shear_stiffness = 1e10
[study]
"#;

fn plan(study: &str) -> StudyPlan {
    StudyPlan::read(Path::new("scene.toml"), &format!("{SCENE}{study}")).expect("a plan")
}

fn measure(name: &str, fracture: &str, value: f64, error: Option<f64>) -> Measure {
    Measure {
        name: name.into(),
        fracture: Some(fracture.into()),
        value: Some(value),
        exact: error.map(|_| 1.0),
        error,
    }
}

fn solved(cells: usize, measures: Vec<Measure>) -> Option<PointRecord> {
    Some(PointRecord {
        fingerprint: String::new(),
        gmsh: None,
        outcome: PointOutcome::Solved(Box::new(Numbers {
            cells,
            unknowns: 3 * cells,
            largest_fracture: Some("b".into()),
            measures,
            ..Numbers::default()
        })),
    })
}

/// Runs whose mean aperture approaches `limit` as the third root of the cells, or faster for order
/// 2.
fn extrapolated(plan: &StudyPlan, limit: impl Fn(&str) -> f64) -> Vec<Option<PointRecord>> {
    let run = |setting: &Setting| {
        let size: f64 = plan.label(setting, 0)[2..].parse().expect("a size");
        let rate = if plan.label(setting, 1) == "order 2" {
            2.0
        } else {
            1.0
        };
        let value = limit(plan.label(setting, 2)) * (1.0 + 0.5 * size.powf(rate));
        let cells = (1e3 / size.powi(3)).round() as usize;
        let measures = ["a", "b"].map(|name| measure("mean_aperture", name, value, None));
        solved(cells, measures.to_vec())
    };
    plan.settings.iter().map(run).collect()
}

fn close(a: f64, b: f64) {
    assert!((a - b).abs() <= 1e-6 * b.abs(), "{a} is not {b}");
}

#[test]
fn the_first_measure_with_an_error_is_charted_or_what_is_asked_for() {
    let records = |plan: &StudyPlan| {
        let measures = vec![
            measure("energy", "a", 2.0, None),
            measure("opening_l2", "a", 3.0, Some(0.2)),
            measure("opening_l2", "b", 3.0, Some(0.1)),
            measure("mean_aperture", "b", 4.0, None),
        ];
        vec![solved(10, measures); plan.settings.len()]
    };
    for (study, name, fracture, compared) in [
        ("", "opening_l2", "a", true),
        ("fracture = 'b'", "opening_l2", "b", true),
        ("measure = 'energy'", "energy", "a", false),
        (
            "measure = 'opening_l2'\nfracture = 'b'",
            "opening_l2",
            "b",
            true,
        ),
    ] {
        let plan = plan(study);
        let found = assess(&plan, &records(&plan));
        let target = found.target.expect("a target");
        assert_eq!(
            (target.name.as_str(), target.fracture.as_deref()),
            (name, Some(fracture))
        );
        assert_eq!(target.is_compared, compared);
    }
    for (study, problem, near, served) in [
        (
            "measure = 'opening_l3'\nfracture = 'b'",
            "the runs have no measure `opening_l3` on `b`",
            "did you mean \"opening_l2\"? ",
            "b",
        ),
        ("fracture = 'c'", "the runs have no measure on `c`", "", "a"),
    ] {
        let wrong = plan(study);
        let found = assess(&wrong, &records(&wrong));
        let defect = found.missing.expect("no such measure");
        assert_eq!(defect.problem, problem);
        let known = format!("{near}measures of the runs: energy of a, ");
        assert!(defect.remedy.starts_with(&known), "{defect}");
        let line = SCENE.lines().count() + 1;
        assert_eq!(defect.place, format!("scene.toml:{line}"));
        let target = found.target.expect("another target");
        assert_eq!(target.name, "opening_l2");
        assert_eq!(target.fracture.as_deref(), Some(served));
    }
}

#[test]
fn without_closed_forms_the_mean_aperture_of_the_largest_fracture_is_extrapolated() {
    let plan = plan("meshes = [{ h = 0.4 }, { h = 0.2 }, { h = 0.1 }]\norders = [1, 2]");
    let found = assess(&plan, &extrapolated(&plan, |_| 3.0));
    let target = found.target.as_ref().expect("a target");
    assert_eq!(
        (target.name.as_str(), target.fracture.as_deref()),
        ("mean_aperture", Some("b"))
    );
    let [reference] = &found.references[..] else {
        panic!("one physics has one reference: {:?}", found.references);
    };
    close(reference.limit.value, 3.0);
    close(reference.limit.rate.expect("a rate"), 2.0);
    assert!(reference.from.contains("order 2"), "{}", reference.from);
    for (setting, verdict) in plan.settings.iter().zip(&found.verdicts) {
        let size: f64 = plan.label(setting, 0)[2..].parse().expect("a size");
        let rate = if plan.label(setting, 1) == "order 2" {
            2.0
        } else {
            1.0
        };
        close(verdict.error.expect("an error"), 0.5 * size.powf(rate));
        close(verdict.uncertainty, 0.005);
    }
    assert_eq!(found.uncertainties().count(), 6);
}

#[test]
fn each_law_has_its_own_reference_unless_one_serves_all() {
    let sweep = "meshes = [{ h = 0.4 }, { h = 0.2 }, { h = 0.1 }]\norders = [2, 1]\nclosures = ['linear', 'logarithmic']";
    let limit = |law: &str| if law == "linear" { 3.0 } else { 4.0 };
    let own = plan(sweep);
    let found = assess(&own, &extrapolated(&own, limit));
    assert_eq!(found.references.len(), 2);
    for (setting, verdict) in own.settings.iter().zip(&found.verdicts) {
        close(
            verdict.reference.expect("a reference"),
            limit(own.label(setting, 2)),
        );
    }
    let shared = plan(&format!("{sweep}\nreference = 'logarithmic'"));
    let found = assess(&shared, &extrapolated(&shared, limit));
    for verdict in &found.verdicts {
        close(verdict.reference.expect("a reference"), 4.0);
    }
}

#[test]
fn two_meshes_or_failures_leave_no_errors() {
    let sweep = plan("meshes = [{ h = 0.4 }, { h = 0.2 }, { h = 0.1 }]");
    let mut records = extrapolated(&sweep, |_| 3.0);
    records[1] = Some(PointRecord {
        fingerprint: String::new(),
        gmsh: None,
        outcome: PointOutcome::Failed("for want of memory".into()),
    });
    let found = assess(&sweep, &records);
    assert!(found.references.is_empty());
    assert!(found.verdicts.iter().all(|verdict| verdict.error.is_none()));
    assert_eq!(found.verdicts[1], Verdict::default());
    let nothing = assess(&sweep, &[None, None, None]);
    assert_eq!(nothing.target, None);
}

#[test]
fn lower_orders_wait_for_higher_ones_unless_these_fail() {
    let plan = plan("meshes = [{ h = 0.4 }, { h = 0.2 }, { h = 0.1 }]\norders = [1, 2]");
    let mut records = extrapolated(&plan, |_| 3.0);
    let finest = plan.settings.len() - 1;
    records[finest] = None;
    let found = assess(&plan, &records);
    assert!(found.references.is_empty(), "{:?}", found.references);
    records[finest] = Some(PointRecord {
        fingerprint: String::new(),
        gmsh: None,
        outcome: PointOutcome::Failed("for want of memory".into()),
    });
    let found = assess(&plan, &records);
    assert!(
        found.references[0].from.contains("order 1"),
        "{:?}",
        found.references
    );
}

#[test]
fn a_drift_has_a_reference_but_no_errors() {
    let plan = plan("meshes = [{ h = 0.4 }, { h = 0.2 }, { h = 0.1 }]");
    let run = |cells, value| solved(cells, vec![measure("mean_aperture", "b", value, None)]);
    let records = [run(10, 1.0), run(80, 1.1), run(640, 1.3)];
    let found = assess(&plan, &records);
    assert_eq!(found.references.len(), 1);
    assert!(found.verdicts.iter().all(|verdict| verdict.error.is_none()));
    assert!(
        found
            .verdicts
            .iter()
            .all(|verdict| verdict.at_most().is_none())
    );
}

#[test]
fn meshes_that_do_not_differ_are_named() {
    let plan = plan("meshes = [{ h = 0.4 }, { h = 0.2 }, { h = 0.1 }]");
    let run = |cells| solved(cells, vec![measure("mean_aperture", "b", 1.0, None)]);
    let found = assess(&plan, &[run(10), run(80), run(80)]);
    assert_eq!(found.identical_meshes.as_deref(), Some("h=0.2 and h=0.1"));
    assert!(found.references.is_empty(), "two meshes have no limit");
    let found = assess(&plan, &[run(10), run(80), None]);
    assert_eq!(found.identical_meshes, None);
}

#[test]
fn series_differ_in_anything_but_the_mesh() {
    let plan =
        plan("meshes = [{ h = 0.1 }, { h = 0.2 }]\norders = [1, 2]\nfacets = ['nodal', 'gauss']");
    let found = assess(&plan, &extrapolated(&plan, |_| 1.0));
    let names: Vec<&str> = found
        .series
        .iter()
        .map(|series| series.name.as_str())
        .collect();
    assert_eq!(
        names,
        [
            "order 1, nodal",
            "order 1, gauss",
            "order 2, nodal",
            "order 2, gauss"
        ]
    );
    for series in &found.series {
        let labels: Vec<&str> = series
            .settings
            .iter()
            .map(|&i| plan.label(&plan.settings[i], 0))
            .collect();
        assert_eq!(labels, ["h=0.2", "h=0.1"], "coarse to fine");
    }
}
