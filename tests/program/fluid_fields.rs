//! Hydraulic values and pressures of a fluid that vary in space, against closed forms and against
//! plain numbers.

use std::fs;
use std::path::Path;

use crate::fields::{assert_near, numbers, rows};
use crate::flow::sources;
use crate::harness::Workshop;
use crate::plane::probes;

/// In the west joint the transmissivity is `T0 (1 + x)`, so that `T0 / ln 2` conducts between its
/// ends; the other three have one each.
#[test]
fn a_hydraulic_aperture_that_varies_conducts_as_the_integral_has_it() {
    let field = |b: &str| format!("{b} = {{ expression = \"1e-4 * (1 + x)^(1/3)\" }}");
    let own = "[fracture.west]\nhydraulic_aperture = 1e-4";
    for key in ["hydraulic_aperture", "aperture"] {
        let varying = format!("[fracture.west]\n{}", field(key));
        let edits = [
            (own, &varying[..]),
            (
                "parameters = { h = 0.2 }",
                "parameters = { h = 0.05 }\ndimension = 2",
            ),
        ];
        let workshop = Workshop::new("flow-star", &edits);
        let rows = sources(&workshop.solve("out", &[]));
        let pairs = [
            (1.0 / 2_f64.ln(), 3e5),
            (8.0, 1e5),
            (0.125, 0.0),
            (3.375, 2e5),
        ];
        let conducted: f64 = pairs.iter().map(|(t, p)| t * p).sum();
        let line = conducted / pairs.iter().map(|(t, _)| t).sum::<f64>();
        let rate = 1e-12 / 12e-3 / 2_f64.ln() * (3e5 - line);
        let left = rows.iter().find(|row| row.0 == "[boundary.left]");
        assert_near(left.expect("a row").2, rate, 2e-4);
    }
}

/// What is the same everywhere is what a number says, to the last bit, also where the flow follows
/// the walls.
#[test]
fn hydraulic_values_that_do_not_vary_are_numbers() {
    let solve = |keys: &str| {
        let more = format!("closure = \"linear\"\n{keys}");
        let edits = [
            ("closure = \"linear\"", &more[..]),
            (
                "times = [10, 20, 30, 40, 50, 60, 70, 80, 90, 100]",
                "times = [10, 20]",
            ),
        ];
        let workshop = Workshop::new("filling-joint", &edits);
        let out = workshop.solve("out", &[]);
        fs::read(out.join("history.csv")).expect("a history")
    };
    let plain = solve("roughness = 1.5\nresidual_hydraulic_aperture = 2e-6");
    let varying = solve(
        "roughness = { expression = \"1.5\" }\n\
         residual_hydraulic_aperture = { table = [[0, 2], [1, 2]], over = \"x\", unit = \"um\", \
         beyond = \"nearest\" }",
    );
    assert_eq!(plain, varying);
    assert_ne!(plain, solve("roughness = { expression = \"1.5 + x\" }"));
}

/// The pressure of each end of the flow star, in the order left, right, front, back.
fn star_of(ends: [&str; 4], edits: &[(&str, &str)]) -> Workshop {
    let given = ["3e5", "1e5", "0.0", "2e5"].map(|value| format!("fluid_pressure = {value}"));
    let wanted = ends.map(|value| format!("fluid_pressure = {value}"));
    let pairs = given.iter().zip(&wanted);
    let pairs = pairs.map(|(given, wanted)| (&given[..], &wanted[..]));
    let edits: Vec<(&str, &str)> = pairs.chain(edits.iter().copied()).collect();
    Workshop::new("flow-star", &edits)
}

/// A hat over the height of the end: linear between nodes, so that the rates are those of its
/// mean, to round-off.
#[test]
fn a_pressure_that_varies_along_a_boundary_drives_what_its_mean_drives() {
    let hat = "{ table = [[0, 2], [0.5, 4], [1, 2]], over = \"z\", unit = \"bar\" }";
    let ends = [hat, "1e5", "0.0", "2e5"];
    let workshop = star_of(ends, &[("h = 0.2", "h = 0.25")]);
    let rows = sources(&workshop.solve("out", &[]));
    for (side, _, rate) in crate::flow::star() {
        let name = format!("[boundary.{side}]");
        let row = rows.iter().find(|row| row.0 == name);
        assert_near(row.expect("a row").2, rate, 1e-11);
    }
}

/// Harmonic pressures in half planes of width and height 1 m whose far end has `P cos(pi z)`: where
/// they meet it is `T P cos(pi z) / (sum T cosh(pi))`. Triangles are off by the second order of
/// their size.
#[test]
fn a_pressure_that_varies_along_a_boundary_fades_as_its_closed_form() {
    let wave = "{ expression = \"1e5 * (1 + cos(PI*z))\" }";
    let edits = [
        (
            "parameters = { h = 0.2 }",
            "parameters = { h = 0.05 }\ndimension = 2",
        ),
        (
            "[fracture.west]\nhydraulic_aperture = 1e-4",
            "[fracture.west]\nhydraulic_aperture = 2e-4",
        ),
    ];
    let workshop = star_of([wave, "1e5", "1e5", "1e5"], &edits);
    let out = workshop.solve("out", &[]);
    let rows = rows(&out);
    let largest = numbers(&rows, ["fracture", "east"], "pressure_max")[0];
    let fades = 8.0 / ((8.0 + 8.0 + 0.125 + 3.375) * std::f64::consts::PI.cosh());
    assert_near((largest - 1e5) / 1e5, fades, 1e-2);
    let rate = sources(&out).into_iter().map(|row| row.2);
    // What 1 bar drives through the west joint is 6.7e-5 m3/s.
    assert!(rate.map(f64::abs).fold(0.0, f64::max) < 1e-15);
}

/// A pressure that falls from the left end of the west joint to that of the line, by its place.
const LINEAR: &str = "{ expression = \"3e5 - 2e5*x\" }";

/// The flow star with a pressure given all over the west joint, in the place of that at its end.
fn given_in_west(pressure: &str, edits: &[(&str, &str)]) -> Workshop {
    let own = "hydraulic_aperture = 1e-4";
    let given = format!("{own}\nfluid_pressure = {pressure}");
    let west = [
        (own, &given[..]),
        ("[boundary.left]\nfluid_pressure = 3e5\n", ""),
    ];
    let edits: Vec<(&str, &str)> = west.iter().chain(edits).copied().collect();
    Workshop::new("flow-star", &edits)
}

/// In a joint whose pressure is given all over, linear to the value at the line, what enters is
/// what the others take from there.
#[test]
fn a_pressure_given_all_over_a_fracture_may_vary_in_it() {
    let workshop = given_in_west(LINEAR, &[]);
    let out = workshop.solve("out", &[]);
    let found = sources(&out);
    let rate = |name: &str| found.iter().find(|row| row.0 == name).expect("a row").2;
    let line = 1e5;
    let others = [
        ("right", 2e-4_f64, 1e5),
        ("front", 0.5e-4, 0.0),
        ("back", 1.5e-4, 2e5),
    ];
    let mut taken = 0.0;
    for (side, aperture, end) in others {
        let expected = aperture.powi(3) / 12e-3 * (end - line);
        let error = rate(&format!("[boundary.{side}]")) - expected;
        assert!(error.abs() < 1e-15, "{side}: {error:e}");
        taken -= expected;
    }
    assert_near(rate("[fracture.west]"), taken, 1e-11);
    let rows = rows(&out);
    let west = |column: &str| numbers(&rows, ["fracture", "west"], column)[0];
    assert_near(west("pressure_max"), 3e5, 1e-12);
    assert_near(west("pressure_mean"), 2e5, 1e-12);
}

#[test]
fn a_pressure_that_a_table_does_not_reach_is_refused_with_its_place() {
    let short = "{ table = [[0, 2e5], [0.7, 4e5]], over = \"z\" }";
    let run = star_of([short, "1e5", "0.0", "2e5"], &[]).run("out", &[]);
    assert_eq!(run.code, Some(2));
    for said in [
        "[boundary.left.fluid_pressure]",
        "from a table over z from 0 to 0.7: there is no row at (0.000000, 1.000000, ",
        "add rows that reach there",
    ] {
        assert!(run.err.contains(said), "{said}: {}", run.err);
    }
    let both = "{ expression = \"1e5*time*z\" }";
    let run = star_of([both, "1e5", "0.0", "2e5"], &[TIMED]).run("out", &[]);
    assert_eq!(run.code, Some(2));
    let said = "`fluid_pressure` drives a fluid and changes with time and from place to place";
    assert!(run.err.contains(said), "{}", run.err);
    let early = "{ table = [[1, 1e5], [3, 2e5]], over = \"time\" }";
    let run = star_of([early, "1e5", "0.0", "2e5"], &[TIMED]).run("out", &[]);
    assert_eq!(run.code, Some(2));
    assert!(run.err.contains("there is no row"), "{}", run.err);
}

/// Load steps of the flow star that have times, 1 to 3 s.
const TIMED: (&str, &str) = (
    "[fracture.west]",
    "[load]\ntimes = [1.0, 2.0, 3.0]\n\n[fracture.west]",
);

/// The rates of a source at the ends of the load steps.
fn rates_of(out: &Path, name: &str) -> Vec<f64> {
    let rows = sources(out);
    let own = rows.iter().filter(|row| row.0 == name);
    own.map(|row| row.2).collect()
}

/// Steady at the end of each load step: what flows in there is what the pressure of then drives,
/// `T_w (p_w - p)` where `p = sum(T p)/sum(T)` is that of the line.
#[test]
fn pressures_on_boundaries_and_in_fractures_change_with_time() {
    let of_time = |time: f64| 1e5 * (1.0 + 2.0 * time * time);
    let wave = "{ expression = \"1e5 * (1 + 2*time^2)\" }";
    let t = [1.0_f64, 2.0, 0.5, 1.5].map(|b| (1e-4 * b).powi(3) / 12e-3);
    let whole: f64 = t.iter().sum();
    let driven = |left: f64| {
        let line = (t[0] * left + t[1] * 1e5 + t[3] * 2e5) / whole;
        t[0] * (left - line)
    };
    let ends = [
        wave,
        "1e5\nhistory = [[0, 1]]",
        "0.0",
        "2e5\nhistory = [[0, 1]]",
    ];
    let workshop = star_of(ends, &[TIMED]);
    let out = workshop.solve("out", &[]);
    let found = rates_of(&out, "[boundary.left]");
    assert_eq!(found.len(), 3);
    for (found, time) in found.into_iter().zip([1.0, 2.0, 3.0]) {
        assert_near(found, driven(of_time(time)), 1e-11);
    }
    let held = [
        TIMED,
        (
            "fluid_pressure = 1e5",
            "fluid_pressure = 1e5\nhistory = [[0, 1]]",
        ),
        (
            "fluid_pressure = 2e5",
            "fluid_pressure = 2e5\nhistory = [[0, 1]]",
        ),
    ];
    let workshop = given_in_west(wave, &held);
    let out = workshop.solve("out", &[]);
    let found = rates_of(&out, "[fracture.west]");
    for (found, time) in found.into_iter().zip([1.0, 2.0, 3.0]) {
        let line = of_time(time);
        let taken = t[1] * (line - 1e5) + t[2] * line + t[3] * (line - 2e5);
        assert_near(found, taken, 1e-11);
    }
}

/// What enters at a boundary follows the time, times its history, and nothing else that acts there
/// does.
#[test]
fn an_inflow_is_what_the_time_makes_of_it() {
    let inflow = "fluid_inflow = { expression = \"1e-5 * sin(PI*time/4)\" }\nhistory = [[0, 0.5]]";
    let edits = [TIMED, ("fluid_pressure = 3e5", inflow)];
    let workshop = Workshop::new("flow-star", &edits);
    let out = workshop.solve("out", &[]);
    let found = rates_of(&out, "[boundary.left]");
    assert_eq!(found.len(), 3);
    for (found, time) in found.into_iter().zip([1.0_f64, 2.0, 3.0]) {
        let wanted = 0.5e-5 * (std::f64::consts::PI * time / 4.0).sin();
        assert_near(found, wanted, 1e-11);
    }
    let plain = Workshop::new(
        "flow-star",
        &[("fluid_pressure = 3e5", "fluid_inflow = 1e-5")],
    );
    let constant = "fluid_inflow = { expression = \"1e-5\" }";
    let same = Workshop::new("flow-star", &[("fluid_pressure = 3e5", constant)]);
    let [plain, same] = [plain, same].map(|one| sources(&one.solve("out", &[])));
    assert_eq!(plain, same);
    let placed = "fluid_inflow = { expression = \"1e-5 * z\" }";
    let run = Workshop::new("flow-star", &[("fluid_pressure = 3e5", placed)]).run("out", &[]);
    assert_eq!(run.code, Some(2), "{}", run.err);
    assert!(run.err.contains("varies with time alone"), "{}", run.err);
}

/// The scene of the star with a source in the place of the pressure at its left end.
fn fed(source: &str, timed: &[(&str, &str)]) -> Workshop {
    let source = format!("[[source]]\nname = \"pump\"\n{source}\n");
    let own = [("[boundary.left]\nfluid_pressure = 3e5\n", &source[..])];
    let edits: Vec<(&str, &str)> = own.iter().chain(timed).copied().collect();
    Workshop::new("flow-star", &edits)
}

/// A source of pressure holds what a fracture's own pressure does; a borehole has what its place
/// says, and no weight on top.
#[test]
fn a_source_holds_pressures_that_vary() {
    let field = LINEAR;
    let of_source = fed(&format!("fracture = \"west\"\npressure = {field}"), &[]);
    let of_fracture = given_in_west(field, &[]);
    let found = rates_of(&of_source.solve("out", &[]), "pump");
    let wanted = rates_of(&of_fracture.solve("out", &[]), "[fracture.west]");
    assert_eq!(found, wanted);
    assert!(found[0] != 0.0);

    let in_time = "{ table = [[0, 0], [10, 2]], over = \"time\", unit = \"MPa\" }";
    let held = fed(
        &format!("fracture = \"west\"\npressure = {in_time}"),
        &[TIMED],
    );
    let out = held.solve("out", &[]);
    let rows = sources(&out);
    let pressures = rows.iter().filter(|row| row.0 == "pump").map(|row| row.1);
    for (found, time) in pressures.zip([1.0, 2.0, 3.0]) {
        assert_near(found, 2e5 * time, 1e-12);
    }

    let borehole = "from = [0.5, 0.9, 0.5]\nto = [0.5, 1.1, 0.5]\nradius = 0.01";
    let drilled = fed(&format!("{borehole}\npressure = {field}"), &[]);
    let rows = sources(&drilled.solve("out", &[]));
    let row = rows.iter().find(|row| row.0.starts_with("pump"));
    let pressure = row.expect("a row").1;
    assert!((1.8e5..2.2e5).contains(&pressure), "{pressure}");
    let heavy = (
        "viscosity = 1e-3",
        "viscosity = 1e-3\ndensity = 1000\n\n[body]\ngravity = [0, 0, -9.81]",
    );
    let timed = fed(
        &format!("{borehole}\npressure = {in_time}"),
        &[TIMED, heavy],
    );
    let run = timed.run("out", &[]);
    assert_eq!(run.code, Some(2), "{}", run.err);
    assert!(
        run.err.contains("the weight of the fluid in it"),
        "{}",
        run.err
    );
    let short = "{ table = [[0, 1], [0.2, 2]], over = \"x\" }";
    let run = fed(&format!("fracture = \"west\"\npressure = {short}"), &[]).run("out", &[]);
    assert_eq!(run.code, Some(2), "{}", run.err);
    assert!(run.err.contains("there is no row at"), "{}", run.err);
}

/// What is the same everywhere is what a number says, to the last bit, also under a history and
/// where the flow follows the walls.
#[test]
fn pressures_that_do_not_vary_are_numbers() {
    let solve = |pressure: &str| {
        let edits = [
            ("fluid_pressure = 0.9e6", pressure),
            (
                "times = [10, 20, 30, 40, 50, 60, 70, 80, 90, 100]",
                "times = [10, 20]",
            ),
        ];
        let workshop = Workshop::new("filling-joint", &edits);
        let out = workshop.solve("out", &[]);
        fs::read(out.join("history.csv")).expect("a history")
    };
    let plain = solve("fluid_pressure = 0.9e6");
    let varying = solve("fluid_pressure = { expression = \"0.9e6 + 0*x\" }");
    assert_eq!(plain, varying);
    assert_ne!(
        plain,
        solve("fluid_pressure = { expression = \"0.9e6 + 1e5*y\" }")
    );
}

/// In a fluid too thick to flow each place loses what leaks off there, `p = p_0 - 4 C sqrt(t) / (b
/// c)`, to the share `c p` by which the fluid gives way; the whole joint loses the integral.
#[test]
fn leak_off_that_varies_empties_each_place_by_its_own() {
    let held = ["1e6\nhistory = [[0, 1]]"; 4];
    let edits = [
        (
            "viscosity = 1e-3",
            "viscosity = 1e12\ncompressibility = 4e-10\ninitial_pressure = 1e6\n\n\
             [load]\ntimes = [1.0, 4.0]\n\n[warnings]\nsilence = [\"values\", \"fluid_times\"]\n\n\
             [probe.west]\nfracture = \"west\"\nfrom = [0.3, 1, 0.5]\nto = [0.7, 1, 0.5]\ncount = 3",
        ),
        (
            "[fracture.west]\nhydraulic_aperture = 1e-4",
            "[fracture.west]\naperture = 1e-4\nleakoff = { expression = \"1e-9 * (1 + x)\" }",
        ),
    ];
    let workshop = star_of(held, &edits);
    let out = workshop.solve("out", &[]);
    let rows = probes(&out);
    assert_eq!(rows.len(), 6);
    for row in rows {
        let number = |column: &str| row[column].parse::<f64>().expect(column);
        let lost = 4e-9 * (1.0 + number("x")) * number("time").sqrt() / (1e-4 * 4e-10);
        assert_near(1e6 - number("pressure"), lost, 5e-4);
    }
    let text = fs::read_to_string(out.join("sources.csv")).expect("sources.csv");
    let last = text
        .lines()
        .rfind(|line| line.contains("leak-off from west"));
    let lost = last.and_then(|line| line.split(',').next_back());
    let lost: f64 = lost.and_then(|cell| cell.parse().ok()).expect("a number");
    assert_near(lost, -4e-9 * 1.5 * 2.0, 1e-9);
}

/// The scene of the star with a pump in the west joint in the place of a pressure at its end.
fn pumped(rate: &str, load: &str) -> Workshop {
    let pump = format!(
        "[load]\n{load}\n\n[[source]]\nname = \"pump\"\nfracture = \"west\"\nrate = {rate}\n"
    );
    Workshop::new(
        "flow-star",
        &[("[boundary.left]\nfluid_pressure = 3e5\n", &pump)],
    )
}

/// At the end of each load step, and times its history.
#[test]
fn a_rate_is_what_the_time_makes_of_it() {
    let times = "times = [1.0, 2.0, 3.0]";
    let sine = |time: f64| 1e-5 * (std::f64::consts::PI * time / 4.0).sin();
    let linear = |time: f64| 2e-6 * time;
    let halved = |time: f64| 1e-6 * time;
    let table = "{ table = [[0, 0], [10, 2e-5]], over = \"time\" }";
    let history = format!("{table}\nhistory = [[0, 0.5]]");
    type Wanted<'a> = &'a dyn Fn(f64) -> f64;
    let cases: [(&str, Wanted<'_>); 3] = [
        ("{ expression = \"1e-5 * sin(PI*time/4)\" }", &sine),
        (table, &linear),
        (&history, &halved),
    ];
    for (rate, wanted) in cases {
        let rows = sources(&pumped(rate, times).solve("out", &[]));
        let pump: Vec<f64> = rows
            .iter()
            .filter(|row| row.0 == "pump")
            .map(|row| row.2)
            .collect();
        assert_eq!(pump.len(), 3);
        for (found, time) in pump.into_iter().zip([1.0, 2.0, 3.0]) {
            assert_near(found, wanted(time), 1e-14);
        }
    }
    for (rate, load, says) in [
        ("{ expression = \"1e-5 * x * time\" }", times, "time alone"),
        (
            "{ expression = \"1e-5 * time\" }",
            "steps = [1.0]",
            "no times",
        ),
        (
            "{ table = [[1, 0], [10, 2e-5]], over = \"time\" }",
            times,
            "no row",
        ),
    ] {
        let run = pumped(rate, load).run("out", &[]);
        assert_eq!(run.code, Some(2), "{}", run.err);
        assert!(run.err.contains(says), "{says}: {}", run.err);
    }
}
