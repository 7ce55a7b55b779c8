//! `kluft study` of scenes with a fluid: what drives it, and what it is.

use std::fs;

use crate::harness::{Workshop, kluft};

/// The flow star with a section `[study]` and other edits.
fn studied(study: &str, edits: &[(&str, &str)]) -> (Workshop, crate::harness::Run) {
    let workshop = Workshop::new("flow-star", edits);
    let scene = fs::read_to_string(workshop.scene()).expect("the scene");
    fs::write(workshop.scene(), format!("{scene}\n[study]\n{study}\n")).expect("written");
    let scene = workshop.scene();
    let run = kluft(&["study".as_ref(), scene.as_os_str(), "-q".as_ref()]);
    (workshop, run)
}

/// A column of `study.csv`.
fn column(workshop: &Workshop, name: &str) -> Vec<f64> {
    let text = fs::read_to_string(workshop.path("study/study.csv")).expect("study.csv");
    let mut table = csv::Reader::from_reader(text.as_bytes());
    let heads = table.headers().expect("heads").clone();
    let place = heads.iter().position(|head| head == name);
    let place = place.unwrap_or_else(|| panic!("no column {name} in {heads:?}"));
    let rows = table
        .records()
        .map(|row| row.expect("a row")[place].to_owned());
    rows.map(|cell| cell.parse().expect("a number")).collect()
}

/// Rates are linear in the pressures, and fall with the viscosity.
#[test]
fn pressures_and_viscosities_are_swept() {
    let study = "meshes = [{ h = 0.5 }]\n\
        values = { \"boundary.left.fluid_pressure\" = [1e5, 3e5], \"fluid.viscosity\" = [1e-3, 2e-3] }";
    let (workshop, run) = studied(study, &[]);
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
    let mut rates = column(&workshop, "rate [boundary.left]");
    rates.sort_by(f64::total_cmp);
    // T (p - sum(T p) / sum(T)) of the head of the scene, for 1 and 3 bar.
    let rate = |pressure: f64| {
        let pairs = [(1.0, pressure), (8.0, 1e5), (0.125, 0.0), (3.375, 2e5)];
        let sum: f64 = pairs.iter().map(|(t, p)| t * p).sum();
        1e-12 / 12e-3 * (pressure - sum / 12.5)
    };
    let mut expected = [rate(1e5), rate(1e5) / 2.0, rate(3e5) / 2.0, rate(3e5)];
    expected.sort_by(f64::total_cmp);
    assert_eq!(rates.len(), 4);
    for (found, expected) in rates.iter().zip(expected) {
        assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
    }
}

#[test]
fn rates_of_sources_are_swept() {
    let source =
        "[[source]]\nname = \"slot\"\nfracture = \"west\"\nrate = 1e-6\n\n[boundary.right]";
    let edits = [
        ("[boundary.right]", source),
        ("[boundary.left]\nfluid_pressure = 3e5\n", ""),
    ];
    let sweep = |name: &str| {
        let study = format!("meshes = [{{ h = 0.5 }}]\nvalues = {{ \"{name}\" = [1e-6, 2e-6] }}");
        studied(&study, &edits)
    };
    for name in ["source.slot.rate", "source.rate"] {
        let (workshop, run) = sweep(name);
        assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
        let mut rates = column(&workshop, "rate slot");
        rates.sort_by(f64::total_cmp);
        assert_eq!(rates, [1e-6, 2e-6]);
    }
    for (name, said) in [
        ("source.slot.at", "`at` of a source is no number"),
        ("source.other.rate", "source.slot"),
        ("fluid.isolated", "`isolated` of a fluid is no number"),
    ] {
        let (_, run) = sweep(name);
        assert_eq!(run.code, Some(2), "{name}: {}", run.err);
        assert!(run.err.contains(said), "{said}: {}", run.err);
    }
}
