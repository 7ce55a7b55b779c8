//! Sources inside a network: boreholes through many fractures, whole fractures that are fed.

use std::fs;

use crate::network_flow::{Made, PARALLEL, flat, number};

/// What stands in `sources.csv`: source, pressure, rate.
fn sources(made: &Made) -> Vec<(String, f64, f64)> {
    let text = fs::read_to_string(made.out().join("sources.csv")).expect("sources.csv");
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        let [pressure, rate] = [3, 4].map(|place| cells[place].parse().expect("a number"));
        (cells[2].to_owned(), pressure, rate)
    };
    text.lines().skip(1).map(row).collect()
}

/// A borehole through three joints feeds each by its transmissivity, and drains nothing of a fluid
/// at rest.
#[test]
fn boreholes_feed_every_fracture_they_cross() {
    let sets = "[fracture_set.wide]\nhydraulic_aperture = 2e-4\n";
    let drained = "[boundary.left]\nfluid_pressure = 0.0\n[boundary.right]\nfluid_pressure = 0.0\n";
    let joints =
        flat("low", "flat", 0.5) + &flat("middle", "wide", 1.0) + &flat("high", "flat", 1.5);
    let hole = "[[source]]\nname = \"injector\"\nfrom = [2.01, 1.02, 3]\nto = [2.01, 1.02, -1]\nradius = 0.01\n";
    let text = |more: &str| PARALLEL.to_owned() + sets + drained + hole + more + &joints;
    let made = Made::new(&text("rate = 1e-5\n"));
    let said = made.solve();
    let told = said["decisions"].to_string();
    assert!(
        told.contains("injector crosses high, middle, low"),
        "{told}"
    );
    let rows = sources(&made);
    let through = |name: &str| {
        let name = format!("injector through {name}");
        rows.iter()
            .find(|row| row.0 == name)
            .expect("a row")
            .clone()
    };
    for (name, share) in [("high", 0.1), ("middle", 0.8), ("low", 0.1)] {
        assert!(
            (through(name).2 / (share * 1e-5) - 1.0).abs() < 1e-12,
            "{rows:?}"
        );
    }
    // Alike in all, but for where gmsh puts their nodes: rate over transmissivity.
    assert!(
        (through("high").1 / through("middle").1 - 1.0).abs() < 0.05,
        "{rows:?}"
    );
    let flow = &said["steps"][0]["flow"];
    assert!(
        (number(&flow["inflow"]) / 1e-5 - 1.0).abs() < 1e-10 && number(&flow["mass_error"]) < 1e-10
    );

    // 2 m of water above the bottom everywhere, 1 m below the head of the borehole.
    let still = text("pressure = -9810.0\n")
        .replace("viscosity = 1e-3", "viscosity = 1e-3\ndensity = 1000")
        .replace(
            "fluid_pressure = 0.0",
            "fluid_pressure = { value = 0.0, per_metre = -9810, at = 2.0 }",
        )
        + "[body]\ngravity = [0, 0, -9.81]\n";
    let made = Made::new(&still);
    made.solve();
    for (name, _, rate) in sources(&made) {
        assert!(rate.abs() < 1e-18, "{name} {rate}");
    }
}

#[test]
fn sources_that_meet_nothing_are_refused_by_name() {
    let drained = "[boundary.left]\nfluid_pressure = 0.0\n";
    let refused = |source: &str| {
        let text =
            PARALLEL.to_owned() + drained + "[[source]]\n" + source + &flat("only", "flat", 1.0);
        let run = match Made::of(&text, &["--group", "fracture"]) {
            Ok(made) => made.run(),
            Err(run) => run,
        };
        assert_eq!(run.code, Some(2), "{}", run.err);
        run.err
    };
    for (source, said) in [
        (
            "from = [1, 1, 3]\nto = [1, 1, 1.5]\nrate = 1e-6\nradius = 0.01\n",
            "crosses no fracture that conducts",
        ),
        (
            "from = [1, 1, 3]\nto = [1, 1, 3]\nrate = 1e-6\nradius = 0.01\n",
            "has no length",
        ),
        ("from = [1, 1, 3]\nrate = 1e-6\nradius = 0.01\n", "`to`"),
        (
            "from = [1, 1, 3]\nto = [1, 1, 0]\nat = [1, 1, 1]\nrate = 1e-6\nradius = 0.01\n",
            "both at and from",
        ),
        (
            "fracture = \"onyl\"\nrate = 1e-6\n",
            "no fracture of the mesh",
        ),
        ("fracture = \"only\"\nrate = 1e-6\nradius = 0.1\n", "radius"),
    ] {
        let err = refused(source);
        assert!(err.contains(said), "{said}: {err}");
    }
}

/// A rate into a whole fracture leaves it where the pressure is given: `p = q (2 L x - x^2) / 2 T`
/// with the rate q by area; the mean of it over the length L is `q L^2 / 3 T`.
#[test]
fn a_fracture_may_be_fed_all_over() {
    let text = PARALLEL.replace("h = 0.5", "h = 0.25").to_owned()
        + "[boundary.left]\nfluid_pressure = 0.0\n[[source]]\nfracture = \"only\"\nrate = 1e-6\n"
        + &flat("only", "flat", 1.0);
    // One surface is the default, which has no name of its own in the scene but in the mesh.
    let made = Made::new(&text);
    let said = made.solve();
    let (conducts, length) = (1e-12 / 12e-3, 4.0);
    let expected = 1e-6 / 8.0 * length * length / (3.0 * conducts);
    let found = number(&said["flow"]["fractures"][0]["pressure"]["mean"]);
    assert!((found / expected - 1.0).abs() < 5e-3, "{found} {expected}");
}
